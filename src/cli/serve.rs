//! `netcert serve`: the certified network on a map, in a browser.

use std::io::Write as _;
use std::net::SocketAddr;

use clap::Args;
use netcert::serve::{BaseMap, Limits, Options, Server};

use super::Session;
use super::database::DatabaseArgs;
use super::output::results;
use super::stop::stop;

/// Show the database on a map: a page in the browser, vector tiles and a JSON interface behind it.
///
/// Prints its address when it is ready; Ctrl-C ends it. It only reads, and listens on this machine alone unless told
/// otherwise; the page asks nobody else for anything.
#[derive(Args)]
#[command(after_help = "\
Examples:
  netcert serve
  netcert serve --db region.gpkg --addr 127.0.0.1:0         any free port
  netcert serve --base-map 'https://tile.example.org/{z}/{x}/{y}.png' --base-map-attribution '© Example'

The interface is described at /api/openapi.json. When the database is made anew, the next request sees it.")]
pub(crate) struct Serve {
    #[command(flatten)]
    db: DatabaseArgs,
    /// Where to listen; port 0 picks a free one.
    #[arg(long, value_name = "ADDRESS:PORT", default_value = "127.0.0.1:8080")]
    addr: SocketAddr,
    /// Listen where other machines can reach it: there is no log-in and no encryption.
    #[arg(long)]
    allow_remote: bool,
    /// Tiles of an online map that the page may show beneath the roads, if the reader wants [default: none; nothing
    /// leaves this machine].
    #[arg(long, value_name = "URL", value_parser = BaseMap::parse)]
    base_map: Option<BaseMap>,
    /// Whom to name in the corner of the map while the base map is shown, as its terms ask [default: its host].
    #[arg(long, value_name = "TEXT", requires = "base_map")]
    base_map_attribution: Option<String>,
}

impl Serve {
    pub(crate) fn run(&self, session: &Session) -> anyhow::Result<()> {
        let base_map = match (self.base_map.clone(), &self.base_map_attribution) {
            (Some(map), Some(text)) => Some(map.named(text)),
            (map, _) => map,
        };
        super::logger::install();
        let server = Server::bind(Options {
            db: self.db.path()?,
            addr: self.addr,
            allow_remote: self.allow_remote,
            base_map,
            limits: Limits::default(),
        })?;
        let mut out = results();
        writeln!(out, "http://{}/", server.address())?;
        out.flush()?;
        session.progress.say("Ctrl-C ends it");
        server.run(stop());
        Ok(())
    }
}
