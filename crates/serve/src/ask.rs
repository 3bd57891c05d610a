//! A request as the endpoints see it: names from the path, parameters of the query, and the encodings that the client
//! accepts.
//!
//! All values are decoded. An unknown parameter is refused; otherwise a misspelt parameter would silently have its
//! default.

use axum::extract::{FromRequestParts, RawPathParams};
use axum::http::header::{self, HeaderMap};
use axum::http::request::Parts;

use super::problem::Problem;
use crate::osm::facts::Policy;
use crate::route::Position;
use crate::rows::Bounds;
use crate::stop::Stop;
use crate::words::Named;

/// The greatest number of parameters of a request; no endpoint has as many.
const MOST_PARAMETERS: usize = 24;
/// Longest value of one parameter, characters.
const LONGEST_VALUE: usize = 200;
/// Longest condition of a request, characters, and the parameter that it stands in.
const LONGEST_FILTER: usize = 2000;
const FILTER: &str = "filter";
/// Answers below this path have whole addresses in them, so they depend on the host that was asked.
pub(super) const ADDRESSED: &str = "/ogc";
/// A parameter that every endpoint accepts: the state of the database that the client has seen. See `answer`.
pub(super) const STATE: &str = "state";

/// A decoded request.
#[derive(Debug, Clone, Default)]
pub(super) struct DecodedRequest {
    path: String,
    names: Vec<(String, String)>,
    parameters: Vec<(String, String)>,
    /// Scheme, host and port by which the server was asked; empty if the request does not say.
    origin: String,
    pub(super) if_none_match: Option<String>,
    pub(super) gzip: bool,
    /// Told to stop when nobody waits for the answer any more.
    pub(super) stop: Stop,
}

impl<S: Send + Sync> FromRequestParts<S> for DecodedRequest {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Problem> {
        let names = RawPathParams::from_request_parts(parts, state).await;
        let names = names.map_err(|_| Problem::not_found("the path is not UTF-8"))?;
        let names = names.iter().map(|(name, value)| (name.to_owned(), value.to_owned())).collect();
        let parameters = read_query(parts.uri.query().unwrap_or_default())?;
        let if_none_match = text(&parts.headers, header::IF_NONE_MATCH);
        let gzip = text(&parts.headers, header::ACCEPT_ENCODING).is_some_and(|accepts| takes_gzip(&accepts));
        let (path, origin, stop) = (parts.uri.path().to_owned(), origin(parts), Stop::default());
        Ok(Self { path, names, parameters, origin, if_none_match, gzip, stop })
    }
}

/// Scheme, host and port of the request. A proxy that encrypts says so in `X-Forwarded-Proto`. Empty if the host has characters that no host
/// has.
fn origin(parts: &Parts) -> String {
    let host = parts.uri.authority().map(|authority| authority.as_str().to_owned());
    let host = host.or_else(|| text(&parts.headers, header::HOST)).unwrap_or_default();
    let plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '.' | '-' | '_' | ':' | '[' | ']');
    if host.is_empty() || !host.chars().all(plain) {
        return String::new();
    }
    let forwarded = text(&parts.headers, header::HeaderName::from_static("x-forwarded-proto"));
    // The first one is the proxy that the client asked.
    let encrypted =
        |schemes: String| schemes.split(',').next().is_some_and(|own| own.trim().eq_ignore_ascii_case("https"));
    let scheme = if forwarded.is_some_and(encrypted) { "https" } else { "http" };
    format!("{scheme}://{host}")
}

fn text(headers: &HeaderMap, name: header::HeaderName) -> Option<String> {
    let values: Vec<&str> = headers.get_all(name).iter().filter_map(|value| value.to_str().ok()).collect();
    (!values.is_empty()).then(|| values.join(", "))
}

