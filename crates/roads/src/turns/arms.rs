//! The two roads of a movement, and the line of every path from the one to the other.
//!
//! The roads meet at one node, or at two nodes of a complex. Paths need only the two centrelines, so both are alike.

use super::LengthClass;
use super::area::segments_cross;
use super::arm::Arm;
use super::code::PathShape;
use super::path::{self, wrapped};
use super::vector::along;

/// Distance from the nodes within which the meeting place is searched along each centreline, metres.
pub(super) const MEET_M: f64 = 90.0;
/// Straight extension of a centreline that ends, metres.
const PROLONGED_M: f64 = 30.0;
/// Smaller lateral moves and angles are none, metres and radians.
const LEAST_SWING: f64 = 0.01;

/// The roads before and after a movement.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Arms {
    pub(super) from: Arm,
    pub(super) to: Arm,
    pub(super) strokes: [u32; 2],
    pub(super) length_class: LengthClass,
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

impl Arms {
    pub(super) fn new(from: Arm, to: Arm, strokes: [u32; 2], length_class: LengthClass) -> Self {
        let mut arms = Self { from, to, strokes, length_class, meeting: None };
        arms.meeting = arms.meeting();
        arms
    }

    /// Angle from the one road's direction to the other's at their nodes, radians, positive left.
    pub(super) fn turn_rad(&self) -> f64 {
        let (from, to) = (&self.from, &self.to);
        wrapped(to.line.heading[to.node] - from.line.heading[from.node])
    }

    /// Stations at which a path's corner begins and ends. A lane shift is measured from the node.
    pub(super) fn corner(&self, shape: &PathShape) -> [f64; 2] {
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
    pub(super) fn line(&self, shape: &PathShape, step_m: f64) -> Option<PathLine> {
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
