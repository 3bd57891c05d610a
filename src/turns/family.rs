//! The family of paths of a turn. A path leaves one centreline at some distance before the place where the two would
//! meet, and joins the other at some distance after it; both distances vary. A path follows the centrelines, or swings
//! out to the far side before and after the turn, as drivers of long vehicles do.
//!
//! The same turn always has the same family. Paths that leave the drivable area drop out, and the others keep their
//! numbers.

use geo::MultiPolygon;

use super::area::{Ground, along, segments_cross};
use super::arm::{Arm, StrokeLine};
use super::path::{self, Pose, STEP_M, wrapped};
use super::rays::{Boundary, Widths};
use super::{Joint, Reach, TurnCorridors, TurnParams, TurnPath, surface::surface};
use crate::corridor::{Corridor, Frame};
use crate::network::{Movement, Network};
use crate::osm::facts::Policy;
use crate::verdict::UnknownReason;

/// Distances from the place where the two lines meet, metres. A turn of 90° that takes 12 m of each line has a radius
/// of about 10 m.
const FROM_CORNER_M: [f64; 9] = [4.0, 6.0, 8.5, 11.5, 15.0, 19.0, 24.0, 31.0, 40.0];
/// Swings to the outside before and after the turn, as shares of the room there. Each comes with the largest difference
/// between approach and departure (in entries of the list above).
const SWINGS: [([f64; 2], usize); 5] =
    [([0.0, 0.0], 1), ([1.0, 1.0], 1), ([0.5, 0.5], 0), ([1.0, 0.0], 0), ([0.0, 1.0], 0)];
/// Candidates for entering and leaving a roundabout: share of the room on the road's side, and the range of distances.
const FEW: [(f64, std::ops::Range<usize>); 2] = [(0.0, 1..8), (1.0, 2..6)];
/// Upper bound of the number of candidates in `FEW`.
pub(super) const FEW_NUMBERS: u8 = 15;
/// Room kept beside the path on the outside of a swing, metres: half a vehicle's width and the swing of its front.
const OUTSIDE_M: f64 = 1.9;
/// Smallest swing, metres.
const LEAST_SWING_M: f64 = 0.15;
/// Length over which a path swings out before the turn, and back after it, metres.
const SWING_M: [f64; 2] = [16.0, 22.0];
/// Distances before and after the node over which lanes shift, metres.
const SHIFTS_M: [f64; 4] = [10.0, 20.0, 35.0, 55.0];
/// Share of the angle that each transition takes.
const SHARES: [f64; 2] = [0.2, 0.42];
/// Distance from the node within which the meeting place is searched along each centreline, metres.
const MEET_M: f64 = 90.0;
/// Straight extension of a centreline that ends, metres.
const PROLONGED_M: f64 = 30.0;
/// Turns tighter than the first value (metres) have stations as close as the second (metres). Bounds are then as tight
/// as in wider turns.
const TIGHT_M: [(f64, f64); 2] = [(6.0, 0.25), (25.0, 0.5)];
/// How often station spacing may be halved where stations step over transitions and would not form a curve. A carter's
/// corner has transitions of half a metre.
const HALVINGS: usize = 2;

