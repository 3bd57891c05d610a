//! Turns a finished body into a response, with entity tag, compression, conditional requests and cache headers.
//!
//! An entity tag is the hash of the content, so it changes exactly when the content changes. A request that names the
//! database's `state` gets an answer that the client may keep for ever, because another state has another address. For
//! other requests the client must ask again each time.

use std::io::{Read as _, Write as _};

use axum::body::Body;
use axum::http::{HeaderValue, StatusCode, header};
use axum::response::Response;
use flate2::Compression;
use flate2::read::GzDecoder;
use flate2::write::GzEncoder;

use super::ask::DecodedRequest;

/// Shorter bodies are not compressed, bytes.
const LEAST_COMPRESSED: usize = 600;
/// zlib's compression level. On the largest tile of rhein_neckar, level 4 takes an eighth more time for 0.7 % fewer bytes, and level 2 a
/// seventh less time for 2 % more.
const LEVEL: u32 = 3;

/// A finished body with its hash. The body is stored compressed if that makes it shorter.
#[derive(Debug)]
pub(super) struct StoredAnswer {
    kind: &'static str,
    bytes: Vec<u8>,
    gzipped: bool,
    plain_len: usize,
    tag: String,
}

/// How long a client may use an answer without asking again.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Keep {
    /// The client must ask each time whether the answer still holds.
    Ask,
    /// The client may keep the answer, because its address names the content.
    ForEver,
}

impl StoredAnswer {
    pub(super) fn new(kind: &'static str, body: Vec<u8>) -> Self {
        let hash = blake3::hash(&body).to_hex();
        let (plain_len, tag) = (body.len(), hash.as_str().chars().take(20).collect());
        let packed = (body.len() >= LEAST_COMPRESSED).then(|| gzip(&body)).flatten();
        let packed = packed.filter(|packed| packed.len() < body.len());
        let gzipped = packed.is_some();
        Self { kind, bytes: packed.unwrap_or(body), gzipped, plain_len, tag }
    }

    /// Length of the stored (possibly compressed) body, bytes.
    pub(super) fn len(&self) -> usize {
        self.bytes.len()
    }

    /// The response to a request. It is `304 Not Modified` if the client has the answer already.
    pub(super) fn respond(&self, ask: &DecodedRequest, keep: Keep) -> Response {
        let encoded = self.gzipped && ask.gzip;
        let tag = if encoded { format!("\"{}-gz\"", self.tag) } else { format!("\"{}\"", self.tag) };
        let fresh = ask.if_none_match.as_deref().is_some_and(|known| self.matches(known));
        let body = match (fresh, self.gzipped && !ask.gzip) {
            (true, _) => Body::empty(),
            (false, true) => Body::from(self.plain()),
            (false, false) => Body::from(self.bytes.clone()),
        };
        let mut response = Response::new(body);
        let headers = response.headers_mut();
        if let Ok(tag) = HeaderValue::from_str(&tag) {
            headers.insert(header::ETAG, tag);
        }
        headers.insert(header::VARY, HeaderValue::from_static("Accept-Encoding"));
        let keep = match keep {
            Keep::Ask => "no-cache",
            Keep::ForEver => "private, max-age=31536000, immutable",
        };
        headers.insert(header::CACHE_CONTROL, HeaderValue::from_static(keep));
        if fresh {
            *response.status_mut() = StatusCode::NOT_MODIFIED;
            return response;
        }
        headers.insert(header::CONTENT_TYPE, HeaderValue::from_static(self.kind));
        if encoded {
            headers.insert(header::CONTENT_ENCODING, HeaderValue::from_static("gzip"));
        }
        response
    }

    /// Whether `If-None-Match` names this content, by weak comparison (RFC 9110, section 13.1.2). The tag of either
    /// encoding matches.
    fn matches(&self, known: &str) -> bool {
        known.split(',').map(str::trim).any(|tag| {
            let tag = tag.strip_prefix("W/").unwrap_or(tag);
            let opaque = tag.strip_prefix('"').and_then(|tag| tag.strip_suffix('"'));
            tag == "*" || opaque.is_some_and(|tag| tag.strip_suffix("-gz").unwrap_or(tag) == self.tag)
        })
    }

    fn plain(&self) -> Vec<u8> {
        let mut plain = Vec::with_capacity(self.plain_len);
        // This program compressed the bytes, so decompression cannot fail and gives at most `plain_len` bytes.
        let _ = GzDecoder::new(self.bytes.as_slice()).take(self.plain_len as u64).read_to_end(&mut plain);
        plain
    }
}

fn gzip(body: &[u8]) -> Option<Vec<u8>> {
    let mut encoder = GzEncoder::new(Vec::with_capacity(body.len() / 3), Compression::new(LEVEL));
    encoder.write_all(body).ok()?;
    encoder.finish().ok()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn ask(gzip: bool, if_none_match: Option<&str>) -> DecodedRequest {
        let mut ask = DecodedRequest::default();
        (ask.gzip, ask.if_none_match) = (gzip, if_none_match.map(str::to_owned));
        ask
    }

    #[test]
    fn what_was_compressed_comes_back() {
        let body: Vec<u8> = (0..5000_u32).map(|i| (i % 50) as u8).collect();
        let stored = StoredAnswer::new("text/plain", body.clone());
        assert!(stored.gzipped && stored.len() < body.len());
        assert_eq!(stored.plain(), body);
    }

    #[test]
    fn a_known_tag_in_either_encoding_means_not_modified() {
        let stored = StoredAnswer::new("text/plain", vec![b'a'; 2000]);
        let tag = |gzip| stored.respond(&ask(gzip, None), Keep::Ask).headers()["etag"].to_str().unwrap().to_owned();
        assert_ne!(tag(true), tag(false), "two encodings are two representations");
        for known in [tag(true), tag(false), format!("\"x\", W/{}", tag(true)), "*".to_owned()] {
            let response = stored.respond(&ask(true, Some(&known)), Keep::Ask);
            assert_eq!(response.status(), StatusCode::NOT_MODIFIED, "{known}");
            assert!(response.headers().contains_key("etag"));
        }
        for other in ["\"x\"", "", "aaaa", &stored.tag] {
            assert_eq!(stored.respond(&ask(true, Some(other)), Keep::Ask).status(), StatusCode::OK, "{other}");
        }
    }
}
