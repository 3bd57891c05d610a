//! Roundabouts as one movement: entering the ring by one of a few paths, along its centreline, and leaving it by one of
//! a few paths.
//!
//! The area is that of both turns and of the whole ring, as wide as the ring's own corridor. Mouths of other arms,
//! aprons and drivable islands do not count. Joints and stations are those of any turn. Paths that cut across the
//! ring's lanes are left out, except for the corrections that a certificate makes.

use geo::{BooleanOps, MultiPolygon};

use super::area::stretch;
use super::arm::{Arm, StrokeLine};
use super::arms::PathLine;
use super::code::PathShape;
use super::family::{FEW_NUMBERS, RingEnd, few};
use super::junction::Junction;
use super::path::{STEP_M, hermite};
use super::{LengthClass, TurnEdges, TurnParams};
use crate::corridor::Frame;
use crate::network::{EdgeNo, Movement, MovementKind, Network};
use crate::osm::facts::Policy;
use crate::verdict::UnknownReason;

/// Least circumference of a ring, metres. A map is too coarse for smaller rings.
const LEAST_ROUND_M: f64 = 38.0;
/// A point less than this ahead of the previous one is dropped, metres.
const LEAST_AHEAD_M: f64 = 0.5 * STEP_M;

/// A passage, prepared.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PreparedPassage {
    pub(super) entry: Junction,
    pub(super) exit: Junction,
    entries: Vec<PathShape>,
    exits: Vec<PathShape>,
    ring: Ring,
    /// Whether the exit lies beyond the seam of the ring.
    beyond: bool,
    pub(super) strokes: [u32; 2],
}

impl PreparedPassage {
    pub(super) fn new(
        network: &Network,
        TurnEdges { movement, through }: TurnEdges<'_>,
        [from, ring, to]: [&StrokeLine; 3],
        policy: Policy,
        params: &TurnParams,
        length_class: LengthClass,
    ) -> Result<Self, UnknownReason> {
        let (Some(&first), Some(&last)) = (through.first(), through.last()) else {
            return Err(UnknownReason::Geometry);
        };
        let place = |arc: EdgeNo| ring.made.spans.iter().position(|s| s.edge == arc).ok_or(UnknownReason::Geometry);
        for &arc in through {
            if let Some(reason) = ring.made.spans[place(arc)?].unknown {
                return Err(reason);
            }
        }
        let frame = from.made.frame;
        let junction = |from: EdgeNo, to: EdgeNo, lines: [&StrokeLine; 2]| {
            let movement = Movement { from, to, kind: MovementKind::Turn, forbidden: None };
            Junction::new(network, movement, lines, frame, policy, params, length_class)
        };
        let entry = junction(movement.from, first, [from, ring])?;
        let exit = junction(last, movement.to, [ring, to])?;
        Ok(Self {
            entries: few(&entry.arms, RingEnd::Entry),
            exits: few(&exit.arms, RingEnd::Exit),
            entry,
            exit,
            beyond: place(last)? < place(first)?,
            ring: Ring::new(ring, frame, params.strip.max(policy))?,
            strokes: [from.stroke, to.stroke],
        })
    }

    /// The drivable area, and the least assumed radius of its kerb returns, if there is one.
    pub(super) fn area(&self) -> (MultiPolygon, Option<f64>) {
        let ((onto, kerb), (off, other_kerb)) = (self.entry.area(), self.exit.area());
        let ring = stretch(&self.ring.arm, self.ring.once());
        (onto.union(&off).union(&ring), kerb.into_iter().chain(other_kerb).reduce(f64::min))
    }

    /// Angle from the one road to the other, radians, positive left.
    pub(super) fn turn_rad(&self) -> f64 {
        let (from, to) = (&self.entry.arms.from, &self.exit.arms.to);
        super::path::wrapped(to.line.heading[to.node] - from.line.heading[from.node])
    }

    /// The numbers of all paths.
    pub(super) fn numbers(&self) -> Vec<i64> {
        let exits = 0..self.exits.len();
        (0..self.entries.len()).flat_map(|i| exits.clone().map(move |j| (i * FEW_NUMBERS + j) as i64)).collect()
    }

