//! One segment of the schema: a way or an unbroken chain of it. Stretches between junctions are linear references.
//!
//! Linear references are shares of the geodesic length on the WGS 84 ellipsoid
//! (<https://docs.overturemaps.org/guides/transportation/linear-referencing>).

use geo::{Distance as _, Geodesic, Point};
use serde_json::{Map, Value, json};

use super::locations::EdgeLocation;
use super::stretch::{SegmentStretch, between};
use super::values;
use crate::osm::facts::Direction;
use crate::osm::{LonLat, NodeId};
use crate::rows::{EdgeRow, RoadName};
use crate::words::Named as _;

/// The vehicles that the rules apply to.
pub(super) struct VehicleScope {
    pub(super) length_m: f64,
}

/// A way, or a part of it without a gap in the extract.
pub(super) struct ExtractSegment {
    pub(super) way_id: i64,
    pub(super) chain: u32,
    road: RoadName,
    pub(super) stretches: Vec<SegmentStretch>,
}

/// The id of a segment: `w123`, and `w123.1` for the part after a gap.
pub(super) fn id(way_id: i64, chain: u32) -> String {
    if chain == 0 { format!("w{way_id}") } else { format!("w{way_id}.{chain}") }
}

/// The id of a connector, such as `n123`.
pub(super) fn connector_id(node: NodeId) -> String {
    format!("n{node}")
}

impl ExtractSegment {
    /// A segment without stretches.
    pub(super) fn new(row: &EdgeRow, location: &EdgeLocation) -> Self {
        let EdgeLocation { way_id, chain, .. } = *location;
        Self { way_id, chain, road: row.road.clone(), stretches: Vec::new() }
    }

