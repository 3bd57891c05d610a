//! 𝒞 compared with its claimed guarantee, Eq. 22: E4, E5, E7, and hinges that are never tested (E20).

use netcert::corridor::Corridor;
use netcert::published::{As, Beta, Offset, Reading, System, TimedRoute, cert};
use netcert::stet::{self, Model, Options};
use netcert::stop::Stop;

use super::scene::{NOTHING, arc, is_on_the_road, route, run, scenario, shifted};

/// As long as wide, so that r_N^max over all directions (E7) hides nothing.
const STUBBY: System = System { trailers: 2, link_m: 4.0, sway_rad: 0.02, length_m: 2.6, width_m: 2.6 };
const TIGHT: Reading = Reading { beta: Beta::Tangent, body: As::Printed, ..Reading::SIMULATED };

#[test]
fn e04_printed_certificate_calls_a_vehicle_safe_that_drives_over_the_edge() {
    let route = route(&Corridor::straight(80.0, 2.0, 2.0));
    let path = shifted(&route, 1.5);
    let by = |offset| run(&STUBBY, &route, &path, &NOTHING, &Reading { offset, ..TIGHT });
    let (printed, repaired) = (by(Offset::SameInstant), by(Offset::FromRoute));
    println!(
        "E4: 1.5 m off the centre of 4 m: 𝒞 printed {:.3} m, repaired {:.3} m",
        printed.rsc.rsc_m, repaired.rsc.rsc_m
    );
    assert!(printed.rsc.printed_safe() && by(Offset::OwnFeet).rsc.printed_safe());
    assert!(!is_on_the_road(&route, &printed.tubes[2][40], 40), "Eq. 22 does not hold");
    assert!(!repaired.rsc.printed_safe());
}

#[test]
fn e05_a_prime_mover_outside_the_road_does_not_count() {
    let system = System { trailers: 3, link_m: 6.0, sway_rad: 0.01, length_m: 2.6, width_m: 2.6 };
    let route = route(&arc(30.0, 150.0, 3.0));
    // The prime mover swings out by as much as the last trailer cuts in.
    let path = shifted(&route, -1.9);
    let by = |units| {
        let reading = Reading { units, offset: Offset::FromRoute, ..TIGHT };
        let run = run(&system, &route, &path, &NOTHING, &reading);
        // The run-in is left out, because the last trailer has not cut in there yet.
        let steady: Vec<_> = run.tubes.iter().map(|tube| tube[200..].to_vec()).collect();
        let rest = TimedRoute {
            t_s: route.t_s[150..].to_vec(),
            centre: route.centre[150..].to_vec(),
            tangent: route.tangent[150..].to_vec(),
            half_width_m: route.half_width_m[150..].to_vec(),
            ..route.clone()
        };
        (cert(&rest, &steady, &reading).unwrap().rsc_m, run)
    };
    let ((last_only, run), (all, _)) = (by(As::Printed), by(As::Repaired));
    println!("E5: 𝒞 of the last trailer {last_only:.3} m, of all units {all:.3} m");
    assert!(last_only >= 0.0 && all < 0.0);
    assert!(!is_on_the_road(&route, &run.tubes[0][250], 250));
    assert!(is_on_the_road(&route, &run.tubes[3][250], 240));
}

#[test]
fn e07_half_a_body_length_to_either_side_is_asked_for_on_a_straight() {
    let system = scenario(1).system;
    let corridor = Corridor::straight(120.0, 3.5, 3.5);
    let route = route(&corridor);
    let by = |room| run(&system, &route, &route.centre, &NOTHING, &Reading { room, ..TIGHT }).rsc;
    let (printed, across) = (by(As::Printed), by(As::Repaired));
    let model = Model::new(&system.vehicle("S1")).unwrap();
    let decided = stet::certify(&corridor, &model, &Options::default(), &Stop::never()).unwrap().unwrap().result;
    println!(
        "E7: straight, 7 m wide, a vehicle 2.6 m wide: 𝒞 {:.3} m, with room across the road only {:.3} m, RSC {:.3} m",
        printed.rsc_m,
        across.rsc_m,
        decided.rsc_m.unwrap()
    );
    assert!(printed.rsc_m < -2.0 && across.rsc_m > 0.0);
    assert!((decided.rsc_m.unwrap() - (3.5 - 1.3)).abs() < 0.01 && decided.safe());
}

/// Eq. 12 to 18 bound δ by θ, but nothing computes the δ that a bend needs.
#[test]
fn e20_a_bend_that_the_hinges_cannot_follow_is_certified() {
    let system = scenario(5).system;
    let corridor = arc(18.0, 90.0, 8.3);
    let route = route(&corridor);
    let run = run(&system, &route, &route.centre, &NOTHING, &Reading::SIMULATED);
    let most = run.chain.link.iter().flatten().fold(0.0f64, |most, link| most.max(link.sway_rad.abs()));
    println!("E20: scenario 5's vehicle at 18 m: 𝒞 {:.3} m, δ up to {:.1}° of 12.4°", run.rsc.rsc_m, most.to_degrees());
    assert!(run.rsc.printed_safe());
    assert!(!run.chain.sways_are_allowed(&system));
    let model = Model::new(&system.vehicle("S5")).unwrap();
    let decided = stet::certify(&corridor, &model, &Options { max_shift_m: 0.0, correction_sweeps: 0 }, &Stop::never())
        .unwrap()
        .unwrap()
        .result;
    assert!(decided.hinge_margin_rad.unwrap() < 0.0 && !decided.safe());
}
