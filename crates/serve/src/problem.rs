//! Errors as `application/problem+json` (RFC 9457). Each has a stable type and a sentence that says what to do.

use axum::http::{HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde_json::{Value, json};

use super::lines::RefusalReason;
use crate::stop::Stopped;
use crate::store::StoreError;

/// A refusal or failure of a request.
#[derive(Debug, Clone)]
pub(super) struct Problem {
    pub(super) status: StatusCode,
    /// The last part of `type`: stable, in lower case.
    kind: &'static str,
    title: &'static str,
    detail: String,
    /// The parameter at fault.
    parameter: Option<String>,
    /// Further members, which programs read. Boxed, because a result is as large as its error.
    more: Box<serde_json::Map<String, Value>>,
    retry_after_s: Option<u32>,
}

impl Problem {
    pub(super) fn new(status: StatusCode, kind: &'static str, title: &'static str, detail: impl Into<String>) -> Self {
        Self { status, kind, title, detail: detail.into(), parameter: None, more: Box::default(), retry_after_s: None }
    }

    /// A parameter is missing, unknown, out of range or cannot be read.
    pub(super) fn parameter(name: &str, detail: impl std::fmt::Display) -> Self {
        let detail = format!("{name}: {detail}");
        let problem = Self::new(StatusCode::BAD_REQUEST, "bad-parameter", "A parameter is wrong", detail);
        Self { parameter: Some(name.to_owned()), ..problem }
    }

    pub(super) fn not_found(detail: impl Into<String>) -> Self {
        Self::new(StatusCode::NOT_FOUND, "not-found", "There is no such thing", detail)
    }

    /// The server has too much to do now.
    pub(super) fn busy(detail: impl Into<String>) -> Self {
        let problem = Self::new(StatusCode::SERVICE_UNAVAILABLE, "busy", "Busy just now", detail);
        Self { retry_after_s: Some(1), ..problem }
    }

    /// The server has too much to do, and is likely to have a place again after this time.
    pub(super) fn busy_for(detail: impl Into<String>, time: std::time::Duration) -> Self {
        Self { retry_after_s: Some(time.as_secs_f64().ceil() as u32), ..Self::busy(detail) }
    }

    /// The work took longer than its lane allows.
    pub(super) fn too_slow(limit_s: f64) -> Self {
        Self::cut_off(format!("not done within {limit_s} s; ask for less, or ask again when the server is less busy"))
    }

    fn cut_off(detail: String) -> Self {
        Self::new(StatusCode::GATEWAY_TIMEOUT, "too-slow", "It takes too long", detail)
    }

    /// A place is near no road that may be used. `members` say where the nearest one is, and what is beside the place.
    pub(super) fn no_road(detail: impl Into<String>, members: Value) -> Self {
        let title = "There is no road that may be used";
        let problem = Self::new(StatusCode::UNPROCESSABLE_ENTITY, "no-road", title, detail);
        let Value::Object(more) = members else { return problem };
        Self { more: Box::new(more), ..problem }
    }

    /// What was sent to be kept is faulty. `faults` name each fault.
    pub(super) fn faulty(detail: impl Into<String>, faults: Vec<Value>) -> Self {
        let title = "The measurements are faulty; nothing was kept";
        let problem = Self::new(StatusCode::UNPROCESSABLE_ENTITY, "measurements", title, detail);
        Self { more: Box::new(serde_json::Map::from_iter([("faults".to_owned(), faults.into())])), ..problem }
    }

    /// The certificates were made by another version of the program.
    pub(super) fn stale(detail: impl Into<String>) -> Self {
        Self::new(StatusCode::CONFLICT, "stale", "The certificates are of another version", detail)
    }

    /// What was begun with one state of the database cannot go on with another one.
    pub(super) fn changed(detail: impl Into<String>) -> Self {
        Self::new(StatusCode::CONFLICT, "changed", "The database has changed", detail)
    }

    /// The program has a fault.
    pub(super) fn fault(detail: impl Into<String>) -> Self {
        let title = "A fault of netcert; please report it";
        Self::new(StatusCode::INTERNAL_SERVER_ERROR, "fault", title, detail)
    }
}

impl From<StoreError> for Problem {
    /// The message leaves out the path of the file, which clients should not learn.
    fn from(error: StoreError) -> Self {
        let unavailable = |kind, title, detail: String| Self {
            retry_after_s: Some(2),
            ..Self::new(StatusCode::SERVICE_UNAVAILABLE, kind, title, detail)
        };
        match error {
            StoreError::NotThere { detail, .. } => Self::not_found(detail),
            StoreError::SetSettings { vehicle, policy, detail, .. } => Self::stale(format!(
                "the settings that {vehicle} was certified with under the {policy} policy cannot be read: {detail}; run \
                 `netcert certify --vehicle {vehicle} --corridor {policy}`"
            )),
            StoreError::Busy(_) => Self::busy("the database is being written; ask again when that is done"),
            StoreError::Missing(_) => unavailable(
                "no-database",
                "The database is gone",
                "its file is not there any more; run `netcert ingest` again".to_owned(),
            ),
            StoreError::Io { source, .. } => {
                unavailable("no-database", "The database cannot be read", source.to_string())
            }
            StoreError::ReadOnly { detail, .. } => {
                let detail = format!("{detail}; whoever runs the server can move it to where it may write");
                unavailable("no-database", "The database cannot be written", detail)
            }
            other => {
                let detail = match &other {
                    StoreError::Damaged { detail, .. } => detail.clone(),
                    StoreError::Sql { source, .. } => source.to_string(),
                    _ => "it is not a database that this program can read".to_owned(),
                };
                unavailable(
                    "no-database",
                    "The database cannot be read",
                    format!("{detail}; run `netcert ingest` again"),
                )
            }
        }
    }
}

impl From<Stopped> for Problem {
    /// The time of the request is up, or the client has gone.
    fn from(stopped: Stopped) -> Self {
        Self::cut_off(format!("{stopped}; ask for less, or ask again when the server is less busy"))
    }
}

impl IntoResponse for Problem {
    fn into_response(self) -> Response {
        let mut body = json!({
            "type": format!("urn:netcert:problem:{}", self.kind),
            "title": self.title,
            "status": self.status.as_u16(),
            "detail": self.detail,
        });
        if let Some(parameter) = &self.parameter {
            body["parameter"] = json!(parameter);
        }
        for (name, member) in *self.more {
            body[name] = member;
        }
        let mut response = (self.status, body.to_string()).into_response();
        response.extensions_mut().insert(RefusalReason(format!(
            "{} {}: {}",
            self.status.as_u16(),
            self.title,
            self.detail
        )));
        let headers = response.headers_mut();
        headers.insert(header::CONTENT_TYPE, HeaderValue::from_static("application/problem+json"));
        headers.insert(header::CACHE_CONTROL, HeaderValue::from_static("no-store"));
        if let Some(seconds) = self.retry_after_s {
            headers.insert(header::RETRY_AFTER, HeaderValue::from(seconds));
        }
        if self.status == StatusCode::UNAUTHORIZED {
            headers.insert(header::WWW_AUTHENTICATE, HeaderValue::from_static("Bearer"));
        }
        response
    }
}
