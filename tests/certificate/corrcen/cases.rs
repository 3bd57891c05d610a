//! Corridors about as wide as their vehicles need, so that the steering matters.

use std::path::Path;

use netcert::corridor::{Corridor, Params, stroke_corridor};
use netcert::network::Network;
use netcert::osm::facts::{Countries, Policy};
use netcert::pipeline::{Summary, read_network};
use netcert::vehicle::Vehicle;

use netcert::reporter::Silent;
use netcert_testing::oracle::draw::{self, Bends, Draw};
use netcert_testing::oracle::fleet;

/// Stations of a real road in one case.
const WINDOW: usize = 320;

pub struct Case {
    pub name: String,
    pub vehicle: Vehicle,
    pub corridor: Corridor,
}

/// RSC is compared at γ = 1: a plan that asks more of the driver must not look as good as one that asks less.
fn unshrunk(mut vehicle: Vehicle) -> Vehicle {
    vehicle.min_shrink = 1.0;
    vehicle
}

/// Squared radius of the tightest circle that a vehicle can follow for ever.
fn tightest2(vehicle: &Vehicle) -> f64 {
    let last = vehicle.units.len() - 1;
    let of = |(i, u): (usize, &netcert::vehicle::Unit)| {
        u.coupling_to_axle_m.powi(2) - if i < last { u.hitch_offset_m.powi(2) } else { 0.0 }
    };
    vehicle.units.iter().enumerate().map(of).sum()
}

/// One or two bends between straights, with radii of 15 to 300 m. Every third case is an S-bend.
pub fn drawn(index: u64) -> Case {
    let mut draw = Draw(0xc077_0000 + 6421 * index);
    let fleet = fleet::all();
    let vehicle = unshrunk(fleet[draw.below(fleet.len())].clone());
    let tightest = tightest2(&vehicle).sqrt();
    let radius = draw.log_between(15.0f64.max(1.25 * tightest + 3.0), 300.0);
    let s_bend = index.is_multiple_of(3);
    let bends = if s_bend { s_bend_of(&mut draw, radius) } else { draw::bends(&mut draw, radius, 60.0 + 0.5 * radius) };
    let bends = [vec![(15.0, 0.0)], bends, vec![(vehicle.length_m + 15.0, 0.0)]].concat();
    let low = 0.5 * vehicle.width_m() + 0.35 + draw.between(0.2, 0.6) * tightest.powi(2) / (2.0 * radius);
    let corridor = draw::corridor(&mut draw, &bends, low, low + 0.6);
    let shape = if s_bend { "S-bend" } else { "bends" };
    Case { name: format!("drawn {index}: {} in {shape} of {radius:.0} m", vehicle.id), vehicle, corridor }
}

fn s_bend_of(draw: &mut Draw, radius: f64) -> Bends {
    let side = draw.sign();
    let transition = draw.between(0.1, 0.5) * radius.min(100.0);
    let arcs = [draw.between(0.2, 0.8) * radius, draw.between(0.2, 0.8) * radius];
    vec![
        (transition, side / radius),
        (arcs[0], side / radius),
        (2.0 * transition, -side / radius),
        (arcs[1], -side / radius),
        (transition, 0.0),
    ]
}

/// Windows around the sharpest bends of a file's roads, each with a vehicle.
pub fn mapped(file: &Path, count: usize) -> Vec<Case> {
    let countries = Countries::load().unwrap();
    let (network, ..) = read_network(file, &countries, &Silent, &mut Summary::default()).unwrap();
    let stem = file.file_name().unwrap().to_string_lossy().into_owned();
    let wheels = ["EU-SEMI16.5", "US-WB67", "AU-BDOUBLE26", "EU-EMS25-D", "AU-ATRIPLE53", "BUS-ART18-EU"];
    windows(&network)
        .into_iter()
        .filter(|window| window.len() == WINDOW)
        // Every seventh window: all sorts of bends, not only the sharpest.
        .step_by(7)
        .take(count)
        .enumerate()
        .map(|(i, corridor)| {
            let vehicle = unshrunk(fleet::vehicle(wheels[i % wheels.len()]));
            Case { name: format!("{stem} {i}: {}", vehicle.id), vehicle, corridor }
        })
        .collect()
}

/// A window of each stroke around its sharpest station, those with the sharpest 30 m or more first.
fn windows(network: &Network) -> Vec<Corridor> {
    let mut all: Vec<(f64, Corridor)> = network
        .strokes
        .iter()
        .filter_map(|stroke| stroke_corridor(network, stroke, Policy::Lane, &Params::default()).ok())
        .filter_map(|made| {
            let c = made.corridor;
            let sharpest = (0..c.len()).max_by(|&a, &b| c.curvature[a].abs().total_cmp(&c.curvature[b].abs()))?;
            let first = sharpest.saturating_sub(WINDOW / 2).min(c.len().checked_sub(WINDOW)?);
            Some((c.curvature[sharpest].abs(), slice(&c, first..first + WINDOW)))
        })
        .filter(|(curvature, _)| (1.0 / 300.0..1.0 / 30.0).contains(curvature))
        .collect();
    all.sort_by(|a, b| b.0.total_cmp(&a.0));
    all.into_iter().map(|(_, corridor)| corridor).collect()
}

fn slice(c: &Corridor, range: std::ops::Range<usize>) -> Corridor {
    let of = |column: &[f64]| column[range.clone()].to_vec();
    Corridor {
        spacing_m: c.spacing_m,
        x: of(&c.x),
        y: of(&c.y),
        heading: of(&c.heading),
        curvature: of(&c.curvature),
        left_m: of(&c.left_m),
        right_m: of(&c.right_m),
        areas: Vec::new(),
    }
}
