//! Why no bound holds for a vehicle on a road, and which shorter vehicle would do.
//!
//! The bounds of a unit's deviation do not close where it stands so far across its path that errors may add up without limit, as before
//! jackknifing. On such a path a wider road does not help, but a gentler path or a shorter unit does.

use super::hints::ShorterHint;
use super::names::{hinge_name, named};
use super::{Explanation, Geometry};
use crate::stet::{Model, fading_m};
use crate::stop::{Stop, Stopped};
use crate::vehicle::{Catalogue, Vehicle};

/// The greatest number of vehicles that are tried.
const MOST_TRIED: usize = 6;

/// Regions whose vehicles do not drive on roads.
const OFF_ROAD: [&str; 2] = ["indoor", "airside"];

/// The longest of the catalogue's shorter vehicles for which `safe` holds. Vehicles of the same region are tried, or those of any road if
/// its region has no shorter one. `None` if there is no shorter one at all.
pub(super) fn shorter(
    vehicle: &Vehicle,
    safe: &dyn Fn(&Model) -> bool,
    stop: &Stop,
) -> Result<Option<ShorterHint>, Stopped> {
    let Ok(catalogue) = Catalogue::builtin() else { return Ok(None) };
    let shorter = |other: &&Vehicle| other.length_m < vehicle.length_m;
    let mut others: Vec<&Vehicle> = catalogue.region(&vehicle.region).filter(shorter).collect();
    if others.is_empty() && !OFF_ROAD.contains(&vehicle.region.as_str()) {
        others = catalogue.iter().filter(shorter).filter(|other| !OFF_ROAD.contains(&other.region.as_str())).collect();
    }
    others.sort_by(|a, b| b.length_m.total_cmp(&a.length_m).then_with(|| a.id.cmp(&b.id)));
    // Of vehicles of one length, the first one stands for the others.
    others.dedup_by(|b, a| a.length_m == b.length_m);
    let tried = evenly(&others);
    for other in &tried {
        stop.check()?;
        if Model::new(other).is_ok_and(|model| safe(&model)) {
            return Ok(Some(ShorterHint::Does(other.id.clone(), other.length_m)));
        }
    }
    stop.check()?;
    Ok(tried.last().map(|shortest| ShorterHint::NoneOf(tried.len(), shortest.length_m)))
}

/// At most [`MOST_TRIED`] of the vehicles, from the longest to the shortest, which is always among them.
fn evenly<'v>(all: &[&'v Vehicle]) -> Vec<&'v Vehicle> {
    let count = all.len().min(MOST_TRIED);
    let index = |i: usize| if count < 2 { 0 } else { i * (all.len() - 1) / (count - 1) };
    (0..count).filter_map(|i| all.get(index(i)).copied()).collect()
}

/// The first line, if no bound holds.
pub(super) fn headline(e: &Explanation, g: &Geometry) -> String {
    if let Some(torn) = torn(e, g) {
        return torn;
    }
    let sharpest = g.corridor.curvature[g.span.clone()].iter().fold(0.0_f64, |k, c| k.max(c.abs()));
    let what = if e.turn.is_some() { "the best path found" } else { "the road" };
    format!(
        "{what} bends too sharply at {:.0} m, to a radius of {:.1} m: no bound holds for {}",
        g.along_m(g.hinge.station),
        1.0 / sharpest.max(1e-6),
        named(&e.vehicle, g.hinge.unit)
    )
}

