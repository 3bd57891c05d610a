//! Writes an explanation as JSON for pages and programs. Names of members say their units: metres or degrees. Positions are in
//! the corridor's own metric frame.

use serde_json::{Value, json};

use super::words::words;
use super::{BodyPart, Explanation, Geometry, KerbHint, LaneGroup, ShorterHint};
use crate::osm::facts::WidthSource;
use crate::rows::AttestedBy;
use crate::vehicle::Vehicle;
use netcert_base::words::{Named as _, verdict_words};

/// The whole explanation without the corridor's stations.
#[must_use]
pub fn json(e: &Explanation) -> Value {
    let (verdict, reason) = verdict_words(e.verdict);
    let words = words(e);
    let road = e.road.as_ref().map(|facts| {
        let (edge, road) = (facts.edge, &facts.road);
        json!({
            // The id is text, because it has 63 bits and JavaScript's numbers hold 53.
            "edge_id": edge.id.to_string(),
            "way_id": edge.way_id,
            "from_node": edge.from_node,
            "to_node": edge.to_node,
            "direction": edge.direction.name(),
            "highway": road.highway,
            "name": road.name,
            "ref": road.reference,
            "title": facts.title,
            "corridor": facts.policy.name(),
            "width_source": facts.width_source.map(WidthSource::name),
            "supposed_lanes": facts.supposed_lanes.as_ref().map(supposed_lanes),
            "width_tags": facts.width_tags,
            "narrowed_by": facts.narrowed_by,
            "lane_shared": facts.lane_shared,
        })
    });
    let conflict = e.conflict.as_ref().map(
        |c| json!({"tag": c.tag, "allowed": c.allowed, "vehicle_has": c.has, "unit": c.unit, "surveyed": c.surveyed}),
    );
    json!({
        "vehicle": e.vehicle.id,
        "road": road,
        "verdict": verdict,
        "reason": Some(reason).filter(|reason| !reason.is_empty()),
        "headline": words.headline,
        "reasons": words.reasons,
        "hints_in_words": words.hints,
        "scope": words.scope,
        "limiting": e.geometry.as_ref().map(|g| limiting(g, &e.vehicle)),
        "hints": hints(e),
        "conflict": conflict,
        "signs": e.signs.iter().map(|sign| AttestedBy::Designation(sign).members()).collect::<Vec<_>>(),
    })
}

/// The group that says how many lanes a road has, with the tagged ways that it rests on.
fn supposed_lanes(group: &LaneGroup) -> Value {
    json!({
        "lanes": group.lanes,
        "country": group.country,
        "class": group.class.name(),
        "oneway": true,
        "tagged_ways": group.rests_on.map(|group| group.tagged),
        "ways_with_as_many": group.rests_on.map(|group| group.reached),
    })
}

fn limiting(g: &Geometry, vehicle: &Vehicle) -> Value {
    let (place, hinge, result) = (&g.place, &g.hinge, &g.result);
    let (part, ahead_m) = body_part(place.part);
    json!({
        "length_m": g.length_m(),
        "rsc_m": result.rsc_m,
        "shrink": result.shrink,
        "tracking_tolerance_m": result.shrink * vehicle.tracking_tolerance_m,
        "place": {
            "s_m": g.along_m(place.station),
            "unit": place.unit,
            "unit_name": vehicle.units.get(place.unit).map(|u| &u.name),
            "side": place.side.name(),
            "part": part,
            "ahead_of_axle_m": ahead_m,
            "nominal_gap_m": place.nominal_m,
            "error_bounds_m": place.bounds_m,
            "width_m": place.width_m,
            "bend": place.bend.map(|bend| json!({"radius_m": bend.radius_m, "to": bend.to.name()})),
            "corner": place.corner,
            "edge": place.edge,
            "units": place.poses.iter().map(|pose| json!({"axle": pose.axle, "heading": pose.heading})).collect::<Vec<_>>(),
        },
        "hinge": {
            "s_m": g.along_m(hinge.station),
            "unit": hinge.unit,
            "angle_deg": hinge.angle_rad.to_degrees(),
            "limit_deg": hinge.limit_rad.to_degrees(),
            "margin_deg": result.hinge_margin_rad.map(f64::to_degrees),
        },
    })
}

/// The name of a part of a body, and its distance ahead of the axle, metres.
pub(super) fn body_part(part: BodyPart) -> (&'static str, Option<f64>) {
    match part {
        BodyPart::FrontCorner => ("front_corner", None),
        BodyPart::RearCorner => ("rear_corner", None),
        BodyPart::Axle => ("axle", Some(0.0)),
        BodyPart::Side(m) => ("side", Some(m)),
    }
}

fn hints(e: &Explanation) -> Value {
    let strip = |other: &super::OtherStrip| json!({"corridor": other.policy.name(), "width_m": other.width_m, "safe": other.safe, "rsc_m": other.rsc_m});
    json!({
        "width_m": e.hints.width.map(|hint| hint.width_m),
        "width_shrink": e.hints.width.map(|hint| hint.shrink),
        "tracking_tolerance_m": e.hints.tolerance_m,
        "hinge_limit_deg": e.hints.hinge_limit_deg,
        "kerb_radius_m": match e.hints.kerb {
            Some(KerbHint::AtLeast(radius_m)) => Some(radius_m),
            _ => None,
        },
        "shorter_vehicle": match &e.hints.shorter {
            Some(ShorterHint::Does(id, length_m)) => Some(json!({"id": id, "length_m": length_m})),
            _ => None,
        },
        "other_strips": e.hints.other_strips.iter().map(strip).collect::<Vec<_>>(),
    })
}
