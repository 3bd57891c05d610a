//! Facts of a turn from the map alone: its id, angle, kerb, and a line to draw.
//!
//! They do not depend on vehicles and policies: the same network gives the same facts.

use rayon::prelude::*;
use rustc_hash::FxHashSet;

use super::area::CORNERS_RAD;
use super::{Kerbs, path, surface};
use crate::network::{Edge, EdgeNo, Movement, MovementKind, Network, Passage, offset_m};
use crate::osm::{LonLat, NodeId};

/// Extent of a turn's line along both edges, metres. The turn's angle is measured over the same length.
const LINE_M: f64 = 12.0;

/// Origin of a corner's kerb.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum KerbSource {
    /// A radius by class and country.
    Assumed,
    /// A radius measured on site.
    Surveyed,
    /// The mapped surface of the junction.
    Mapped,
}

impl KerbSource {
    /// The source with this name in the database.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        [Self::Assumed, Self::Surveyed, Self::Mapped].into_iter().find(|source| source.name() == name)
    }

    /// Name in the database.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Assumed => "assumed",
            Self::Surveyed => "surveyed",
            Self::Mapped => "mapped",
        }
    }
}

/// A turn as mapped.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct TurnFacts {
    /// Stable id: the same edges give the same id in the next extract. Positive.
    pub id: i64,
    /// The edges before and after the turn. The edge after a passage starts at another node.
    pub movement: Movement,
    /// The edges between, in driving order, for a passage; otherwise empty.
    pub through: Vec<EdgeNo>,
    /// Angle of the turn, degrees, positive left.
    pub angle_deg: f64,
    /// Radius of the kerb on the inside, metres. `None` if the corner is too flat or too acute, or is mapped.
    pub kerb_radius_m: Option<f64>,
    /// Origin of the kerb. `None` if the corner is too flat or too acute for one.
    pub kerb_source: Option<KerbSource>,
    /// The last metres of its first edge and the first metres of its last edge, in driving order.
    pub line: Vec<LonLat>,
}

/// All turns of a network in the order of its movements, then the passages. Straight continuations and
/// U-turns are not turns.
#[must_use]
pub fn turn_facts(network: &Network, kerbs: &Kerbs) -> Vec<TurnFacts> {
    let movements = network.movements();
    let turns = movements.all().iter().filter(|movement| movement.kind == MovementKind::Turn);
    let passage = |Passage { from, to, through, forbidden }| {
        (Movement { from, to, kind: MovementKind::Turn, forbidden }, through)
    };
    let turns = turns.map(|&movement| (movement, Vec::new())).chain(network.passages().into_iter().map(passage));
    let mut taken = FxHashSet::default();
    let mut with_id = |(movement, through): (Movement, Vec<EdgeNo>)| {
        let (from, to) = (network.edges.get(movement.from.index())?, network.edges.get(movement.to.index())?);
        let mut id = turn_id(from.id, to.id);
        while !taken.insert(id) {
            id = (id + 1) & i64::MAX;
        }
        Some((id, [from, to], movement, through))
    };
    let turns: Vec<_> = turns.filter_map(&mut with_id).collect();
    turns
        .into_par_iter()
        .filter_map(|(id, [from, to], movement, through)| {
            let line = line(network, movement, &through)?;
            let angle = angle_rad(&line);
            let ends = [through.first(), through.last()];
            let between = ends.map(|edge| edge.and_then(|&edge| network.edges.get(edge.index())));
            // The radius of a corner, and whether it is surveyed; none if the corner is mapped.
            let corner = |node: NodeId, a: &Edge, b: &Edge| {
                let roads = [network.road(a), network.road(b)];
                let radius = || (kerbs.at(network, node, [a, b]), network.site_kerb_m(node, [a, b]).is_some());
                (!surface::is_mapped(network, node, roads)).then(radius)
            };
            let corners = match between {
                [Some(first), Some(last)] => vec![corner(from.to_node, from, first), corner(to.from_node, last, to)],
                _ => vec![corner(from.to_node, from, to)],
            };
            let cornered = !through.is_empty() || CORNERS_RAD.contains(&angle.abs());
            // Of two corners the sharper one counts.
            let sharpest = corners.into_iter().flatten().reduce(|a, b| if b.0 < a.0 { b } else { a });
            let (kerb_radius_m, kerb_source) = match sharpest {
                _ if !cornered => (None, None),
                None => (None, Some(KerbSource::Mapped)),
                Some((m, surveyed)) if m > 0.0 => {
                    (Some(m), Some(if surveyed { KerbSource::Surveyed } else { KerbSource::Assumed }))
                }
                Some(_) => (None, None),
            };
            let angle_deg = angle.to_degrees();
            Some(TurnFacts { id, movement, through, angle_deg, kerb_radius_m, kerb_source, line })
        })
        .collect()
}

/// A hash of the two edges' ids.
fn turn_id(from: i64, to: i64) -> i64 {
    let mut hash = blake3::Hasher::new();
    hash.update(&from.to_le_bytes()).update(&to.to_le_bytes());
    let bytes = hash.finalize();
    let word = bytes.as_bytes().first_chunk::<8>().map_or(0, |bytes| i64::from_le_bytes(*bytes));
    (word & i64::MAX).max(1)
}

fn line(network: &Network, movement: Movement, through: &[EdgeNo]) -> Option<Vec<LonLat>> {
    let (from, to) = (network.edges.get(movement.from.index())?, network.edges.get(movement.to.index())?);
    let mut line = first_metres(network.positions(from).rev());
    line.reverse();
    for &arc in through {
        line.extend(network.positions(network.edges.get(arc.index())?).skip(1));
    }
    line.extend(first_metres(network.positions(to)).into_iter().skip(1));
    Some(line)
}

/// The first [`LINE_M`] metres of a line.
fn first_metres(positions: impl Iterator<Item = LonLat>) -> Vec<LonLat> {
    let mut out: Vec<LonLat> = Vec::new();
    let mut left_m = LINE_M;
    for next in positions {
        let Some(&last) = out.last() else {
            out.push(next);
            continue;
        };
        let [east, north] = offset_m(last, next);
        let length_m = east.hypot(north);
        let share = (left_m / length_m.max(1e-9)).min(1.0);
        let part = |a: i32, b: i32| a.saturating_add((f64::from(b.wrapping_sub(a)) * share).round() as i32);
        out.push(if share < 1.0 {
            LonLat { lon_e7: part(last.lon_e7, next.lon_e7), lat_e7: part(last.lat_e7, next.lat_e7) }
        } else {
            next
        });
        left_m -= length_m;
        if left_m <= 0.0 {
            break;
        }
    }
    out
}

/// Angle from the first segment's direction to the last one's, summed over the turns between.
fn angle_rad(line: &[LonLat]) -> f64 {
    let course = |w: &[LonLat]| {
        let [east, north] = offset_m(w[0], w[1]);
        north.atan2(east)
    };
    let courses: Vec<f64> = line.windows(2).map(course).collect();
    match (courses.first(), courses.last()) {
        (Some(first), Some(last)) => path::wrapped(last - first),
        _ => 0.0,
    }
}
