//! Random corridor files and vehicles as people make them: catalogued and unusual vehicles, points half a metre to ten
//! metres apart, widths with kinks, bends from 4.5 to 90 m. They are the same in every run.

use netcert::corridor::{FileCorridor, corridor_from_file};
use netcert::stet::Options;
use netcert::vehicle::{Unit, Vehicle};
use serde_json::json;

use super::draw::{self, Draw};
use super::fleet;

/// Number of vehicles from the fleet, and of random vehicles.
const FLEET: usize = 20;
const RANDOM: usize = 256;

/// One case: vehicle, corridor file, and the plan's largest distance from the centreline.
pub struct OracleCase {
    pub index: u64,
    pub vehicle: Vehicle,
    pub given: FileCorridor,
    pub options: Options,
}

/// The case with this number.
pub fn case(index: u64) -> OracleCase {
    let mut draw = Draw(0xf11e_5eed + 7919 * index);
    let vehicle = match draw.below(FLEET + RANDOM) {
        // Vehicles of the fleet are as likely as random ones.
        _ if draw.one_in(2) => fleet::all().swap_remove(draw.below(FLEET)),
        number => random_vehicle(number as u64),
    };
    let max_shift_m = if draw.one_in(3) { 0.0 } else { draw.between(0.1, 1.5) };
    loop {
        // A drawn line that no curve follows is refused with a reason. Then the next line is tried.
        if let Some(given) = corridor(&mut draw, &vehicle) {
            return OracleCase { index, vehicle, given, options: Options { max_shift_m, ..Options::default() } };
        }
    }
}

/// One to five units with hitches from 0.9 of a unit's length ahead of its axle to 1.9 behind it.
fn random_vehicle(number: u64) -> Vehicle {
    let mut draw = Draw(0x7a11 + 104_729 * number);
    loop {
        let count = 1 + draw.below(5);
        let width_m = draw.between(0.8, 3.0);
        let longest_m = draw.log_between(2.0, 13.0);
        let units: Vec<Unit> = (0..count).map(|i| unit(&mut draw, i, count, width_m, longest_m)).collect();
        let mut vehicle = Vehicle {
            id: format!("RANDOM-{number}"),
            name: format!("random vehicle {number}"),
            region: String::new(),
            length_m: 0.0,
            height_m: None,
            gross_mass_t: None,
            class: None,
            axles: None,
            axle_load_t: None,
            tracking_tolerance_m: draw.between(0.0, 0.5),
            tracking_heading_rad: draw.between(0.0, 5.0).to_radians(),
            min_shrink: draw.between(0.1, 1.0),
            source: String::new(),
            units,
        };
        vehicle.length_m = length_m(&vehicle.units);
        // Only vehicles that the program accepts from a file, which refuses overlapping bodies.
        if let Ok(vehicle) = Vehicle::from_json(&vehicle.to_json().unwrap().to_string()) {
            return vehicle;
        }
    }
}

fn unit(draw: &mut Draw, i: usize, count: usize, width_m: f64, longest_m: f64) -> Unit {
    let length = draw.between(0.3, 1.0) * longest_m;
    let hitch = if i + 1 == count { 0.0 } else { length * draw.between(-0.9, 1.9) };
    let front = if i == 0 { draw.between(0.1, 0.4) } else { draw.between(-0.6, 0.2) } * length;
    Unit {
        name: format!("unit {i}"),
        coupling_to_axle_m: length,
        hitch_offset_m: hitch,
        front_overhang_m: front,
        rear_overhang_m: draw.between(0.05, 0.4) * length,
        width_m: width_m * draw.between(0.7, 1.0),
        max_articulation_rad: if i == 0 { draw.between(25.0, 55.0) } else { draw.between(40.0, 100.0) }.to_radians(),
        sway_rad: draw.between(0.0, 1.0).to_radians(),
    }
}

/// Length of the straight vehicle, from the front of the foremost body to the rear of the rearmost.
fn length_m(units: &[Unit]) -> f64 {
    let (mut coupling, mut front, mut rear) = (0.0_f64, f64::NEG_INFINITY, f64::INFINITY);
    for unit in units {
        front = front.max(coupling + unit.front_overhang_m);
        rear = rear.min(coupling - unit.coupling_to_axle_m - unit.rear_overhang_m);
        coupling -= unit.coupling_to_axle_m + unit.hitch_offset_m;
    }
    front - rear
}

/// A corridor file for the vehicle, read as the program reads it.
fn corridor(draw: &mut Draw, vehicle: &Vehicle) -> Option<FileCorridor> {
    let radius = draw.log_between(4.5, 90.0);
    let length = draw.between(40.0, 160.0);
    let bends = draw::bends(draw, radius, length);
    let apart = draw.log_between(0.5, 10.0);
    let points = points(draw, &bends, apart);
    let least = 0.5 * vehicle.width_m() + draw.between(0.1, 1.5) + 8.0 / radius.max(4.0) * draw.between(0.0, 1.0);
    let [left, right] = [0; 2].map(|_| widths(draw, points.len(), apart, least));
    let tolerance = if draw.one_in(2) { 0.0 } else { draw.between(0.1, 0.5) };
    let file = json!({"frame": "metres", "points": points, "left_m": left, "right_m": right,
                      "smoothing_tolerance_m": tolerance});
    corridor_from_file(&file.to_string()).ok()
}

/// Points `apart` metres from each other along bends, at a random place in the plane.
fn points(draw: &mut Draw, bends: &draw::Bends, apart: f64) -> Vec<[f64; 2]> {
    const STEP_M: f64 = 0.05;
    let total: f64 = bends.iter().map(|bend| bend.0).sum();
    let (mut x, mut y, mut heading) =
        (draw.between(-900.0, 900.0), draw.between(-900.0, 900.0), draw.between(-3.0, 3.0));
    let each = (apart / STEP_M).round().max(1.0) as usize;
    let mut points = Vec::new();
    for k in 0..=(total / STEP_M) as usize {
        if k % each == 0 {
            points.push([x, y]);
        }
        let turn = STEP_M * draw::curvature_at(bends, (k as f64 + 0.5) * STEP_M);
        let (sin, cos) = (heading + 0.5 * turn).sin_cos();
        (x, y, heading) = (x + STEP_M * cos, y + STEP_M * sin, heading + turn);
    }
    points
}

/// Half-widths at points: constant, tapered, or with a kink at every point.
fn widths(draw: &mut Draw, points: usize, apart: f64, least: f64) -> Vec<f64> {
    let kind = draw.below(3);
    let steady = least + draw.between(0.0, 2.0);
    let slope = draw.between(0.0, 0.3) * apart;
    let mut width = steady;
    let each = |k: usize| {
        match kind {
            0 => {}
            1 => width = least + (width - least + slope * draw.between(-1.0, 1.0)).abs(),
            _ => width = steady + if k.is_multiple_of(2) { slope.min(1.5) } else { 0.0 },
        }
        width
    };
    (0..points).map(each).collect()
}
