//! Nodes on roads: barriers, narrow places and limits at a point. The network passes them to the edges on both sides.

use crate::osm::facts::keys::PASSAGE_KEYS;
use crate::osm::facts::limits::LegalTags;
use crate::osm::facts::notes::Notes;
use crate::osm::facts::{Direction, Limit, Oneway, PointFacts, Tags, tag_lines, value};

/// Passable width of a choker or chicane without a tagged width, metres: one lane of a minor main road. Assumed.
const CALMED_PASSAGE_M: f32 = 3.0;

/// Effect of a barrier on a lorry without further tags.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Barrier {
    /// Opens, or is no obstacle.
    Passable,
    /// Bars the road unless tags say that it may be opened or removed.
    Bars,
    /// Limits the height.
    Height,
}

fn barrier(value: &str) -> Barrier {
    match value {
        "gate" | "lift_gate" | "swing_gate" | "sliding_gate" | "sliding_beam" | "hampshire_gate" | "toll_booth"
        | "toll_gantry" | "border_control" | "checkpoint" | "cattle_grid" | "entrance" | "sally_port" | "kerb"
        | "bump_gate" | "no" => Barrier::Passable,
        "height_restrictor" => Barrier::Height,
        // Bollards, blocks, chains, stiles, cycle barriers, and everything not known to open.
        _ => Barrier::Bars,
    }
}

/// Keys that make a node an object of its own, whose access tags say who may use the object, not the road.
const OBJECTS: [&str; 23] = [
    "advertising",
    "aeroway",
    "amenity",
    "building",
    "craft",
    "door",
    "emergency",
    "entrance",
    "healthcare",
    "historic",
    "information",
    "landuse",
    "leisure",
    "man_made",
    "natural",
    "office",
    "place",
    "playground",
    "power",
    "public_transport",
    "shop",
    "sport",
    "tourism",
];

/// Whether a tag makes a node an object beside or on the road whose access tags are its own.
fn is_beside(key: &str, value: &str) -> bool {
    OBJECTS.contains(&key)
        || key == "highway" && matches!(value, "bus_stop" | "platform" | "services" | "rest_area" | "elevator")
}

/// The facts from a node's tags, or `None` if nothing concerns a lorry. Access tags of objects such as a car park's entrance belong to
/// the object. Limits hold in both directions.
#[must_use]
pub fn point_facts(tags: &Tags<'_>) -> Option<PointFacts> {
    let get = |wanted: &str| tags.iter().find(|(key, _)| *key == wanted).map(|(_, value)| *value);
    let barrier = get("barrier").map(barrier);
    let calmed =
        get("traffic_calming").is_some_and(|v| v.split(';').any(|part| matches!(part.trim(), "choker" | "chicane")));

    let on_road = barrier.is_some() || !tags.iter().any(|(key, value)| is_beside(key, value));
    let mut notes = Notes::default();
    let mut rules = LegalTags::default();
    for &(key, value) in tags {
        let head = key.split(':').next().unwrap_or(key);
        if matches!(head, "oneway" | "seasonal") {
            continue;
        }
        if head.starts_with("max") || on_road {
            rules.take(key, value, &mut notes);
        }
        // A gate that is closed to cars is closed.
        if barrier.is_some() && key == "motorcar:conditional" {
            rules.take("motor_vehicle:conditional", value, &mut notes);
        }
    }
    let mut legal = rules.resolve(Direction::Forward, Oneway::No);
    if tags.iter().any(|(key, _)| key.ends_with("ward") || key.contains("ward:")) {
        legal = legal.merge(&rules.resolve(Direction::Backward, Oneway::No));
    }
    if barrier == Some(Barrier::Height) && legal.max_height == Limit::None {
        legal.max_height = Limit::Unreadable;
    }

    let mut passage_m =
        ["maxwidth:physical", "maxwidth"].iter().filter_map(|key| value::metres(get(key)?)).reduce(f32::min);
    if barrier.is_some() || calmed {
        let opening_m = get("width").or_else(|| get("est_width")).and_then(value::metres);
        passage_m = passage_m.into_iter().chain(opening_m).reduce(f32::min);
    }
    if calmed && passage_m.is_none() {
        passage_m = Some(CALMED_PASSAGE_M);
    }

    let opened = rules.access.explicitly_open();
    let barred = match barrier {
        // Bollards with a known distance between them are a narrow place.
        Some(Barrier::Bars) => !opened && passage_m.is_none(),
        Some(Barrier::Passable | Barrier::Height) => get("locked") == Some("yes") && !opened,
        None => false,
    };
    let stops = barred || barrier == Some(Barrier::Height);
    let behind = [("barrier", stops), ("locked", stops)];
    let behind = behind.into_iter().chain(PASSAGE_KEYS.map(|key| (key, passage_m.is_some())));
    let mut lines = String::new();
    behind.filter(|row| row.1).filter_map(|(key, _)| Some((key, get(key)?))).for_each(|(key, value)| {
        tag_lines::add(&mut lines, key, value);
    });
    legal.tags = tag_lines::merged(legal.tags.as_deref(), (!lines.is_empty()).then_some(lines.as_str()));
    let facts = PointFacts { legal, passage_m, barred };
    (facts != PointFacts::default()).then_some(facts)
}
