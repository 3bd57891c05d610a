//! Ellipses: E1 to E3, E6, E9, and the evidence of Table I itself (E12, E13).

use netcert::published::{
    As, Beta, EllipseMatrix, Reading, System, follower_shape, kurzhanski_varaiya, optimal_beta, peak_sways_m,
    reach_displacement, scenarios, sway_ellipse, sway_shape,
};

use super::scene::{drawn, route, run, scenario};
use netcert_testing::oracle::path::{V2, along, dot, left_of};

const EAST: V2 = [1.0, 0.0];
const TILTED: V2 = [0.8, 0.6];

/// Q_1 behind a prime mover that heads east.
fn first_trailer(system: &System, beta: Beta) -> EllipseMatrix {
    let reading = Reading { beta, ..Reading::SIMULATED };
    follower_shape(&system.prime_shape(EAST, As::Printed), EAST, system, &reading)
}

#[test]
fn e01_the_printed_beta_multiplies_the_body_at_every_hinge() {
    let system = scenario(1).system;
    let growth = |beta| first_trailer(&system, beta).largest_radius_m() / system.prime_radius_m(As::Printed);
    let (printed, least, tangent) = (growth(Beta::Printed), growth(Beta::TraceOptimal), growth(Beta::Tangent));
    println!("E1: scenario 1, first hinge: printed × {printed:.3}, least trace × {least:.3}, tangent × {tangent:.3}");
    assert!(printed > 2.9, "{printed}");
    assert!(least < 1.07, "{least}");

    let shape = system.prime_shape(EAST, As::Printed);
    let limit = sway_shape(EAST, system.link_m, system.sway_rad, As::Repaired).unwrap();
    let trace = |beta| kurzhanski_varaiya(&shape, &limit, beta).inverse().trace();
    let at = |rule| trace(optimal_beta(&shape, &limit, [0.0, 1.0], rule));
    println!("    trace of (Q^b)⁻¹: printed {:.1} m², least {:.1} m²", at(Beta::Printed), at(Beta::TraceOptimal));
    assert!(at(Beta::Printed) > 6.0 * at(Beta::TraceOptimal));
}

#[test]
fn e01_the_printed_beta_has_the_largest_tube_behind_the_stiffest_hinge() {
    let stiff = |sway_deg: f64| System { sway_rad: f64::to_radians(sway_deg), ..scenario(1).system };
    let radius = |sway_deg: f64, beta| first_trailer(&stiff(sway_deg), beta).largest_radius_m();
    for beta in [Beta::Printed, Beta::TraceOptimal] {
        println!(
            "E1: θ 9.4°, 1°, 0.1°: {:?} {:.2} {:.2} {:.2} m",
            beta,
            radius(9.4, beta),
            radius(1.0, beta),
            radius(0.1, beta)
        );
    }
    assert!(radius(0.1, Beta::Printed) > 9.0 * radius(9.4, Beta::Printed));
    assert!(radius(0.1, Beta::TraceOptimal) < radius(9.4, Beta::TraceOptimal));
    assert!((radius(0.1, Beta::TraceOptimal) - 5.6).abs() < 0.01, "without sway the tube is the body's");
}

/// With nothing corrected, because SHRINK would hide the effect of β° (E16).
#[test]
fn e01_only_the_repaired_beta_gives_the_papers_verdicts() {
    let safe = |beta| -> Vec<u32> {
        let reading = Reading { beta, ..Reading::SIMULATED };
        let of = |s: &netcert::published::Scenario| {
            let route = route(&drawn(s.w_min_m));
            run(&s.system, &route, &route.centre, &super::scene::NOTHING, &reading).rsc
        };
        scenarios().unwrap().iter().filter(|s| of(s).printed_safe()).map(|s| s.number).collect()
    };
    assert_eq!(safe(Beta::Printed), Vec::<u32>::new());
    assert_eq!(safe(Beta::TraceOptimal), [1, 3, 5]);
}

#[test]
fn e02_the_sway_ellipse_holds_the_arc_only_where_it_is_centred_on_the_chord() {
    for s in scenarios().unwrap() {
        let ellipse = |sway_centre| {
            let reading = Reading { sway_centre, ..Reading::SIMULATED };
            sway_ellipse([0.0; 2], TILTED, &s.system, &reading).unwrap()
        };
        let on_arc = |share: f64| reach_displacement(TILTED, share * s.system.sway_rad, s.system.link_m);
        let form = |p: V2| ellipse(As::Printed).shape.form(along(p, -1.0, ellipse(As::Printed).centre));
        assert!((form(on_arc(1.0)) - 2.0).abs() < 1e-6, "the end of the arc is at (a, b): ψᵀQψ = 2");
        assert!(!ellipse(As::Printed).holds(on_arc(1.0)));
        let repaired = ellipse(As::Repaired);
        for k in -1000..=1000 {
            let p = on_arc(f64::from(k) / 1000.0);
            let value = repaired.shape.form(along(p, -1.0, repaired.centre));
            assert!(value <= 1.0 + 1e-9, "scenario {}: {value} at {k}", s.number);
        }
    }
}

#[test]
fn e02_the_repair_holds_for_every_hinge_up_to_a_right_angle() {
    for k in 1..=180 {
        let system = System { sway_rad: f64::to_radians(0.5 * f64::from(k)), ..scenario(1).system };
        let reading = Reading { sway_centre: As::Repaired, ..Reading::SIMULATED };
        let ellipse = sway_ellipse([0.0; 2], EAST, &system, &reading).unwrap();
        for j in -200..=200 {
            let p = reach_displacement(EAST, system.sway_rad * f64::from(j) / 200.0, system.link_m);
            assert!(ellipse.shape.form(along(p, -1.0, ellipse.centre)) <= 1.0 + 1e-6, "θ {}°", 0.5 * f64::from(k));
        }
    }
}

