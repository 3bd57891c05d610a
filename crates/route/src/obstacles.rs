//! Finds what blocks a route: the set of places of least cost that would have to become safe.
//!
//! The cost counts both number and size: each place costs one metre plus the metres that are missing there. Two places with 0.1
//! m missing are cheaper than one place with 3 m missing. Among sets of equal cost, the one with the shortest way is taken.

use super::assemble::{AssemblyError, PartKind, passes_over};
use super::drive::Drive;
use super::graph::{Access, BARRED};
use super::permits::{Permit, Permits};
use crate::network::{EdgeNo, Movements, Network, destination_tag};
use crate::osm::facts::{Policy, WidthSource};
use crate::osm::rounded;
use crate::vehicle::Vehicle;
use crate::verdict::{ForbiddenReason, Verdict};
use crate::words::verdict_words;

/// The price of a missing centimetre. It exceeds the cost of any way on earth (40,000 km are 2³⁶ millimetres; in milliseconds
/// 2³⁶ are two years), and the prices of 100,000 of the dearest places can be added without overflow.
pub(super) const CENTIMETRE: u64 = 1 << 36;
/// The cost of a place by itself, centimetres.
const PLACE: f64 = 100.0;
/// The missing width to assume if there is no number, centimetres: no width or line is known, or no width would help.
const NO_NUMBER: f64 = 500.0;
/// The greatest missing width that counts, centimetres.
const MOST_MISSING: f64 = 2000.0;

/// A whole route that failed although its parts passed.
#[derive(Debug, Clone, PartialEq)]
pub struct Refutation {
    /// The turn that the failure is attributed to, or an edge if no turn is near.
    pub at: PartKind,
    /// RSC (metres) and hinge margin (radians) of the whole. `None` if its pieces could not be joined or no bound holds.
    pub result: Option<(f64, f64)>,
    /// Why its pieces could not be joined.
    pub assembly: Option<AssemblyError>,
    /// Whether the search went on without the place. Otherwise the turn was tried on another path.
    pub left_out: bool,
}

/// A place that would have to become safe.
#[derive(Debug, Clone, PartialEq)]
pub struct Obstacle {
    /// The edge or turn.
    pub at: PartKind,
    /// The strip that the vehicle may use.
    pub policy: Policy,
    /// The permit of the place by itself.
    pub permit: Permit,
    /// Whether the place passed by itself, but a whole route failed there.
    pub refuted: bool,
    /// Whether the road is open to a destination only, and the way passes through it. It begins with this edge.
    pub destination_only: bool,
    /// The missing width, metres, if it is known: from the place's own certificate, or from the whole route that came nearest to
    /// passing.
    pub missing_m: Option<f64>,
}

/// The way that the fewest and smallest obstacles block. Nothing certifies it.
#[derive(Debug, Clone, PartialEq)]
pub struct BlockedWay {
    /// All its edges in driving order.
    pub edges: Vec<EdgeNo>,
    /// The share of the first edge before its beginning, and of the last edge up to its end, 0..=1.
    pub start: f64,
    /// See `start`.
    pub end: f64,
}

impl BlockedWay {
    /// Its line on the map, degrees.
    #[must_use]
    pub fn line(&self, network: &Network) -> Vec<[f64; 2]> {
        let last = self.edges.len().saturating_sub(1);
        let mut line: Vec<[f64; 2]> = Vec::new();
        for (i, &edge) in self.edges.iter().enumerate() {
            let Some(edge) = network.edges.get(edge.index()) else { continue };
            let whole: Vec<[f64; 2]> = network.positions(edge).map(|at| <[f64; 2]>::from(at.degrees())).collect();
            let from = if i == 0 { self.start } else { 0.0 };
            let to = if i == last { self.end } else { 1.0 };
            line.extend(cut(&whole, from, to));
        }
        line.dedup();
        line
    }
}

