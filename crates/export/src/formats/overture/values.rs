//! What the map says of a segment, whatever the vehicle: directions that do not exist, speed limits, widths.

use serde_json::{Map, Value, json};

use super::stretch::{SegmentStretch, Values, between};
use crate::osm::facts::Direction;
use crate::words::Named as _;

/// Neighbouring stretches with the same value, as first and last junction.
fn ranges<T: PartialEq>(stretches: &[SegmentStretch], value: impl Fn(&Values) -> Option<T>) -> Vec<([usize; 2], T)> {
    let mut ranges: Vec<([usize; 2], T)> = Vec::new();
    for (i, stretch) in stretches.iter().enumerate() {
        let Some(value) = value(&stretch.values) else { continue };
        match ranges.last_mut() {
            Some((range, known)) if range[1] == i && *known == value => range[1] = i + 1,
            _ => ranges.push(([i, i + 1], value)),
        }
    }
    ranges
}

/// Denials of directions that do not exist. They hold for everybody.
pub(super) fn oneways(stretches: &[SegmentStretch], at: &[f64]) -> Vec<Value> {
    let mut rules = Vec::new();
    for (heading, name) in [(0, Direction::Forward.name()), (1, Direction::Backward.name())] {
        let gone = |values: &Values| (!values.exists[heading] && values.exists[1 - heading]).then_some(());
        for (range, ()) in ranges(stretches, gone) {
            let mut rule = Map::new();
            rule.insert("access_type".to_owned(), json!("denied"));
            between(&mut rule, at, range);
            rule.insert("when".to_owned(), json!({"heading": name}));
            rules.push(Value::Object(rule));
        }
    }
    rules
}

/// Speed limits. A limit for both headings names none.
pub(super) fn speed_limits(stretches: &[SegmentStretch], at: &[f64]) -> Vec<Value> {
    let of = |values: &Values, heading: usize| values.speed_km_h[heading].filter(|_| values.exists[heading]);
    let alike = stretches.iter().all(|SegmentStretch { values, .. }| {
        values.exists.contains(&false) || values.speed_km_h[0] == values.speed_km_h[1]
    });
    let mut rules = Vec::new();
    let mut add = |range: [usize; 2], km_h: u8, heading: Option<Direction>| {
        let mut rule = Map::new();
        rule.insert("max_speed".to_owned(), json!({"value": km_h, "unit": "km/h"}));
        between(&mut rule, at, range);
        if let Some(heading) = heading {
            rule.insert("when".to_owned(), json!({"heading": heading.name()}));
        }
        rules.push(Value::Object(rule));
    };
    if alike {
        ranges(stretches, |values| of(values, 0).or(of(values, 1)))
            .into_iter()
            .for_each(|(range, km_h)| add(range, km_h, None));
        return rules;
    }
    for heading in [Direction::Forward, Direction::Backward] {
        let of_heading = ranges(stretches, |values| of(values, heading as usize));
        of_heading.into_iter().for_each(|(range, km_h)| add(range, km_h, Some(heading)));
    }
    rules
}

/// Mapped widths of the carriageway.
pub(super) fn widths(stretches: &[SegmentStretch], at: &[f64]) -> Vec<Value> {
    let rule = |(range, width_m)| {
        let mut rule = Map::new();
        rule.insert("value".to_owned(), json!(width_m));
        between(&mut rule, at, range);
        Value::Object(rule)
    };
    ranges(stretches, |values| values.width_m).into_iter().map(rule).collect()
}

/// The schema's class, and whether the road is a slip road. The schema has no class for busways.
pub(super) fn class(highway: &str) -> (&str, bool) {
    let (class, link) = highway.strip_suffix("_link").map_or((highway, false), |class| (class, true));
    (if class == "busway" { "unknown" } else { class }, link)
}
