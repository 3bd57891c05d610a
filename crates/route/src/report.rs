//! Writes answers as JSON and GeoJSON.

use serde_json::{Value, json};

use super::assemble::{PartKind, passes_over};
use super::conditions::Conditional;
use super::obstacles::{Basis, Obstacle, Refutation};
use super::plan::Answer;
use super::route::{LimitedStretch, PartResult, Route};
use super::strip_use::StripUse;
use super::title::{place, title};
use crate::corridor::FrameError;
use crate::network::{EdgeNo, Network, PassageKind};
use crate::osm::facts::WidthSource;
use crate::osm::rounded;
use crate::stet::Model;
use crate::vehicle::Vehicle;
use crate::words::{Named, verdict_words};

/// The verdict of a route that is certified only under conditions. It is no verdict of a certificate by itself.
pub const CONDITIONAL: &str = "conditional";

fn ids(network: &Network, at: PartKind) -> Value {
    let id = |edge: EdgeNo| network.edges.get(edge.index()).map(|edge| edge.id);
    match at {
        PartKind::Edge(edge) => json!({"kind": "edge", "edge_id": id(edge), "title": title(network, at)}),
        PartKind::Turn { from, to } => {
            let kind = passes_over(network, at).map_or("turn", PassageKind::name);
            json!({"kind": kind, "from_edge": id(from), "to_edge": id(to), "title": title(network, at)})
        }
    }
}

fn with(mut object: Value, more: Value) -> Value {
    if let (Value::Object(object), Value::Object(more)) = (&mut object, more) {
        object.extend(more);
    }
    object
}

/// What tells a place, with its position.
fn placed(network: &Network, at: PartKind) -> Value {
    with(ids(network, at), json!({"place": place(network, at)}))
}

fn route_members(network: &Network, model: &Model, route: &Route) -> Value {
    let result = &route.certificate.result;
    json!({
        "length_m": route.length_m,
        "time_s": route.time_s,
        "rsc_m": result.rsc_m,
        "hinge_margin_deg": result.hinge_margin_rad.map(f64::to_degrees),
        "shrink": result.shrink,
        "safe": result.safe(),
        "limiting_s_m": route.limiting_m(),
        "limiting_unit": result.limiting.unit,
        "limiting_unit_name": model.vehicle.units.get(result.limiting.unit).map(|unit| unit.name.as_str()),
        "limiting_side": result.limiting.side.name(),
        "limiting_at": route.limiting().map(|at| title(network, at)),
        "destination_only": stretches(&route.destination_only(network, &model.vehicle)),
        "only_at_times": stretches(&route.only_at_times(network, &model.vehicle)),
        "rung": route.rung().name(),
        "uses": use_members(network, route),
    })
}

/// The members of a route's uses of more than its own lane. A distance is rounded up to centimetres.
#[must_use]
pub fn use_members(network: &Network, route: &Route) -> Vec<Value> {
    let members = |used: &StripUse| {
        let own = json!({
            "what": used.words(network),
            "strip": used.strip.name(),
            "where": used.place.name(),
            "from_m": used.from_m,
            "to_m": used.to_m,
            "beyond_m": (used.beyond_m * 100.0).ceil() / 100.0,
            "side": used.side.name(),
        });
        with(ids(network, used.at), own)
    };
    route.uses.iter().map(members).collect()
}

fn stretches(all: &[LimitedStretch]) -> Vec<Value> {
    let members = |stretch: &LimitedStretch| json!({"title": stretch.title, "tag": stretch.tag, "from_m": stretch.from_m, "to_m": stretch.to_m});
    all.iter().map(members).collect()
}

fn part_members(network: &Network, part: &PartResult) -> Value {
    let own = json!({"from_m": part.from_m, "to_m": part.to_m, "rsc_m": part.rsc_m});
    with(ids(network, part.kind), own)
}

/// The members of a part of a route under conditions. Its RSC holds only under them.
fn conditional_part_members(network: &Network, part: &PartResult) -> Value {
    with(part_members(network, part), json!({"verdict": CONDITIONAL}))
}