/// A piece of a line, from one share of its length to another.
fn cut(line: &[[f64; 2]], from: f64, to: f64) -> Vec<[f64; 2]> {
    let Some(first) = line.first() else { return Vec::new() };
    let shrink = first[1].to_radians().cos();
    let length = |p: &[[f64; 2]]| ((p[1][0] - p[0][0]) * shrink).hypot(p[1][1] - p[0][1]);
    let whole: f64 = line.windows(2).map(length).sum();
    let (from, to) = (from.clamp(0.0, 1.0) * whole, to.clamp(0.0, 1.0) * whole);
    let mut piece = Vec::new();
    let mut sum = 0.0;
    for pair in line.windows(2) {
        let own = length(pair);
        let at = |along: f64| {
            let share = ((along - sum) / own.max(1e-12)).clamp(0.0, 1.0);
            rounded([0, 1].map(|axis| pair[0][axis] + share * (pair[1][axis] - pair[0][axis])))
        };
        if sum + own >= from && sum <= to {
            piece.extend([at(from), at(to)]);
        }
        sum += own;
    }
    piece.dedup();
    piece
}

/// What the verdict of a place rests on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Basis {
    /// Where the width of an edge's strip comes from. `None` if it has no width.
    Width(Option<WidthSource>),
    /// The kerb radius of a turn's corner.
    Kerb {
        /// Whether it is assumed, because nobody has measured or mapped it.
        assumed: bool,
    },
    /// The area of a passage over a roundabout or over several nodes.
    Area,
}

impl Obstacle {
    /// A road that is open to a destination only, by its first edge on the way.
    pub(super) fn passed_through(edge: EdgeNo, policy: Policy, permit: Permit) -> Self {
        let at = PartKind::Edge(edge);
        Self { at, policy, permit, refuted: false, destination_only: true, missing_m: None }
    }

    /// The words for its verdict and reason. The reason may be empty.
    #[must_use]
    pub fn words(&self, network: &Network, vehicle: &Vehicle) -> (&'static str, &'static str) {
        let (verdict, reason) = verdict_words(self.permit.verdict);
        match (self.tag(network, vehicle), self.refuted) {
            (Some(tag), _) if tag.starts_with("hgv") => verdict_words(Verdict::Forbidden(ForbiddenReason::Hgv)),
            (Some(_), _) => verdict_words(Verdict::Forbidden(ForbiddenReason::Access)),
            (None, true) => ("refuted", reason),
            (None, false) => (verdict, reason),
        }
    }

    /// The tags that open the road to a destination only, if the way passes through such a road here.
    #[must_use]
    pub fn tag(&self, network: &Network, vehicle: &Vehicle) -> Option<String> {
        let PartKind::Edge(edge) = self.at else { return None };
        let edge = network.edges.get(edge.index()).filter(|_| self.destination_only)?;
        destination_tag(network, edge, vehicle)
    }

    /// The edge at or after which it is.
    pub(super) fn last_edge(&self) -> EdgeNo {
        match self.at {
            PartKind::Edge(edge) | PartKind::Turn { to: edge, .. } => edge,
        }
    }

    /// What the verdict rests on.
    #[must_use]
    pub fn basis(&self, network: &Network) -> Option<Basis> {
        if self.destination_only {
            return None;
        }
        let edge = |edge: EdgeNo| network.edges.get(edge.index());
        Some(match self.at {
            PartKind::Edge(own) => {
                let strip = network.section(edge(own)?).strip(self.policy);
                Basis::Width(strip.map(|strip| strip.source))
            }
            at if passes_over(network, at).is_some() => Basis::Area,
            PartKind::Turn { from, to } => {
                let (from, to) = (edge(from)?, edge(to)?);
                Basis::Kerb { assumed: network.site_kerb_m(from.to_node, [from, to]).is_none() }
            }
        })
    }
}

/// The missing width if the RSC is negative, metres.
fn missing_m(rsc_m: Option<f64>) -> Option<f64> {
    rsc_m.filter(|rsc_m| rsc_m.is_finite() && *rsc_m < 0.0).map(|rsc_m| -rsc_m)
}

/// The least missing width among the refutations of a place, metres.
fn refuted_missing_m(refuted: &[Refutation], at: PartKind) -> Option<f64> {
    let there = refuted.iter().filter(|refutation| refutation.at == at);
    there.filter_map(|refutation| missing_m(refutation.result.map(|result| result.0))).min_by(f64::total_cmp)
}

