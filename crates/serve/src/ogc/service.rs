//! What is served: the first page, the conformance classes, the collections, and the description of all of it.

use serde_json::{Value, json};

use super::super::answer::StoredAnswer;
use super::super::ask::DecodedRequest;
use super::super::problem::Problem;
use super::super::region::RegionState;
use super::features::Collection;
use super::links::{address, licence, link};
use super::{ATTRIBUTION, CRS84, GEOJSON, JSON, ROOT, SCHEMA, SCOPE, answered};
use crate::rows::{Bounds, SetKey};
use crate::words::Named as _;

/// The description of this interface (OpenAPI 3.0, which the standard and QGIS ask for). A test compares it with the answers.
pub(in super::super) const OPENAPI: &str = include_str!("openapi.json");

/// The media type of [`OPENAPI`].
const OPENAPI_KIND: &str = "application/vnd.oai.openapi+json;version=3.0";

/// The conformance classes that are fulfilled.
const CLASSES: [&str; 9] = [
    "http://www.opengis.net/spec/ogcapi-features-1/1.0/conf/core",
    "http://www.opengis.net/spec/ogcapi-features-1/1.0/conf/geojson",
    "http://www.opengis.net/spec/ogcapi-features-1/1.0/conf/oas30",
    "http://www.opengis.net/spec/ogcapi-features-3/1.0/conf/queryables",
    "http://www.opengis.net/spec/ogcapi-features-3/1.0/conf/filter",
    "http://www.opengis.net/spec/ogcapi-features-3/1.0/conf/features-filter",
    "http://www.opengis.net/spec/cql2/1.0/conf/cql2-text",
    "http://www.opengis.net/spec/cql2/1.0/conf/basic-cql2",
    "http://www.opengis.net/spec/cql2/1.0/conf/advanced-comparison-operators",
];

/// `/ogc/`
pub(in super::super) fn landing(region: &RegionState, ask: &DecodedRequest) -> Result<StoredAnswer, Problem> {
    ask.only(&[])?;
    let document = json!({
        "title": format!("Roads of {}, certified by netcert", region.name()),
        "description": SCOPE,
        "attribution": ATTRIBUTION,
        "links": [
            link(&ask.address(None), "self", JSON, "This page"),
            link(&address(ask, "/api"), "service-desc", OPENAPI_KIND, "The description of this interface"),
            link(&address(ask, "/conformance"), "conformance", JSON, "Conformance classes"),
            link(&address(ask, "/collections"), "data", JSON, "The collections"),
            licence(),
        ],
    });
    Ok(answered(JSON, &document))
}

/// `/ogc/conformance`
pub(in super::super) fn conformance(ask: &DecodedRequest) -> Result<StoredAnswer, Problem> {
    ask.only(&[])?;
    Ok(answered(JSON, &json!({"conformsTo": CLASSES})))
}

/// `/ogc/api`
pub(in super::super) fn api(ask: &DecodedRequest) -> Result<StoredAnswer, Problem> {
    ask.only(&[])?;
    let mut document: Value = serde_json::from_str(OPENAPI).map_err(|error| Problem::fault(error.to_string()))?;
    document["servers"] = json!([{"url": format!("{}{ROOT}", ask.origin())}]);
    Ok(answered(OPENAPI_KIND, &document))
}

/// `/ogc/collections`
pub(in super::super) fn collections(region: &RegionState, ask: &DecodedRequest) -> Result<StoredAnswer, Problem> {
    ask.only(&[])?;
    let collections = Collection::all(region)?.into_iter().map(|collection| described(region, ask, collection));
    let document = json!({
        "links": [link(&ask.address(None), "self", JSON, "This page"), licence()],
        "collections": collections.collect::<Result<Vec<_>, _>>()?,
    });
    Ok(answered(JSON, &document))
}

/// `/ogc/collections/{collectionId}`
pub(in super::super) fn collection(region: &RegionState, ask: &DecodedRequest) -> Result<StoredAnswer, Problem> {
    ask.only(&[])?;
    let collection = Collection::named(region, ask.name("collectionId")?)?;
    Ok(answered(JSON, &described(region, ask, collection)?))
}

fn described(region: &RegionState, ask: &DecodedRequest, collection: Collection<'_>) -> Result<Value, Problem> {
    let id = collection.id();
    let at = |end: &str| address(ask, &format!("/collections/{id}{end}"));
    let extent = region.read(|database| database.layer_extent(collection.layer()))?;
    let (title, description) = words(region, collection)?;
    let mut document = json!({
        "id": id,
        "title": title,
        "description": description,
        "attribution": ATTRIBUTION,
        "itemType": "feature",
        "links": [
            link(&at(""), "self", JSON, "This collection"),
            link(&at("/items"), "items", GEOJSON, "The features"),
            link(&at("/queryables"), "http://www.opengis.net/def/rel/ogc/1.0/queryables", SCHEMA, "What conditions may name"),
            link(&at("/schema"), "describedBy", SCHEMA, "What the features have"),
            licence(),
        ],
    });
    if let Some(Bounds { west, south, east, north }) = extent {
        document["extent"] = json!({"spatial": {"bbox": [[west, south, east, north]], "crs": CRS84}});
    }
    Ok(document)
}

/// Title and description.
fn words(region: &RegionState, collection: Collection<'_>) -> Result<(String, String), Problem> {
    let of = |SetKey { vehicle, policy }: SetKey<'_>| -> Result<(String, String), Problem> {
        let name = &region.vehicle(vehicle)?.name;
        Ok((
            format!("{vehicle}, {}", policy.name()),
            format!("certified for {name} under the policy {}", policy.name()),
        ))
    };
    Ok(match collection {
        Collection::Edges(set) => {
            let (which, certified) = of(set)?;
            (format!("Edges: {which}"), format!("One direction of a road between two junctions, {certified}. {SCOPE}"))
        }
        Collection::Turns(set) => {
            let (which, certified) = of(set)?;
            (format!("Turns: {which}"), format!("Turns at junctions, {certified}. {SCOPE}"))
        }
        Collection::Junctions => {
            let what = "Areas of junctions, for people to look at. No certificate rests on them.";
            ("Junctions".to_owned(), what.to_owned())
        }
    })
}