/// The members of an obstacle.
#[must_use]
pub fn obstacle_members(network: &Network, vehicle: &Vehicle, obstacle: &Obstacle) -> Value {
    let (verdict, reason) = obstacle.words(network, vehicle);
    let (width_source, kerb_assumed) = match obstacle.basis(network) {
        Some(Basis::Width(source)) => (source.map(WidthSource::name), None),
        Some(Basis::Kerb { assumed }) => (None, Some(assumed)),
        Some(Basis::Area) | None => (None, None),
    };
    let own = json!({
        "verdict": verdict,
        "reason": (!reason.is_empty()).then_some(reason),
        "rsc_m": obstacle.permit.rsc_m,
        "missing_m": obstacle.missing_m,
        "destination_only": obstacle.destination_only,
        "tag": obstacle.tag(network, vehicle),
        "width_source": width_source,
        "kerb_assumed": kerb_assumed,
        "place": place(network, obstacle.at),
    });
    with(ids(network, obstacle.at), own)
}

fn refutation_members(network: &Network, refutation: &Refutation) -> Value {
    let own = json!({
        "rsc_m": refutation.result.map(|result| result.0),
        "assembly": refutation.assembly.as_ref().map(ToString::to_string),
        "left_out": refutation.left_out,
        "place": place(network, refutation.at),
    });
    with(ids(network, refutation.at), own)
}

/// The numbers of a route's certificate. Under conditions the verdict is not `safe`.
fn certificate_members(route: &Route, conditions: &[Value]) -> Value {
    let result = &route.certificate.result;
    let (verdict, _) = verdict_words(result.verdict());
    json!({
        "verdict": if conditions.is_empty() { verdict } else { CONDITIONAL },
        "rsc_m": result.rsc_m,
        "hinge_margin_deg": result.hinge_margin_rad.map(f64::to_degrees),
        "shrink": result.shrink,
    })
}

/// The members of a route's conditions.
#[must_use]
pub fn condition_members(network: &Network, conditional: &Conditional) -> Vec<Value> {
    (1..).zip(&conditional.conditions).map(|(number, condition)| condition.members(network, number)).collect()
}

/// The members of a route that is certified under conditions. `safe` is false.
fn conditional_members(network: &Network, model: &Model, conditional: &Conditional) -> Value {
    let route = &conditional.route;
    let conditions = condition_members(network, conditional);
    let own = json!({
        "safe": false,
        "certificate": certificate_members(route, &conditions),
        "conditions": conditions,
        "conditions_suffice": conditional.suffices,
        "conditions_attested": conditional.attested(),
    });
    with(route_members(network, model, route), own)
}

/// The whole answer without geometry. `rsc_m`, `certificate` and `conditions` are those of the first route, or of the conditional one.
#[must_use]
pub fn json(network: &Network, model: &Model, answer: &Answer) -> Value {
    let parts = |route: &Route, members: fn(&Network, &PartResult) -> Value| -> Vec<Value> {
        route.parts().iter().map(|part| members(network, part)).collect()
    };
    let route = |route: &Route| {
        let parts = parts(route, part_members);
        let own = json!({"certificate": certificate_members(route, &[]), "conditions": [], "parts": parts});
        with(route_members(network, model, route), own)
    };
    let conditional = answer.conditional.as_ref().map(|conditional| {
        let parts = parts(&conditional.route, conditional_part_members);
        with(conditional_members(network, model, conditional), json!({"parts": parts}))
    });
    let best = answer.routes.first().map(route).or_else(|| conditional.clone()).unwrap_or_default();
    let of_best = |name: &str| best.get(name).cloned();
    let snapped = answer
        .snapped
        .iter()
        .map(|s| json!({"position": [s.position.lon, s.position.lat], "distance_m": s.distance_m}));
    json!({
        "vehicle_id": model.vehicle.id,
        "rsc_m": of_best("rsc_m"),
        "certificate": of_best("certificate"),
        "conditions": of_best("conditions").unwrap_or_else(|| json!([])),
        "routes": answer.routes.iter().map(route).collect::<Vec<_>>(),
        "conditional": conditional,
        "places": snapped.collect::<Vec<_>>(),
        "refuted": answer.refuted.iter().map(|r| refutation_members(network, r)).collect::<Vec<_>>(),
        "gave_up": answer.gave_up,
        "conditions_cut_short": answer.conditions_cut_short,
        "nothing_helps": answer.nothing_helps.iter().map(|&at| placed(network, at)).collect::<Vec<_>>(),
        "obstacles": answer.obstacles.as_ref().map(|all| all.iter().map(|o| obstacle_members(network, &model.vehicle, o)).collect::<Vec<_>>()),
    })
}

