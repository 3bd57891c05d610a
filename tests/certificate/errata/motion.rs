//! Def. 4 in bends: E8, and the direction of a trailer's tube (E21).

use netcert::published::{As, Reading, Stet, Sway, System, follower_shape};
use netcert::stet::steady_offtracking;

use super::scene::{NOTHING, arc, route, run};
use netcert_testing::oracle::path::{V2, along, dot, left_of};

const SYSTEM: System = System { trailers: 3, link_m: 5.0, sway_rad: 0.2, length_m: 9.0, width_m: 2.5 };

/// Lateral offset of the last unit at the end of a long arc to the left, positive inwards.
fn inwards_m(sway: Sway) -> f64 {
    let route = route(&arc(40.0, 200.0, 6.0));
    let run = run(&SYSTEM, &route, &route.centre, &NOTHING, &Reading { sway, ..Reading::SIMULATED });
    let i = route.len() - 60;
    route.foot(run.tubes[3][i].centre, i).lateral_m
}

#[test]
fn e08_without_articulation_trailers_leave_the_bend_on_the_wrong_side() {
    let (printed, rolling) = (inwards_m(Sway::Zero), inwards_m(Sway::NoSlip));
    // The prime mover of `vehicle` has a link of its own; the paper's q_0 is its rear axle.
    let vehicle = System { trailers: 2, ..SYSTEM }.vehicle("three links");
    let closed = steady_offtracking(&vehicle, 40.0).unwrap();
    println!(
        "E8: three links of 5 m at 40 m: printed {printed:.3} m, rolling {rolling:.3} m, closed form {closed:.3} m inwards"
    );
    assert!((printed - (40.0 - (1600.0f64 + 75.0).sqrt())).abs() < 0.01, "√(R² + ΣL²): outwards");
    assert!((rolling - closed).abs() < 0.01);
}

/// If θ bounds real sway (rubber, wind, crossfall), the printed tube does not hold the rolling axle.
#[test]
fn e08_the_tube_around_zero_sway_does_not_hold_a_rolling_axle() {
    let slip = System { sway_rad: f64::to_radians(1.0), ..SYSTEM };
    let route = route(&arc(40.0, 200.0, 6.0));
    let by = |sway| run(&slip, &route, &route.centre, &NOTHING, &Reading { sway, ..Reading::SIMULATED });
    let (printed, rolling) = (by(Sway::Zero), by(Sway::NoSlip));
    let i = route.len() - 60;
    // The tube of positions alone: the prime mover is a point on its path.
    let tube = |run: &netcert::published::RouteCert| {
        let e = run.chain.link[0][i].direction;
        let point = netcert::published::EllipseMatrix::from_semi_axes(e, 1e-3, 1e-3);
        let shapes = run.chain.xi(i, &point, &slip, &Reading::SIMULATED);
        Stet { centre: run.tubes[3][i].centre, shape: shapes[3] }
    };
    let axle = rolling.chain.centre[3][i];
    assert!(!tube(&printed).holds(axle));
    assert!(tube(&rolling).holds(axle));
}

/// Ξ turns Q^lim, but the shape that it is added to keeps the prime mover's heading.
#[test]
fn e21_a_trailers_tube_points_where_the_prime_mover_does() {
    let system = System { trailers: 2, link_m: 6.0, sway_rad: f64::to_radians(2.0), length_m: 12.0, width_m: 2.5 };
    let route = route(&arc(15.0, 120.0, 7.0));
    let reading = Reading { body: As::Repaired, ..Reading::SIMULATED };
    let run = run(&system, &route, &route.centre, &NOTHING, &reading);
    let i = route.len() - 40;
    let stet = run.tubes[2][i];
    let own = run.chain.link[2][i].direction;
    let corners = |of: V2| -> Vec<V2> {
        let at = |x: f64, y: f64| along(along(stet.centre, x, of), y, left_of(of));
        vec![at(6.0, 1.25), at(6.0, -1.25), at(-6.0, 1.25), at(-6.0, -1.25)]
    };
    let apart = dot(run.chain.link[0][i].direction, own).acos().to_degrees();
    let outside = corners(own).into_iter().filter(|&c| !stet.holds(c)).count();
    println!(
        "E21: at 15 m the last trailer heads {apart:.1}° off the prime mover: {outside} of its corners outside its tube"
    );
    assert!(apart > 20.0);
    assert!(outside == 4, "even with semi-axes that hold the corners (E6)");
    // Propagated in the trailer's own heading, the tube would hold the corners.
    let turned = (0..2).fold(system.prime_shape(own, As::Repaired), |q, _| follower_shape(&q, own, &system, &reading));
    assert!(corners(own).into_iter().all(|c| Stet { shape: turned, ..stet }.holds(c)));
}