    /// The nodes at which the segment meets others.
    pub(super) fn nodes(&self) -> impl Iterator<Item = (NodeId, LonLat)> + '_ {
        self.stretches.iter().flat_map(|stretch| {
            let ends = [stretch.line.first(), stretch.line.last()];
            stretch.nodes.into_iter().zip(ends).filter_map(|(node, at)| Some((node, *at?)))
        })
    }

    /// The segment as a GeoJSON feature.
    pub(super) fn feature(&self, scope: &VehicleScope) -> Value {
        let at = self.at();
        let (class, link) = values::class(&self.road.highway);
        let mut properties = json!({
            "theme": "transportation",
            "type": "segment",
            "version": 0,
            "subtype": "road",
            "class": class,
            "sources": [{
                "property": "",
                "dataset": "OpenStreetMap",
                "license": "ODbL-1.0",
                "record_id": format!("w{}", self.way_id),
            }],
            "connectors": self.connectors(&at),
        });
        if let Some(members) = properties.as_object_mut() {
            if link {
                members.insert("subclass".to_owned(), json!("link"));
            }
            if let Some(name) = self.road.name.as_deref().map(str::trim).filter(|name| !name.is_empty()) {
                members.insert("names".to_owned(), json!({"primary": name}));
            }
            if let Some(reference) = self.road.reference.as_deref().map(str::trim).filter(|text| !text.is_empty()) {
                members.insert("routes".to_owned(), json!([{"ref": reference}]));
            }
            for (member, rules) in [
                ("access_restrictions", self.denials(&at, scope)),
                ("prohibited_transitions", self.transitions(&at, scope)),
                ("speed_limits", values::speed_limits(&self.stretches, &at)),
                ("width_rules", values::widths(&self.stretches, &at)),
            ] {
                if !rules.is_empty() {
                    members.insert(member.to_owned(), Value::Array(rules));
                }
            }
        }
        let coordinates: Vec<[f64; 2]> = self.line().map(|place| place.degrees().into()).collect();
        json!({
            "type": "Feature",
            "id": id(self.way_id, self.chain),
            "geometry": {"type": "LineString", "coordinates": coordinates},
            "properties": properties,
        })
    }

    /// All positions. A position at which two stretches meet comes once.
    fn line(&self) -> impl Iterator<Item = LonLat> + '_ {
        let begin = self.stretches.first().and_then(|stretch| stretch.line.first()).copied();
        begin.into_iter().chain(self.stretches.iter().flat_map(|stretch| stretch.line.iter().skip(1).copied()))
    }

    /// The linear references of the stretches' ends, from 0 to 1. There is one more than there are stretches.
    fn at(&self) -> Vec<f64> {
        let mut along_m = vec![0.0];
        let mut so_far_m = 0.0;
        for stretch in &self.stretches {
            so_far_m += length_m(&stretch.line);
            along_m.push(so_far_m);
        }
        // Rounded so that the text does not depend on the last bits. The step is 0.1 mm on a way of 100 km.
        let share = |m: f64| if so_far_m > 0.0 { (m / so_far_m * 1e9).round() / 1e9 } else { 0.0 };
        let mut at: Vec<f64> = along_m.into_iter().map(share).collect();
        if let Some(last) = at.last_mut() {
            *last = 1.0;
        }
        at
    }

    fn connectors(&self, at: &[f64]) -> Vec<Value> {
        let begin = self.stretches.first().map(|stretch| stretch.nodes[0]);
        let ends = self.stretches.iter().map(|stretch| stretch.nodes[1]);
        let connector = |(node, at): (NodeId, &f64)| json!({"connector_id": connector_id(node), "at": at});
        begin.into_iter().chain(ends).zip(at).map(connector).collect()
    }

    /// The rules for directions that do not exist, and for stretches that may not be used. Neighbouring stretches share a rule, and a rule for both headings names none.
    fn denials(&self, at: &[f64], scope: &VehicleScope) -> Vec<Value> {
        let denied = |heading: usize| -> Vec<[usize; 2]> {
            let mut ranges: Vec<[usize; 2]> = Vec::new();
            let refused = |stretch: &SegmentStretch| {
                // A direction that does not exist has a rule of its own, unless neither has an edge.
                let gone = !stretch.values.exists[heading] && stretch.values.exists[1 - heading];
                stretch.permitted[heading].is_none() && !gone
            };
            for (i, _) in self.stretches.iter().enumerate().filter(|(_, stretch)| refused(stretch)) {
                match ranges.last_mut() {
                    Some(range) if range[1] == i => range[1] = i + 1,
                    _ => ranges.push([i, i + 1]),
                }
            }
            ranges
        };
        let rule = |range: [usize; 2], heading: Option<Direction>| {
            let mut rule = Map::new();
            rule.insert("access_type".to_owned(), json!("denied"));
            between(&mut rule, at, range);
            rule.insert("when".to_owned(), scope.when(heading));
            Value::Object(rule)
        };
        let mut rules = values::oneways(&self.stretches, at);
        let [forward, backward] = [denied(0), denied(1)];
        if forward == backward {
            rules.extend(forward.into_iter().map(|range| rule(range, None)));
            return rules;
        }
        rules.extend(forward.into_iter().map(|range| rule(range, Some(Direction::Forward))));
        rules.extend(backward.into_iter().map(|range| rule(range, Some(Direction::Backward))));
        rules
    }

    /// The prohibited transitions of each stretch, including turning back on the road.
    fn transitions(&self, at: &[f64], scope: &VehicleScope) -> Vec<Value> {
        let mut rules = Vec::new();
        for (i, stretch) in self.stretches.iter().enumerate() {
            for heading in [Direction::Forward, Direction::Backward] {
                let (ahead, back) = (heading as usize, 1 - heading as usize);
                let Some(forbidden) = &stretch.permitted[ahead] else { continue };
                let mut rule = |steps: &[(NodeId, String, Direction)]| {
                    let Some(last) = steps.last() else { return };
                    let entry = |(node, segment, _): &(NodeId, String, Direction)| json!({"connector_id": connector_id(*node), "segment_id": segment});
                    let mut rule = Map::new();
                    rule.insert("sequence".to_owned(), steps.iter().map(entry).collect());
                    rule.insert("final_heading".to_owned(), json!(last.2.name()));
                    between(&mut rule, at, [i, i + 1]);
                    rule.insert("when".to_owned(), scope.when(Some(heading)));
                    rules.push(Value::Object(rule));
                };
                forbidden.iter().for_each(|forbidden| rule(&forbidden.steps));
                if stretch.permitted[back].is_some() {
                    let opposite = if heading == Direction::Forward { Direction::Backward } else { Direction::Forward };
                    rule(&[(stretch.nodes[back], id(self.way_id, self.chain), opposite)]);
                }
            }
        }
        rules
    }
}

