//! The page: files of `web/dist`, built into the program by this crate's `build.rs`.
//!
//! Only the addresses in the table are answered, and no path of a request reaches the file system. Clients may keep files
//! below `/assets/` for ever, because their names contain a hash.

use std::sync::{Arc, OnceLock};

use axum::extract::FromRequestParts as _;
use axum::extract::Request;
use axum::response::{IntoResponse as _, Response};

use super::answer::{Keep, StoredAnswer};
use super::ask::{DecodedRequest, shortened};
use super::problem::Problem;

include!(concat!(env!("OUT_DIR"), "/page.rs"));

type Table = Vec<(&'static str, OnceLock<Arc<StoredAnswer>>)>;

/// Answers with a file of the page.
pub(super) async fn asset(request: Request) -> Response {
    static KEPT: OnceLock<Table> = OnceLock::new();
    let path = match request.uri().path() {
        "/" => "/index.html",
        path => path,
    };
    let kept = KEPT.get_or_init(|| PAGE.iter().map(|(path, _)| (*path, OnceLock::new())).collect());
    let found = PAGE.iter().zip(kept).find(|((name, _), _)| *name == path);
    let Some(((name, bytes), (_, stored))) = found else { return nothing(&request) };
    let stored = stored.get_or_init(|| Arc::new(StoredAnswer::new(kind(name), bytes.to_vec())));
    let keep = if name.starts_with("/assets/") { Keep::ForEver } else { Keep::Ask };
    let (mut parts, _) = request.into_parts();
    match DecodedRequest::from_request_parts(&mut parts, &()).await {
        Ok(ask) => stored.respond(&ask, keep),
        Err(problem) => problem.into_response(),
    }
}

/// The answer to an unknown address.
fn nothing(request: &Request) -> Response {
    let path = shortened(request.uri().path());
    Problem::not_found(format!("{path}: no such address; /api/openapi.json lists all addresses")).into_response()
}

/// The media type of a file, by the ending of its name.
fn kind(name: &str) -> &'static str {
    match name.rsplit('.').next() {
        Some("html") => "text/html; charset=utf-8",
        Some("js" | "mjs") => "text/javascript; charset=utf-8",
        Some("css") => "text/css; charset=utf-8",
        Some("svg") => "image/svg+xml",
        Some("png") => "image/png",
        Some("webp") => "image/webp",
        Some("ico") => "image/x-icon",
        Some("woff2") => "font/woff2",
        Some("json" | "map") => "application/json",
        Some("webmanifest") => "application/manifest+json",
        _ => "text/plain; charset=utf-8",
    }
}
