//! Tests of tubes alone (docs/proof.md, sections 3 to 6). To first order they are the exact reach of the disturbances.
//! At full size an adversary matched to the time-varying kernel of the attacked axle never leaves them.

use netcert::corridor::Corridor;
use netcert::stet::{Model, Options, Tube, certify, tubes};
use netcert::stop::Stop;
use netcert::vehicle::Vehicle;
use netcert_testing::oracle::adversary::{AdversaryBounds, Kernel, PushTarget, kernel};
use netcert_testing::oracle::draw::{self, Bends, Draw};
use netcert_testing::oracle::fleet;
use netcert_testing::oracle::path::{Path, V2, direction, dot, left_of};
use netcert_testing::oracle::simulator::{Disturbance, SimulatedDrive, SimulatedRun};
use rayon::prelude::*;

const STEPS: usize = 10;
/// Metres within which the adversary's steer axle changes sides.
const SWING_M: f64 = 0.3;

struct Case {
    name: String,
    vehicle: Vehicle,
    corridor: Corridor,
}

/// The result of attacks on one axle's tube at one station.
struct Met {
    name: String,
    unit: usize,
    station: usize,
    tube_m: f64,
    reached_m: f64,
}

fn bend(radius: f64, degrees: f64, transition: f64) -> Bends {
    let arc = (degrees.to_radians() * radius - transition).max(1.0);
    vec![
        (20.0, 0.0),
        (transition, 1.0 / radius),
        (arc, 1.0 / radius),
        (2.0 * transition, -0.7 / radius),
        (0.5 * arc, -0.7 / radius),
        (transition, 0.0),
        (40.0, 0.0),
    ]
}

fn cases(tolerance_m: f64, sway_deg: f64) -> Vec<Case> {
    let kinds = [
        ("EU-SEMI16.5", 15.0),
        ("EU-SEMI16.5", 60.0),
        ("AU-BDOUBLE26", 25.0),
        ("AU-BDOUBLE26", 80.0),
        ("AU-BTRIPLE36", 30.0),
        ("AU-ATRIPLE53", 40.0),
        ("AU-ATRIPLE53", 150.0),
        ("US-WB109D", 35.0),
        ("EU-EMS25-C", 18.0),
        ("EU-CAT18.75", 20.0),
        ("BUS-BIART24", 25.0),
    ];
    let case = |(k, &(id, radius)): (usize, &(&str, f64))| {
        let mut vehicle = fleet::vehicle(id);
        vehicle.tracking_tolerance_m = tolerance_m;
        vehicle.units.iter_mut().for_each(|unit| unit.sway_rad = sway_deg.to_radians());
        let bends = bend(radius, 100.0, 6.0 + radius / 10.0);
        let corridor = draw::corridor(&mut Draw(k as u64 + 5), &bends, 9.0, 9.5);
        Case { name: format!("{id} at {radius} m"), vehicle, corridor }
    };
    kinds.iter().enumerate().map(case).collect()
}

struct Bench<'a> {
    drive: SimulatedDrive<'a>,
    nominal: SimulatedRun,
    calm: Disturbance,
    bounds: AdversaryBounds,
    tubes: Vec<Tube>,
}

fn bench<'a>(case: &'a Case, path: &'a Path) -> Bench<'a> {
    let model = Model::new(&case.vehicle).unwrap();
    let options = Options { max_shift_m: 0.0, ..Options::default() };
    let certificate = certify(&case.corridor, &model, &options, &Stop::never()).unwrap().unwrap();
    assert!(certificate.result.shrink == 1.0, "{}: {:?}", case.name, certificate.result);
    let drive = SimulatedDrive::new(&case.vehicle, path, STEPS);
    let calm = Disturbance::none(drive.steps());
    let nominal = drive.whole(&calm);
    let slip = std::array::from_fn(|i| case.vehicle.units.get(i).map_or(0.0, |u| u.sway_rad));
    let steer_m = case.vehicle.tracking_tolerance_m;
    let change_m = 2.0 * steer_m / SWING_M * case.corridor.spacing_m / STEPS as f64;
    let tubes = tubes(&case.corridor, &model, &certificate);
    Bench { drive, nominal, calm, bounds: AdversaryBounds { steer_m, change_m, slip }, tubes }
}

fn path(case: &Case) -> Path {
    let c = &case.corridor;
    let plan: Vec<V2> = c.x.iter().zip(&c.y).map(|(&x, &y)| [x, y]).collect();
    let ends = (c.heading[0], c.heading[c.len() - 1]);
    Path::through(&plan, c.spacing_m, ends, 3.0 * case.vehicle.length_m, 10.0)
}

