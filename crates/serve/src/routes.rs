//! The endpoint of every address.

use std::sync::Arc;

use axum::body::Bytes;
use axum::extract::{DefaultBodyLimit, State};
use axum::response::Response;
use axum::routing::{delete, get, post};
use axum::{Router, middleware};

use super::answer::StoredAnswer;
use super::api;
use super::app::{App, Pace};
use super::ask::DecodedRequest;
use super::assets;
use super::editing;
use super::gate::gate;
use super::ogc;
use super::options::ServerOptions;
use super::problem::Problem;
use super::state::ServedState;
use super::tiles;

type Work = fn(&ServedState, &DecodedRequest) -> Result<StoredAnswer, Problem>;

/// The addresses that are answered from the database, each with its lane and its function.
const ENDPOINTS: &[(&str, Pace, Work)] = &[
    ("/api/vehicles", Pace::Quick, |served, ask| api::vehicles::list(&served.region, ask)),
    ("/api/vehicles/{id}/drawing.svg", Pace::Quick, |served, ask| api::vehicles::drawing(&served.region, ask)),
    ("/api/changes", Pace::Slow, |served, ask| {
        api::changes::changes(&served.region, served.older.as_ref(), &served.comparisons, ask)
    }),
    ("/api/edges/{id}", Pace::Quick, |served, ask| api::edges::edge(&served.region, ask)),
    ("/api/evidence", Pace::Quick, |served, ask| api::evidence::list(&served.region, ask)),
    ("/api/evidence/{no}", Pace::Quick, |served, ask| api::evidence::one(&served.region, ask)),
    ("/api/explain/{id}", Pace::Slow, |served, ask| api::explain::explain(&served.region, &served.explanations, ask)),
    ("/api/explain/{id}/map.geojson", Pace::Slow, |served, ask| {
        api::explain::mapped(&served.region, &served.explanations, ask)
    }),
    ("/api/explain/{id}/picture.svg", Pace::Slow, |served, ask| {
        api::explain::drawn(&served.region, &served.explanations, ask)
    }),
    ("/api/route", Pace::Slow, |served, ask| api::route::route(&served.region, &served.planners, ask)),
    ("/api/decision.html", Pace::Slow, |served, ask| api::route::decision_html(&served.region, &served.planners, ask)),
    ("/api/sheet.css", Pace::Quick, |_, ask| api::route::sheet_css(ask)),
    ("/api/sheet.csv", Pace::Slow, |served, ask| api::route::sheet_csv(&served.region, &served.planners, ask)),
    ("/api/sheet.geojson", Pace::Slow, |served, ask| api::route::sheet_geojson(&served.region, &served.planners, ask)),
    ("/api/sheet.html", Pace::Slow, |served, ask| api::route::sheet_html(&served.region, &served.planners, ask)),
    ("/api/road", Pace::Quick, |served, ask| api::road::road(&served.region, ask)),
    ("/api/search", Pace::Quick, |served, ask| api::search::search(&served.region, ask)),
    ("/api/stats", Pace::Slow, |served, ask| api::stats::stats(&served.region, ask)),
    ("/api/suppose/{id}", Pace::Slow, |served, ask| api::suppose::suppose(&served.region, ask)),
    ("/backdrop/{z}/{x}/{y}", Pace::Quick, |served, ask| tiles::backdrop::tile(&served.region, ask)),
    ("/tiles/{policy}/{vehicle}/{z}/{x}/{y}", Pace::Quick, |served, ask| {
        tiles::tile(&served.region, &served.overviews, ask)
    }),
];

type FeatureWork = fn(&ServedState, &DecodedRequest, &ServerOptions) -> Result<StoredAnswer, Problem>;

