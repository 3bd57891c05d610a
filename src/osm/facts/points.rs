//! Nodes on roads: barriers, narrow places and limits at a point. The network passes them to the edges on both sides.

use crate::osm::facts::limits::LegalTags;
use crate::osm::facts::notes::Notes;
use crate::osm::facts::{Direction, Limit, PointFacts, Tags, value};

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

/// The facts from a node's tags, or `None` if nothing concerns a lorry. Access tags count only on barriers; elsewhere
/// they belong to objects beside the road. Limits hold in both directions.
#[must_use]
pub fn point_facts(tags: &Tags<'_>) -> Option<PointFacts> {
    let get = |wanted: &str| tags.iter().find(|(key, _)| *key == wanted).map(|(_, value)| *value);
    let barrier = get("barrier").map(barrier);
    let calmed =
        get("traffic_calming").is_some_and(|v| v.split(';').any(|part| matches!(part.trim(), "choker" | "chicane")));

    let mut notes = Notes::default();
    let mut rules = LegalTags::default();
    for &(key, value) in tags {
        let (head, suffix) = key.split_once(':').unwrap_or((key, ""));
        if head.starts_with("max") || barrier.is_some() {
            rules.take(head, suffix, value, &mut notes);
        }
    }
    let mut legal = rules.resolve(Direction::Forward).merge(rules.resolve(Direction::Backward));
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
    let facts = PointFacts { legal, passage_m, barred };
    (facts != PointFacts::default()).then_some(facts)
}
