//! How to serve: what the command line says, and the bounds.

use std::net::SocketAddr;
use std::path::PathBuf;
use std::time::Duration;

/// What `serve` is asked to do.
#[derive(Clone)]
pub struct Options {
    /// The database.
    pub db: PathBuf,
    /// Where to listen; port 0 picks one.
    pub addr: SocketAddr,
    /// Listen on an address that other machines reach, and answer to any host name.
    pub allow_remote: bool,
    /// Tiles of an online map that the page may show beneath, as `https://…/{z}/{x}/{y}.png`; `None`: no request leaves
    /// the machine.
    pub base_map: Option<BaseMap>,
    /// The bounds.
    pub limits: Limits,
}

/// An online map to show beneath the roads.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BaseMap {
    /// With `{z}`, `{x}` and `{y}`.
    pub url: String,
    /// Scheme, host and port of it: what the page's content security policy lets through.
    pub origin: String,
    /// Who is to be named beside it, as plain text; at first its host.
    pub attribution: String,
}

impl BaseMap {
    /// Reads a template.
    ///
    /// # Errors
    /// It is not one.
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
        if !["{z}", "{x}", "{y}"].iter().all(|part| url.contains(part)) || url.chars().any(char::is_control) {
            return Err("give a template with {z}, {x} and {y}".into());
        }
        let attribution = format!("Base map: {host}");
        Ok(Self { url: url.to_owned(), origin: format!("{scheme}{host}"), attribution })
    }

    /// With what those who made the map want to be named as.
    #[must_use]
    pub fn named(self, attribution: &str) -> Self {
        Self { attribution: attribution.to_owned(), ..self }
    }
}

/// Bounds of a lane of work.
#[derive(Debug, Clone, Copy)]
pub struct LaneLimits {
    /// Done at a time.
    pub at_a_time: usize,
    /// May wait beside those.
    pub waiting: usize,
    /// Waiting and working together.
    pub time: Duration,
}

/// All bounds; the defaults are for one machine with a few people before it.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Rows from the database: tiles, edges, search.
    pub quick: LaneLimits,
    /// Certificates: explanations, routes; and whatever reads everything.
    pub slow: LaneLimits,
    /// Finished answers kept.
    pub cache_bytes: usize,
    /// Connections at a time; more wait to be accepted.
    pub connections: usize,
    /// For a request's line and headers to arrive, and between two requests.
    pub header_time: Duration,
    /// How long one connection may last.
    pub connection_time: Duration,
    /// For requests that are being answered when the server is to stop.
    pub stop_time: Duration,
}

impl Default for Limits {
    fn default() -> Self {
        let processors = std::thread::available_parallelism().map_or(2, usize::from);
        Self {
            quick: LaneLimits { at_a_time: processors.clamp(2, 16), waiting: 256, time: Duration::from_secs(15) },
            slow: LaneLimits { at_a_time: (processors / 2).clamp(1, 8), waiting: 16, time: Duration::from_secs(60) },
            cache_bytes: 128 << 20,
            connections: 256,
            header_time: Duration::from_secs(20),
            connection_time: Duration::from_secs(600),
            stop_time: Duration::from_secs(10),
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_base_map_is_a_template_of_a_plain_host() {
        let map = BaseMap::parse("https://tiles.example.org:8443/a/{z}/{x}/{y}.png").unwrap();
        assert_eq!(map.origin, "https://tiles.example.org:8443");
        assert!(map.attribution.contains("tiles.example.org"));
        assert_eq!(map.named("© the mappers").attribution, "© the mappers");
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
