//! The tags of a road by its permits.
//!
//! A permit never opens what a tag closes: only keys of netcert's own favour the vehicle. A tag that contradicts a refusal is kept
//! under `netcert:was:…`.
//!
//! What closes a direction to Valhalla 3.9.1 (`lua/graph.lua`, `filter_tags_generic`), in the order of its rules:
//!
//! 1. The class of the road, `access`, `vehicle`, `motor_vehicle` and `hgv` open or close both directions.
//! 2. `service=driveway` without `access` opens both directions, whatever `hgv` says.
//! 3. `oneway` closes one direction.
//! 4. `motor_vehicle:forward` sets its direction, or else `vehicle:forward` does; `backward` likewise.
//! 5. `oneway=-1` exchanges the two directions.
//!
//! A refused direction therefore gets the tag of rule 4, and `hgv=no` if both directions are refused. A tag that would trigger rule
//! 5 is moved away.

use super::Flavour;
use crate::wider::EdgeUse;
use crate::words::Named as _;

/// A key and its value.
pub(super) type Tag = (Vec<u8>, Vec<u8>);

/// The permits of a stretch of road: whether it is permitted, the least RSC, and what is known of the strip that is used, along the way and
/// against it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct StretchPermits {
    pub(super) permitted: [bool; 2],
    pub(super) rsc_m: [Option<f64>; 2],
    pub(super) uses: [Option<EdgeUse>; 2],
}

impl StretchPermits {
    /// Whether one way can have the tags of both stretches. Of two RSCs it has the least.
    pub(super) fn same_but_for_rsc(&self, other: &Self) -> bool {
        (self.permitted, self.uses) == (other.permitted, other.uses)
    }
}

const DIRECTIONS: [&str; 2] = ["forward", "backward"];

/// The tags of a stretch: `tags` with its permits.
pub(super) fn with_permits(tags: &[Tag], said: StretchPermits, flavour: Flavour) -> Vec<Tag> {
    let mut out: Vec<Tag> = Vec::with_capacity(tags.len() + 6);
    for (key, value) in tags {
        if key.starts_with(b"netcert") {
            continue; // a tag of an earlier export
        }
        let gives_way = contradicts(key, said.permitted, flavour) || exchanges(key, value, said.permitted, flavour);
        let key = if gives_way { [b"netcert:was:", key.as_slice()].concat() } else { key.clone() };
        out.push((key, value.clone()));
    }
    let mut add = |key: String, value: &str| out.push((key.into_bytes(), value.as_bytes().to_vec()));
    let closed = said.permitted == [false; 2];
    if closed {
        add("hgv".to_owned(), "no");
        add("netcert".to_owned(), "no");
    }
    let of_directions = DIRECTIONS.into_iter().zip(said.permitted).zip(said.rsc_m).zip(said.uses);
    for (((direction, permitted), rsc_m), uses) in of_directions {
        if !closed {
            add(format!("netcert:{direction}"), if permitted { "yes" } else { "no" });
        }
        if let Some(rsc_m) = rsc_m.filter(|_| permitted) {
            add(format!("netcert:rsc:{direction}"), &rsc_m.to_string());
        }
        if let Some(uses) = uses.filter(|_| permitted) {
            add(format!("netcert:uses:{direction}"), uses.strip.name());
            if uses.factor > 1.0 {
                add(format!("netcert:cost:{direction}"), &uses.factor.to_string());
            }
        }
        if !permitted && !closed {
            add(format!("hgv:{direction}"), "no");
        }
        if !permitted && flavour == Flavour::Valhalla {
            add(format!("motor_vehicle:{direction}"), "no");
        }
    }
    out
}

/// Whether a key contradicts a refusal, so that its tag is moved away.
fn contradicts(key: &[u8], permitted: [bool; 2], flavour: Flavour) -> bool {
    let Ok(key) = std::str::from_utf8(key) else { return false };
    let mut parts = key.split(':');
    let subject = parts.next();
    let direction = parts.next().and_then(|part| DIRECTIONS.iter().position(|direction| *direction == part));
    let ours = subject == Some("hgv") || flavour == Flavour::Valhalla && subject == Some("motor_vehicle");
    let refused = match direction {
        Some(direction) => permitted.get(direction) == Some(&false),
        // A key without a direction applies to both, but a key with a direction overrides it, unless the key has a condition.
        None => {
            subject == Some("hgv")
                && (permitted == [false; 2] || permitted != [true; 2] && key.ends_with(":conditional"))
        }
    };
    ours && refused
}

