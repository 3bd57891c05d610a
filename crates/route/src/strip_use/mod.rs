//! Where a certified route uses more of the road than its own lane, and how far at most.
//!
//! On a road the certificate bounds every body: its half-width less the leeway there. Near a turn the area of the junction counts instead
//! of half-widths. On the roads before and after the turn that area has the strip of the turn; how much of the strip is needed there says
//! a certificate in a smaller area ([`turn_reach`]). Between the roads, inside the crossing, there are no lanes. All numbers are upper bounds,
//! disturbances included, with the widths that the map or assumptions give.

mod strips;
mod turn_reach;
mod windows;

use netcert_base::leeway::NOTHING_M;
use netcert_base::named;

use super::assemble::{PartKind, RoutePart, RoutePath};
use super::pieces::Strokes;
use crate::network::{EdgeNo, Network};
use crate::osm::facts::{Oneway, Policy};
use crate::stet::{Certificate, Model, Side, known_m};
use crate::stop::{Stop, Stopped};
use crate::turn_ends::TurnEnds;
use strips::{PartStrips, StationStrips};
use turn_reach::turn_reach;
use windows::{BodyReach, area_windows};

/// What stands beyond a strip by less than this counts as inside, metres.
const LEAST_M: f64 = 0.01;
/// Uses of one road that are closer than this are one use, metres.
const GAP_M: f64 = 10.0;

/// The kind of place at which a strip is used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UsePlace {
    /// On a road. The distance beyond the narrower strip comes from the certificate.
    Road,
    /// Beside a turn. The distance comes from the certificate of the same plan in a smaller area, or is that of the edge of the turn's strip.
    Turn,
}

named!(UsePlace { Road = "road", Turn = "turn" });

/// A stretch on which a vehicle may use more of the road than its own lane.
#[derive(Debug, Clone, PartialEq)]
pub struct StripUse {
    /// What it uses: [`Policy::Direction`] is another lane of its direction, [`Policy::Carriageway`] is beyond all lanes of its direction.
    pub strip: Policy,
    /// The kind of place.
    pub place: UsePlace,
    /// The edge or turn.
    pub at: PartKind,
    /// Beginning, metres from the route's beginning.
    pub from_m: f64,
    /// End, metres from the route's beginning.
    pub to_m: f64,
    /// The greatest distance of any point of a body beyond the edge of the narrower strip (the own lane, or all lanes of the direction),
    /// metres. An upper bound.
    pub beyond_m: f64,
    /// The side of that edge.
    pub side: Side,
}

/// How far bodies stand beyond a strip at one station.
#[derive(Debug, Clone, Copy)]
struct Beyond {
    strip: Policy,
    by_m: f64,
    side: Side,
}

/// A certified path with what its uses follow from.
#[derive(Clone, Copy)]
pub(super) struct CertifiedPath<'p> {
    pub(super) path: &'p RoutePath,
    pub(super) certificate: &'p Certificate,
    pub(super) model: &'p Model,
}

impl StripUse {
    /// All uses of a certified path, in driving order. `strokes` must be those that the path was made from.
    ///
    /// # Errors
    /// `stop` was told.
    pub(super) fn all(strokes: &mut Strokes, of: CertifiedPath<'_>, stop: &Stop) -> Result<Vec<Self>, Stopped> {
        let CertifiedPath { path, certificate, model } = of;
        let windows = area_windows(path, BodyReach::of(&model.vehicle, path.corridor.spacing_m));
        let edges = path.parts.iter().filter_map(|part| match part.kind {
            PartKind::Edge(edge) => Some((part, edge)),
            PartKind::Turn { .. } => None,
        });
        let strips: Vec<(&RoutePart, PartStrips)> =
            edges.map(|(part, edge)| (part, PartStrips::new(strokes, path, part, edge, &windows))).collect();
        let strips_alone: Vec<&PartStrips> = strips.iter().map(|(_, strips)| strips).collect();
        let reach = turn_reach(&path.corridor, certificate, model, &strips_alone, &windows, stop)?;
        let mut all: Vec<Self> = Vec::new();
        let mut beside: Vec<Self> = Vec::new();
        for (part, strips) in &strips {
            for k in part.stations.clone() {
                let window = windows.iter().find(|window| window.stations.contains(&k));
                let leeways = leeways(certificate, k);
                let beyond = beyond(strips, k, |k, strips| match window {
                    // While the area does not count, the corridor's half-widths do.
                    Some(_) => [0, 1].map(|side| {
                        let in_area_m = reach[k][side].unwrap_or(strips.turn[side]);
                        Some(leeways[side].map_or(in_area_m, |m| in_area_m.max(strips.corridor[side] - m)))
                    }),
                    None => [0, 1].map(|side| Some(strips.corridor[side] - leeways[side]?)),
                });
                let Some(beyond) = beyond else { continue };
                let turn =
                    window.and_then(|window| window.turn).map(|TurnEnds { from, to }| PartKind::Turn { from, to });
                let uses = if turn.is_some() { &mut beside } else { &mut all };
                let found = Self::at_station(path, turn.unwrap_or(part.kind), k, beyond);
                match uses.last_mut() {
                    Some(last) if last.goes_on_with(&found) => last.join(&found),
                    _ => uses.push(found),
                }
            }
        }
        all.append(&mut beside);
        all.sort_by(|a, b| a.from_m.total_cmp(&b.from_m));
        Ok(all)
    }

