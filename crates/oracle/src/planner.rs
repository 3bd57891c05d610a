//! A planner of turns that knows nothing of certificates: it searches the path that leaves the most room undisturbed.
//!
//! It measures recall. Where it finds room to spare, a certifier that gives up has to say why. Its search is a random
//! one with a fixed seed: turns all over the range, then small changes of the best ones.

use netcert_base::vehicle::Vehicle;

use crate::area::{AreaBoundary, Body};
use crate::crossing::{Crossing, Manoeuvre, SPACING_M};
use crate::draw::Draw;
use crate::path::{V2, along, direction, dot, left_of, wrapped};
use crate::simulator::{MAX_UNITS, PerUnit};

/// Number of turns that are tried all over the range, of those that are improved, and of changes to each.
const TRIED: usize = 160;
const IMPROVED: usize = 3;
const CHANGES: usize = 110;
/// How far the vehicle is followed after the bend: its length, and this much more, metres.
const AFTER_M: f64 = 10.0;
/// Distance between places of a side, metres.
const PITCH_M: f64 = 1.0;
/// Half of the side of the square around the crossing in which rooms are looked up, and their pitch, metres.
const SQUARE_M: f64 = 50.0;
const CELL_M: f64 = 0.5;
/// What hinges and the steering lock have to keep beside the course tolerance, radians.
const RESERVE_RAD: f64 = 0.05;
/// Metres of room that a radian beyond a hinge's limit costs, so that the search finds its way back.
const BEYOND_LIMIT: f64 = 20.0;

/// The best turn that was found.
#[derive(Debug, Clone, Copy)]
pub struct Drivable {
    pub way: Manoeuvre,
    /// The least room of any body on it, undisturbed, metres. Negative if a hinge gets too close to its limit.
    pub room_m: f64,
}

/// Searches the turn that leaves a vehicle the most room.
pub fn drivable(crossing: &Crossing, vehicle: &Vehicle, seed: u64) -> Drivable {
    let mut draw = Draw(seed);
    let mut test = Test::new(crossing, vehicle);
    let mut best: Vec<(f64, [f64; 7])> = Vec::new();
    for k in 0..TRIED {
        let numbers =
            std::array::from_fn(|i| if k % 2 == 0 && (i == 1 || i == 5) { 0.5 } else { draw.between(0.0, 1.0) });
        let enough = best.get(IMPROVED - 1).map_or(f64::NEG_INFINITY, |last| last.0);
        let room_m = test.room(&test.way(&numbers), enough);
        if room_m > enough {
            best.push((room_m, numbers));
            best.sort_by(|a, b| b.0.total_cmp(&a.0));
            best.truncate(IMPROVED);
        }
    }
    for (room_m, numbers) in &mut best {
        for k in 0..CHANGES {
            let size = 0.25 * 0.97_f64.powi(k as i32);
            let some = draw.below(3) + 1;
            let mut changed = *numbers;
            for number in &mut changed {
                if draw.below(3) < some {
                    *number = (*number + size * draw.between(-1.0, 1.0)).clamp(0.0, 1.0);
                }
            }
            let found = test.room(&test.way(&changed), *room_m);
            if found > *room_m {
                (*room_m, *numbers) = (found, changed);
            }
        }
    }
    let exact = best.into_iter().map(|(_, numbers)| {
        let way = test.way(&numbers);
        Drivable { way, room_m: test.exact_room(&way) }
    });
    exact.max_by(|a, b| a.room_m.total_cmp(&b.room_m)).expect("some turn was tried")
}

/// The least room of a turn undisturbed, metres, by the same simulation. Outlines count exactly.
pub fn room_m(crossing: &Crossing, vehicle: &Vehicle, way: &Manoeuvre) -> f64 {
    Test::new(crossing, vehicle).exact_room(way)
}

/// One crossing and one vehicle.
struct Test<'a> {
    crossing: &'a Crossing,
    vehicle: &'a Vehicle,
    ground: AreaBoundary,
    /// Rooms at the corners of cells, NaN where none is known yet.
    rooms: Vec<f64>,
    origin: V2,
}

impl<'a> Test<'a> {
    fn new(crossing: &'a Crossing, vehicle: &'a Vehicle) -> Self {
        let ground = AreaBoundary::new(&crossing.unposed());
        let origin = crossing.inside().map(|x| x - SQUARE_M);
        Self { crossing, vehicle, ground, rooms: vec![f64::NAN; cells() * cells()], origin }
    }

