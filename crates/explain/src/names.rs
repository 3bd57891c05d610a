//! Names for sentences (strips, units, corners, hinges, sources of widths), and amounts that are rounded to the cautious
//! side.

use super::{BodyPart, Explanation, LimitingPlace};
use crate::osm::facts::{Policy, WidthSource};
use crate::vehicle::Vehicle;
use netcert_base::words::Named as _;

/// The amount of a leeway without its sign, metres with two decimals. Room to spare is rounded down, missing room is rounded
/// up.
#[must_use]
pub fn cautious_m(leeway_m: f64) -> String {
    if leeway_m < 0.0 { needed(-leeway_m) } else { cut(leeway_m) }
}

/// Metres to spare, rounded down.
pub(super) fn cut(metres: f64) -> String {
    format!("{:.2}", (metres * 100.0 + 1e-6).floor() / 100.0)
}

/// Missing metres, rounded up.
pub(super) fn needed(metres: f64) -> String {
    format!("{:.2}", (metres * 100.0 - 1e-6).ceil() / 100.0)
}

impl Explanation {
    /// The name of the strip that the vehicle may use under the policy.
    #[must_use]
    pub fn strip_name(&self) -> &'static str {
        match (&self.road, &self.turn) {
            (Some(road), _) => strip_name(road.policy),
            (None, Some(_)) => "road",
            (None, None) => "corridor",
        }
    }
}

pub(super) fn strip_name(policy: Policy) -> &'static str {
    match policy {
        Policy::Lane => "lane",
        Policy::Direction => "strip of one's own direction",
        Policy::Carriageway => "carriageway",
    }
}

impl Explanation {
    /// The name of a place on a unit, such as `rear left corner of trailer 2 (unit 4 of 6)`.
    #[must_use]
    pub fn corner(&self, place: &LimitingPlace) -> String {
        let side = place.side.name();
        let part = match place.part {
            BodyPart::FrontCorner => format!("front {side} corner"),
            BodyPart::RearCorner => format!("rear {side} corner"),
            BodyPart::Axle => format!("{side} side, at the axle,"),
            BodyPart::Side(m) if m > 0.0 => format!("{side} side, {m:.1} m ahead of the axle,"),
            BodyPart::Side(m) => format!("{side} side, {:.1} m behind the axle,", -m),
        };
        format!("{part} of {}", unit_name(&self.vehicle, place.unit))
    }
}

/// The name of a unit in a sentence: `the tractor`, but `trailer 2` without an article.
pub(super) fn named(vehicle: &Vehicle, unit: usize) -> String {
    let name = vehicle.units.get(unit).map_or("unit", |u| u.name.as_str());
    let numbered = name.ends_with(|c: char| c.is_ascii_digit()) || name.contains(',');
    if numbered { name.to_owned() } else { format!("the {name}") }
}

pub(super) fn unit_name(vehicle: &Vehicle, unit: usize) -> String {
    let name = named(vehicle, unit);
    match vehicle.units.len() {
        1 => name,
        count => format!("{name} (unit {} of {count})", unit + 1),
    }
}

pub(super) fn hinge_name(vehicle: &Vehicle, unit: usize) -> String {
    match unit.checked_sub(1) {
        None => "the steering".to_owned(),
        Some(towing) => {
            format!("the hinge between {} and {}", named(vehicle, towing), named(vehicle, unit))
        }
    }
}

/// The source of a width in words.
#[must_use]
pub(super) fn source_words(source: WidthSource) -> &'static str {
    match source {
        WidthSource::Assumed => "assumed from the road's class and country",
        WidthSource::FromLanes => "from the tagged number of lanes, their width assumed",
        WidthSource::Estimated => "tagged as estimated",
        WidthSource::Tagged => "tagged",
        WidthSource::Surveyed => "surveyed",
    }
}
