//! Which paths a turn has: every pair of a place to leave one centreline and a place to join the other, early and late, each as
//! far from where the two would meet as one of a few distances.
//!
//! The family is the same for the same turn, whatever else is computed; paths that leave the drivable area drop out, the others
//! keep their numbers.

use super::area::{Ground, along, segments_cross};
use super::arm::{Arm, StrokeLine};
use super::path::{self, Pose, STEP_M, wrapped};
use super::rays::{Boundary, Widths};
use super::{Joint, Reach, TurnCorridors, TurnParams, TurnPath};
use crate::corridor::{Corridor, Frame};
use crate::network::{Movement, Network};
use crate::osm::facts::Policy;
use crate::verdict::UnknownReason;

/// Distances from where the centrelines meet, metres. A turn of 90° that takes 12 m of each centreline has a radius of about 10 m.
const FROM_CORNER_M: [f64; 9] = [4.0, 6.0, 8.5, 11.5, 15.0, 19.0, 24.0, 31.0, 40.0];
/// Approach and departure differ by so many places in that list at most.
const MOST_UNLIKE: usize = 2;
/// Distances before and after the node over which lanes shift, metres.
const SHIFTS_M: [f64; 4] = [10.0, 20.0, 35.0, 55.0];
/// Share of the angle that each transition takes.
const SHARES: [f64; 2] = [0.2, 0.42];
/// Where centrelines meet is looked for so far from the node along each, metres.
const MEET_M: f64 = 90.0;
/// A centreline that ends is prolonged straight by so much, metres.
const PROLONGED_M: f64 = 30.0;
/// Stations of tight turns lie this close, metres.
const TIGHT_SPACING_M: f64 = 0.5;
/// Tighter than this is tight, metres.
const TIGHT_M: f64 = 25.0;

/// A junction's turn, ready for its family.
pub(super) struct Junction<'a> {
    from: Arm,
    to: Arm,
    lines: [&'a StrokeLine; 2],
    frame: Frame,
    policy: Policy,
    left_hand_traffic: bool,
    kerb_radius_m: f64,
    reach: Reach,
}

