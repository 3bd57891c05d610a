//! The checks that every request passes, and the security headers of every response.
//!
//! A request is refused if its method is not `GET` or `HEAD`, if it has a body, or if its address is too long. Changes of measurements have
//! checks of their own (`editing.rs`). Unless
//! --allow-remote is given, a request is also refused if its `Host` is not a loopback name; otherwise a page of another
//! site could read answers by DNS rebinding. Every refusal writes one line to the log.

use std::sync::Arc;

use axum::extract::{Request, State};
use axum::http::{HeaderName, HeaderValue, Method, StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse as _, Response};

use super::app::App;
use super::editing;
use super::lines::{self, RefusalReason};
use super::options::ServerOptions;
use super::problem::Problem;

/// The greatest length of path and query together, bytes.
const LONGEST_TARGET: usize = 4096;

/// The middleware with the checks and headers.
pub(super) async fn gate(State(app): State<Arc<App>>, request: Request, next: Next) -> Response {
    let (method, target) = (request.method().clone(), request.uri().clone());
    let mut response = match refusal(&request, &app.options) {
        Some(problem) => problem.into_response(),
        None => next.run(request).await,
    };
    if let Some(refused) = response.extensions().get::<RefusalReason>() {
        lines::refused(&method, &target, refused);
    }
    let not_allowed = response.status() == StatusCode::METHOD_NOT_ALLOWED;
    let headers = response.headers_mut();
    if not_allowed {
        let methods = listed(editing::methods(target.path(), &app.options.editing));
        headers.extend(HeaderValue::from_str(&methods).map(|methods| (header::ALLOW, methods)));
    }
    for (name, value) in FIXED_HEADERS {
        headers.insert(name, HeaderValue::from_static(value));
    }
    if let Ok(policy) = HeaderValue::from_str(&content_security_policy(&app.options)) {
        headers.insert(header::CONTENT_SECURITY_POLICY, policy);
    }
    response
}

const FIXED_HEADERS: [(HeaderName, &str); 5] = [
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    (header::REFERRER_POLICY, "no-referrer"),
    (header::X_FRAME_OPTIONS, "DENY"),
    (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
    (HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
];

/// The policy allows content of this server only, and nothing inline. MapLibre passes images as blobs.
fn content_security_policy(options: &ServerOptions) -> String {
    let map = options.base_map.as_ref().map_or(String::new(), |map| format!(" {}", map.origin));
    format!(
        "default-src 'none'; script-src 'self'; worker-src 'self'; style-src 'self'; \
         img-src 'self' data: blob:{map}; connect-src 'self'{map}; font-src 'self'; manifest-src 'self'; \
         base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    )
}

fn refusal(request: &Request, options: &ServerOptions) -> Option<Problem> {
    let methods = editing::methods(request.uri().path(), &options.editing);
    let change = ![Method::GET, Method::HEAD].contains(request.method());
    if !methods.contains(request.method()) {
        let detail = format!("methods here are {}", listed(methods));
        return Some(Problem::new(StatusCode::METHOD_NOT_ALLOWED, "method", "The method is not allowed", detail));
    }
    let target = request.uri().path_and_query().map_or(0, |target| target.as_str().len());
    if target > LONGEST_TARGET {
        let detail = format!("path and query have {target} bytes; {LONGEST_TARGET} are allowed");
        return Some(Problem::new(StatusCode::URI_TOO_LONG, "too-long", "The address is too long", detail));
    }
    let headers = request.headers();
    let body = headers.get(header::CONTENT_LENGTH).is_some_and(|length| length.as_bytes() != b"0");
    if !change && (body || headers.contains_key(header::TRANSFER_ENCODING)) {
        let detail = "requests have no body here";
        return Some(Problem::new(StatusCode::PAYLOAD_TOO_LARGE, "body", "A body is not wanted", detail));
    }
    let hosts: Vec<_> = headers.get_all(header::HOST).iter().collect();
    let host = match (hosts.as_slice(), request.uri().authority()) {
        // A target in absolute form takes precedence over the header (RFC 9112, section 3.2.2).
        (_, Some(authority)) => authority.as_str(),
        ([host], None) => host.to_str().unwrap_or_default(),
        _ => "",
    };
    if !options.allow_remote && !is_own(host, options) {
        let detail = "this server answers to localhost and its own address; use the address it printed";
        return Some(Problem::new(StatusCode::MISDIRECTED_REQUEST, "host", "Not for this server", detail));
    }
    if change { editing::refusal(request, host, &options.editing) } else { None }
}

/// Methods as `Allow` lists them.
fn listed(methods: &[Method]) -> String {
    methods.iter().map(Method::as_str).collect::<Vec<_>>().join(", ")
}

/// Whether a `Host` is a loopback name or the server's own address, with any port.
fn is_own(host: &str, options: &ServerOptions) -> bool {
    let (name, port) = match host.rsplit_once(':') {
        Some((name, port)) if !port.ends_with(']') => (name, port),
        _ => (host, ""),
    };
    let name = name.trim_start_matches('[').trim_end_matches(']');
    let own = name.parse().is_ok_and(|ip: std::net::IpAddr| ip.is_loopback() || ip == options.addr.ip());
    port.bytes().all(|b| b.is_ascii_digit()) && (own || name.eq_ignore_ascii_case("localhost"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::PathBuf;

    #[test]
    fn only_loopback_names_are_ones_own() {
        let options = ServerOptions {
            db: PathBuf::new(),
            before: None,
            addr: std::net::SocketAddr::from(([127, 0, 0, 1], 8080)),
            allow_remote: false,
            base_map: None,
            editing: editing::Editing::Off,
            now: Arc::new(String::new),
            limits: super::super::Limits::default(),
        };
        for own in ["localhost", "LOCALHOST:8080", "127.0.0.1", "127.0.0.1:1", "[::1]:8080", "[::1]", "127.8.9.1"] {
            assert!(is_own(own, &options), "{own}");
        }
        for other in [
            "",
            "example.org",
            "localhost.example.org",
            "127.0.0.1.example.org",
            "10.0.0.1",
            "localhost:a",
            "a@localhost",
        ] {
            assert!(!is_own(other, &options), "{other}");
        }
    }
}