/// A turn at a junction, prepared for its family.
pub(super) struct Junction {
    pub(super) from: Arm,
    pub(super) to: Arm,
    strokes: [u32; 2],
    frame: Frame,
    policy: Policy,
    left_hand_traffic: bool,
    kerb_radius_m: f64,
    /// The junction's surface, if mapped.
    surface: Option<MultiPolygon>,
    reach: Reach,
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
        let before_m = reach.run_in_m()
            + reach.counted_before_m()
            + FROM_CORNER_M[FROM_CORNER_M.len() - 1]
            + SWING_M[0]
            + PROLONGED_M;
        let after_m = reach.counted_after_m() + MEET_M + SWING_M[1] + 1.0;
        let strip = params.strip.max(policy);
        Ok(Self {
            from: Arm::arriving(lines[0], movement.from, frame, strip, [before_m, MEET_M])?,
            to: Arm::leaving(lines[1], movement.to, frame, strip, [MEET_M, after_m])?,
            strokes: lines.map(|line| line.stroke),
            frame,
            policy,
            left_hand_traffic: from.left_hand_traffic,
            kerb_radius_m: params.kerbs.radius_m(from, to),
            surface: surface(network, node, [from, to], frame),
            reach,
        })
    }

    /// Angle between the strokes' directions at the node, radians, positive left.
    fn turn_rad(&self) -> f64 {
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
        };
        let (area, rounded) = ground.area();
        (area, rounded.then_some(self.kerb_radius_m))
    }

    pub(super) fn corridors(&self) -> Result<TurnCorridors, UnknownReason> {
        let turn_rad = self.turn_rad();
        let (area, kerb_radius_m) = self.area();
        let boundary = Boundary::new(&area);
        let mut paths = Vec::new();
        for candidate in self.candidates(turn_rad) {
            let Some(points) = self.points(&candidate) else { continue };
            let Candidate { number, leave, join, .. } = candidate;
            let ends = Ends {
                arms: [&self.from, &self.to],
                strokes: self.strokes,
                stations: [leave, join],
                reach: self.reach,
            };
            paths.extend(boundary.widths(&points).and_then(|widths| ends.path(number, &points, widths)));
        }
        Ok(TurnCorridors { frame: self.frame, turn_rad, area, kerb_radius_m, paths })
    }

    /// The whole family without repetitions.
    fn candidates(&self, turn_rad: f64) -> Vec<Candidate> {
        let meeting = self.meeting();
        let mut family = Family::default();
        for (swing, unlike) in SWINGS {
            for (i, before_m) in FROM_CORNER_M.into_iter().enumerate() {
                for (j, after_m) in FROM_CORNER_M.into_iter().enumerate().filter(|(j, _)| i.abs_diff(*j) <= unlike) {
                    let corner = self.corner(meeting, [before_m, after_m]);
                    let aside_m = self.aside_m(turn_rad, corner, swing);
                    family.add(corner, aside_m, Some(SHARES[0]));
                    if i == j && swing == [0.0, 0.0] {
                        family.add(corner, aside_m, Some(SHARES[1]));
                    }
                }
            }
        }
        for before_m in SHIFTS_M {
            for after_m in SHIFTS_M {
                family.add(self.around_node([before_m, after_m]), [0.0; 2], None);
            }
        }
        family.of(self.spacing(), self.to.len())
    }

    /// The few candidates at one end of a roundabout's passage: entering the ring, or leaving it. The ring bends away
    /// from the turn, so its tangent meets the road farther from the node than the path touches the ring. On the road's
    /// side the next larger distance is therefore used.
    pub(super) fn few(&self, onto: bool) -> Vec<Candidate> {
        let turn_rad = self.turn_rad();
        let meeting = self.meeting();
        let sides = |road_m: f64, ring_m: f64| if onto { [road_m, ring_m] } else { [ring_m, road_m] };
        let mut family = Family::default();
        for (swing, places) in FEW {
            for w in FROM_CORNER_M[places].windows(2) {
                let corner = self.corner(meeting, sides(w[1], w[0]));
                family.add(corner, self.aside_m(turn_rad, corner, sides(swing, 0.0)), Some(SHARES[0]));
            }
        }
        for m in &SHIFTS_M[..2] {
            family.add(self.around_node([*m; 2]), [0.0; 2], None);
        }
        family.of(self.spacing(), self.to.len())
    }

    fn spacing(&self) -> [f64; 2] {
        [self.from.line.spacing_m, self.to.line.spacing_m]
    }

    /// Stations at the given distances before and after the place where the lines meet.
    fn corner(&self, meeting: Option<[f64; 2]>, [before_m, after_m]: [f64; 2]) -> [usize; 2] {
        let (from, to) = (&self.from, &self.to);
        let [meet_a, meet_b] = meeting.unwrap_or([from.node as f64, to.node as f64]);
        let leave = (meet_a - before_m / from.line.spacing_m).round().clamp(0.0, (from.own.end - 1) as f64);
        let join = (meet_b + after_m / to.line.spacing_m).round().clamp(to.own.start as f64, (to.len() - 1) as f64);
        [leave as usize, join as usize]
    }

    /// Stations at the given distances before and after the node.
    fn around_node(&self, [before_m, after_m]: [f64; 2]) -> [usize; 2] {
        let (from, to) = (&self.from, &self.to);
        let back = (from.node as f64 - before_m / from.line.spacing_m).round().max(0.0) as usize;
        let on = (to.node as f64 + after_m / to.line.spacing_m).round() as usize;
        [back, on.min(to.len() - 1)]
    }

    /// Lateral move to the left, metres, of a path that takes the given shares of the room on the outside.
    fn aside_m(&self, turn_rad: f64, corner: [usize; 2], swing: [f64; 2]) -> [f64; 2] {
        let arms = [&self.from, &self.to];
        [0, 1].map(|i| {
            // In a right turn the outside is to the left of travel.
            let outside = arms[i].wide(corner[i])[usize::from(turn_rad >= 0.0)];
            -turn_rad.signum() * (outside - OUTSIDE_M).max(0.0) * swing[i]
        })
    }

    /// A candidate's points: out to the side, round the corner, back to the middle.
    pub(super) fn points(&self, candidate: &Candidate) -> Option<Vec<[f64; 2]>> {
        let pose = |arm: &Arm, k: usize, aside_m: f64| Pose { at: arm.aside(k, aside_m), heading: arm.line.heading[k] };
        let ends = [pose(&self.from, candidate.leave, 0.0), pose(&self.to, candidate.join, 0.0)];
        let corner = [0, 1].map(|i| pose([&self.from, &self.to][i], candidate.corner[i], candidate.aside_m[i]));
        let mut points = match candidate.share {
            None => return path::shift(ends[0], ends[1]),
            Some(share) => path::corner(corner[0], corner[1], share)?,
        };
        if candidate.leave != candidate.corner[0] {
            let mut out = path::shift(ends[0], corner[0])?;
            out.extend(points.into_iter().skip(1));
            points = out;
        }
        if candidate.join != candidate.corner[1] {
            points.extend(path::shift(corner[1], ends[1])?.into_iter().skip(1));
        }
        Some(points)
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

/// The places where a path leaves one road and joins the other.
pub(super) struct Ends<'a> {
    pub(super) arms: [&'a Arm; 2],
    pub(super) strokes: [u32; 2],
    /// One station per arm.
    pub(super) stations: [usize; 2],
    pub(super) reach: Reach,
}

impl Ends<'_> {
    /// The corridor along one path, with the road driven before and after it.
    pub(super) fn path(&self, number: u8, points: &[[f64; 2]], mut widths: Widths) -> Option<TurnPath> {
        let [from, to] = self.arms;
        let [leave, join] = self.stations;
        // At the joints the corridor has the half-widths of the turn's strip.
        widths.gentle(points, [from.wide(leave), to.wide(join)]);
        let before = ((self.reach.run_in_m() + self.reach.counted_before_m()) / from.line.spacing_m) as usize;
        let after = (self.reach.counted_after_m() / to.line.spacing_m) as usize;
        let lead = leave.saturating_sub(before)..leave;
        let tail = join + 1..(join + 1 + after).min(to.len());
        let mut line = Line::default();
        for k in lead {
            let [left_m, right_m] = from.near_joint(k, leave, self.reach);
            line.push(from.point(k), left_m, right_m);
        }
        let begins = line.length_m;
        for (k, &p) in points.iter().enumerate() {
            line.push(p, widths.left_m[k], widths.right_m[k]);
        }
        let ends = line.length_m;
        for k in tail {
            let [left_m, right_m] = to.near_joint(k, join, self.reach);
            line.push(to.point(k), left_m, right_m);
        }
        let min_radius_m = 1.0 / path::sharpest(points).max(1e-9);
        let tight = TIGHT_M.into_iter().find(|(radius_m, _)| min_radius_m < *radius_m);
        let spacing_m = tight.map_or(from.line.spacing_m, |(_, spacing_m)| spacing_m);
        let sampled = |halvings: usize| {
            let spacing_m = spacing_m / (1 << halvings) as f64;
            let corridor =
                crate::corridor::from_centreline(&line.points, &line.left_m, &line.right_m, 0.0, spacing_m).ok()?;
            let last = corridor.len() - 1;
            let station = |m: f64| (m / corridor.spacing_m).round().clamp(0.0, last as f64) as usize;
            let turn = nearest(&corridor, from.point(leave), station(begins))
                ..nearest(&corridor, to.point(join), station(ends)) + 1;
            let counted = station(begins - self.reach.counted_before_m())..last + 1;
            let whole = !corridor.torn().iter().any(|k| turn.contains(k));
            whole.then_some((corridor, turn, counted))
        };
        let (corridor, turn, counted) = (0..=HALVINGS).find_map(sampled)?;
        Some(TurnPath {
            number,
            turn,
            counted,
            approach: Joint { stroke: self.strokes[0], station: from.first + leave },
            departure: Joint { stroke: self.strokes[1], station: to.first + join },
            min_radius_m,
            corridor,
        })
    }
}

