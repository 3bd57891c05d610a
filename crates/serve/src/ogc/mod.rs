//! The certified network by OGC API – Features, which QGIS, GDAL and others read as layers: pages of edges, turns and junctions as GeoJSON,
//! with a box and a condition.
//!
//! Part 1 (Core) and Part 3 (Filtering) of the standard: <https://docs.ogc.org/is/17-069r4/17-069r4.html>,
//! <https://docs.ogc.org/is/19-079r2/19-079r2.html>. Conditions are CQL2: <https://docs.ogc.org/is/21-065r2/21-065r2.html>.
//!
//! | file | for |
//! | --- | --- |
//! | `links` | links of answers |
//! | `cql2` | conditions as text |
//! | `features` | the collections, their columns and their rows |
//! | `columns` | what can be asked of a collection, and what its features have |
//! | `parameters` | box, time, limit and place in the order of a request |
//! | `items` | pages of features, and single ones |
//! | `service` | what is served: the first page, conformance, collections, the description |

mod columns;
mod cql2;
mod features;
mod items;
mod links;
mod parameters;
mod service;

pub(super) use columns::{queryables, schema};
pub(super) use items::{item, items};
#[cfg(test)]
pub(super) use service::OPENAPI;
pub(super) use service::{api, collection, collections, conformance, landing};

use serde_json::Value;

use super::answer::StoredAnswer;
use super::api::{ATTRIBUTION, SCOPE};
use super::ask::{ADDRESSED, DecodedRequest, shortened};

/// The path that all of this is below.
pub(super) const ROOT: &str = ADDRESSED;

const JSON: &str = "application/json";
const GEOJSON: &str = "application/geo+json";
const SCHEMA: &str = "application/schema+json";

/// Longitude, latitude on WGS 84, in degrees.
const CRS84: &str = "http://www.opengis.net/def/crs/OGC/1.3/CRS84";

fn answered(kind: &'static str, value: &Value) -> StoredAnswer {
    StoredAnswer::new(kind, value.to_string().into_bytes())
}