/// A GeoJSON collection: each route as one line followed by its parts and by where it uses more than its own lane; conditions, obstacles and
/// places that no condition opens as points.
///
/// # Errors
/// Positions cannot be converted from a route's frame.
pub fn geojson(network: &Network, model: &Model, answer: &Answer) -> Result<Value, FrameError> {
    let mut features = Vec::new();
    type Members = fn(&Network, &PartResult) -> Value;
    let certified =
        answer.routes.iter().map(|route| (route, json!({"kind": "route", "conditions": []}), part_members as Members));
    let conditional = answer.conditional.as_ref().map(|conditional| {
        let kind = json!({"kind": "conditional_route"});
        let own = with(conditional_members(network, model, conditional), kind);
        (&conditional.route, own, conditional_part_members as Members)
    });
    for (number, (route, own, members)) in certified.chain(conditional).enumerate() {
        let c = &route.path.corridor;
        let metres: Vec<[f64; 2]> = c.x.iter().zip(&c.y).map(|(&x, &y)| [x, y]).collect();
        let line: Vec<[f64; 2]> = route.path.frame.inverse(&metres)?.into_iter().map(rounded).collect();
        let feature = |stations: std::ops::Range<usize>, properties: Value| {
            let own = line.get(stations).unwrap_or_default();
            json!({
                "type": "Feature",
                "geometry": {"type": "LineString", "coordinates": own},
                "properties": with(json!({"route": number + 1, "vehicle_id": model.vehicle.id}), properties),
            })
        };
        let whole = with(route_members(network, model, route), own);
        features.push(feature(0..line.len(), whole));
        for (part, result) in route.path.parts.iter().zip(route.parts()) {
            // A line must have at least two positions.
            let end = part.stations.end.max(part.stations.start + 2).min(line.len());
            let start = part.stations.start.min(end.saturating_sub(2));
            features.push(feature(start..end, members(network, &result)));
        }
        for (used, members) in route.uses.iter().zip(use_members(network, route)) {
            let station = |m: f64| ((m / c.spacing_m).round() as usize).min(line.len().saturating_sub(1));
            let end = (station(used.to_m) + 1).max(2);
            let stations = station(used.from_m).min(end - 2)..end;
            features.push(feature(stations, with(json!({"feature": "use"}), members)));
        }
    }
    for condition in answer.conditional.iter().flat_map(|conditional| condition_members(network, conditional)) {
        let of = json!({"vehicle_id": model.vehicle.id, "feature": "condition"});
        features.push(json!({
            "type": "Feature",
            "geometry": {"type": "Point", "coordinates": condition.get("place")},
            "properties": with(of, condition),
        }));
    }
    for obstacle in answer.obstacles.iter().flatten() {
        features.push(json!({
            "type": "Feature",
            "geometry": {"type": "Point", "coordinates": place(network, obstacle.at)},
            "properties": with(json!({"vehicle_id": model.vehicle.id}), obstacle_members(network, &model.vehicle, obstacle)),
        }));
    }
    for &at in &answer.nothing_helps {
        let of = json!({"vehicle_id": model.vehicle.id, "feature": "nothing_helps"});
        features.push(json!({
            "type": "Feature",
            "geometry": {"type": "Point", "coordinates": place(network, at)},
            "properties": with(of, ids(network, at)),
        }));
    }
    Ok(json!({"type": "FeatureCollection", "features": features}))
}
