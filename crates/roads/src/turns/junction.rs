//! A turn at a junction, prepared: its two roads and its area.

use geo::{MultiPolygon, Polygon};

use super::LengthClass;
use super::TurnParams;
use super::area::TurnGround;
use super::arm::{Arm, StrokeLine};
use super::arms::{Arms, MEET_M};
use super::crossing::{MOST_NODES, parts, passed};
use super::surface::{beside_the_map, surface};
use crate::corridor::Frame;
use crate::network::{EdgeNo, Movement, Network};
use crate::osm::facts::Policy;
use crate::verdict::UnknownReason;

/// Distance before the meeting place in which paths leave the approach, metres.
pub(super) const LEAVE_M: f64 = 86.0;
/// Distance after it in which paths have joined the departure, metres.
pub(super) const JOIN_M: f64 = 23.0;
/// Nodes along the two roads within this distance of the turn's node belong to the same junction, metres.
const COMPLEX_M: f64 = 30.0;

/// A turn at a junction.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Junction {
    pub(super) arms: Arms,
    policy: Policy,
    left_hand_traffic: bool,
    kerb_radius_m: f64,
    /// The junction's surface, if mapped.
    surface: Option<MultiPolygon>,
    /// What the crossing has beside the two roads.
    crossing: Vec<Polygon>,
}

impl Junction {
    /// Prepares the turn in the metric frame `frame`.
    pub(super) fn new(
        network: &Network,
        movement: Movement,
        lines: [&StrokeLine; 2],
        frame: Frame,
        policy: Policy,
        params: &TurnParams,
        length_class: LengthClass,
    ) -> Result<Self, UnknownReason> {
        let edge = |index: EdgeNo| network.edges.get(index.index()).ok_or(UnknownReason::Geometry);
        let own = [edge(movement.from)?, edge(movement.to)?];
        let [from, to] = own.map(|edge| network.road(edge));
        let node = own[0].to_node;
        let before_m = length_class.run_in_m() + length_class.counted_before_m() + LEAVE_M;
        let after_m = length_class.counted_after_m() + MEET_M + JOIN_M;
        let strip = params.strip.max(policy);
        let surface = surface(network, node, &[from, to], frame);
        let arriving = Arm::arriving(lines[0], movement.from, frame, strip, [before_m, MEET_M])?;
        let leaving = Arm::leaving(lines[1], movement.to, frame, strip, [MEET_M, after_m])?;
        Ok(Self {
            arms: Arms::new(arriving, leaving, lines.map(|line| line.stroke), length_class),
            policy,
            left_hand_traffic: from.left_hand_traffic,
            kerb_radius_m: params.own_kerb_m.unwrap_or_else(|| params.kerbs.at(network, node, own)),
            crossing: crossing(network, movement, lines, frame, params, surface.as_ref())
                .into_iter()
                .chain(beside_the_map(network, node, frame))
                .collect(),
            surface,
        })
    }

    /// A drawn junction of two roads, with right-hand traffic.
    pub(super) fn drawn(arms: Arms, kerb_radius_m: f64) -> Self {
        Self {
            arms,
            policy: Policy::Lane,
            left_hand_traffic: false,
            kerb_radius_m,
            surface: None,
            crossing: Vec::new(),
        }
    }

    /// The drivable area, and the assumed radius of its kerb return, if there is one.
    pub(super) fn area(&self) -> (MultiPolygon, Option<f64>) {
        let ground = TurnGround {
            from: &self.arms.from,
            to: &self.arms.to,
            policy: self.policy,
            left_hand_traffic: self.left_hand_traffic,
            turn_rad: self.arms.turn_rad(),
            kerb_radius_m: self.kerb_radius_m,
            surface: self.surface.as_ref(),
            crossing: &self.crossing,
            length_class: self.arms.length_class,
        };
        let (area, rounded) = ground.area();
        (area, rounded.then_some(self.kerb_radius_m))
    }
}

/// What the junction has beside the two roads: at the turn's node, and at the nodes close to it along both roads. Where a road
/// meets two carriageways, a ramp with two mouths or two staggered roads, all of that is one junction.
fn crossing(
    network: &Network,
    movement: Movement,
    lines: [&StrokeLine; 2],
    frame: Frame,
    params: &TurnParams,
    surface: Option<&MultiPolygon>,
) -> Vec<Polygon> {
    let mut nodes = 1;
    let mut all = parts(network, [movement.from, movement.to], frame, params, surface);
    for (line, edge, arrives) in [(lines[0], movement.from, true), (lines[1], movement.to, false)] {
        let spans = &line.made.spans;
        let Some(own) = spans.iter().find(|span| span.edge == edge) else { continue };
        let node = if arrives { own.stations.end - 1 } else { own.stations.start };
        let near = (COMPLEX_M / line.made.corridor.spacing_m) as usize;
        for [before, after] in spans.array_windows() {
            let at = after.stations.start;
            // The turn's own node is at the end or at the beginning of its edge.
            let other = if arrives { before.edge != edge } else { after.edge != edge };
            if other && at.abs_diff(node) <= near && nodes < MOST_NODES {
                nodes += 1;
                all.extend(passed(network, [before.edge, after.edge], frame, params));
            }
        }
    }
    all
}
