//! What stands higher on a way that fails: roads become wider, turns climb by one rung.

use super::assemble::PartKind;
use super::drive::Drive;
use super::rungs::Rungs;
use super::turn_ends::TurnEnds;
use crate::network::{EdgeNo, Network};
use crate::stet::SpanResult;

/// Where a place is raised, so much of the road before and after it is raised, too, metres. A vehicle swings out before the place where it
/// needs the room.
const BESIDE_M: f64 = 30.0;

impl Rungs {
    /// Raises a place of a way and the road beside it: the turn by one rung, the roads by `missing_m`. Returns the edges that stand higher now,
    /// or whose turns do; none if all stand on the top.
    pub(super) fn raise(&mut self, network: &Network, drive: &Drive, at: PartKind, missing_m: f32) -> Vec<EdgeNo> {
        let (first, last, turn) = match at {
            PartKind::Edge(edge) => (edge, edge, None),
            PartKind::Turn { from, to } => (from, to, Some(TurnEnds { from, to })),
        };
        let mut raised = Vec::new();
        let length_m = |edge: EdgeNo| network.edges.get(edge.index()).map_or(0.0, |edge| network.length_m(edge));
        let near = beside(drive, first, last, &length_m);
        raised.extend(near.into_iter().filter(|&edge| self.widen(network, edge, missing_m)));
        raised.extend(turn.filter(|&ends| self.raise_turn(ends)).map(|_| [first, last]).into_iter().flatten());
        raised
    }

    /// Raises what fails on a way: of each run of failing parts the narrowest road that can become wider, else its turns, else the roads
    /// beside the run. A road that only leads to a narrow one keeps its strip so. A road gets `times` what is missing. Returns as
    /// [`Self::raise`].
    pub(super) fn raise_failing(
        &mut self,
        network: &Network,
        parts: &[(PartKind, SpanResult)],
        times: f64,
    ) -> Vec<EdgeNo> {
        let mut raised = Vec::new();
        let mut at = 0;
        for run in parts.chunk_by(|a, b| a.1.safe() == b.1.safe()) {
            let (from, to) = (at, at + run.len());
            at = to;
            if run.iter().all(|(_, result)| result.safe()) {
                continue;
            }
            let missing_m = run.iter().filter_map(|(_, result)| result.rsc_m).fold(0.0, |most: f64, m| most.max(-m));
            let missing_m = (times * missing_m) as f32;
            let mut roads: Vec<(f32, EdgeNo)> =
                run.iter().filter_map(edge).filter_map(|edge| Some((self.width_m(network, edge)?, edge))).collect();
            roads.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            if let Some((_, edge)) = roads.into_iter().find(|(_, edge)| self.widen(network, *edge, missing_m)) {
                raised.push(edge);
                continue;
            }
            let turns = run.iter().filter_map(|(kind, _)| match *kind {
                PartKind::Turn { from, to } => Some(TurnEnds { from, to }),
                PartKind::Edge(_) => None,
            });
            let turns: Vec<TurnEnds> = turns.filter(|&ends| self.raise_turn(ends)).collect();
            if !turns.is_empty() {
                raised.extend(turns.iter().flat_map(|ends| [ends.from, ends.to]));
                continue;
            }
            let before = from.checked_sub(1).and_then(|before| parts.get(before));
            let beside = before.into_iter().chain(parts.get(to)).filter_map(edge);
            raised.extend(beside.filter(|&edge| self.widen(network, edge, missing_m)));
        }
        raised
    }
}

/// The edge of a part that is no turn.
fn edge((kind, _): &(PartKind, SpanResult)) -> Option<EdgeNo> {
    match *kind {
        PartKind::Edge(edge) => Some(edge),
        PartKind::Turn { .. } => None,
    }
}

/// The edges of a way from `first` to `last`, and those beside them, each edge once.
fn beside(drive: &Drive, first: EdgeNo, last: EdgeNo, length_m: &dyn Fn(EdgeNo) -> f64) -> Vec<EdgeNo> {
    let of = |edge: EdgeNo| drive.edges.iter().position(|&of| of == edge);
    let Some((first, last)) = of(first).zip(of(last)).filter(|(first, last)| first <= last) else {
        return vec![first, last];
    };
    let near = |edges: &mut dyn Iterator<Item = &EdgeNo>| {
        let mut way_m = 0.0;
        let mut count = 0;
        for &edge in edges {
            count += 1;
            way_m += length_m(edge);
            if way_m >= BESIDE_M {
                break;
            }
        }
        count
    };
    let before = near(&mut drive.edges[..first].iter().rev());
    let after = near(&mut drive.edges[last + 1..].iter());
    let mut edges = drive.edges[first - before..last + 1 + after].to_vec();
    edges.sort_unstable();
    edges.dedup();
    edges
}