/// The addresses of OGC API – Features. All of them read some rows.
const FEATURES: &[(&str, FeatureWork)] = &[
    ("/ogc", |served, ask, _| ogc::landing(&served.region, ask)),
    ("/ogc/", |served, ask, _| ogc::landing(&served.region, ask)),
    ("/ogc/api", |_, ask, _| ogc::api(ask)),
    ("/ogc/conformance", |_, ask, _| ogc::conformance(ask)),
    ("/ogc/collections", |served, ask, _| ogc::collections(&served.region, ask)),
    ("/ogc/collections/{collectionId}", |served, ask, _| ogc::collection(&served.region, ask)),
    ("/ogc/collections/{collectionId}/queryables", |served, ask, _| ogc::queryables(&served.region, ask)),
    ("/ogc/collections/{collectionId}/schema", |served, ask, _| ogc::schema(&served.region, ask)),
    ("/ogc/collections/{collectionId}/items", |served, ask, options| {
        ogc::items(&served.region, &served.state, &(options.now)(), ask)
    }),
    ("/ogc/collections/{collectionId}/items/{featureId}", |served, ask, _| ogc::item(&served.region, ask)),
];

/// The whole server except listening.
pub(super) fn router(app: Arc<App>) -> Router {
    let mut router = Router::new();
    for &(path, pace, work) in ENDPOINTS {
        let answer =
            move |State(app): State<Arc<App>>, ask: DecodedRequest| async move { app.answer(ask, pace, work).await };
        router = router.route(path, get(answer));
    }
    for &(path, work) in FEATURES {
        let answer = move |State(app): State<Arc<App>>, ask: DecodedRequest| async move {
            let options = app.options.clone();
            app.answer(ask, Pace::Quick, move |served, ask| work(served, ask, &options)).await
        };
        router = router.route(path, get(answer));
    }
    router
        .route(editing::EVIDENCE, post(add_evidence))
        .route(&format!("{}/{{no}}", editing::EVIDENCE), delete(remove_evidence))
        .route("/api/suppose/{id}", post(suppose_surface))
        .route("/healthz", get(health))
        .route("/api/region", get(region))
        .route("/api/openapi.json", get(openapi))
        .fallback(get(assets::asset))
        .layer(DefaultBodyLimit::max(editing::MOST_BODY))
        .layer(middleware::from_fn_with_state(Arc::clone(&app), gate))
        .with_state(app)
}

/// Answers `ok` if the server runs and the database can be read.
async fn health(State(app): State<Arc<App>>, ask: DecodedRequest) -> Response {
    app.answer(ask, Pace::Quick, |served, ask| {
        ask.only(&[])?;
        Ok(StoredAnswer::new("text/plain; charset=utf-8", format!("ok {}\n", served.state).into_bytes()))
    })
    .await
}

/// Adds measurements to the register.
async fn add_evidence(State(app): State<Arc<App>>, ask: DecodedRequest, body: Bytes) -> Response {
    app.change(ask, move |options, ask| api::evidence::add(options, ask, &body)).await
}

/// Supposes a surface that is sent.
async fn suppose_surface(State(app): State<Arc<App>>, ask: DecodedRequest, body: Bytes) -> Response {
    app.suppose(ask, move |served, ask| api::suppose::suppose_surface(&served.region, ask, &body)).await
}

/// Removes a measurement from the register.
async fn remove_evidence(State(app): State<Arc<App>>, ask: DecodedRequest) -> Response {
    app.change(ask, api::evidence::remove).await
}

/// Describes what is served.
async fn region(State(app): State<Arc<App>>, ask: DecodedRequest) -> Response {
    let options = app.options.clone();
    let work = move |ServedState { region, older, state, .. }: &ServedState, ask: &DecodedRequest| {
        api::region::region(region, older.as_ref(), state, &options, ask)
    };
    app.answer(ask, Pace::Quick, work).await
}

/// Describes the interface.
async fn openapi(State(app): State<Arc<App>>, ask: DecodedRequest) -> Response {
    let editing = app.options.editing.clone();
    app.answer(ask, Pace::Quick, move |_, ask| api::openapi(ask, &editing)).await
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

        let document: serde_json::Value = serde_json::from_str(ogc::OPENAPI).unwrap();
        let described = document["paths"].as_object().unwrap().keys().map(|path| format!("{}{path}", ogc::ROOT));
        let mut described: Vec<String> = described.chain([ogc::ROOT.to_owned()]).collect();
        let mut answered: Vec<&str> = FEATURES.iter().map(|endpoint| endpoint.0).collect();
        described.sort_unstable();
        answered.sort_unstable();
        assert_eq!(described, answered);
    }
}