/// Where the line drawn for the road is no curve, on the span, or so shortly before it that the units have not settled since.
fn torn(e: &Explanation, g: &Geometry) -> Option<String> {
    let stations = |metres: f64| (metres / g.corridor.spacing_m).ceil() as usize;
    let settling_m = fading_m(&e.vehicle.units);
    let length = stations(e.vehicle.length_m);
    let mattering = g.span.start.saturating_sub(stations(settling_m) + length)..g.span.end + length;
    let torn: Vec<usize> = g.corridor.torn().into_iter().filter(|k| mattering.contains(k)).collect();
    let on_the_span = torn.iter().find(|k| g.span.contains(k)).or(torn.last())?;
    Some(if g.span.contains(on_the_span) {
        let at_m = g.along_m(*on_the_span as f64);
        format!("the line drawn for the road is no curve at {at_m:.0} m: nothing is certified there")
    } else if *on_the_span < g.span.start {
        let before_m = (g.span.start - on_the_span) as f64 * g.corridor.spacing_m;
        format!(
            "the line drawn for the road is no curve {before_m:.0} m before: how the units stand after that place is not known, and {} \
             needs {settling_m:.0} m to settle",
            e.vehicle.id
        )
    } else {
        "the line drawn for the road is no curve just behind, where the vehicle is before its rear has left".to_owned()
    })
}

/// What happens there: how far the hinge turns without any error.
pub(super) fn reason(e: &Explanation, g: &Geometry) -> Option<String> {
    if torn(e, g).is_some() {
        return None;
    }
    let unit = g.hinge.unit;
    let last = (g.span.end + (e.vehicle.length_m / g.corridor.spacing_m) as usize).min(g.ride.len());
    let furthest = (g.span.start..last).map(|k| g.ride.angle(k, unit).abs()).fold(0.0, f64::max).to_degrees();
    let (name, limit) = (hinge_name(&e.vehicle, unit), g.hinge.limit_rad.to_degrees());
    Some(if furthest > limit {
        format!("Even steered exactly, {name} would turn to {furthest:.0}°, and it allows {limit:.0}°.")
    } else {
        format!(
            "Steered exactly, {name} would turn to {furthest:.0}° of its {limit:.0}°. The errors that are allowed could add \
             up without limit there, so nothing can be certified."
        )
    })
}

/// The hint in words.
pub(super) fn words(hint: &ShorterHint) -> String {
    match hint {
        ShorterHint::Does(id, length_m) => format!("A shorter vehicle would do: {id}, {length_m:.1} m long."),
        ShorterHint::NoneOf(tried, shortest_m) => {
            format!("No shorter vehicle of the catalogue would do: {tried} tried, down to one of {shortest_m:.1} m.")
        }
    }
}

#[cfg(test)]
#[allow(clippy::panic, clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_vehicle_that_does_is_named_and_the_shortest_is_tried() {
        let catalogue = Catalogue::builtin().unwrap();
        let vehicle = catalogue.get("AU-ATRIPLE53").unwrap();
        let found =
            |most_m: f64| shorter(vehicle, &|model| model.vehicle.length_m <= most_m, &Stop::never()).unwrap().unwrap();
        let lengths: Vec<f64> = catalogue.region("AU").map(|other| other.length_m).collect();
        let shortest = lengths.iter().copied().fold(f64::INFINITY, f64::min);
        let ShorterHint::Does(_, length_m) = found(shortest) else { panic!("the shortest does") };
        assert_eq!(length_m, shortest);
        let ShorterHint::Does(_, length_m) = found(1000.0) else { panic!("every vehicle does") };
        assert!(lengths.iter().all(|other| *other <= length_m || *other >= vehicle.length_m), "{length_m}");
        assert_eq!(found(0.0), ShorterHint::NoneOf(MOST_TRIED, shortest));
        // The shortest of its region: vehicles of other regions' roads are tried.
        let vehicle = catalogue.get("AU-SEMI19").unwrap();
        let any = shorter(vehicle, &|_| true, &Stop::never()).unwrap().unwrap();
        assert!(
            matches!(&any, ShorterHint::Does(id, length_m) if !id.starts_with("AU-") && *length_m < 19.0),
            "{any:?}"
        );
        let stop = Stop::default();
        stop.tell();
        assert_eq!(shorter(vehicle, &|_| true, &stop), Err(Stopped));
    }
}
