//! The options of the server from the command line, and the bounds of its work.

use std::net::SocketAddr;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

/// The options of the server.
#[derive(Clone)]
pub struct ServerOptions {
    /// The database.
    pub db: PathBuf,
    /// An older database, whose differences from `db` the server tells.
    pub before: Option<PathBuf>,
    /// The address to listen on. Port 0 picks a free port.
    pub addr: SocketAddr,
    /// Whether the server may listen on an address that other machines can reach, and answer to any host name.
    pub allow_remote: bool,
    /// The online map that the page may show beneath the roads, `https://…/{z}/{x}/{y}.png`. With `None` the page sends
    /// no request to another server.
    pub base_map: Option<BaseMap>,
    /// Who may change the register of measurements.
    pub editing: Editing,
    /// The time now in UTC, for what changes are written into the database.
    pub now: Arc<dyn Fn() -> String + Send + Sync>,
    /// The bounds.
    pub limits: Limits,
}

/// Who may change the register of measurements over the server.
#[derive(Clone, PartialEq, Eq)]
pub enum Editing {
    /// Nobody. The server only reads.
    Off,
    /// Whoever reaches the server, which only this machine can.
    Local,
    /// Whoever sends this token.
    Token(String),
}

impl Editing {
    /// Fewer characters can be guessed.
    pub const SHORTEST_TOKEN: usize = 16;

    /// The token of a text: the text without white space around it.
    ///
    /// # Errors
    /// The text is no token. The error says what is wrong.
    pub fn token(text: &str) -> Result<Self, String> {
        let token = text.trim();
        if token.len() < Self::SHORTEST_TOKEN || !token.bytes().all(|byte| byte.is_ascii_graphic()) {
            return Err(format!(
                "give one line of {} or more letters, digits and signs without spaces, such as `openssl rand -hex 16` prints",
                Self::SHORTEST_TOKEN
            ));
        }
        Ok(Self::Token(token.to_owned()))
    }

    /// The word for it in the description of what is served.
    pub(super) fn word(&self) -> &'static str {
        match self {
            Self::Off => "off",
            Self::Local => "local",
            Self::Token(_) => "token",
        }
    }
}

/// An online map to show beneath the roads.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BaseMap {
    /// The template of the tiles' addresses, with `{z}`, `{x}` and `{y}`, or with `{bbox-epsg-3857}` for a WMS.
    pub url: String,
    /// Scheme, host and port of `url`, which the page's content security policy allows.
    pub origin: String,
    /// The attribution to show beside the map, as plain text. [`BaseMap::parse`] sets it to the host.
    pub attribution: String,
}

impl BaseMap {
    /// Parses the template of the tiles' addresses.
    ///
    /// # Errors
    /// The text is no such template. The error says what is wrong.
    pub fn parse(url: &str) -> Result<Self, String> {
        let scheme = ["https://", "http://"].into_iter().find(|scheme| url.starts_with(scheme));
        let scheme = scheme.ok_or("give a template that begins with https://")?;
        let host = url[scheme.len()..].split('/').next().unwrap_or_default();
        let plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '.' | '-' | ':' | '[' | ']');
        if host.is_empty() || !host.chars().all(plain) {
            return Err(
                "give a template with a plain host name, such as https://tiles.example.org/{z}/{x}/{y}.png".into()
            );
        }
        let has = |parts: &[&str]| parts.iter().all(|part| url.contains(part));
        if !(has(&["{z}", "{x}", "{y}"]) || has(&["{bbox-epsg-3857}"])) || url.chars().any(char::is_control) {
            return Err("give a template with {z}, {x} and {y}, or with {bbox-epsg-3857} for a WMS".into());
        }
        let attribution = format!("Base map: {host}");
        Ok(Self { url: url.to_owned(), origin: format!("{scheme}{host}"), attribution })
    }

    /// Sets the attribution that the makers of the map require.
    #[must_use]
    pub fn named(self, attribution: &str) -> Self {
        Self { attribution: attribution.to_owned(), ..self }
    }
}

/// Bounds of a lane of work.
#[derive(Debug, Clone, Copy)]
pub struct LaneLimits {
    /// Pieces of work that run at the same time.
    pub at_a_time: usize,
    /// Pieces of work that may wait for a place.
    pub waiting: usize,
    /// The longest time for waiting and working together.
    pub time: Duration,
}

/// All bounds of the server. The defaults suit one machine and a few users.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Bounds of work that reads some rows: tiles, edges, search.
    pub quick: LaneLimits,
    /// Bounds of work that certifies (explanations, routes) or reads the whole database.
    pub slow: LaneLimits,
    /// Bounds of changes of the database, which takes one at a time.
    pub changes: LaneLimits,
    /// Size of the cache of finished answers, bytes.
    pub cache_bytes: usize,
    /// The greatest number of edges whose numbers are held in memory, for tiles and summaries.
    pub held_edges: usize,
    /// Connections at the same time. Further connections wait to be accepted.
    pub connections: usize,
    /// The longest time until a request's line and headers have arrived, and between two requests.
    pub header_time: Duration,
    /// The longest time that one connection may last.
    pub connection_time: Duration,
    /// The longest time for requests in progress to finish when the server is told to stop.
    pub stop_time: Duration,
}

impl Default for Limits {
    fn default() -> Self {
        let processors = std::thread::available_parallelism().map_or(2, usize::from);
        Self {
            quick: LaneLimits { at_a_time: processors.clamp(2, 16), waiting: 256, time: Duration::from_secs(15) },
            slow: LaneLimits { at_a_time: (processors / 2).clamp(1, 8), waiting: 16, time: Duration::from_secs(60) },
            changes: LaneLimits { at_a_time: 1, waiting: 8, time: Duration::from_secs(600) },
            cache_bytes: 128 << 20,
            held_edges: 2_000_000,
            connections: 256,
            header_time: Duration::from_secs(20),
            connection_time: Duration::from_secs(600),
            stop_time: Duration::from_millis(500),
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_token_is_one_long_word() {
        assert!(Editing::token("  0123456789abcdef\n") == Ok(Editing::Token("0123456789abcdef".to_owned())));
        for wrong in ["", "0123456789abcde", "0123456789 abcdef", "0123456789abcdé0"] {
            assert!(Editing::token(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_base_map_is_a_template_of_a_plain_host() {
        let map = BaseMap::parse("https://tiles.example.org:8443/a/{z}/{x}/{y}.png").unwrap();
        assert_eq!(map.origin, "https://tiles.example.org:8443");
        assert!(map.attribution.contains("tiles.example.org"));
        assert_eq!(map.named("© the mappers").attribution, "© the mappers");
        let wms = "https://wms.example.org/aerial?service=WMS&request=GetMap&crs=EPSG:3857&bbox={bbox-epsg-3857}";
        assert_eq!(BaseMap::parse(wms).unwrap().origin, "https://wms.example.org");
        for wrong in [
            "tiles/{z}/{x}/{y}",
            "https:///{z}/{x}/{y}",
            "https://a.org/{z}/{x}",
            "https://a.org; script-src */{z}/{x}/{y}",
            "javascript://a/{z}/{x}/{y}",
        ] {
            assert!(BaseMap::parse(wrong).is_err(), "{wrong}");
        }
    }
}