/// Whether `Accept-Encoding` allows gzip, by name or by `*`, with a weight above 0 (RFC 9110, section 12.5.3).
fn takes_gzip(accepts: &str) -> bool {
    let weight = |wanted: &str| {
        accepts.split(',').find_map(|item| {
            let mut parts = item.split(';').map(str::trim);
            let name = parts.next()?;
            let weight = parts.find_map(|part| part.strip_prefix("q=")).map_or(Some(1.0), |q| q.parse::<f64>().ok());
            name.eq_ignore_ascii_case(wanted).then_some(weight?)
        })
    };
    weight("gzip").or_else(|| weight("*")).is_some_and(|weight| weight > 0.0)
}

fn read_query(query: &str) -> Result<Vec<(String, String)>, Problem> {
    let mut parameters = Vec::new();
    for (name, value) in form_urlencoded::parse(query.as_bytes()) {
        if parameters.len() == MOST_PARAMETERS {
            return Err(Problem::parameter("query", format!("more than {MOST_PARAMETERS} parameters")));
        }
        let most = if name == FILTER { LONGEST_FILTER } else { LONGEST_VALUE };
        let long = |text: &str| text.chars().nth(most).is_some();
        if long(&value) || long(&name) {
            return Err(Problem::parameter(&shortened(&name), format!("longer than {most} characters")));
        }
        parameters.push((name.into_owned(), value.into_owned()));
    }
    Ok(parameters)
}

/// A text of the request for use in messages, without control characters and at most 60 characters long.
pub(super) fn shortened(text: &str) -> String {
    let mut short: String = text.chars().filter(|c| !c.is_control()).take(60).collect();
    if short.chars().count() < text.chars().count() {
        short.push('…');
    }
    short
}

impl DecodedRequest {
    /// A request with these parameters.
    #[cfg(test)]
    pub(super) fn with_parameters(parameters: &[(&str, &str)]) -> Self {
        let parameters = parameters.iter().map(|&(name, value)| (name.to_owned(), value.to_owned())).collect();
        Self { parameters, ..Self::default() }
    }

    /// Refuses parameters that `known` lacks, and parameters that are given twice. An entry of `known` that ends in `*`
    /// may be given several times.
    pub(super) fn only(&self, known: &[&str]) -> Result<(), Problem> {
        for (i, (name, _)) in self.parameters.iter().enumerate() {
            let entry = known.iter().find(|entry| entry.trim_end_matches('*') == name);
            let entry = entry.copied().or_else(|| (name == STATE).then_some(STATE));
            let Some(entry) = entry else {
                let known: Vec<&str> = known.iter().map(|entry| entry.trim_end_matches('*')).collect();
                let known = if known.is_empty() { "there are none here".to_owned() } else { known.join(", ") };
                let name = shortened(name);
                return Err(Problem::parameter(&name, format!("no such parameter; known: {known}")));
            };
            if !entry.ends_with('*') && self.parameters.iter().skip(i + 1).any(|(other, _)| other == name) {
                return Err(Problem::parameter(name, "given more than once"));
            }
        }
        Ok(())
    }

    /// The value of a name in the path.
    pub(super) fn name(&self, name: &str) -> Result<&str, Problem> {
        let found = self.names.iter().find(|pair| pair.0 == name).map(|pair| pair.1.as_str());
        found.ok_or_else(|| Problem::fault(format!("the path has no {name}")))
    }

    pub(super) fn parameter(&self, name: &str) -> Option<&str> {
        self.parameters.iter().find(|pair| pair.0 == name).map(|pair| pair.1.as_str())
    }

    pub(super) fn all<'a>(&'a self, name: &'a str) -> impl Iterator<Item = &'a str> {
        self.parameters.iter().filter(move |pair| pair.0 == name).map(|pair| pair.1.as_str())
    }

    pub(super) fn required(&self, name: &str) -> Result<&str, Problem> {
        self.parameter(name).ok_or_else(|| Problem::parameter(name, "is missing"))
    }

