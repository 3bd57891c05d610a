//! Tests of the oracle alone: its order of accuracy, its adversary's reach, its roads. `soundness.rs` compares it with
//! the certifier.

use netcert_testing::oracle;

use netcert_testing::oracle::adversary::{AdversaryBounds, PushTarget, kernel};
use netcert_testing::oracle::draw::{self, Draw};
use netcert_testing::oracle::path::{Path, V2, along, dot, left_of};
use netcert_testing::oracle::road::{self, PreparedCorridor};
use netcert_testing::oracle::simulator::{Disturbance, MAX_UNITS, SimulatedDrive};
use netcert_testing::oracle::{draw::Bends, fleet};

fn plan(bends: &Bends) -> Vec<V2> {
    let kappa = draw::curvature(bends);
    let wide = vec![5.0; kappa.len()];
    let c = road::corridor(1.0, [0.0; 2], 0.0, &kappa, &wide, &wide);
    c.x.iter().zip(&c.y).map(|(&x, &y)| [x, y]).collect()
}

fn loop_exit(radius: f64) -> Bends {
    vec![(20.0, 0.0), (8.0, 1.0 / radius), (4.0 * radius, 1.0 / radius), (8.0, 0.0), (60.0, 0.0)]
}

#[test]
fn halving_the_step_moves_the_last_axle_by_less_than_two_micrometres() {
    for (id, radius) in [("US-WB109D", 20.0), ("AU-BTRIPLE36", 20.0), ("EU-EMS25-C", 12.5), ("AGV-TUG4", 12.5)] {
        let vehicle = fleet::vehicle(id);
        let path = Path::through(&plan(&loop_exit(radius)), 1.0, (0.0, 0.0), 30.0, 60.0);
        let run = |n: usize| SimulatedDrive::new(&vehicle, &path, n).whole(&Disturbance::none(path.spans() * n));
        let (coarse, fine) = (run(10), run(20));
        let worst = (0..=path.spans())
            .map(|k| {
                let at = |run: &oracle::simulator::SimulatedRun, n: usize| {
                    let (guide, headings) = run.at(k * n);
                    SimulatedDrive::new(&vehicle, &path, n).axles(guide, headings)[vehicle.units.len() - 1]
                };
                let gap = along(at(&coarse, 10), -1.0, at(&fine, 20));
                dot(gap, gap).sqrt()
            })
            .fold(0.0, f64::max);
        println!("{id} at {radius} m: 0.1 m against 0.05 m steps: {worst:.1e} m");
        assert!(worst < 2e-6, "{id}: {worst}");
    }
}

/// 0.33 m for the rear of the last trailer of a type 2 road train with ε 0.15 m and σ 0.2° (0.336 m with the
/// catalogue's dimensions).
#[test]
fn the_adversary_reaches_the_deviation_that_the_design_promises_on_the_straight() {
    let vehicle = fleet::vehicle("AU-ATRIPLE53");
    let path = Path::through(&plan(&vec![(300.0, 0.0)]), 1.0, (0.0, 0.0), 5.0, 5.0);
    let drive = SimulatedDrive::new(&vehicle, &path, 20);
    let none = Disturbance::none(drive.steps());
    let run = drive.whole(&none);
    let target = PushTarget { step: 20 * 295, unit: 5, ahead_m: -2.8, aside_m: 1.25, push: [0.0, 1.0] };
    let kernel = kernel(&drive, &run, &none, &target, 20 * 290);
    let bounds = AdversaryBounds { steer_m: 0.15, change_m: 0.05, slip: [0.2f64.to_radians(); MAX_UNITS] };
    let attacked = drive.whole(&kernel.attack(&bounds, drive.steps()));
    let place = |run: &oracle::simulator::SimulatedRun| {
        let (guide, headings) = run.at(target.step);
        drive.body_point(guide, headings, target.unit, target.ahead_m, target.aside_m)
    };
    let moved = dot(target.push, along(place(&attacked), -1.0, place(&run)));
    println!("reach {:.4} m, attained {moved:.4} m", kernel.reach_m(&bounds));
    assert!((kernel.reach_m(&bounds) - 0.336).abs() < 1e-3);
    assert!(moved > kernel.reach_m(&bounds) - 1e-3);
}

#[test]
fn the_kernel_is_the_derivative_of_the_simulator() {
    let vehicle = fleet::vehicle("EU-EMS25-C");
    let path = Path::through(&plan(&loop_exit(14.0)), 1.0, (0.0, 0.0), 30.0, 60.0);
    let drive = SimulatedDrive::new(&vehicle, &path, 10);
    let none = Disturbance::none(drive.steps());
    let run = drive.whole(&none);
    let target = PushTarget { step: 1050, unit: 2, ahead_m: 3.0, aside_m: -1.2, push: [0.6, 0.8] };
    let kernel = kernel(&drive, &run, &none, &target, 600);
    let place = |d: &Disturbance| {
        let run = drive.whole(d);
        let (guide, headings) = run.at(target.step);
        dot(target.push, drive.body_point(guide, headings, target.unit, target.ahead_m, target.aside_m))
    };
    for back in [1usize, 37, 140, 300] {
        let step = target.step - back;
        let mut d = none.clone();
        d.steer_m[step] = 1e-5;
        let steer = (place(&d) - place(&none)) / 1e-5;
        assert!(
            (steer - kernel.steer[step - kernel.first]).abs() < 2e-3,
            "{back}: {steer} {}",
            kernel.steer[step - kernel.first]
        );
        for unit in 0..3 {
            let mut d = none.clone();
            d.slip[step][unit] = 1e-5;
            let slip = (place(&d) - place(&none)) / 1e-5;
            let promised = kernel.slip[step - kernel.first][unit];
            assert!((slip - promised).abs() < 2e-3, "{back}, unit {unit}: {slip} {promised}");
        }
    }
}

#[test]
fn a_point_is_found_again_where_it_was_put() {
    let mut draw = Draw(7);
    for _ in 0..50 {
        let bends = draw::bends(&mut draw, 15.0, 200.0);
        let corridor = draw::corridor(&mut draw, &bends, 2.0, 6.0);
        let road = PreparedCorridor::new(&corridor);
        for _ in 0..50 {
            let (s, lateral) = (draw.between(-5.0, road.length_m() + 5.0), draw.between(-6.0, 6.0));
            let (centre, tangent) = road.centre(s);
            let found = road.locate(along(centre, lateral, left_of(tangent)), s + draw.between(-3.0, 3.0));
            assert!(
                (found.foot_m - s).abs() < 1e-6 && (found.lateral_m - lateral).abs() < 1e-6,
                "{s} {lateral} {found:?}"
            );
        }
    }
}

#[test]
fn the_oracles_corridors_are_the_certifiers() {
    let mut draw = Draw(11);
    for _ in 0..50 {
        let kappa = draw::curvature(&draw::bends(&mut draw, 15.0, 300.0));
        let wide = vec![4.0; kappa.len()];
        let ours = road::corridor(1.0, [100.0, -50.0], 0.7, &kappa, &wide, &wide);
        let theirs = netcert::corridor::Corridor::from_curvature(1.0, [100.0, -50.0], 0.7, &kappa, 4.0, 4.0);
        for k in 0..ours.len() {
            assert!((ours.x[k] - theirs.x[k]).hypot(ours.y[k] - theirs.y[k]) < 1e-6, "station {k}");
        }
    }
}
