//! Passages of junction complexes: one movement over several nodes with short edges between them.
//!
//! The path leads from the road before to the road after, as a turn's does; it need not follow the edges between. The area is
//! that of the turn at every node where the way turns, and the whole carriageway of the edges between: inside a crossing no lane
//! is reserved for one direction.

use geo::{MultiPolygon, Polygon, unary_union};

use super::arm::StrokeLine;
use super::arms::Arms;
use super::crossing;
use super::junction::Junction;
use super::{LengthClass, TurnEdges, TurnParams};
use crate::network::{EdgeNo, Movement, MovementKind, Network};
use crate::osm::facts::Policy;
use crate::verdict::UnknownReason;

/// A passage, prepared.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Complex {
    pub(super) arms: Arms,
    /// The turns of the way, in driving order.
    turns: Vec<Junction>,
    inside: Vec<Polygon>,
}

impl Complex {
    /// Prepares the passage. `line` gives the line of an edge's stroke.
    pub(super) fn new<'l>(
        network: &Network,
        TurnEdges { movement, through }: TurnEdges<'_>,
        line: &dyn Fn(EdgeNo) -> Result<&'l StrokeLine, UnknownReason>,
        policy: Policy,
        params: &TurnParams,
        length_class: LengthClass,
    ) -> Result<Self, UnknownReason> {
        let frame = line(movement.from)?.made.frame;
        let way: Vec<EdgeNo> = [&[movement.from], through, &[movement.to]].concat();
        let mut turns = Vec::new();
        for &[from, to] in way.array_windows() {
            let lines = [line(from)?, line(to)?];
            if !goes_on(lines[0], from, to) {
                let movement = Movement { from, to, kind: MovementKind::Turn, forbidden: None };
                turns.push(Junction::new(network, movement, lines, frame, policy, params, length_class)?);
            }
        }
        let (Some(first), Some(last)) = (turns.first(), turns.last()) else { return Err(UnknownReason::Geometry) };
        let strokes = [first.arms.strokes[0], last.arms.strokes[1]];
        let arms = Arms::new(first.arms.from.clone(), last.arms.to.clone(), strokes, length_class);
        let inside = crossing::carriageways(network, through, frame, params);
        Ok(Self { arms, turns, inside })
    }

    /// The drivable area, and the least assumed radius of its kerb returns, if there is one.
    pub(super) fn area(&self) -> (MultiPolygon, Option<f64>) {
        let (areas, kerbs): (Vec<_>, Vec<_>) = self.turns.iter().map(Junction::area).unzip();
        let parts: Vec<Polygon> = areas.into_iter().flatten().chain(self.inside.iter().cloned()).collect();
        (unary_union(&parts), kerbs.into_iter().flatten().reduce(f64::min))
    }
}

/// Whether an edge's stroke goes on into another edge.
fn goes_on(line: &StrokeLine, from: EdgeNo, to: EdgeNo) -> bool {
    line.made.spans.array_windows().any(|[a, b]| a.edge == from && b.edge == to)
}