impl Bench<'_> {
    fn target(&self, station: usize, unit: usize, side: f64) -> PushTarget {
        let step = self.drive.path.span_of_vertex(station) * STEPS;
        // Across the axle's own nominal path, along the normal of its heading.
        let normal = left_of(direction(self.nominal.at(step).1[unit]));
        PushTarget { step, unit, ahead_m: 0.0, aside_m: 0.0, push: [side * normal[0], side * normal[1]] }
    }

    /// Largest movement of the linearised chain if the steer axle may jump. The plan's chord, κ ℓ²/8, is added to ε as
    /// in the tube.
    fn reach_m(&self, response: &Kernel, corridor: &Corridor) -> f64 {
        let chord = |step: usize| {
            let place = step as f64 / STEPS as f64 - self.drive.path.span_of_vertex(0) as f64;
            let k = (place.max(0.0) as usize).min(corridor.len() - 2);
            let part = (place - k as f64).clamp(0.0, 1.0);
            let bend = corridor.curvature[k] * (1.0 - part) + corridor.curvature[k + 1] * part;
            bend.abs() * corridor.spacing_m.powi(2) / 8.0
        };
        let chords: f64 = response.steer.iter().enumerate().map(|(k, g)| g.abs() * chord(response.first + k)).sum();
        response.reach_m(&self.bounds) + chords
    }

    fn memory(&self) -> usize {
        (5.0 * self.drive.vehicle.length_m) as usize * STEPS
    }

    fn axle(&self, run: &SimulatedRun, step: usize, unit: usize) -> V2 {
        let (guide, headings) = run.at(step);
        self.drive.body_point(guide, headings, unit, 0.0, 0.0)
    }

    /// The greatest lateral distance of an axle from its nominal path over the steps around an attack, and the tube
    /// there.
    fn attack(&self, station: usize, unit: usize, side: f64) -> (f64, f64) {
        let target = self.target(station, unit, side);
        let response = kernel(&self.drive, &self.nominal, &self.calm, &target, self.memory());
        let attack = response.attack(&self.bounds, self.drive.steps());
        let end = (target.step + 3 * STEPS).min(self.drive.steps());
        let run = self.drive.some(&attack, response.first..end, *self.nominal.at(response.first).1);
        let mut worst = (0.0, f64::INFINITY);
        for step in target.step.saturating_sub(5 * STEPS)..end {
            let Some((off, tube)) = self.against(self.axle(&run, step, unit), step, unit) else { continue };
            if off / tube > worst.0 / worst.1 {
                worst = (off, tube);
            }
        }
        worst
    }

    /// Lateral place of a point across an axle's nominal path, and the tube's half-width at its foot.
    fn against(&self, point: V2, step: usize, unit: usize) -> Option<(f64, f64)> {
        let off = |k: usize| {
            let at = self.axle(&self.nominal, k, unit);
            [point[0] - at[0], point[1] - at[1]]
        };
        let near = (step.saturating_sub(2 * STEPS)..(step + 2 * STEPS).min(self.drive.steps()))
            .min_by(|&a, &b| dot(off(a), off(a)).total_cmp(&dot(off(b), off(b))))?;
        let lateral = dot(off(near), left_of(direction(self.nominal.at(near).1[unit])));
        let tube = &self.tubes[unit].lateral_m;
        let station = (near / STEPS).checked_sub(self.drive.path.span_of_vertex(0))?;
        let (a, b) = (tube.get(station)?, tube.get(station + 1)?);
        Some((lateral.abs(), a.max(*b)))
    }
}

#[test]
fn at_first_order_a_tube_is_the_exact_reach_of_the_disturbances() {
    let cases = cases(0.004, 0.004);
    let met: Vec<Met> = cases
        .par_iter()
        .flat_map_iter(|case| {
            let path = path(case);
            let bench = bench(case, &path);
            let mut met = Vec::new();
            for station in (0..case.corridor.len() - 1).step_by(9) {
                for unit in 0..case.vehicle.units.len() {
                    let target = bench.target(station, unit, 1.0);
                    let response = kernel(&bench.drive, &bench.nominal, &bench.calm, &target, bench.memory());
                    let tube_m = bench.tubes[unit].lateral_m[station];
                    met.push(Met {
                        name: case.name.clone(),
                        unit,
                        station,
                        tube_m,
                        reached_m: bench.reach_m(&response, &case.corridor),
                    });
                }
            }
            met
        })
        .collect();
    let mut excess: Vec<f64> = met.iter().map(|m| m.tube_m / m.reached_m - 1.0).collect();
    excess.sort_by(f64::total_cmp);
    let part = |p: f64| 100.0 * excess[((excess.len() - 1) as f64 * p) as usize];
    println!(
        "{} tubes over the exact reach: least {:.2} %, median {:.2} %, 95 % {:.2} %, most {:.2} %",
        met.len(),
        part(0.0),
        part(0.5),
        part(0.95),
        part(1.0)
    );
    for m in &met {
        let line =
            format!("{}, unit {}, station {}: {:.5} of {:.5} m", m.name, m.unit, m.station, m.reached_m, m.tube_m);
        assert!(m.tube_m > m.reached_m * 0.995, "{line}");
    }
    assert!(part(0.5) < 3.0, "half of the tubes are wider by {:.2} %", part(0.5));
}

#[test]
fn no_matched_attack_drives_an_axle_out_of_its_tube() {
    let cases = cases(0.15, 0.2);
    let met: Vec<Met> = cases
        .par_iter()
        .enumerate()
        .flat_map_iter(|(k, case)| {
            let path = path(case);
            let bench = bench(case, &path);
            let mut draw = Draw(k as u64 + 99);
            let mut met = Vec::new();
            for _ in 0..24 {
                let station = draw.below(case.corridor.len() - 4);
                let unit = draw.below(case.vehicle.units.len());
                let (reached_m, tube_m) = bench.attack(station, unit, draw.sign());
                met.push(Met { name: case.name.clone(), unit, station, tube_m, reached_m });
            }
            met
        })
        .collect();
    let mut part: Vec<f64> = met.iter().map(|m| m.reached_m / m.tube_m).collect();
    part.sort_by(f64::total_cmp);
    println!(
        "{} attacks; part of the tube reached: median {:.3}, most {:.4}",
        part.len(),
        part[part.len() / 2],
        part[part.len() - 1]
    );
    for m in &met {
        let line =
            format!("{}, unit {}, station {}: {:.5} of {:.5} m", m.name, m.unit, m.station, m.reached_m, m.tube_m);
        assert!(m.reached_m <= m.tube_m, "{line}");
    }
    assert!(part[part.len() / 2] > 0.8, "the attacks are too weak to prove anything: {}", part[part.len() / 2]);
}