impl VehicleScope {
    /// The condition of a rule: lorries at least as long as the vehicle.
    fn when(&self, heading: Option<Direction>) -> Value {
        let mut when = Map::new();
        if let Some(heading) = heading {
            when.insert("heading".to_owned(), json!(heading.name()));
        }
        when.insert("mode".to_owned(), json!(["truck", "hgv"]));
        let longer =
            json!({"dimension": "length", "comparison": "greater_than_equal", "value": self.length_m, "unit": "m"});
        when.insert("vehicle".to_owned(), json!([longer]));
        Value::Object(when)
    }
}

fn length_m(line: &[LonLat]) -> f64 {
    let point = |place: &LonLat| Point::from(place.degrees());
    line.windows(2).map(|pair| Geodesic.distance(point(&pair[0]), point(&pair[1]))).sum()
}

#[cfg(test)]
mod tests {
    use super::super::stretch::Values;
    use super::*;

    fn stretch(from: i32, to: i32, permitted: [bool; 2]) -> SegmentStretch {
        let line = [from, to].map(|lon_e7| LonLat { lon_e7: lon_e7 * 1000, lat_e7: 0 }).to_vec();
        let permitted = permitted.map(|yes| yes.then(Vec::new));
        let values = Values { exists: [true; 2], ..Values::default() };
        SegmentStretch {
            shape_start: 0,
            nodes: [from, to].map(|node| NodeId::new(node.into())),
            line,
            values,
            permitted,
        }
    }

    fn segment(stretches: Vec<SegmentStretch>) -> Value {
        let segment = ExtractSegment {
            way_id: 7,
            chain: 0,
            road: RoadName { highway: "primary_link".to_owned(), name: None, reference: None },
            stretches,
        };
        segment.feature(&VehicleScope { length_m: 16.5 })["properties"].clone()
    }

    #[test]
    fn refused_stretches_next_to_each_other_are_one_rule() {
        let made = segment(vec![stretch(0, 1, [true, false]), stretch(1, 2, [false; 2]), stretch(2, 4, [false, true])]);
        let rules: Vec<(Value, Value)> = made["access_restrictions"]
            .as_array()
            .map(|rules| rules.iter().map(|r| (r["between"].clone(), r["when"]["heading"].clone())).collect())
            .unwrap_or_default();
        assert_eq!(rules, [(json!([0.25, 1.0]), json!("forward")), (json!([0.0, 0.5]), json!("backward"))]);
        assert_eq!((&made["class"], &made["subclass"]), (&json!("primary"), &json!("link")));
        assert_eq!(made["connectors"][1], json!({"connector_id": "n1", "at": 0.25}));
        assert!(made.get("prohibited_transitions").is_none());
    }

    #[test]
    fn what_is_refused_as_a_whole_has_one_rule_and_nobody_turns_back() {
        let made = segment(vec![stretch(0, 1, [false; 2]), stretch(1, 2, [false; 2])]);
        let rules = made["access_restrictions"].as_array().map_or(0, Vec::len);
        assert_eq!((rules, made["access_restrictions"][0].get("between")), (1, None));
        let made = segment(vec![stretch(0, 1, [true; 2]), stretch(1, 2, [false, true])]);
        let turns = made["prohibited_transitions"].as_array().cloned().unwrap_or_default();
        assert_eq!(turns.len(), 2);
        assert_eq!(turns[0]["sequence"], json!([{"connector_id": "n1", "segment_id": "w7"}]));
        assert_eq!((&turns[0]["final_heading"], &turns[0]["when"]["heading"]), (&json!("backward"), &json!("forward")));
        assert_eq!(turns[1]["sequence"][0]["connector_id"], json!("n0"));
    }
}
