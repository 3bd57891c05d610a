//! A turn at a junction, prepared: its two arms, its area, and the path of each code.

use geo::{MultiPolygon, Polygon};

use super::Reach;
use super::TurnParams;
use super::area::{Ground, along, segments_cross};
use super::arm::{Arm, StrokeLine};
use super::code::Shape;
use super::crossing::{parts, passed};
use super::path::{self, wrapped};
use super::surface::surface;
use crate::corridor::Frame;
use crate::network::{Movement, Network};
use crate::osm::facts::Policy;
use crate::verdict::UnknownReason;

/// Distance before the meeting place in which paths leave the approach, metres.
const LEAVE_M: f64 = 86.0;
/// Distance from the node within which the meeting place is searched along each centreline, metres.
const MEET_M: f64 = 90.0;
/// Distance after it in which paths have joined the departure, metres.
const JOIN_M: f64 = 23.0;
/// Straight extension of a centreline that ends, metres.
const PROLONGED_M: f64 = 30.0;
/// Nodes along the two roads within this distance of the turn's node belong to the same junction, metres.
const COMPLEX_M: f64 = 30.0;
/// Smaller lateral moves and angles are none, metres and radians.
const LEAST_SWING: f64 = 0.01;

/// A turn at a junction.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Junction {
    pub(super) from: Arm,
    pub(super) to: Arm,
    pub(super) strokes: [u32; 2],
    policy: Policy,
    left_hand_traffic: bool,
    kerb_radius_m: f64,
    /// The junction's surface, if mapped.
    surface: Option<MultiPolygon>,
    /// What the crossing has beside the two roads.
    crossing: Vec<Polygon>,
    pub(super) reach: Reach,
    /// The stations at which the centrelines cross, if they do.
    meeting: Option<[f64; 2]>,
}

