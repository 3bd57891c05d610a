//! Algorithm 1 and the Theorem: E14 to E16, E18, E19.

use netcert::corridor::Corridor;
use netcert::published::{
    As, Beta, Correction, KinematicChain, Offset, Permissible, Reading, Stet, System, bound_m, boundary_leeway, cert,
    worst_side,
};
use netcert::stet::{self, Model, Options};
use netcert::stop::Stop;

use super::scene::{drawn, route, run, scenario};
use netcert_testing::oracle::path::V2;

const TANGENT: Reading = Reading { beta: Beta::Tangent, ..Reading::SIMULATED };

/// Corollary (i) compares q̃_N with q̃_0, and Ω moves both equally.
#[test]
fn e14_no_center_correction_changes_the_certificate() {
    let s = scenario(5);
    let route = route(&drawn(3.0));
    let by = |max_shift_m, offset| {
        let permissible = Permissible { max_shift_m, min_shrink: 1.0 };
        run(&s.system, &route, &route.centre, &permissible, &Reading { offset, ..Reading::SIMULATED })
    };
    let (still, moved) = (by(0.0, Offset::SameInstant), by(1.5, Offset::SameInstant));
    let count = moved.steps.iter().filter(|step| step.shift_m != 0.0).count();
    println!("E14: shifted at {count} instants; 𝒞 {:.6} and {:.6} m", still.rsc.rsc_m, moved.rsc.rsc_m);
    assert!(count > 20 && (still.rsc.rsc_m - moved.rsc.rsc_m).abs() < 1e-9);
    // Measured from the road, as it must be, the shift shows.
    assert!((by(0.0, Offset::FromRoute).rsc.rsc_m - by(1.5, Offset::FromRoute).rsc.rsc_m).abs() > 0.01);
}

/// Eq. 21 can only hold where nothing needs a correction.
#[test]
fn e15_the_theorem_speaks_only_of_instants_that_need_no_correction() {
    let permissible = Permissible::default();
    let (mut asked, mut helped) = (0, 0);
    for (w_min_m, number) in [(5.0, 5), (4.0, 1), (4.5, 3), (6.0, 6), (3.3, 7)] {
        let s = scenario(number);
        let route = route(&drawn(w_min_m));
        let run = run(&s.system, &route, &route.centre, &permissible, &Reading::SIMULATED);
        for (i, step) in run.steps.iter().enumerate().filter(|(_, step)| step.correction != Correction::None) {
            let nominal = s.system.prime_shape(run.chain.link[0][i].direction, As::Printed);
            let before = run.chain.xi(i, &nominal, &s.system, &Reading::SIMULATED);
            let last = run.tubes.last().unwrap()[i].shape;
            let bound = bound_m(&s.system, &permissible, before.last().unwrap(), &last, As::Printed);
            asked += 1;
            helped += usize::from(worst_side(&step.before) >= bound);
            assert!(bound >= 0.0, "the right side of Eq. 21 is never negative");
        }
    }
    println!("E15: {asked} instants in need of a correction, the Theorem applies to {helped}");
    assert!(asked > 500 && helped == 0);
}

/// The tube is the body (Def. 4's Q_0 from the "prime mover dimensions"), so SHRINK cuts off parts of the lorry.
#[test]
fn e16_shrinking_certifies_a_vehicle_through_a_road_narrower_than_its_body() {
    let system = System { trailers: 2, link_m: 4.0, sway_rad: 0.01, length_m: 2.6, width_m: 2.6 };
    let corridor = Corridor::straight(80.0, 1.0, 1.0);
    let route = route(&corridor);
    let run = run(&system, &route, &route.centre, &Permissible::default(), &TANGENT);
    let gamma = run.steps.iter().fold(1.0f64, |least, step| least.min(step.gamma));
    // Def. 6 permits any γ down to γ_0^min. The missing room needs 0.71 and leaves 𝒞 at 0 up to rounding.
    let permitted = Permissible::default().min_shrink;
    let tube = |unit: usize| {
        let at = |i: usize| {
            let shape = system.prime_shape(route.tangent[i], As::Printed).shrunk(permitted);
            let shapes = run.chain.xi(i, &shape, &system, &TANGENT);
            Stet { centre: run.chain.centre[unit][i], shape: shapes[unit] }
        };
        (0..route.len()).map(at).collect()
    };
    let rsc = cert(&route, &[tube(0), tube(1), tube(2)], &TANGENT).unwrap();
    println!(
        "E16: bodies 2.6 m wide in 2.0 m: γ {gamma:.3} 𝒞 {:.3} m; γ {permitted} 𝒞 {:.3} m",
        run.rsc.rsc_m, rsc.rsc_m
    );
    assert!(run.rsc.rsc_m > -1e-9 && gamma < 0.75);
    assert!(rsc.printed_safe() && rsc.rsc_m > 0.5);
    let model = Model::new(&system.vehicle("wide")).unwrap();
    let decided = stet::certify(&corridor, &model, &Options::default(), &Stop::never()).unwrap().unwrap().result;
    assert!(decided.rsc_m.unwrap() < -0.29 && !decided.safe(), "netcert shrinks a tolerance, never a body");
}