    /// The turn of seven numbers from 0 to 1.
    fn way(&self, numbers: &[f64; 7]) -> Manoeuvre {
        let most_m = self.vehicle.units.iter().map(|unit| 0.5 * unit.width_m).fold(0.0, f64::max) + 0.3;
        let place = |[right, left]: [f64; 2], share: f64| {
            let spare = (0.5 * (left - right) - most_m).max(0.0);
            0.5 * (left + right) + spare * (2.0 * share - 1.0)
        };
        let range = |low: f64, high: f64, share: f64| low + (high - low) * share;
        let [before, swing, radius, rise, fall, drift, after] = *numbers;
        Manoeuvre {
            before_m: place(self.crossing.lanes[0], before),
            swing_m: range(-2.0, 2.0, swing),
            radius_m: range(8f64.ln(), 32f64.ln(), radius).exp(),
            rise_m: range(2.0, 20.0, rise),
            fall_m: range(2.0, 20.0, fall),
            drift_m: range(-2.0, 2.0, drift),
            after_m: place(self.crossing.lanes[1], after),
        }
    }

    /// The least room of a turn, or any number that is at most `enough` if it is not more than that.
    fn room(&mut self, way: &Manoeuvre, enough: f64) -> f64 {
        let vehicle = self.vehicle;
        let mut ride = Ride::new(self.crossing, vehicle, way);
        let mut least = f64::INFINITY;
        loop {
            // Looking at every station takes twice the time, and the exact room does so anyway.
            if ride.now.is_multiple_of(2) {
                let axles = ride.axles();
                for (unit, part) in vehicle.units.iter().enumerate() {
                    least = self.sides(&Body::new(part, axles[unit], ride.headings[unit]), least);
                    if least <= enough {
                        return least;
                    }
                }
            }
            let (more, limit) = ride.advance();
            least = least.min(limit);
            if least <= enough || !more {
                return least;
            }
        }
    }

    /// The least room of a body's sides and the middle of its ends, or `least` if that is less. Room changes by a metre
    /// per metre at most, so what is too far from the boundary is left out.
    fn sides(&mut self, body: &Body, mut least: f64) -> f64 {
        for aside in [body.half_m, -body.half_m, 0.0] {
            let mut ahead = -body.rear_m;
            loop {
                let room = self.looked_up(body.at([ahead, aside]));
                least = least.min(room);
                if ahead >= body.front_m {
                    break;
                }
                // Between the middles of both ends there is nothing.
                let next = if aside == 0.0 { f64::INFINITY } else { ahead + PITCH_M.max(room - least) };
                ahead = next.min(body.front_m);
            }
        }
        least
    }

    /// The least room of a turn by exact distances.
    fn exact_room(&self, way: &Manoeuvre) -> f64 {
        let mut ride = Ride::new(self.crossing, self.vehicle, way);
        let mut least = f64::INFINITY;
        loop {
            let axles = ride.axles();
            for (unit, part) in self.vehicle.units.iter().enumerate() {
                let body = Body::new(part, axles[unit], ride.headings[unit]);
                least = least.min(self.ground.body(&body).room_m);
            }
            let (more, limit) = ride.advance();
            least = least.min(limit);
            if !more {
                return least;
            }
        }
    }

    /// The room of a place between the corners of its cell. Far from the crossing, where paths are straight, it is not
    /// asked for.
    fn looked_up(&mut self, at: V2) -> f64 {
        let [x, y] = [0, 1].map(|i| (at[i] - self.origin[i]) / CELL_M);
        let last = (cells() - 2) as f64;
        if !(0.0..last).contains(&x) || !(0.0..last).contains(&y) {
            return f64::INFINITY;
        }
        let (i, j) = (x.floor(), y.floor());
        let (s, t) = (x - i, y - j);
        let mut corner = |di: usize, dj: usize| self.corner(i as usize + di, j as usize + dj);
        let low = corner(0, 0) * (1.0 - s) + corner(1, 0) * s;
        let high = corner(0, 1) * (1.0 - s) + corner(1, 1) * s;
        low * (1.0 - t) + high * t
    }

    fn corner(&mut self, i: usize, j: usize) -> f64 {
        let known = self.rooms[j * cells() + i];
        if !known.is_nan() {
            return known;
        }
        let at = [self.origin[0] + i as f64 * CELL_M, self.origin[1] + j as f64 * CELL_M];
        let room = self.ground.room(at).0;
        self.rooms[j * cells() + i] = room;
        room
    }
}

fn cells() -> usize {
    (2.0 * SQUARE_M / CELL_M) as usize + 2
}

/// A vehicle on its way through a turn, station by station.
struct Ride<'a> {
    vehicle: &'a Vehicle,
    stations: Vec<V2>,
    now: usize,
    headings: PerUnit,
}

impl<'a> Ride<'a> {
    /// The vehicle stands straight, with its steer axle where the bend begins.
    fn new(crossing: &Crossing, vehicle: &'a Vehicle, way: &Manoeuvre) -> Self {
        let mut stations = crossing.trace(way).1;
        let last = stations[stations.len() - 1];
        let after = ((vehicle.length_m + AFTER_M) / SPACING_M).ceil() as usize;
        stations.extend((1..=after).map(|k| along(last, k as f64 * SPACING_M, direction(crossing.angle))));
        Self { vehicle, stations, now: 0, headings: [0.0; MAX_UNITS] }
    }

