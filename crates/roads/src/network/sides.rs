//! Which movement a turn restriction means where a member runs on over the node, so that two movements fit the members.
//!
//! The value names a side (`no_left_turn`), and the roads have angles at the node. Where these do not decide, every reading applies.

use super::geometry::chord_deg;
use super::{EdgeNo, Network, reverse};
use crate::osm::facts::{RestrictedTurn, RestrictionKind};

/// The length of road that gives a direction at a node, metres.
const REACH_M: f64 = 15.0;
/// The greatest angle, degrees, of a way on that is neither to the left nor to the right.
const AHEAD_DEG: f64 = 15.0;
/// The least angle, degrees, of a way back that is neither to the left nor to the right.
const BACK_DEG: f64 = 165.0;
/// The greatest angle, degrees, of a way straight on, and the least one of a U-turn over another way.
const STRAIGHT_DEG: f64 = 45.0;
const U_TURN_DEG: f64 = 135.0;

/// A movement over a node: the edge before it and the edge after it.
pub(super) type EdgePair = (EdgeNo, EdgeNo);

/// The movements that a value means among those that its members allow.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Meant {
    /// The members allow no choice.
    Named(Vec<EdgePair>),
    /// The side decides.
    BySide(Vec<EdgePair>),
    /// The side does not decide, so each of them may be meant.
    Any(Vec<EdgePair>),
}

impl Meant {
    /// The movements.
    pub(super) fn pairs(&self) -> &[EdgePair] {
        let (Self::Named(pairs) | Self::BySide(pairs) | Self::Any(pairs)) = self;
        pairs
    }
}

/// What a value means among the movements from the edges of one way into those of another one.
pub(super) fn meant(network: &Network, kind: RestrictionKind, from: &[EdgeNo], to: &[EdgeNo]) -> Meant {
    let all = || from.iter().flat_map(|&f| to.iter().map(move |&t| (f, t)));
    let back = |pair: &EdgePair| reverse(network, pair.0, pair.1);
    let mut pairs: Vec<EdgePair> = match kind.turn {
        // A U-turn on one way means its reversal, not the continuation past the node.
        RestrictedTurn::UTurn => all().filter(|pair| !same_way(network, *pair) || back(pair)).collect(),
        _ => all().filter(|pair| !back(pair)).collect(),
    };
    if pairs.is_empty() && kind.turn != RestrictedTurn::UTurn {
        pairs = all().collect();
    }
    if pairs.len() < 2 {
        return Meant::Named(pairs);
    }
    let (fits, others): (Vec<EdgePair>, Vec<EdgePair>) =
        pairs.iter().copied().partition(|&pair| fits(kind.turn, angle_deg(network, pair)));
    match (fits.is_empty(), others.is_empty()) {
        (false, false) => Meant::BySide(fits),
        _ => Meant::Any(pairs),
    }
}

fn same_way(network: &Network, (from, to): EdgePair) -> bool {
    network.edges[from.index()].road == network.edges[to.index()].road
}

/// Whether a movement of this angle is one that the value names.
fn fits(turn: RestrictedTurn, angle_deg: f64) -> bool {
    let aside = |side_deg: f64| (AHEAD_DEG..=BACK_DEG).contains(&side_deg);
    match turn {
        RestrictedTurn::LeftTurn => aside(angle_deg),
        RestrictedTurn::RightTurn => aside(-angle_deg),
        RestrictedTurn::StraightOn => angle_deg.abs() <= STRAIGHT_DEG,
        RestrictedTurn::UTurn => angle_deg.abs() >= U_TURN_DEG,
        RestrictedTurn::Entry | RestrictedTurn::Exit | RestrictedTurn::Other => false,
    }
}

/// The angle of a movement, degrees in −180..=180, positive to the left. Turning back on the road is 180.
fn angle_deg(network: &Network, (from, to): EdgePair) -> f64 {
    if reverse(network, from, to) {
        return 180.0;
    }
    let [from, to] = [from, to].map(|edge| &network.edges[edge.index()]);
    // A loop's chord must not span the whole loop.
    let reach_m = |edge: &super::Edge| REACH_M.min(network.length_m(edge) / 2.0);
    let back_deg = chord_deg(network.positions(from).rev(), reach_m(from));
    let ahead_deg = chord_deg(network.positions(to), reach_m(to));
    let turned = (ahead_deg - back_deg - 180.0).rem_euclid(360.0);
    if turned > 180.0 { turned - 360.0 } else { turned }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_fits_angles_on_its_side() {
        use RestrictedTurn::{Entry, Exit, LeftTurn, Other, RightTurn, StraightOn, UTurn};
        let table = [
            (LeftTurn, [false, true, true, false, false, false]),
            (RightTurn, [false, false, false, false, true, true]),
            (StraightOn, [true, true, false, false, false, false]),
            (UTurn, [false, false, false, true, false, true]),
            (Entry, [false; 6]),
            (Exit, [false; 6]),
            (Other, [false; 6]),
        ];
        for (turn, expected) in table {
            assert_eq!([0.0, 20.0, 90.0, 180.0, -90.0, -150.0].map(|deg| fits(turn, deg)), expected, "{turn:?}");
        }
    }
}