    /// The key for the cache: the path and the sorted parameters without `state`. The same question has the same key.
    pub(super) fn key(&self) -> String {
        let mut parameters: Vec<_> = self.parameters.iter().filter(|pair| pair.0 != STATE).collect();
        parameters.sort_by(|a, b| a.0.cmp(&b.0)); // stable, so several values of one name keep their order
        let mut key = self.path.clone();
        if key.starts_with(ADDRESSED) {
            key.insert_str(0, &self.origin);
        }
        for (name, value) in parameters {
            // Names and values are escaped, so `\n` can separate them.
            key.push('\n');
            key.push_str(&name.escape_default().to_string());
            key.push('\n');
            key.push_str(&value.escape_default().to_string());
        }
        key
    }

    /// Scheme, host and port by which the server was asked, without a slash at the end.
    pub(super) fn origin(&self) -> &str {
        &self.origin
    }

    /// The whole address of this request, with another value of one parameter if there is one.
    pub(super) fn address(&self, other: Option<(&str, &str)>) -> String {
        let kept = self.parameters.iter().filter(|pair| other.is_none_or(|other| other.0 != pair.0));
        let kept = kept.map(|pair| (pair.0.as_str(), pair.1.as_str()));
        let query = form_urlencoded::Serializer::new(String::new()).extend_pairs(kept.chain(other)).finish();
        let mark = if query.is_empty() { "" } else { "?" };
        format!("{}{}{mark}{query}", self.origin, self.path)
    }

    /// The whole number of a parameter, within bounds. `None` if the parameter is missing.
    pub(super) fn whole(&self, name: &str, bounds: std::ops::RangeInclusive<u32>) -> Result<Option<u32>, Problem> {
        let Some(text) = self.parameter(name) else { return Ok(None) };
        let value = text.parse::<u32>().ok().filter(|value| bounds.contains(value));
        let (low, high) = (bounds.start(), bounds.end());
        value.map(Some).ok_or_else(|| Problem::parameter(name, format!("give a whole number from {low} to {high}")))
    }

    /// The finite number of a parameter, within bounds. `None` if the parameter is missing.
    pub(super) fn number(&self, name: &str, low: f64, high: f64) -> Result<Option<f64>, Problem> {
        let Some(text) = self.parameter(name) else { return Ok(None) };
        let value = text.parse::<f64>().ok().filter(|value| (low..=high).contains(value));
        value.map(Some).ok_or_else(|| Problem::parameter(name, format!("give a number from {low} to {high}")))
    }

    /// The box of a parameter, `west,south,east,north` in degrees. A box whose west is east of its east goes over 180°. `None` if the
    /// parameter is missing.
    pub(super) fn bounds(&self, name: &str) -> Result<Option<Bounds>, Problem> {
        let Some(text) = self.parameter(name) else { return Ok(None) };
        let numbers: Option<Vec<f64>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
        let on_earth = |lon: f64, lat: f64| lon.abs() <= 180.0 && lat.abs() <= 90.0;
        match numbers.as_deref() {
            Some(&[west, south, east, north]) if on_earth(west, south) && on_earth(east, north) && south <= north => {
                Ok(Some(Bounds { west, south, east, north }))
            }
            _ => Err(Problem::parameter(name, "give degrees: west,south,east,north, such as 8.6,49.3,8.8,49.5")),
        }
    }

    /// The places of a parameter, each `lon,lat` in degrees.
    pub(super) fn places(&self, name: &str) -> Result<Vec<Position>, Problem> {
        self.all(name)
            .map(|text| {
                let numbers: Option<Vec<f64>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
                match numbers.as_deref() {
                    Some(&[lon, lat]) if lon.abs() <= 180.0 && lat.abs() <= 90.0 => Ok(Position { lon, lat }),
                    _ => Err(Problem::parameter(name, "give degrees: longitude,latitude, such as 8.694,49.411")),
                }
            })
            .collect()
    }
}

/// The value of a word. The error lists the words that there are.
pub(super) fn one_of<T: Named>(name: &str, word: &str) -> Result<T, Problem> {
    T::named(word).ok_or_else(|| {
        let words: Vec<&str> = T::ALL.iter().map(|value| value.name()).collect();
        Problem::parameter(name, format!("no {:?} here; give one of {}", shortened(word), words.join(", ")))
    })
}

