//! The score of a path for a vehicle: the least room around the bodies of a vehicle that follows the path exactly, less
//! an estimate of the tubes, and less where the path asks for more steering or bending than is prudent.

use super::field::Field;
use crate::turns::corridors::TurnCorridors;
use crate::vehicle::{Unit, Vehicle};
use netcert_base::work_count::{WorkKind, count};

/// Estimated deviation of the first unit from its nominal place, and how much more each further unit deviates, metres.
const TUBE_M: [f64; 2] = [0.09, 0.03];
/// Angles kept from the steering lock and from the other hinges' limits, radians.
const SPARE_RAD: [f64; 2] = [0.12, 0.14];
/// Metres of room that a radian beyond that is worth.
const PER_RAD_M: f64 = 14.0;
/// Least distance between the places looked at along a side, metres.
const SIDE_STEP_M: f64 = 1.0;
/// One in this many moments is looked at first. What they lack beyond [`SURE_M`], metres, other samples along a side hardly make up.
const FEW: usize = 5;
const SURE_M: f64 = 0.1;
/// Least distance between the places looked at along the front of a body that goes on, metres.
const FRONT_STEP_M: f64 = 0.4;
/// More room than the least by this is not measured, metres.
const SLACK_M: f64 = 0.5;
/// Moments that refused the last paths. They are looked at first, while the vehicle is still followed: most paths lack room where the
/// one before lacked it.
const CRITICAL: usize = 3;
/// Way that the rear goes on the road that a path joins before the score ends, metres.
const BEYOND_M: f64 = 5.0;

/// How well a path fits, metres.
#[derive(Clone, Copy)]
pub(super) struct Score {
    /// The score.
    pub(super) score_m: f64,
    /// The least room, less the tubes. Steering and hinges do not count.
    pub(super) room_m: f64,
}

/// Scores paths of one turn for one vehicle.
pub(super) struct Scorer<'a> {
    made: &'a TurnCorridors,
    vehicle: &'a Vehicle,
    /// By unit: the angle to the unit ahead that costs nothing, radians, and its cosine.
    limits: Vec<(f64, f64)>,
    /// The units' headings (unit vectors) by station of the approach at which the steer axle is.
    approach: Vec<[f64; 2]>,
    headings: Vec<[f64; 2]>,
    /// By moment and unit of the path at hand: axle and heading.
    stands: Vec<[[f64; 2]; 2]>,
    /// By unit and side: where it was last, and the room there.
    sides: Vec<Side>,
    /// The last critical moments, the newest one first.
    critical: [usize; CRITICAL],
}

impl<'a> Scorer<'a> {
    pub(super) fn new(made: &'a TurnCorridors, vehicle: &'a Vehicle) -> Self {
        let from = made.arms()[0];
        let mut headings = vec![from.forward(0); vehicle.units.len()];
        let mut approach = headings.clone();
        for k in 1..from.len() {
            let (a, b) = (from.point(k - 1), from.point(k));
            follow(&mut headings, [b[0] - a[0], b[1] - a[1]], &vehicle.units);
            approach.extend_from_slice(&headings);
        }
        let prudent = |(i, unit): (usize, &Unit)| unit.max_articulation_rad - SPARE_RAD[usize::from(i > 0)];
        let limits = vehicle.units.iter().enumerate().map(prudent).map(|rad| (rad, rad.cos())).collect();
        Self {
            made,
            vehicle,
            limits,
            approach,
            headings,
            stands: Vec::new(),
            sides: Vec::new(),
            critical: [usize::MAX; CRITICAL],
        }
    }