impl<'a> Junction<'a> {
    pub(super) fn new(
        network: &Network,
        movement: Movement,
        lines: [&'a StrokeLine; 2],
        policy: Policy,
        params: &TurnParams,
        reach: Reach,
    ) -> Result<Self, UnknownReason> {
        let edge = |index: u32| network.edges.get(index as usize).ok_or(UnknownReason::Geometry);
        let (from, to) = (network.road(edge(movement.from)?), network.road(edge(movement.to)?));
        let frame = lines[0].frame;
        let before_m =
            reach.run_in_m() + reach.counted_before_m() + FROM_CORNER_M[FROM_CORNER_M.len() - 1] + PROLONGED_M;
        let after_m = reach.counted_after_m() + MEET_M + 1.0;
        Ok(Self {
            from: Arm::arriving(lines[0], movement.from, frame, [before_m, MEET_M])?,
            to: Arm::leaving(lines[1], movement.to, frame, [MEET_M, after_m])?,
            lines,
            frame,
            policy,
            left_hand_traffic: from.left_hand_traffic,
            kerb_radius_m: params.kerbs.radius_m(from, to),
            reach,
        })
    }

    pub(super) fn corridors(&self) -> Result<TurnCorridors, UnknownReason> {
        let (from, to) = (&self.from, &self.to);
        let turn_rad = wrapped(to.line.heading[to.node] - from.line.heading[from.node]);
        let ground = Ground {
            from,
            to,
            policy: self.policy,
            left_hand_traffic: self.left_hand_traffic,
            turn_rad,
            kerb_radius_m: self.kerb_radius_m,
        };
        let (area, rounded) = ground.area();
        let boundary = Boundary::new(&area);
        let mut paths = Vec::new();
        for (number, [leave, join], share) in self.pairs() {
            let pose = |arm: &Arm, k: usize| Pose { at: arm.point(k), heading: arm.line.heading[k] };
            let (a, b) = (pose(from, leave), pose(to, join));
            let points = match share {
                Some(share) => path::corner(a, b, share),
                None => path::shift(a, b),
            };
            let made = points.and_then(|points| self.path(number, [leave, join], &points, &boundary.widths(&points)?));
            paths.extend(made);
        }
        let kerb_radius_m = rounded.then_some(self.kerb_radius_m);
        Ok(TurnCorridors { frame: self.frame, turn_rad, area, kerb_radius_m, paths })
    }

    /// Number, stations of both arms, and the share of the transitions (`None`: a lane shift). No pair comes twice.
    fn pairs(&self) -> Vec<(u8, [usize; 2], Option<f64>)> {
        let (from, to) = (&self.from, &self.to);
        let spacing = [from.line.spacing_m, to.line.spacing_m];
        let [meet_a, meet_b] = self.meeting().unwrap_or([from.node as f64, to.node as f64]);
        let leave = |m: f64| ((meet_a - m / spacing[0]).round().min((from.own.end - 1) as f64)).max(0.0) as usize;
        let join =
            |m: f64| ((meet_b + m / spacing[1]).round().max(to.own.start as f64)).min((to.len() - 1) as f64) as usize;
        let mut pairs: Vec<(u8, [usize; 2], Option<f64>)> = Vec::new();
        let mut number = 0;
        let mut add = |pair: [usize; 2], share: Option<f64>| {
            if !pairs.iter().any(|(_, known, with)| *known == pair && *with == share) {
                pairs.push((number, pair, share));
            }
            number += 1;
        };
        for (i, before_m) in FROM_CORNER_M.into_iter().enumerate() {
            for (j, after_m) in FROM_CORNER_M.into_iter().enumerate() {
                if i.abs_diff(j) <= MOST_UNLIKE {
                    let share = SHARES[usize::from(i == j)];
                    add([leave(before_m), join(after_m)], Some(SHARES[0]));
                    if i == j {
                        add([leave(before_m), join(after_m)], Some(share));
                    }
                }
            }
        }
        let back = |m: f64| (from.node as f64 - m / spacing[0]).round().max(0.0) as usize;
        let on = |m: f64| ((to.node as f64 + m / spacing[1]).round() as usize).min(to.len() - 1);
        for before_m in SHIFTS_M {
            for after_m in SHIFTS_M {
                add([back(before_m), on(after_m)], None);
            }
        }
        pairs
    }

    /// Stations (of each arm, with fractions, possibly beyond its end) at which the centrelines cross, nearest to the node.
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

    /// The corridor along one path, with what is driven before and after it.
    fn path(&self, number: u8, [leave, join]: [usize; 2], points: &[[f64; 2]], widths: &Widths) -> Option<TurnPath> {
        let (from, to) = (&self.from, &self.to);
        let before = ((self.reach.run_in_m() + self.reach.counted_before_m()) / from.line.spacing_m) as usize;
        let after = (self.reach.counted_after_m() / to.line.spacing_m) as usize;
        let lead = leave.saturating_sub(before)..leave;
        let tail = join + 1..(join + 1 + after).min(to.len());
        let mut line = Line::default();
        for k in lead {
            line.push(from.point(k), from.line.left_m[k], from.line.right_m[k]);
        }
        let begins = line.at_m();
        for (k, &p) in points.iter().enumerate() {
            line.push(p, widths.left_m[k], widths.right_m[k]);
        }
        // At the joints the corridor is the stroke's.
        line.narrow(begins.1, from.line.left_m[leave], from.line.right_m[leave]);
        let ends = line.at_m();
        line.narrow(ends.1 - 1, to.line.left_m[join], to.line.right_m[join]);
        for k in tail {
            line.push(to.point(k), to.line.left_m[k], to.line.right_m[k]);
        }
        let min_radius_m = 1.0 / path::sharpest(points).max(1e-9);
        let spacing_m = if min_radius_m < TIGHT_M { TIGHT_SPACING_M } else { self.from.line.spacing_m };
        let corridor = Corridor::from_centreline(&line.points, &line.left_m, &line.right_m, 0.0, spacing_m).ok()?;
        let last = corridor.len() - 1;
        let station = |m: f64| (m / corridor.spacing_m).round().clamp(0.0, last as f64) as usize;
        let turn = station(begins.0)..station(ends.0) + 1;
        let counted = station(begins.0 - self.reach.counted_before_m())..last + 1;
        Some(TurnPath {
            number,
            turn,
            counted,
            approach: Joint { stroke: self.lines[0].stroke, station: from.first + leave },
            departure: Joint { stroke: self.lines[1].stroke, station: to.first + join },
            min_radius_m,
            corridor,
        })
    }
}

/// A centreline's points with half-widths, each point once.
#[derive(Default)]
struct Line {
    points: Vec<[f64; 2]>,
    left_m: Vec<f64>,
    right_m: Vec<f64>,
    length_m: f64,
}

impl Line {
    fn push(&mut self, p: [f64; 2], left_m: f64, right_m: f64) {
        if let Some(last) = self.points.last() {
            let step = (p[0] - last[0]).hypot(p[1] - last[1]);
            if step < 0.2 * STEP_M {
                let k = self.points.len() - 1;
                self.narrow(k, left_m, right_m);
                return;
            }
            self.length_m += step;
        }
        self.points.push(p);
        self.left_m.push(left_m);
        self.right_m.push(right_m);
    }

    fn narrow(&mut self, k: usize, left_m: f64, right_m: f64) {
        if let (Some(left), Some(right)) = (self.left_m.get_mut(k), self.right_m.get_mut(k)) {
            (*left, *right) = (left.min(left_m), right.min(right_m));
        }
    }

    /// Length so far, and how many points.
    fn at_m(&self) -> (f64, usize) {
        (self.length_m, self.points.len())
    }
}