    fn at_station(path: &RoutePath, at: PartKind, k: usize, beyond: Beyond) -> Self {
        let spacing_m = path.corridor.spacing_m;
        let last_m = (path.corridor.len() - 1) as f64 * spacing_m;
        Self {
            strip: beyond.strip,
            place: if matches!(at, PartKind::Turn { .. }) { UsePlace::Turn } else { UsePlace::Road },
            at,
            from_m: ((k as f64 - 1.0) * spacing_m).max(0.0),
            to_m: ((k as f64 + 1.0) * spacing_m).min(last_m),
            beyond_m: beyond.by_m,
            side: beyond.side,
        }
    }

    /// What the vehicle uses, in words.
    #[must_use]
    pub fn words(&self, network: &Network) -> &'static str {
        let edges = match self.at {
            PartKind::Edge(edge) => [edge, edge],
            PartKind::Turn { from, to } => [from, to],
        };
        let two_way =
            |edge: EdgeNo| network.edges.get(edge.index()).is_some_and(|edge| network.road(edge).oneway == Oneway::No);
        match self.strip {
            Policy::Lane => "its own lane",
            Policy::Direction => "another lane of its direction",
            Policy::Carriageway if edges.into_iter().any(two_way) => "the oncoming lane",
            Policy::Carriageway => "the road beyond its lanes",
        }
    }

    fn goes_on_with(&self, next: &Self) -> bool {
        let same_turn = self.place == UsePlace::Road || self.at == next.at;
        same_turn
            && (self.place, self.strip, self.side) == (next.place, next.strip, next.side)
            && next.from_m - self.to_m < GAP_M
    }

    /// Adds a use of the same place. The wider strip counts, with the greatest distance beyond its edge.
    fn join(&mut self, next: &Self) {
        if (next.strip, next.beyond_m) > (self.strip, self.beyond_m) {
            (self.strip, self.beyond_m, self.side) = (next.strip, next.beyond_m, next.side);
        }
        (self.from_m, self.to_m) = (self.from_m.min(next.from_m), self.to_m.max(next.to_m));
    }
}

/// The least leeway of bodies at a station against half-widths, `[left, right]`, metres; not below the route's RSC. `None` on a side that no
/// body passes.
fn leeways(certificate: &Certificate, k: usize) -> [Option<f64>; 2] {
    let rsc_m = certificate.result.rsc_m.unwrap_or(0.0);
    // Where the bounds do not close at γ = 1, they do at the route's γ, with the route's RSC.
    let closes = |m: &f64| if *m <= 0.5 * NOTHING_M { rsc_m } else { *m };
    let [left_m, right_m] = &certificate.strip_leeway_m;
    [left_m, right_m].map(|column| column.get(k).map(closes).and_then(known_m).map(|m| m.max(rsc_m)))
}

/// How far bodies stand beyond a strip at a station. `reach` says how far they may be to the left and right of the route's line at a station,
/// given its strips, metres; `None` on a side that no body passes. A body between two stations has its leeway against an edge between theirs,
/// so the stations beside count, too.
fn beyond(strips: &PartStrips, k: usize, reach: impl Fn(usize, &StationStrips) -> [Option<f64>; 2]) -> Option<Beyond> {
    let Some(near) = strips.around(k) else {
        // Nothing is known of the lanes. The vehicle may be anywhere in the strip.
        return Some(Beyond { strip: Policy::Carriageway, by_m: strips.width_m(k)?, side: Side::Left });
    };
    let over = |edges: fn(&StationStrips) -> [f64; 2], strip: Policy| {
        let beyond = |(k, strips): &(usize, StationStrips)| {
            let (reach, edges) = (reach(*k, strips), edges(strips));
            let side = |of: usize, side: Side| Some(Beyond { strip, by_m: reach[of]? - edges[of], side });
            [side(0, Side::Left), side(1, Side::Right)]
        };
        let all = near.iter().flat_map(beyond).flatten();
        all.max_by(|a, b| a.by_m.total_cmp(&b.by_m)).filter(|beyond| beyond.by_m > LEAST_M)
    };
    over(|strips| strips.direction, Policy::Carriageway).or_else(|| over(|strips| strips.lane, Policy::Direction))
}