    /// The score of the path with a code, from moments about `step_m` apart. `None` if it is not above `floor_m`, or if the turn has no such
    /// path.
    pub(super) fn score(&mut self, field: &mut Field, code: i64, step_m: f64, floor_m: f64) -> Option<Score> {
        count(WorkKind::Score, 1);
        let line = self.made.line(code, step_m)?;
        let (units, to) = (&self.vehicle.units, self.made.arms()[1]);
        let [leave, join] = line.joints;
        let count = units.len();
        self.headings.copy_from_slice(self.approach.get(leave * count..(leave + 1) * count)?);
        let tail = ((self.vehicle.length_m + BEYOND_M) / to.line.spacing_m).ceil() as usize;
        let every = ((step_m / to.line.spacing_m).round() as usize).max(1);
        let tail = (join + 1..(join + 1 + tail).min(to.len())).step_by(every).map(|k| to.point(k));
        let mut at = *line.points.first()?;
        let mut beyond_rad = 0.0_f64;
        self.stands.clear();
        for p in line.points.iter().skip(1).copied().chain(tail) {
            let step = [p[0] - at[0], p[1] - at[1]];
            let length_m = length(step);
            if length_m < 1e-6 {
                continue;
            }
            at = p;
            let before = self.headings.first().copied()?;
            follow(&mut self.headings, step, units);
            let mut ahead = [step[0] / length_m, step[1] / length_m];
            for (i, (&heading, &(most_rad, least_cosine))) in self.headings.iter().zip(&self.limits).enumerate() {
                // A chord points where the steer axle goes in the middle of the step.
                let of = if i == 0 { middle(before, heading) } else { heading };
                let cosine = ahead[0] * of[0] + ahead[1] * of[1];
                if cosine < least_cosine {
                    beyond_rad = beyond_rad.max(cosine.clamp(-1.0, 1.0).acos() - most_rad);
                }
                ahead = heading;
            }
            let mut coupling = p;
            for (heading, unit) in self.headings.iter().zip(units) {
                let axle = along(coupling, *heading, -unit.coupling_to_axle_m);
                self.stands.push([axle, *heading]);
                coupling = along(axle, *heading, -unit.hitch_offset_m);
            }
            let moment = self.stands.len() / count.max(1) - 1;
            let needed_m = floor_m + PER_RAD_M * beyond_rad;
            if self.critical.contains(&moment) && self.lacks(field, moment, needed_m) {
                return None;
            }
        }
        let spent_m = PER_RAD_M * beyond_rad;
        let needed_m = floor_m + spent_m;
        let moments = self.stands.len() / count.max(1);
        // Most paths lack room for many moments on end: a few moments far apart refuse them soonest.
        let refused_m = needed_m - SURE_M;
        let few = self.room_of_few(field, (0..moments).rev().step_by(FEW), refused_m);
        if few.0 <= refused_m {
            self.note(few.1);
            return None;
        }
        let (room_m, moment) = self.room_of_all(field, moments, few, needed_m);
        self.note(moment);
        let score_m = room_m - spent_m;
        (room_m > needed_m && score_m > floor_m).then_some(Score { score_m, room_m })
    }

    /// Least room around the bodies at some moments of the path at hand, less the tubes, and the moment that has it. The search ends where
    /// it is no more than `needed_m`.
    fn room_of_few(&self, field: &mut Field, moments: impl Iterator<Item = usize>, needed_m: f64) -> (f64, usize) {
        let mut least = (f64::INFINITY, 0);
        for moment in moments {
            for (tube_m, axle, heading, unit) in self.at(moment) {
                let room_m = room_m(field, axle, heading, unit, least.0 + tube_m) - tube_m;
                if room_m < least.0 {
                    least = (room_m, moment);
                }
            }
            if least.0 <= needed_m {
                break;
            }
        }
        least
    }

    /// As [`Self::room_of_few`] for all moments one after the other, with the least room of some of them. A body that follows itself is
    /// looked at only where it has not been before.
    fn room_of_all(
        &mut self,
        field: &mut Field,
        moments: usize,
        mut least: (f64, usize),
        needed_m: f64,
    ) -> (f64, usize) {
        let mut sides = std::mem::take(&mut self.sides);
        sides.clear();
        sides.resize(2 * self.vehicle.units.len(), Side::default());
        for moment in 0..moments {
            let units = self.at(moment).zip(sides.chunks_exact_mut(2));
            for ((tube_m, axle, heading, unit), sides) in units {
                for (side, corner) in sides.iter_mut().zip(rear_corners(axle, heading, unit)) {
                    let room_m = side.go_on(field, corner, heading, length_m(unit), least.0 + tube_m) - tube_m;
                    if room_m < least.0 {
                        least = (room_m, moment);
                    }
                }
            }
            if least.0 <= needed_m {
                break;
            }
        }
        self.sides = sides;
        least
    }