    fn axles(&self) -> [V2; MAX_UNITS] {
        let mut coupling = self.stations[self.now];
        let mut axles = [[0.0; 2]; MAX_UNITS];
        for (i, unit) in self.vehicle.units.iter().enumerate() {
            let u = direction(self.headings[i]);
            axles[i] = along(coupling, -unit.coupling_to_axle_m, u);
            coupling = along(axles[i], -unit.hitch_offset_m, u);
        }
        axles
    }

    /// Turns every unit as the front one moves by a chord: a midpoint step. Returns the turns and the chord's angle to
    /// the front unit.
    fn turned(&self, chord: V2, headings: &PerUnit) -> PerUnit {
        let mut moved = chord;
        let mut turns = [0.0; MAX_UNITS];
        for (i, unit) in self.vehicle.units.iter().enumerate() {
            let n = left_of(direction(headings[i]));
            turns[i] = dot(moved, n) / unit.coupling_to_axle_m;
            moved = along(moved, -(unit.coupling_to_axle_m + unit.hitch_offset_m) * turns[i], n);
        }
        turns
    }

    /// Drives to the next station. Returns whether there is one, and infinity or what a hinge or the steering beyond
    /// its limit costs, as room.
    fn advance(&mut self) -> (bool, f64) {
        let Some(next) = self.stations.get(self.now + 1) else { return (false, f64::INFINITY) };
        let chord = along(*next, -1.0, self.stations[self.now]);
        let first = self.turned(chord, &self.headings);
        let middle: PerUnit = std::array::from_fn(|i| self.headings[i] + 0.5 * first[i]);
        let turns = self.turned(chord, &middle);
        let steered = wrapped(chord[1].atan2(chord[0]) - middle[0]);
        let reserve = self.vehicle.tracking_heading_rad + RESERVE_RAD;
        let mut beyond = 0.0_f64;
        for (i, unit) in self.vehicle.units.iter().enumerate() {
            let folded = if i == 0 { steered } else { middle[i] - middle[i - 1] };
            beyond = beyond.max(folded.abs() + reserve - unit.max_articulation_rad);
        }
        self.headings = std::array::from_fn(|i| self.headings[i] + turns[i]);
        self.now += 1;
        (true, if beyond > 0.0 { -BEYOND_LIMIT * beyond } else { f64::INFINITY })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::least_room::PathAreas;
    use crate::path::Path;
    use crate::simulator::{Disturbance, SimulatedDrive};
    use crate::{attack, fleet};

    fn cases() -> impl Iterator<Item = (Crossing, Draw)> {
        (0..20).map(|index| {
            let mut draw = Draw(0x91a7 + index * 104_729);
            let crossing = if index % 4 == 0 { Crossing::with_islands(&mut draw) } else { Crossing::drawn(&mut draw) };
            (crossing, draw)
        })
    }

    #[test]
    fn the_simulation_agrees_with_the_simulator() {
        let vehicle = fleet::vehicle("AU-BDOUBLE26");
        for (crossing, mut draw) in cases() {
            let crossing = Crossing { split: false, ..crossing };
            let way = Manoeuvre::drawn(&mut draw, &crossing);
            let corridor = crossing.corridor(&way, &vehicle);
            let plan: Vec<V2> = corridor.x.iter().zip(&corridor.y).map(|(x, y)| [*x, *y]).collect();
            let headings = (corridor.heading[0], corridor.heading[corridor.len() - 1]);
            let path = Path::through(&plan, SPACING_M, headings, 60.0, 40.0);
            let drive = SimulatedDrive::new(&vehicle, &path, attack::STEPS_PER_M / 2);
            let run = drive.whole(&Disturbance::none(drive.steps()));
            let swept = PathAreas::new(&corridor, &drive).least(&drive, &run, run.steps()).unwrap().room_m;
            // Without the hinges' limits, of which the simulator knows nothing.
            let mut loose = vehicle.clone();
            loose.units.iter_mut().for_each(|unit| unit.max_articulation_rad = 3.0);
            let planned = room_m(&crossing, &loose, &way);
            assert!((swept - planned).abs() < 0.02, "{swept} {planned} {crossing:?} {way:?}");
        }
    }

    #[test]
    fn the_search_beats_turns_at_random_and_is_the_same_each_time() {
        let vehicle = fleet::vehicle("EU-SEMI16.5");
        let (mut ahead, mut fits) = (0, 0);
        for (crossing, mut draw) in cases() {
            let found = drivable(&crossing, &vehicle, 7);
            assert_eq!(found.way, drivable(&crossing, &vehicle, 7).way);
            let random = (0..30).map(|_| room_m(&crossing, &vehicle, &Manoeuvre::drawn(&mut draw, &crossing)));
            let best = random.fold(f64::NEG_INFINITY, f64::max);
            ahead += usize::from(found.room_m >= best - 0.02);
            fits += usize::from(found.room_m >= 0.3);
        }
        assert!(ahead >= 18, "{ahead}");
        assert!(fits >= 8, "{fits}");
    }
}