/// Whether a tag would make Valhalla exchange the permits of the two directions.
fn exchanges(key: &[u8], value: &[u8], permitted: [bool; 2], flavour: Flavour) -> bool {
    flavour == Flavour::Valhalla && permitted[0] != permitted[1] && key == b"oneway" && value == b"-1"
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::osm::facts::Policy;

    fn tags(text: &str) -> Vec<Tag> {
        text.split_whitespace()
            .filter_map(|tag| tag.split_once('='))
            .map(|(key, value)| (key.as_bytes().to_vec(), value.as_bytes().to_vec()))
            .collect()
    }

    fn said(before: &str, permitted: [bool; 2], flavour: Flavour) -> String {
        let said = StretchPermits { permitted, rsc_m: permitted.map(|yes| yes.then_some(0.25)), uses: [None; 2] };
        written(before, said, flavour)
    }

    fn written(before: &str, said: StretchPermits, flavour: Flavour) -> String {
        let after = with_permits(&tags(before), said, flavour);
        let text = |text: &Vec<u8>| String::from_utf8_lossy(text).into_owned();
        after.iter().map(|(key, value)| format!("{}={}", text(key), text(value))).collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn what_is_refused_is_closed_and_what_said_otherwise_is_kept_aside() {
        assert_eq!(
            said("highway=x", [true; 2], Flavour::Hgv),
            "highway=x netcert:forward=yes netcert:rsc:forward=0.25 \
            netcert:backward=yes netcert:rsc:backward=0.25"
        );
        assert_eq!(
            said("hgv=designated hgv:backward=yes", [false; 2], Flavour::Hgv),
            "netcert:was:hgv=designated netcert:was:hgv:backward=yes hgv=no netcert=no"
        );
        assert_eq!(
            said("hgv=yes hgv:backward=yes hgv:conditional=no@x", [true, false], Flavour::Hgv),
            "hgv=yes netcert:was:hgv:backward=yes netcert:was:hgv:conditional=no@x netcert:forward=yes \
             netcert:rsc:forward=0.25 netcert:backward=no hgv:backward=no"
        );
        assert_eq!(
            said("motor_vehicle=yes motor_vehicle:forward=yes", [false, true], Flavour::Valhalla),
            "motor_vehicle=yes netcert:was:motor_vehicle:forward=yes netcert:forward=no hgv:forward=no \
             motor_vehicle:forward=no netcert:backward=yes netcert:rsc:backward=0.25"
        );
        assert_eq!(said("netcert=no hgv=no", [true; 2], Flavour::Hgv).matches("netcert=no").count(), 0);
    }

    #[test]
    fn the_strip_is_named_where_it_is_known_and_has_its_cost_where_it_is_wider() {
        let uses = |strip, factor| Some(EdgeUse { strip, factor });
        let said = StretchPermits {
            permitted: [true; 2],
            rsc_m: [None; 2],
            uses: [uses(Policy::Lane, 1.0), uses(Policy::Carriageway, 5.5)],
        };
        assert_eq!(
            written("highway=x netcert:uses:forward=carriageway", said, Flavour::Valhalla),
            "highway=x netcert:forward=yes netcert:uses:forward=lane netcert:backward=yes netcert:uses:backward=carriageway \
             netcert:cost:backward=5.5"
        );
        let refused = StretchPermits { permitted: [true, false], ..said };
        assert!(!written("highway=x", refused, Flavour::Hgv).contains("carriageway"));
    }

    #[test]
    fn both_directions_are_closed_to_valhalla_by_the_tags_that_nothing_overrules() {
        assert_eq!(
            said("highway=service service=driveway", [false; 2], Flavour::Valhalla),
            "highway=service service=driveway hgv=no netcert=no motor_vehicle:forward=no motor_vehicle:backward=no"
        );
        assert_eq!(
            said("vehicle:forward=destination motor_vehicle:forward=yes", [false; 2], Flavour::Valhalla),
            "vehicle:forward=destination netcert:was:motor_vehicle:forward=yes hgv=no netcert=no \
             motor_vehicle:forward=no motor_vehicle:backward=no"
        );
    }

    #[test]
    fn a_road_that_is_one_way_against_its_nodes_is_closed_to_valhalla_along_them_alone() {
        assert_eq!(
            said("oneway=-1", [false, true], Flavour::Valhalla),
            "netcert:was:oneway=-1 netcert:forward=no hgv:forward=no motor_vehicle:forward=no netcert:backward=yes \
             netcert:rsc:backward=0.25"
        );
        assert!(said("oneway=-1", [false, true], Flavour::Hgv).starts_with("oneway=-1 "));
        assert!(said("oneway=-1", [false; 2], Flavour::Valhalla).starts_with("oneway=-1 "));
    }
}
