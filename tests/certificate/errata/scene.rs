//! Vehicles and roads that the tests share.

use netcert::corridor::Corridor;
use netcert::published::{
    Permissible, Reading, RouteCert, Scenario, Stet, System, TimedRoute, drawn_route, route_cert, scenarios,
};
use netcert::speed_profile::SpeedProfile;

use netcert_testing::oracle::path::{V2, along};

pub(crate) const NOTHING: Permissible = Permissible { max_shift_m: 0.0, min_shrink: 1.0 };

pub(crate) fn scenario(number: u32) -> Scenario {
    scenarios().unwrap().into_iter().find(|s| s.number == number).unwrap()
}

pub(crate) fn route(corridor: &Corridor) -> TimedRoute {
    TimedRoute::new(corridor, &SpeedProfile::default())
}

/// The drawn route of 543.62 m.
pub(crate) fn drawn(w_min_m: f64) -> Corridor {
    drawn_route().unwrap().corridor(w_min_m)
}

/// An arc to the left of `length_m` metres, with stations half a metre apart.
pub(crate) fn arc(radius: f64, length_m: f64, half_m: f64) -> Corridor {
    let stations = (2.0 * length_m) as usize + 1;
    Corridor::from_curvature(0.5, [0.0; 2], 0.0, &vec![1.0 / radius; stations], half_m, half_m)
}

/// The centreline shifted to the left.
pub(crate) fn shifted(route: &TimedRoute, by_m: f64) -> Vec<V2> {
    (0..route.len()).map(|i| along(route.centre[i], by_m, route.normal(i))).collect()
}

pub(crate) fn run(
    system: &System,
    route: &TimedRoute,
    path: &[V2],
    permissible: &Permissible,
    reading: &Reading,
) -> RouteCert {
    route_cert(system, route, path, permissible, reading).unwrap()
}

/// Whether every point of the ellipse lies between the edges, each point at its own foot. No formula of the paper is
/// used.
pub(crate) fn is_on_the_road(route: &TimedRoute, stet: &Stet, near: usize) -> bool {
    stet.outline(720).into_iter().all(|p| {
        let foot = route.foot(p, near);
        foot.lateral_m.abs() <= route.half_width_at_m(&foot)
    })
}