/// The line of a path between its joints.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PathLine {
    pub(super) points: Vec<[f64; 2]>,
    /// The stations of the two arms at which the path leaves and joins.
    pub(super) joints: [usize; 2],
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
        reach: Reach,
    ) -> Result<Self, UnknownReason> {
        let edge = |index: u32| network.edges.get(index as usize).ok_or(UnknownReason::Geometry);
        let (from, to) = (network.road(edge(movement.from)?), network.road(edge(movement.to)?));
        let node = edge(movement.from)?.to_node;
        let before_m = reach.run_in_m() + reach.counted_before_m() + LEAVE_M;
        let after_m = reach.counted_after_m() + MEET_M + JOIN_M;
        let strip = params.strip.max(policy);
        let surface = surface(network, node, [from, to], frame);
        let mut junction = Self {
            from: Arm::arriving(lines[0], movement.from, frame, strip, [before_m, MEET_M])?,
            to: Arm::leaving(lines[1], movement.to, frame, strip, [MEET_M, after_m])?,
            strokes: lines.map(|line| line.stroke),
            policy,
            left_hand_traffic: from.left_hand_traffic,
            kerb_radius_m: params.kerbs.radius_m(from, to),
            crossing: crossing(network, movement, lines, frame, params, surface.as_ref()),
            surface,
            reach,
            meeting: None,
        };
        junction.meeting = junction.meeting();
        Ok(junction)
    }

    /// Angle between the strokes' directions at the node, radians, positive left.
    pub(super) fn turn_rad(&self) -> f64 {
        let (from, to) = (&self.from, &self.to);
        wrapped(to.line.heading[to.node] - from.line.heading[from.node])
    }

    /// The drivable area, and the assumed radius of its kerb return, if there is one.
    pub(super) fn area(&self) -> (MultiPolygon, Option<f64>) {
        let ground = Ground {
            from: &self.from,
            to: &self.to,
            policy: self.policy,
            left_hand_traffic: self.left_hand_traffic,
            turn_rad: self.turn_rad(),
            kerb_radius_m: self.kerb_radius_m,
            surface: self.surface.as_ref(),
            crossing: &self.crossing,
            reach: self.reach,
        };
        let (area, rounded) = ground.area();
        (area, rounded.then_some(self.kerb_radius_m))
    }

    /// Stations at which a path's corner begins and ends. A lane shift is measured from the node.
    pub(super) fn corner(&self, shape: &Shape) -> [f64; 2] {
        let (from, to) = (&self.from, &self.to);
        let nodes = [from.node as f64, to.node as f64];
        let [a, b] = if shape.shares.is_some() { self.meeting.unwrap_or(nodes) } else { nodes };
        let [before, after] =
            [shape.from_corner_m[0] / from.line.spacing_m, shape.from_corner_m[1] / to.line.spacing_m];
        [
            (a - before).clamp(0.0, (from.own.end - 1) as f64),
            (b + after).clamp(to.own.start as f64, (to.len() - 1) as f64),
        ]
    }

    /// The line of a path: out to the side, round the corner, back to the middle. Its points are about `step_m` apart.
    /// `None` if the roads leave no room for it.
    pub(super) fn line(&self, shape: &Shape, step_m: f64) -> Option<PathLine> {
        let (from, to) = (&self.from, &self.to);
        let corner = self.corner(shape);
        let Some(shares) = shape.shares else {
            let joints = [corner[0].floor() as usize, corner[1].ceil() as usize];
            let points = path::shift(from.pose(joints[0] as f64, 0.0), to.pose(joints[1] as f64, 0.0), step_m)?;
            return Some(PathLine { points, joints });
        };
        let mut poses = [from.pose(corner[0], shape.aside_m[0]), to.pose(corner[1], shape.aside_m[1])];
        for (pose, splay) in poses.iter_mut().zip(shape.splay_rad) {
            pose.heading += splay;
        }
        let beside = |i: usize| shape.aside_m[i].abs() > LEAST_SWING || shape.splay_rad[i].abs() > LEAST_SWING;
        let over = |i: usize, arm: &Arm| if beside(i) { shape.swing_m[i] / arm.line.spacing_m } else { 0.0 };
        let (leave, join) = (corner[0] - over(0, from), corner[1] + over(1, to));
        if leave < 0.0 || join > (to.len() - 1) as f64 {
            return None;
        }
        let joints = [leave.floor() as usize, join.ceil() as usize];
        let ends = [from.pose(joints[0] as f64, 0.0), to.pose(joints[1] as f64, 0.0)];
        let round = path::corner(poses[0], poses[1], shares, step_m)?;
        let mut points = if beside(0) { path::shift(ends[0], poses[0], step_m)? } else { vec![ends[0].at] };
        points.extend(round.into_iter().skip(usize::from(beside(0) || joints[0] as f64 == corner[0])));
        if beside(1) {
            points.extend(path::shift(poses[1], ends[1], step_m)?.into_iter().skip(1));
        } else if (joints[1] as f64) > corner[1] {
            points.push(ends[1].at);
        }
        Some(PathLine { points, joints })
    }

    /// The stations at which the centrelines cross, nearest to the node. There is one per arm, with fractions, possibly
    /// beyond the arm's end.
    fn meeting(&self) -> Option<[f64; 2]> {
        let (from, to) = (&self.from, &self.to);
        let near = |arm: &Arm| {
            let reach = (MEET_M / arm.line.spacing_m) as usize;
            let end = (arm.node + reach + 1).min(arm.own.end);
            let mut line: Vec<(f64, [f64; 2])> =
                (arm.node.saturating_sub(reach).max(arm.own.start)..end).map(|k| (k as f64, arm.point(k))).collect();
            let stations = PROLONGED_M / arm.line.spacing_m;
            if let (Some(&first), Some(&last)) = (line.first(), line.last()) {
                line.insert(0, (first.0 - stations, along(first.1, arm.forward(first.0 as usize), -PROLONGED_M)));
                line.push((last.0 + stations, along(last.1, arm.forward(last.0 as usize), PROLONGED_M)));
            }
            line
        };
        let mut best: Option<(f64, [f64; 2])> = None;
        for a in near(from).windows(2) {
            for b in near(to).windows(2) {
                let Some((_, t, u)) = segments_cross(a[0].1, a[1].1, b[0].1, b[1].1) else { continue };
                let at = [a[0].0 + t * (a[1].0 - a[0].0), b[0].0 + u * (b[1].0 - b[0].0)];
                let far = (at[0] - from.node as f64).abs() + (at[1] - to.node as f64).abs();
                if best.is_none_or(|(known, _)| far < known) {
                    best = Some((far, at));
                }
            }
        }
        best.map(|(_, at)| at)
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
            if other && at.abs_diff(node) <= near {
                all.extend(passed(network, [before.edge, after.edge], frame, params));
            }
        }
    }
    all
}
