//! Who may change the register of measurements.
//!
//! Pages of other sites cannot: a browser asks before it sends a body of such a type, and the server does not say yes. `Origin` and
//! `Sec-Fetch-Site` are checked, too. Who reaches the server from another machine must send the token.

use axum::extract::Request;
use axum::http::{HeaderMap, HeaderName, Method, StatusCode, header};

pub(super) use super::options::Editing;
use super::problem::Problem;

/// The address under which a turn's surface is supposed. The turn's id stands behind it.
const SUPPOSE: &str = "/api/suppose/";
/// The address of the register. A measurement has its number behind it.
pub(super) const EVIDENCE: &str = "/api/evidence";
/// The longest body, bytes.
pub(super) const MOST_BODY: usize = 1 << 20;
/// The types of a body. A form of another site can have none of them.
const TYPES: [&str; 2] = ["application/geo+json", "application/json"];

/// The methods of an address: those that read, and where changes are taken the one that sends something.
pub(super) fn methods(path: &str, editing: &Editing) -> &'static [Method] {
    const READ: [Method; 2] = [Method::GET, Method::HEAD];
    const ADD: [Method; 3] = [Method::GET, Method::HEAD, Method::POST];
    const REMOVE: [Method; 3] = [Method::GET, Method::HEAD, Method::DELETE];
    if *editing == Editing::Off {
        return &READ;
    }
    match path.strip_prefix(EVIDENCE) {
        Some("") => &ADD,
        Some(one) if one.starts_with('/') => &REMOVE,
        None if path.starts_with(SUPPOSE) => &ADD,
        _ => &READ,
    }
}

/// Why a change is refused, or `None` if it is not. `host` is what the request calls this server.
pub(super) fn refusal(request: &Request, host: &str, editing: &Editing) -> Option<Problem> {
    let headers = request.headers();
    let of_other_site = || {
        let detail = "only the page of this server may change its database";
        Problem::new(StatusCode::FORBIDDEN, "origin", "Not from another site", detail)
    };
    let text = |name: HeaderName| headers.get(name).map(|value| value.to_str().unwrap_or_default());
    let site = text(HeaderName::from_static("sec-fetch-site"));
    if site.is_some_and(|site| site != "same-origin" && site != "none") {
        return Some(of_other_site());
    }
    let origin = text(header::ORIGIN).map(|origin| origin.split_once("://").map_or("", |(_, host)| host));
    if origin.is_some_and(|origin| !origin.eq_ignore_ascii_case(host)) {
        return Some(of_other_site());
    }
    if let Editing::Token(token) = editing
        && !sent(headers).is_some_and(|sent| blake3::hash(sent.as_bytes()) == blake3::hash(token.as_bytes()))
    {
        let detail = "changes need the token of this server, as `Authorization: Bearer TOKEN`";
        return Some(Problem::new(StatusCode::UNAUTHORIZED, "token", "The token is missing or wrong", detail));
    }
    let length = text(header::CONTENT_LENGTH).and_then(|length| length.parse::<usize>().ok());
    if headers.contains_key(header::TRANSFER_ENCODING) || (*request.method() == Method::POST && length.is_none()) {
        let detail = "say the body's length with Content-Length";
        return Some(Problem::new(StatusCode::LENGTH_REQUIRED, "length", "The length is missing", detail));
    }
    if length.is_some_and(|length| length > MOST_BODY) {
        let detail = format!("a body has at most {MOST_BODY} bytes; `netcert evidence add` takes files of any size");
        return Some(Problem::new(StatusCode::PAYLOAD_TOO_LARGE, "body", "The body is too large", detail));
    }
    let kind = text(header::CONTENT_TYPE).and_then(|kind| kind.split(';').next()).map(str::trim);
    if *request.method() == Method::POST
        && !kind.is_some_and(|kind| TYPES.contains(&kind.to_ascii_lowercase().as_str()))
    {
        let detail = format!("send measurements as {}", TYPES.join(" or "));
        return Some(Problem::new(StatusCode::UNSUPPORTED_MEDIA_TYPE, "type", "Not this type of body", detail));
    }
    None
}

/// The token of `Authorization: Bearer`.
fn sent(headers: &HeaderMap) -> Option<&str> {
    let (scheme, token) = headers.get(header::AUTHORIZATION)?.to_str().ok()?.split_once(' ')?;
    scheme.eq_ignore_ascii_case("bearer").then(|| token.trim())
}
