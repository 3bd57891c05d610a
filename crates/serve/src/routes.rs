//! The endpoint of every address.

use std::sync::Arc;

use axum::extract::{Request, State};
use axum::response::{IntoResponse as _, Response};
use axum::routing::get;
use axum::{Router, middleware};

use super::answer::Stored;
use super::api;
use super::app::{App, Pace};
use super::ask::Ask;
use super::assets;
use super::gate::gate;
use super::problem::Problem;
use super::region::Region;
use super::tiles;

type Work = fn(&Region, &Ask) -> Result<Stored, Problem>;

/// The addresses that are answered from the database, each with its lane and its function.
const ENDPOINTS: &[(&str, Pace, Work)] = &[
    ("/api/vehicles", Pace::Quick, api::vehicles::list),
    ("/api/vehicles/{id}/drawing.svg", Pace::Quick, api::vehicles::drawing),
    ("/api/changes", Pace::Slow, api::changes::changes),
    ("/api/edges/{id}", Pace::Quick, api::edges::edge),
    ("/api/explain/{id}", Pace::Slow, api::explain::explain),
    ("/api/explain/{id}/map.geojson", Pace::Slow, api::explain::mapped),
    ("/api/explain/{id}/picture.svg", Pace::Slow, api::explain::drawn),
    ("/api/route", Pace::Slow, api::route::route),
    ("/api/sheet.css", Pace::Quick, api::route::sheet_css),
    ("/api/sheet.csv", Pace::Slow, api::route::sheet_csv),
    ("/api/sheet.geojson", Pace::Slow, api::route::sheet_geojson),
    ("/api/sheet.html", Pace::Slow, api::route::sheet_html),
    ("/api/road", Pace::Quick, api::road::road),
    ("/api/search", Pace::Quick, api::search::search),
    ("/api/stats", Pace::Slow, api::stats::stats),
    ("/api/suppose/{id}", Pace::Slow, api::suppose::suppose),
    ("/backdrop/{z}/{x}/{y}", Pace::Quick, tiles::backdrop::tile),
    ("/tiles/{policy}/{vehicle}/{z}/{x}/{y}", Pace::Quick, tiles::tile),
];

/// The whole server except listening.
pub(super) fn router(app: Arc<App>) -> Router {
    let mut router = Router::new();
    for &(path, pace, work) in ENDPOINTS {
        let answer = move |State(app): State<Arc<App>>, ask: Ask| async move { app.answer(ask, pace, work).await };
        router = router.route(path, get(answer));
    }
    router
        .route("/healthz", get(health))
        .route("/api/region", get(api::region::region))
        .route("/api/openapi.json", get(api::openapi))
        .fallback(get(assets::asset))
        .layer(middleware::from_fn_with_state(Arc::clone(&app), gate))
        .with_state(app)
}

/// Answers `ok` if the server runs and the database can be read.
async fn health(State(app): State<Arc<App>>, ask: Ask) -> Response {
    app.answer(ask, Pace::Quick, |region, ask| {
        ask.only(&[])?;
        Ok(Stored::new("text/plain; charset=utf-8", format!("ok {}\n", region.state).into_bytes()))
    })
    .await
}

/// The answer to an unknown address.
pub(super) fn nothing(request: &Request) -> Response {
    let path = super::ask::shortened(request.uri().path());
    Problem::not_found(format!("{path}: no such address; /api/openapi.json lists all addresses")).into_response()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn every_address_is_described_and_every_description_has_an_address() {
        let document: serde_json::Value = serde_json::from_str(api::OPENAPI).unwrap();
        let mut described: Vec<&str> = document["paths"].as_object().unwrap().keys().map(String::as_str).collect();
        let mut answered: Vec<&str> = ENDPOINTS.iter().map(|endpoint| endpoint.0).collect();
        answered.extend(["/healthz", "/api/region", "/api/openapi.json"]);
        // The router cannot express that the last part of a tile's address ends in `.mvt`.
        let answered = answered.iter().map(|path| {
            let end = if path.ends_with("{y}") { ".mvt" } else { "" };
            format!("{path}{end}")
        });
        let mut answered: Vec<String> = answered.collect();
        described.sort_unstable();
        answered.sort_unstable();
        assert_eq!(described, answered);
    }
}
