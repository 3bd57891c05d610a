//! Def. 5, Eq. 19 and 20: boundary leeway.

use super::ellipse::Stet;
use super::plane::{dot, minus};
use super::reading::{As, Reading};
use super::route::{Foot, TimedRoute};

/// (η_l, η_r), metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Leeway {
    /// η_l.
    pub left_m: f64,
    /// η_r.
    pub right_m: f64,
}

impl Leeway {
    /// min(η_l, η_r), metres.
    #[must_use]
    pub fn least_m(&self) -> f64 {
        self.left_m.min(self.right_m)
    }
}

/// Eq. 19: ζ − r on both sides. The foot of the ellipse is searched from station `near`.
///
/// r_l and r_r are taken along the normals at the foot. Def. 5 gives r a normal by time and ζ a normal by place; only
/// at the foot are both the same.
#[must_use]
pub fn boundary_leeway(route: &TimedRoute, tube: &Stet, near: usize, reading: &Reading) -> Leeway {
    let foot = route.foot(tube.centre, near);
    let radius = tube.shape.support_radius_m(foot.normal, reading.radius);
    let [left, right] = offsets(route, tube, &foot, reading);
    Leeway { left_m: left - radius, right_m: right - radius }
}

/// Eq. 20: ζ_l and ζ_r. Each of its faults (E10, E11) can be kept or repaired separately.
fn offsets(route: &TimedRoute, tube: &Stet, foot: &Foot, reading: &Reading) -> [f64; 2] {
    let outward = match reading.normals {
        As::Printed => -1.0,
        As::Repaired => 1.0,
    };
    match reading.boundary {
        As::Repaired => {
            let half = route.half_width_at_m(foot);
            [outward * (half - foot.lateral_m), outward * (half + foot.lateral_m)]
        }
        As::Printed => {
            let least = |sign: f64, edge: &dyn Fn(usize) -> [f64; 2]| {
                let offset = |i: usize| outward * sign * dot(minus(edge(i), tube.centre), route.normal(i));
                (0..route.len()).map(offset).fold(f64::INFINITY, f64::min)
            };
            [least(1.0, &|i| route.left(i)), least(-1.0, &|i| route.right(i))]
        }
    }
}