    /// Whether any body has less room than needed at a moment, the tubes deducted.
    fn lacks(&self, field: &mut Field, moment: usize, needed_m: f64) -> bool {
        self.at(moment).any(|(tube_m, axle, heading, unit)| {
            let needed_m = needed_m + tube_m;
            room_m(field, axle, heading, unit, needed_m) < needed_m
        })
    }

    /// The units at a moment: tube, axle, heading.
    fn at(&self, moment: usize) -> impl Iterator<Item = (f64, [f64; 2], [f64; 2], &Unit)> {
        let units = &self.vehicle.units;
        let stands = self.stands.iter().skip(moment * units.len());
        let tubes = (0..).map(|i| TUBE_M[0] + f64::from(i) * TUBE_M[1]);
        stands.zip(units).zip(tubes).map(|((&[axle, heading], unit), tube_m)| (tube_m, axle, heading, unit))
    }

    /// Takes a moment for critical.
    fn note(&mut self, moment: usize) {
        if !self.critical.contains(&moment) {
            self.critical.rotate_right(1);
            self.critical[0] = moment;
        }
    }
}

/// Turns the units' headings as the steer axle moves by `step`. Roads and turns are made without the prover, so this is
/// its own.
fn follow(headings: &mut [[f64; 2]], mut step: [f64; 2], units: &[Unit]) {
    for (heading, unit) in headings.iter_mut().zip(units) {
        let turned = turned(*heading, step, unit.coupling_to_axle_m);
        let reach = unit.coupling_to_axle_m + unit.hitch_offset_m;
        step = [step[0] - reach * (turned[0] - heading[0]), step[1] - reach * (turned[1] - heading[1])];
        *heading = turned;
    }
}

/// The heading after the front coupling has moved by `step`, as in the kernel's nominal motion.
fn turned(heading: [f64; 2], step: [f64; 2], length_m: f64) -> [f64; 2] {
    let moved = length(step);
    if moved < 1e-12 {
        return heading;
    }
    let sine = heading[0] * step[1] - heading[1] * step[0];
    let cosine = heading[0] * step[0] + heading[1] * step[1];
    let half = sine / (moved + cosine).max(f64::MIN_POSITIVE) * (-moved / length_m).exp();
    let (cos, sin) = ((1.0 - half * half) / (1.0 + half * half), 2.0 * half / (1.0 + half * half));
    let ahead = [step[0] / moved, step[1] / moved];
    [ahead[0] * cos + ahead[1] * sin, ahead[1] * cos - ahead[0] * sin]
}

/// Least distance of a unit's sides from the boundary, where it is below `least_m`. Distance changes by no more than
/// the place does, so a place with much room speaks for its neighbours.
fn room_m(field: &mut Field, axle: [f64; 2], heading: [f64; 2], unit: &Unit, mut least_m: f64) -> f64 {
    for corner in rear_corners(axle, heading, unit) {
        least_m = room_along(field, corner, heading, [0.0, length_m(unit)], SIDE_STEP_M, least_m);
    }
    least_m
}

/// The left and the right rear corner of a unit.
fn rear_corners(axle: [f64; 2], heading: [f64; 2], unit: &Unit) -> [[f64; 2]; 2] {
    let rear = along(axle, heading, -unit.rear_overhang_m);
    [0.5, -0.5].map(|share| along(rear, [-heading[1], heading[0]], share * unit.width_m))
}

/// Least distance of a line from the boundary between two distances from its start, where it is below `least_m`. Places are at least
/// `step_m` apart.
fn room_along(
    field: &mut Field,
    start: [f64; 2],
    heading: [f64; 2],
    [mut s, end]: [f64; 2],
    step_m: f64,
    mut least_m: f64,
) -> f64 {
    loop {
        let m = field.distance_m(along(start, heading, s));
        let beyond_m = m - least_m;
        least_m = least_m.min(m);
        if s >= end {
            return least_m;
        }
        s = (s + beyond_m.max(step_m)).min(end);
    }
}

/// A side of a body at the last moment.
#[derive(Clone, Copy)]
struct Side {
    rear: [f64; 2],
    heading: [f64; 2],
    /// The side had about this room or more, metres.
    room_m: f64,
}