/// The policy of a word from the path or a parameter.
pub(super) fn policy(word: &str) -> Result<Policy, Problem> {
    one_of("policy", word)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn ask(path: &str, query: &str) -> DecodedRequest {
        DecodedRequest { path: path.to_owned(), parameters: read_query(query).unwrap(), ..DecodedRequest::default() }
    }

    #[test]
    fn gzip_is_taken_where_the_client_says_so() {
        for accepts in ["gzip", "br, GZIP", "deflate, gzip;q=0.5", "*", "gzip ; q=1.0"] {
            assert!(takes_gzip(accepts), "{accepts}");
        }
        for accepts in ["", "br", "identity", "gzip;q=0", "*;q=0", "gzip;q=0, *", "gzip;q=x"] {
            assert!(!takes_gzip(accepts), "{accepts}");
        }
    }

    #[test]
    fn a_parameter_nobody_knows_is_refused() {
        let known = ["vehicle", "via*"];
        assert!(ask("/", "vehicle=A&via=1,2&via=3,4&state=x").only(&known).is_ok());
        assert!(ask("/", "vehicel=A").only(&known).is_err());
        assert!(ask("/", "vehicle=A&vehicle=B").only(&known).is_err());
    }

    #[test]
    fn the_order_of_parameters_does_not_matter_to_the_key() {
        assert_eq!(ask("/a", "b=1&a=2&state=9").key(), ask("/a", "a=2&b=1").key());
        assert_ne!(ask("/a", "via=1&via=2").key(), ask("/a", "via=2&via=1").key());
        assert_ne!(ask("/a", "q=x%0Ay%0Az").key(), ask("/a", "q=x&y=z").key());
    }

    #[test]
    fn an_address_has_another_value_where_one_is_given() {
        let ask = DecodedRequest {
            origin: "http://localhost:80".to_owned(),
            ..ask("/ogc/x", "limit=5&after=1&filter=a+%3D+'%26'")
        };
        assert_eq!(ask.address(None), "http://localhost:80/ogc/x?limit=5&after=1&filter=a+%3D+%27%26%27");
        let next = "http://localhost:80/ogc/x?limit=5&filter=a+%3D+%27%26%27&after=2-f";
        assert_eq!(ask.address(Some(("after", "2-f"))), next);
        let other = DecodedRequest { origin: "https://localhost:80".to_owned(), ..ask.clone() };
        assert_ne!(other.key(), ask.key(), "its links differ");
        assert!(read_query(&format!("filter={}", "a".repeat(2000))).is_ok());
        assert!(read_query(&format!("filter={}", "a".repeat(2001))).is_err());
    }

    #[test]
    fn places_and_numbers_out_of_range_are_refused() {
        assert_eq!(ask("/", "from=8.5,%2049").places("from").unwrap(), [Position { lon: 8.5, lat: 49.0 }]);
        for wrong in ["1", "1,2,3", "181,0", "0,91", "NaN,1", "inf,1", "a,b", "1,,2", ""] {
            assert!(ask("/", &format!("from={wrong}")).places("from").is_err(), "{wrong}");
        }
        assert_eq!(ask("/", "").bounds("bbox").unwrap(), None);
        assert_eq!(ask("/", "bbox=170,-10,-170,10").bounds("bbox").unwrap().unwrap().west, 170.0);
        for wrong in ["", "1,2,3", "1,2,3,4,5", "1,5,2,4", "181,0,1,1", "0,NaN,1,1", "0,0,inf,1", "a,b,c,d"] {
            assert!(ask("/", &format!("bbox={wrong}")).bounds("bbox").is_err(), "{wrong}");
        }
        assert!(ask("/", "n=NaN").number("n", 0.0, 1.0).is_err());
        assert!(ask("/", "n=-1").whole("n", 0..=9).is_err());
        assert_eq!(ask("/", "n=3").whole("n", 0..=9).unwrap(), Some(3));
    }
}
