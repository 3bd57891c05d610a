//! Eq. 10 to 15: the follower's reachable set, and the ellipse meant to hold its sway.

use super::ellipse::{EllipseMatrix, Stet};
use super::plane::{V2, along, dot, link_direction, perp};
use super::reading::{As, Reading};
use super::system::System;

/// Eq. 11: −L û(t, δ), the displacement from leader to follower, metres. Over δ ∈ [−θ, θ] it is the set 𝓗.
#[must_use]
pub fn reach_displacement(e: V2, sway_rad: f64, link_m: f64) -> V2 {
    along([0.0; 2], -link_m, link_direction(e, sway_rad))
}

/// Eq. 12 and 13: D = q_{i+1}|δ − q_{i+1}|₀ = L((1 − cos δ) û(0) − sin δ û^⊥(0)), metres.
#[must_use]
pub fn sway_displacement(e: V2, sway_rad: f64, link_m: f64) -> V2 {
    let (sin, cos) = sway_rad.sin_cos();
    along([link_m * (1.0 - cos) * e[0], link_m * (1.0 - cos) * e[1]], -link_m * sin, perp(e))
}

/// Eq. 14: a = L(1 − cos θ) and b = L sin θ, metres.
#[must_use]
pub fn peak_sways_m(link_m: f64, sway_rad: f64) -> (f64, f64) {
    (link_m * (1.0 - sway_rad.cos()), link_m * sway_rad.sin())
}

/// Eq. 15: Q^lim. As printed, U = [û, û^⊥]ᵀ, which turns the ellipse the wrong way (E3). `None` if the hinge does not
/// sway: the ellipse is then a point, which no Q describes.
#[must_use]
pub fn sway_shape(e: V2, link_m: f64, sway_rad: f64, rotation: As) -> Option<EllipseMatrix> {
    let (a, b) = peak_sways_m(link_m, sway_rad);
    let axis = match rotation {
        // U D Uᵀ with U = Rᵀ is the rotation by the opposite angle.
        As::Printed => [e[0], -e[1]],
        As::Repaired => e,
    };
    (a > 0.0 && b > 0.0).then(|| EllipseMatrix::from_semi_axes(axis, a, b))
}

/// 𝓔^lim of Eq. 16 for a leader at `q`. As printed its centre is q − L û(0). Repaired its centre is q − L cos θ û(0),
/// where the same ellipse holds the whole arc (E2).
#[must_use]
pub fn sway_ellipse(q: V2, e: V2, system: &System, reading: &Reading) -> Option<Stet> {
    let shape = sway_shape(e, system.link_m, system.sway_rad, reading.rotation)?;
    let behind_m = match reading.sway_centre {
        As::Printed => system.link_m,
        As::Repaired => system.link_m * system.sway_rad.cos(),
    };
    Some(Stet { centre: along(q, -behind_m, e), shape })
}

/// Eq. 10: whether p ∈ 𝓜 = 𝓔_i ⊕ 𝓗. That means the leader may stand where some δ ∈ [−θ, θ] brings the follower to p. δ
/// is searched to a thousandth of a radian.
#[must_use]
pub fn in_reachable_set(leader: &Stet, e: V2, system: &System, p: V2) -> bool {
    let holds = |sway: f64| leader.holds(along(p, system.link_m, link_direction(e, sway)));
    let steps = (system.sway_rad / 1e-3).ceil().max(1.0) as i32;
    let aim = aimed_sway(leader, e, p).clamp(-system.sway_rad, system.sway_rad);
    holds(aim) || (-steps..=steps).any(|i| holds(system.sway_rad * f64::from(i) / f64::from(steps)))
}

/// The δ at which the link from p points at the leader's centre.
fn aimed_sway(leader: &Stet, e: V2, p: V2) -> f64 {
    let d = along(leader.centre, -1.0, p);
    dot(perp(e), d).atan2(dot(e, d))
}

#[cfg(test)]
mod tests {
    use super::*;

    const SYSTEM: System = System { trailers: 1, link_m: 4.0, sway_rad: 0.4, length_m: 8.0, width_m: 2.5 };
    const E: V2 = [0.6, 0.8];

    #[test]
    fn displacements_are_differences_of_places() {
        for sway in [-0.4, -0.1, 0.0, 0.25, 0.4] {
            let (bent, straight) = (reach_displacement(E, sway, 4.0), reach_displacement(E, 0.0, 4.0));
            let d = sway_displacement(E, sway, 4.0);
            assert!((bent[0] - straight[0] - d[0]).abs() < 1e-12 && (bent[1] - straight[1] - d[1]).abs() < 1e-12);
        }
        let (a, b) = peak_sways_m(4.0, 0.4);
        let d = sway_displacement(E, -0.4, 4.0);
        assert!((dot(d, E) - a).abs() < 1e-12 && (dot(d, perp(E)) - b).abs() < 1e-12);
    }

    #[test]
    fn followers_are_in_the_reachable_set_and_others_are_not() {
        let leader = Stet { centre: [1.0, 2.0], shape: EllipseMatrix::from_semi_axes(E, 0.5, 0.2) };
        for p in leader.outline(24) {
            for sway in [-0.39, 0.0, 0.39] {
                let inner = along(leader.centre, 0.99, along(p, -1.0, leader.centre));
                assert!(in_reachable_set(&leader, E, &SYSTEM, along(inner, 1.0, reach_displacement(E, sway, 4.0))));
            }
        }
        assert!(!in_reachable_set(&leader, E, &SYSTEM, along(leader.centre, 1.0, reach_displacement(E, 0.9, 4.0))));
        assert!(!in_reachable_set(&leader, E, &SYSTEM, leader.centre));
    }
}