#[test]
fn e03_the_printed_rotation_turns_the_sway_ellipse_away_from_the_arc() {
    let system = scenario(1).system;
    let beyond = |rotation| {
        let reading = Reading { rotation, sway_centre: As::Repaired, ..Reading::SIMULATED };
        let ellipse = sway_ellipse([0.0; 2], TILTED, &system, &reading).unwrap();
        let value = |k: i32| {
            let p = reach_displacement(TILTED, system.sway_rad * f64::from(k) / 100.0, system.link_m);
            ellipse.shape.form(along(p, -1.0, ellipse.centre))
        };
        (-100..=100).map(value).fold(0.0, f64::max)
    };
    println!(
        "E3: heading (0.8, 0.6): greatest ψᵀQψ on the arc, printed {:.1}, repaired {:.3}",
        beyond(As::Printed),
        beyond(As::Repaired)
    );
    assert!(beyond(As::Printed) > 100.0);
    assert!(beyond(As::Repaired) <= 1.0 + 1e-9);
    // Along the axes of the page the fault does not show.
    let east = |rotation| sway_shape(EAST, 4.0, 0.2, rotation).unwrap();
    assert_eq!(east(As::Printed), east(As::Repaired));
}

#[test]
fn e06_the_ellipse_of_half_the_dimensions_leaves_the_corners_out() {
    for s in scenarios().unwrap() {
        let corners = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)].map(|(x, y)| {
            along(
                [0.5 * x * s.system.length_m * TILTED[0], 0.5 * x * s.system.length_m * TILTED[1]],
                0.5 * y * s.system.width_m,
                left_of(TILTED),
            )
        });
        for corner in corners {
            assert!((s.system.prime_shape(TILTED, As::Printed).form(corner) - 2.0).abs() < 1e-9);
            assert!(s.system.prime_shape(TILTED, As::Repaired).form(corner) <= 1.0 + 1e-9);
        }
    }
}

#[test]
fn e09_the_printed_support_radius_lets_a_tilted_ellipse_over_the_edge() {
    let shape = EllipseMatrix::from_semi_axes(TILTED, 5.6, 1.3);
    let n = [0.0, 1.0];
    let reach = netcert::published::Stet { centre: [0.0; 2], shape }
        .outline(7200)
        .iter()
        .map(|&p| dot(p, n))
        .fold(0.0, f64::max);
    let [printed, repaired] = [As::Printed, As::Repaired].map(|r| shape.support_radius_m(n, r));
    println!(
        "E9: 5.6 × 1.3 m at 37°: printed {printed:.3} m, support {repaired:.3} m, reach of its points {reach:.3} m"
    );
    assert!(printed < 0.5 * reach, "{printed} of {reach}");
    assert!((repaired - reach).abs() < 1e-5);
    // The printed radius is never too large, and it is right on the axes and in the supremum: 𝒞 itself is unaffected.
    for k in 0..360 {
        let (s, c) = (f64::from(k) * 0.01745).sin_cos();
        assert!(shape.support_radius_m([c, s], As::Printed) <= shape.support_radius_m([c, s], As::Repaired) + 1e-12);
    }
    let greatest = |r| {
        (0..3600)
            .map(|k| f64::from(k) * 1.745e-3)
            .map(|t| shape.support_radius_m([t.cos(), t.sin()], r))
            .fold(0.0, f64::max)
    };
    assert!((greatest(As::Printed) - greatest(As::Repaired)).abs() < 1e-4);
}

/// The sum of Eq. 16 reaches r_0 + N·a along the vehicle, and every ellipse around it reaches at least as far.
#[test]
fn e12_table_ones_h_xi_is_less_than_any_bound_of_eq_16_can_have() {
    for s in scenarios().unwrap() {
        let (a, _) = peak_sways_m(s.system.link_m, s.system.sway_rad);
        let r_0 = s.system.prime_radius_m(As::Printed);
        let least = 1.0 + s.system.trailers as f64 * a / r_0;
        let through = |beta| {
            let reading = Reading { beta, ..Reading::SIMULATED };
            let start = s.system.prime_shape(EAST, As::Printed);
            (0..s.system.trailers).fold(start, |q, _| follower_shape(&q, EAST, &s.system, &reading)).largest_radius_m()
                / r_0
        };
        println!(
            "E12: scenario {}: h_Ξ {:.3} in the table, at least {least:.3}; least trace {:.3}",
            s.number,
            s.h_xi,
            through(Beta::TraceOptimal)
        );
        assert!(s.h_xi < least, "scenario {}", s.number);
        for beta in [Beta::Printed, Beta::TraceOptimal, Beta::Tangent] {
            assert!(through(beta) >= least, "scenario {}, {beta:?}", s.number);
        }
    }
}

/// Bodies of length 𝒟 around axles L apart.
#[test]
fn e13_the_bodies_of_table_one_stand_in_each_other() {
    for s in scenarios().unwrap() {
        println!(
            "E13: scenario {}: bodies of {} m, {} m from one to the next",
            s.number, s.system.length_m, s.system.link_m
        );
        assert!(s.system.length_m > 2.0 * s.system.link_m, "scenario {}", s.number);
    }
}
