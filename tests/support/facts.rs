//! What tests and benchmarks of the reader use for facts: the least that a way with `highway` gives.

use netcert::osm::facts::{Legal, Limit, Oneway, PointFacts, RoadClass, WayDraft, WayFacts};

/// Every way with a `highway` is a road.
pub fn way<'t>(tags: &[(&'t str, &'t str)]) -> Result<WayDraft<'t>, &'static str> {
    let value = |wanted: &str| tags.iter().find(|(key, _)| *key == wanted).map(|(_, value)| *value);
    let Some(highway) = value("highway") else { return Err("not_a_highway") };
    let facts = WayFacts {
        class: if highway == "primary" { RoadClass::Primary } else { RoadClass::Unclassified },
        link: false,
        roundabout: value("junction") == Some("roundabout"),
        oneway: Oneway::No,
        name: None,
        reference: None,
        legal_forward: Legal::default(),
        legal_backward: Legal::default(),
    };
    Ok(WayDraft { facts, name: value("name"), reference: value("ref") })
}

/// Every node with a `maxheight` limits it to three metres.
pub fn point(tags: &[(&str, &str)]) -> Option<PointFacts> {
    let limited = tags.iter().any(|(key, _)| *key == "maxheight");
    let legal = Legal { max_height: Limit::At(3.0), ..Legal::default() };
    limited.then_some(PointFacts { legal, ..PointFacts::default() })
}