/// The station nearest to a point, searched from a close guess. (Chords are shorter than the corridor.)
fn nearest(corridor: &Corridor, p: [f64; 2], guess: usize) -> usize {
    let far = |k: usize| (corridor.x[k] - p[0]).hypot(corridor.y[k] - p[1]);
    let around = guess.saturating_sub(8)..(guess + 9).min(corridor.len());
    around.min_by(|&a, &b| far(a).total_cmp(&far(b))).unwrap_or(guess)
}

/// A candidate path: the stations of both arms at which it leaves and joins, and the place of its corner.
pub(super) struct Candidate {
    pub(super) number: u8,
    pub(super) leave: usize,
    pub(super) join: usize,
    /// Stations of both arms at which the corner begins and ends, and the lateral moves to their left.
    corner: [usize; 2],
    aside_m: [f64; 2],
    /// Share of the angle in each transition. `None` for a lane shift.
    share: Option<f64>,
}

type Key = ([usize; 2], [f64; 2], Option<f64>);

/// Candidates by number. A repeated candidate is dropped, but the numbers stay.
#[derive(Default)]
struct Family {
    known: Vec<(u8, Key)>,
    number: u8,
}

impl Family {
    fn add(&mut self, corner: [usize; 2], aside_m: [f64; 2], share: Option<f64>) {
        let key = (corner, aside_m.map(|m| if m.abs() < LEAST_SWING_M { 0.0 } else { m }), share);
        if !self.known.iter().any(|(_, known)| *known == key) {
            self.known.push((self.number, key));
        }
        self.number += 1;
    }

    /// The candidates with room to swing out and back; those without it drop out.
    fn of(self, spacing: [f64; 2], stations: usize) -> Vec<Candidate> {
        let candidate = |(number, (corner, aside_m, share)): (u8, Key)| {
            let over = |i: usize| if aside_m[i] == 0.0 { 0 } else { (SWING_M[i] / spacing[i]).round() as usize };
            let leave = corner[0].checked_sub(over(0))?;
            let join = Some(corner[1] + over(1)).filter(|&join| join < stations)?;
            Some(Candidate { number, leave, join, corner, aside_m, share })
        };
        self.known.into_iter().filter_map(candidate).collect()
    }
}

/// A centreline's points with half-widths, without repeated points.
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
}