/// Line 12 moves q_N with q_0 at once. A rolling trailer follows a shift only after it has rolled on.
#[test]
fn e18_the_last_trailer_does_not_move_when_the_prime_mover_does() {
    let s = scenario(3);
    let route = route(&drawn(5.0));
    let permissible = Permissible { min_shrink: 1.0, ..Permissible::default() };
    let run = run(&s.system, &route, &route.centre, &permissible, &TANGENT);
    let driven: Vec<V2> = run.tubes[0].iter().map(|stet| stet.centre).collect();
    let chain = KinematicChain::follow(&s.system, &driven, route.tangent[0], &TANGENT);
    let first = run.steps.iter().position(|step| step.shift_m != 0.0).unwrap();
    let (promised, last) = (run.steps[first].after.least_m(), s.system.trailers);
    let really = Stet { centre: chain.centre[last][first], ..run.tubes[last][first] };
    let really = boundary_leeway(&route, &really, first, &TANGENT).least_m();
    let before = run.steps[first].before.least_m();
    println!(
        "E18: first corrected instant: leeway {before:.3} m before, {promised:.3} m by line 12, {really:.3} m by rolling"
    );
    assert!(promised > 0.1 && really < before + 0.02);
}

/// Def. 1 requires q_i ∈ C¹, but each instant is corrected separately.
#[test]
fn e19_the_corrected_path_jumps() {
    let s = scenario(5);
    let coarse = drawn(5.0);
    let halved = |c: &Corridor| {
        let double = |v: &[f64]| -> Vec<f64> {
            let middle = v.windows(2).flat_map(|w| [w[0], 0.5 * (w[0] + w[1])]);
            middle.chain(v.last().copied()).collect()
        };
        let line = Corridor::from_curvature(0.5 * c.spacing_m, [0.0; 2], 0.0, &double(&c.curvature), 1.0, 1.0);
        Corridor { left_m: double(&c.left_m), right_m: double(&c.right_m), ..line }
    };
    let permissible = Permissible { min_shrink: 1.0, ..Permissible::default() };
    let jump = |corridor: &Corridor| {
        let route = route(corridor);
        let run = run(&s.system, &route, &route.centre, &permissible, &Reading::SIMULATED);
        run.steps.windows(2).map(|w| (w[1].shift_m - w[0].shift_m).abs()).fold(0.0, f64::max)
    };
    let (first, second) = (halved(&coarse), halved(&halved(&coarse)));
    let jumps = [jump(&coarse), jump(&first), jump(&second)];
    println!("E19: greatest step of Δq_0 from one instant to the next at 1, 0.5, 0.25 m: {jumps:.3?} m");
    assert!(jumps.iter().all(|&j| j > 0.25), "a jump does not shrink with the step: {jumps:?}");
    // netcert's plan is smooth: its steps halve with the spacing.
    let plan = |corridor: &Corridor| {
        let model = Model::new(&s.system.vehicle("S5")).unwrap();
        let shift = stet::certify(corridor, &model, &Options::default(), &Stop::never()).unwrap().unwrap().shift_m;
        shift.windows(2).map(|w| (w[1] - w[0]).abs()).fold(0.0, f64::max)
    };
    let lane = drawn(1.7);
    let (whole, half) = (plan(&lane), plan(&halved(&lane)));
    println!("     netcert in a lane of 3.4 m: {whole:.4} and {half:.4} m");
    assert!(whole > 0.0 && half < 0.7 * whole);
}
