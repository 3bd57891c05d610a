//! Pages of features, and single ones.

use serde_json::{Value, json};

use super::super::answer::StoredAnswer;
use super::super::ask::DecodedRequest;
use super::super::problem::Problem;
use super::super::region::RegionState;
use super::features::Collection;
use super::links::{address, licence, link};
use super::{ATTRIBUTION, GEOJSON, JSON, SCOPE, parameters, shortened};
use crate::rows::Bounds;
use crate::store::PageQuery;

/// `/ogc/collections/{collectionId}/items`. `state` names the state of the database, `now` is the time of the answer.
pub(in super::super) fn items(
    region: &RegionState,
    state: &str,
    now: &str,
    ask: &DecodedRequest,
) -> Result<StoredAnswer, Problem> {
    ask.only(&["after", "bbox", "datetime", "filter", "filter-crs", "filter-lang", "limit"])?;
    let collection = Collection::named(region, ask.name("collectionId")?)?;
    parameters::datetime(ask)?;
    let limit = parameters::limit(ask)?;
    let bbox = parameters::bbox(ask)?;
    let filter = parameters::filter(ask, &collection.attributes())?;
    let after = parameters::after(ask, state)?;
    // A box around everything leaves nothing out, and would be looked up for every page.
    let area = bbox.filter(|&bbox| region.extent.is_none_or(|extent| !covers(bbox, extent)));
    let query = PageQuery { after, id: None, area, filter: filter.as_ref(), most: limit + 1 };
    let mut page = collection.page(region, &ask.stop, &query)?;
    let more = page.len() > limit;
    page.truncate(limit);
    let mut links = vec![link(&ask.address(None), "self", GEOJSON, "This page")];
    if let Some(last) = page.last().filter(|_| more) {
        let next = ask.address(Some(("after", &parameters::behind(last.key, state))));
        links.push(link(&next, "next", GEOJSON, "The next page"));
    }
    links.push(of_collection(ask, collection));
    links.push(licence());
    let mut head = json!({"type": "FeatureCollection", "timeStamp": now});
    if bbox.is_none() && filter.is_none() {
        head["numberMatched"] = json!(collection.count(region)?);
    }
    head["numberReturned"] = json!(page.len());
    head["links"] = json!(links);
    head["attribution"] = json!(ATTRIBUTION);
    if collection.set().is_some() {
        head["scope"] = json!(SCOPE);
    }
    let mut text = head.to_string();
    text.pop();
    text.push_str(",\"features\":[");
    for (i, own) in page.iter().enumerate() {
        text.push_str(if i > 0 { ",\n" } else { "\n" });
        text.push_str(&own.feature.to_string());
    }
    text.push_str("\n]}");
    Ok(StoredAnswer::new(GEOJSON, text.into_bytes()))
}

/// `/ogc/collections/{collectionId}/items/{featureId}`
pub(in super::super) fn item(region: &RegionState, ask: &DecodedRequest) -> Result<StoredAnswer, Problem> {
    ask.only(&[])?;
    let collection = Collection::named(region, ask.name("collectionId")?)?;
    let text = ask.name("featureId")?;
    let missing = || Problem::not_found(format!("{} has no feature {:?}", collection.id(), shortened(text)));
    let id: i64 = text.parse().ok().filter(|id: &i64| id.to_string() == *text).ok_or_else(missing)?;
    let query = PageQuery { after: None, id: Some(id), area: None, filter: None, most: 1 };
    let found = collection.page(region, &ask.stop, &query)?.pop().ok_or_else(missing)?;
    let mut feature = found.feature;
    feature["links"] =
        json!([link(&ask.address(None), "self", GEOJSON, "This feature"), of_collection(ask, collection), licence()]);
    feature["attribution"] = json!(ATTRIBUTION);
    if collection.set().is_some() {
        feature["scope"] = json!(SCOPE);
    }
    Ok(super::answered(GEOJSON, &feature))
}

fn of_collection(ask: &DecodedRequest, collection: Collection<'_>) -> Value {
    let id = collection.id();
    link(&address(ask, &format!("/collections/{id}")), "collection", JSON, &id)
}

/// Whether a box that does not go over 180° has all of another one.
fn covers(bbox: Bounds, other: Bounds) -> bool {
    bbox.west <= other.west && bbox.south <= other.south && bbox.east >= other.east && bbox.north >= other.north
}