    /// The line of the path with a number, with points about `step_m` apart.
    pub(super) fn line(&self, number: i64, step_m: f64) -> Option<PathLine> {
        let number = usize::try_from(number).ok()?;
        let entry = self.entry.arms.line(self.entries.get(number / FEW_NUMBERS)?, step_m)?;
        let exit = self.exit.arms.line(self.exits.get(number % FEW_NUMBERS)?, step_m)?;
        let round = self.round(&entry, &exit)?;
        let points = strung(&entry.points, &round, &exit.points);
        Some(PathLine { points, joints: [entry.joints[0], exit.joints[1]] })
    }

    /// The ring's centreline from the joint of an entry to the joint of an exit. `None` if the exit begins earlier.
    fn round(&self, entry: &PathLine, exit: &PathLine) -> Option<Vec<[f64; 2]>> {
        let joins = self.entry.arms.to.first + entry.joints[1];
        let leaves = self.exit.arms.from.first + exit.joints[0] + if self.beyond { self.ring.period? } else { 0 };
        (joins <= leaves).then(|| self.ring.centreline(joins, leaves))
    }
}

/// The stations of a roundabout.
#[derive(Debug, Clone, PartialEq)]
struct Ring {
    arm: Arm,
    /// The first counted station, and the number of stations in a whole circle (to half a station). `None` if the ring
    /// is not closed.
    first: usize,
    period: Option<usize>,
}

impl Ring {
    fn new(line: &StrokeLine, frame: Frame, strip: Policy) -> Result<Self, UnknownReason> {
        let arm = Arm::whole(line, frame, strip)?;
        let spans = &line.made.spans;
        let (Some(first), Some(last)) = (spans.first(), spans.last()) else { return Err(UnknownReason::Geometry) };
        let (first, end) = (first.stations.start, last.stations.end - 1);
        let [x, y] = arm.point(first);
        let off = |k: &usize| (arm.line.x[*k] - x).hypot(arm.line.y[*k] - y);
        let again = (end.saturating_sub(3)..(end + 4).min(arm.len())).min_by(|a, b| off(a).total_cmp(&off(b)));
        let period = again.map(|again| again - first).filter(|_| line.closed);
        if period.is_some_and(|n| (n as f64) * arm.line.spacing_m < LEAST_ROUND_M) {
            return Err(UnknownReason::Geometry);
        }
        Ok(Self { arm, first, period })
    }

    /// Stations of the whole ring, with the seam twice.
    fn once(&self) -> std::ops::Range<usize> {
        match self.period {
            Some(n) => self.first..(self.first + n + 2).min(self.arm.len()),
            None => self.arm.own.clone(),
        }
    }

    /// Points along the centreline between two stations, as close as a path's points.
    fn centreline(&self, from: usize, to: usize) -> Vec<[f64; 2]> {
        let once = |k: usize| match self.period {
            Some(n) if k >= self.first => self.first + (k - self.first) % n,
            _ => k,
        };
        let mut line = Vec::new();
        for k in from..to {
            let (a, b) = (once(k), once(k + 1));
            let (p, q, u, v) = (self.arm.point(a), self.arm.point(b), self.arm.forward(a), self.arm.forward(b));
            let chord = (q[0] - p[0]).hypot(q[1] - p[1]);
            let parts = (chord / STEP_M).round().max(1.0);
            line.extend((0..parts as usize).map(|i| hermite([p, q], [u, v], chord, i as f64 / parts)));
        }
        line.push(self.arm.point(once(to)));
        line
    }
}

/// Joins three lines into one. The ring's seam and its ends are a whole circle apart to half a station, so points that
/// would lie behind are dropped.
fn strung(onto: &[[f64; 2]], round: &[[f64; 2]], off: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut line = onto.to_vec();
    let ahead = |line: &[[f64; 2]], p: [f64; 2]| match *line {
        [.., a, b] => {
            let d = [b[0] - a[0], b[1] - a[1]];
            ((p[0] - b[0]) * d[0] + (p[1] - b[1]) * d[1]) / d[0].hypot(d[1]).max(1e-9)
        }
        _ => f64::INFINITY,
    };
    for &p in round {
        if ahead(&line, p) >= LEAST_AHEAD_M {
            line.push(p);
        }
    }
    let begins = onto.len();
    while let (true, Some(&next)) = (line.len() > begins, off.first()) {
        if ahead(&line, next) >= LEAST_AHEAD_M {
            break;
        }
        line.pop();
    }
    for &p in off {
        if ahead(&line, p) >= LEAST_AHEAD_M {
            line.push(p);
        }
    }
    line
}
