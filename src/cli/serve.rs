//! `netcert serve`: shows the certified network on a map in a browser.

use std::io::Write as _;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::sync::Arc;

use anyhow::Context as _;
use clap::Args;
use netcert::serve::{BaseMap, Editing, Limits, Server, ServerOptions};

use super::Session;
use crate::cli::database::DatabaseArgs;
use crate::cli::output::results;
use crate::cli::session::stop::stop;

/// Show the database on a map in the browser, with vector tiles and a JSON interface.
///
/// The server prints its address when it is ready; Ctrl-C ends it. Unless options say otherwise, it only reads its
/// databases, only this machine can reach it, and the page sends requests to no other server.
#[derive(Args)]
#[command(after_help = "\
Examples:
  netcert serve
  netcert serve --db region.gpkg --addr 127.0.0.1:0         listen on any free port
  netcert serve --db region.gpkg --before old.gpkg          what changed since then is a layer on the map
  netcert serve --edit                                      measurements can be added on the page
  netcert serve --base-map 'https://tile.example.org/{z}/{x}/{y}.png'

/api/openapi.json describes the JSON interface. QGIS and GDAL read layers from /ogc (OGC API – Features).
If a database is replaced while the server runs, the next request is answered from the new one.")]
pub(crate) struct Serve {
    #[command(flatten)]
    db: DatabaseArgs,
    /// An older database. The page then shows what changed since; both files must have a vehicle in common.
    #[arg(long, value_name = "OLD.gpkg")]
    before: Option<PathBuf>,
    /// The address and port to listen on; port 0 picks a free port.
    #[arg(long, value_name = "ADDRESS:PORT", default_value = "127.0.0.1:8080")]
    addr: SocketAddr,
    /// Allow an address that other machines can reach. The server has no log-in and no encryption.
    #[arg(long)]
    allow_remote: bool,
    /// Let the page add measurements to the database and remove them. Whatever sees a change is certified again.
    #[arg(long)]
    edit: bool,
    /// As --edit, but only for who sends the token of this file, a line of 16 characters or more.
    #[arg(long, value_name = "FILE", conflicts_with = "edit")]
    edit_token: Option<PathBuf>,
    /// Tiles of an online map or of aerial pictures that the reader of the page can switch on beneath the roads: an
    /// address with {z}, {x} and {y}, or that of a WMS with {bbox-epsg-3857} [default: none; no request leaves this
    /// machine].
    #[arg(long, value_name = "URL", value_parser = BaseMap::parse)]
    base_map: Option<BaseMap>,
    /// The attribution to show while the base map is on, as its terms of use require [default: its host].
    #[arg(long, value_name = "TEXT", requires = "base_map")]
    base_map_attribution: Option<String>,
}

impl Serve {
    pub(crate) fn run(&self, session: &Session) -> anyhow::Result<()> {
        let base_map = match (self.base_map.clone(), &self.base_map_attribution) {
            (Some(map), Some(text)) => Some(map.named(text)),
            (map, _) => map,
        };
        crate::cli::session::logger::install();
        let clock = session.clock;
        let server = Server::bind(ServerOptions {
            db: self.db.path()?,
            before: self.before.clone(),
            addr: self.addr,
            allow_remote: self.allow_remote,
            base_map,
            editing: self.editing()?,
            now: Arc::new(move || clock.now()),
            limits: Limits::default(),
        })?;
        let mut out = results();
        writeln!(out, "http://{}/", server.address())?;
        out.flush()?;
        session.progress.say("Ctrl-C ends it");
        server.run(stop());
        session.progress.say("stopped");
        Ok(())
    }

    fn editing(&self) -> anyhow::Result<Editing> {
        let Some(path) = &self.edit_token else {
            return Ok(if self.edit { Editing::Local } else { Editing::Off });
        };
        let text = std::fs::read_to_string(path).with_context(|| path.display().to_string())?;
        Editing::token(&text).map_err(|what| anyhow::anyhow!("{}: {what}", path.display()))
    }
}
