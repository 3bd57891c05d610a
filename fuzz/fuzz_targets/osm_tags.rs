//! Tags of ways and nodes, which anybody can write: one `key=value` in a line. Tagged widths are finite and positive, and limits, access and
//! opening hours have an answer for every shipped vehicle, whenever and at a time.
#![no_main]

use std::sync::LazyLock;

use jiff::civil::date;
use libfuzzer_sys::fuzz_target;
use netcert_base::vehicle::Catalogue;
use netcert_osm::osm::facts::{At, RuleSet, area_kind, backdrop_kind, point_facts, turn_rules, way_facts};

static VEHICLES: LazyLock<Catalogue> = LazyLock::new(|| Catalogue::builtin().expect("the shipped vehicles"));

fuzz_target!(|text: &str| {
    let mut tags: Vec<(&str, &str)> = text.lines().filter_map(|line| line.split_once('=')).collect();
    let _ = (area_kind(&tags), backdrop_kind(&tags), turn_rules(&tags));
    let point = point_facts(&tags);
    assert!(point.as_ref().and_then(|point| point.passage_m).is_none_or(|m| m.is_finite() && m > 0.0));
    tags.push(("highway", "secondary"));
    let way = way_facts(&tags).ok();
    assert!(way.as_ref().and_then(|way| way.facts.tagged_width_m()).is_none_or(|m| m.is_finite() && m > 0.0));
    let of_way = way.iter().flat_map(|way| [&way.facts.legal_forward, &way.facts.legal_backward]);
    for legal in of_way.chain(point.iter().map(|point| &point.legal)) {
        let at = At::Time { time: date(2026, 12, 1).at(8, 0, 0, 0), country: *b"DE" };
        for vehicle in VEHICLES.iter().step_by(7) {
            let judged = legal.judge(vehicle, at);
            assert!([judged.allowed, judged.has].into_iter().flatten().all(f64::is_finite), "{judged:?}");
            let _ = legal.forbids(vehicle);
        }
        let _ = legal.open_when();
        // As a database keeps it.
        if let Some(rules) = &legal.rules {
            assert_eq!(RuleSet::from_text(rules.text()).as_ref(), Some(rules));
        }
    }
});