impl Default for Side {
    /// Nothing is known.
    fn default() -> Self {
        Self { rear: [0.0; 2], heading: [1.0, 0.0], room_m: f64::NEG_INFINITY }
    }
}

impl Side {
    /// Takes the side to its next place, given by its rear end and heading. Returns its room, where it is below `least_m`.
    fn go_on(&mut self, field: &mut Field, rear: [f64; 2], heading: [f64; 2], length_m: f64, least_m: f64) -> f64 {
        let front = along(rear, heading, length_m);
        let from_rear = |p: [f64; 2]| {
            let [x, y] = [p[0] - self.rear[0], p[1] - self.rear[1]];
            let [cos, sin] = self.heading;
            [x * cos + y * sin, y * cos - x * sin]
        };
        let ([behind_m, rear_aside_m], [front_m, front_aside_m]) = (from_rear(rear), from_rear(front));
        let known_m = self.room_m - rear_aside_m.abs().max(front_aside_m.abs());
        let on = known_m > least_m && behind_m >= 0.0;
        // Places behind this one have been looked at, and lie no farther aside than the ends.
        let room_m = if on {
            let new = [(length_m + length_m - front_m).clamp(0.0, length_m), length_m];
            room_along(field, rear, heading, new, FRONT_STEP_M, known_m)
        } else {
            room_along(field, rear, heading, [0.0, length_m], SIDE_STEP_M, least_m + SLACK_M)
        };
        *self = Self { rear, heading, room_m };
        room_m
    }
}

/// Length of a unit, metres.
fn length_m(unit: &Unit) -> f64 {
    unit.coupling_to_axle_m + unit.front_overhang_m + unit.rear_overhang_m
}

/// The heading halfway between two.
fn middle(u: [f64; 2], v: [f64; 2]) -> [f64; 2] {
    let [x, y] = [u[0] + v[0], u[1] + v[1]];
    let length = length([x, y]).max(1e-9);
    [x / length, y / length]
}

/// Unlike `hypot` it is inlined.
fn length([x, y]: [f64; 2]) -> f64 {
    (x * x + y * y).sqrt()
}

fn along(p: [f64; 2], u: [f64; 2], m: f64) -> [f64; 2] {
    [p[0] + m * u[0], p[1] + m * u[1]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::corridor::PlaneArea;

    /// A side of 8 m passes a corner that points at it, straight on or turning. Looks at all of it at every moment find no less room.
    #[test]
    fn a_side_that_goes_on_has_the_room_of_all_its_places() {
        let yard = vec![[-30.0, -30.0], [30.0, -30.0], [30.0, 30.0], [-30.0, 30.0]];
        let island = vec![[0.0, 0.0], [-3.0, 6.0], [3.0, 6.0]];
        let area = PlaneArea { rings: vec![yard, island] };
        let mut field = Field::new(&area, [0.0, 0.0], 29.0);
        for (aside_m, turn_rad) in [(0.3, 0.0), (0.9, 0.0), (1.4, 0.01), (2.0, 0.03), (0.6, -0.004)] {
            let (mut side, mut found_m, mut whole_m, mut truth_m) = (Side::default(), 2.5_f64, 2.5_f64, 2.5_f64);
            let (mut rear, mut angle) = ([-16.0, -aside_m], 0.0_f64);
            for _ in 0..18 {
                let heading = [angle.cos(), angle.sin()];
                found_m = found_m.min(side.go_on(&mut field, rear, heading, 8.0, found_m));
                whole_m = room_along(&mut field, rear, heading, [0.0, 8.0], SIDE_STEP_M, whole_m);
                for i in 0..=400 {
                    truth_m = truth_m.min(field.distance_m(along(rear, heading, 0.02 * f64::from(i))));
                }
                rear = along(rear, heading, 1.0);
                angle += turn_rad;
            }
            assert!(truth_m < 2.0, "the side comes near the corner: {truth_m}");
            assert!(found_m >= truth_m - 0.02 && found_m <= whole_m + 0.12, "{aside_m}: {found_m} {whole_m} {truth_m}");
        }
    }
}
