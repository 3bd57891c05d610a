//! Def. 2 and 5: E10, E11, and the strip 𝓡(t) (E17).

use netcert::corridor::Corridor;
use netcert::published::{As, EllipseMatrix, Offset, Reading, Stet, System, boundary_leeway};

use super::scene::{NOTHING, arc, is_on_the_road, route, run};
use netcert_testing::oracle::path::along;

const POINT_M: f64 = 1e-6;

/// An ellipse so small that leeway is its centre's distance from the edges.
fn point(centre: [f64; 2]) -> Stet {
    Stet { centre, shape: EllipseMatrix::from_semi_axes([1.0, 0.0], POINT_M, POINT_M) }
}

#[test]
fn e10_with_inward_normals_a_point_in_the_middle_has_negative_leeway() {
    let route = route(&Corridor::straight(100.0, 4.0, 4.0));
    let leeway = |normals| boundary_leeway(&route, &point([50.0, 0.0]), 50, &Reading { normals, ..Reading::SIMULATED });
    let (printed, repaired) = (leeway(As::Printed), leeway(As::Repaired));
    println!("E10: in the middle of 8 m: printed {:.3} m, outward {:.3} m", printed.left_m, repaired.left_m);
    assert!((printed.left_m + 4.0).abs() < 1e-5 && (printed.right_m + 4.0).abs() < 1e-5);
    assert!((repaired.left_m - 4.0).abs() < 1e-5 && (repaired.right_m - 4.0).abs() < 1e-5);
}

#[test]
fn e11_the_infimum_over_the_whole_boundary_takes_the_far_side_of_the_bend() {
    let (radius, half) = (30.0, 4.0);
    let corridor = arc(radius, 45.0, half);
    let route = route(&corridor);
    let middle = point(route.centre[0]);
    let leeway = |boundary| boundary_leeway(&route, &middle, 0, &Reading { boundary, ..Reading::SIMULATED });
    let (printed, repaired) = (leeway(As::Printed), leeway(As::Repaired));
    println!(
        "E11: on the centreline of an arc of 30 m: printed {:.2} and {:.2} m, at the foot {:.2} and {:.2} m",
        printed.left_m, printed.right_m, repaired.left_m, repaired.right_m
    );
    // (x − q)·n̂ at the angle φ of the inner edge: R cos φ − (R − w/2); at the arc's end, φ = 1.5 rad, −23.9 m.
    assert!((printed.left_m - (radius * 1.5f64.cos() - (radius - half))).abs() < 0.01);
    assert!((repaired.left_m - half).abs() < 1e-3 && (repaired.right_m - half).abs() < 1e-3);
}

/// Eq. 3 has no end along the tangent.
#[test]
fn e17_the_strip_at_t_is_not_the_road() {
    let (radius, half, i) = (40.0, 3.0, 60);
    let route = route(&arc(radius, 60.0, half));
    // One place on the road, 25 m behind; another on the tangent, far off the road.
    let behind = route.centre[10];
    assert!(!route.holds(i, behind), "a trailer 25 m behind on the centreline is outside 𝓡(t)");
    let field = along(route.centre[i], 25.0, route.tangent[i]);
    let foot = route.foot(field, i);
    println!(
        "E17: on the tangent 25 m ahead in an arc of 40 m: {:.2} m off the centreline, inside 𝓡(t)",
        foot.lateral_m
    );
    assert!(route.holds(i, field) && foot.lateral_m.abs() > 2.0 * half);
    assert!(!is_on_the_road(&route, &point(field), i));
    assert!(is_on_the_road(&route, &point(behind), 10));
}

/// The same fault in Corollary (i): for a trailer that follows the centreline to the centimetre, h_Ω contains the
/// road's own bend.
#[test]
fn e17_h_omega_at_one_instant_measures_the_bend_of_the_road() {
    let system = System { trailers: 1, link_m: 10.0, sway_rad: 0.3, length_m: 8.0, width_m: 2.5 };
    let route = route(&arc(100.0, 150.0, 6.0));
    let h_omega =
        |offset| run(&system, &route, &route.centre, &NOTHING, &Reading { offset, ..Reading::SIMULATED }).rsc.h_omega_m;
    let (printed, feet) = (h_omega(Offset::SameInstant), h_omega(Offset::OwnFeet));
    println!("E17: 10 m of link at 100 m: h_Ω printed {printed:.3} m, of which off-tracking is {feet:.3} m");
    assert!((feet - (100.0 - (1e4f64 - 100.0).sqrt())).abs() < 2e-3);
    assert!((printed - 2.0 * feet).abs() < 0.01, "half of it is the road's: L²/2R twice");
}