fn price(missing_m: Option<f64>) -> u64 {
    let missing = missing_m.map_or(NO_NUMBER, |missing_m| (100.0 * missing_m).ceil().min(MOST_MISSING));
    CENTIMETRE * (PLACE + missing) as u64
}

/// The access to everything lawful. Places that are not safe, refuted places, and passing through roads that are open to a destination
/// only have a price.
pub(super) fn priced(permits: &Permits, movements: &Movements, refuted: &[Refutation]) -> Access {
    let mut access = permits.access_at(movements, |permit| price(missing_m(permit.rsc_m)));
    access.pass_through = price(None);
    for refutation in refuted.iter().filter(|refutation| refutation.left_out) {
        if let Some(slot) = slot(&mut access, movements, refutation.at).filter(|slot| **slot != BARRED) {
            *slot = price(refuted_missing_m(refuted, refutation.at));
        }
    }
    access
}

/// The places on a way that have a price.
pub(super) fn on(
    drive: &Drive,
    permits: &Permits,
    movements: &Movements,
    access: &mut Access,
    refuted: &[Refutation],
) -> Vec<Obstacle> {
    let first = drive.edges.first().map(|&edge| PartKind::Edge(edge));
    let rest = drive.joins().flat_map(|join| {
        let turn = PartKind::Turn { from: join.from, to: join.to };
        [turn, PartKind::Edge(join.to)]
    });
    let places = first.into_iter().chain(rest).filter_map(|at| {
        slot(access, movements, at).filter(|price| **price > 0)?;
        let permit = permit(permits, movements, at)?;
        let refuted_here = refuted.iter().any(|refutation| refutation.left_out && refutation.at == at);
        let missing_m = if refuted_here { refuted_missing_m(refuted, at) } else { missing_m(permit.rsc_m) };
        let policy = permits.settings.policy;
        Some(Obstacle { at, policy, permit, refuted: refuted_here, destination_only: false, missing_m })
    });
    places.collect()
}

/// The slot of a place's price in `access`.
pub(super) fn slot<'a>(access: &'a mut Access, movements: &Movements, at: PartKind) -> Option<&'a mut u64> {
    match at {
        PartKind::Edge(edge) => access.edges.get_mut(edge.index()),
        PartKind::Turn { from, to } => match movements.index(from, to) {
            Some(place) => access.movements.get_mut(place),
            None => access.passages.get_mut(movements.passage(from, to)?),
        },
    }
}

fn permit(permits: &Permits, movements: &Movements, at: PartKind) -> Option<Permit> {
    match at {
        PartKind::Edge(edge) => permits.edges.get(edge.index()).copied(),
        PartKind::Turn { from, to } => match movements.index(from, to) {
            Some(place) => permits.movements.get(place).copied(),
            None => permits.passages.get(movements.passage(from, to)?).copied(),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_piece_of_a_line_begins_and_ends_at_its_shares() {
        let line = [[0.0, 0.0], [0.0, 1.0], [0.0, 3.0], [0.0, 4.0]];
        assert_eq!(cut(&line, 0.125, 0.5), [[0.0, 0.5], [0.0, 1.0], [0.0, 2.0]]);
        assert_eq!(cut(&line, 0.0, 1.0), line);
        assert_eq!(cut(&line, 0.3, 0.3).len(), 1);
        assert!(cut(&[], 0.0, 1.0).is_empty());
    }

    #[test]
    fn number_and_metres_count_both() {
        let cost = |missing: &[Option<f64>]| missing.iter().map(|&m| price(m)).sum::<u64>();
        assert!(cost(&[Some(0.1), Some(0.1)]) < cost(&[Some(3.0)]));
        assert!(cost(&[Some(0.5)]) < cost(&[Some(0.01), Some(0.01)]));
        assert!(cost(&[Some(0.5)]) < cost(&[Some(0.6)]));
        assert!(cost(&[Some(3.0)]) < cost(&[None]));
        assert_eq!(cost(&[Some(50.0)]), cost(&[Some(1e9)]), "a road that is not there is not dearer still");
        assert!(price(Some(1e9)).checked_mul(100_000).is_some());
    }
}
