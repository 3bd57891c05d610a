//! Algorithm 1, ROUTE_CERT, line by line. It corrects each instant by itself, without smoothness, and leaves the rest
//! to CERT.

use super::corrections::{Permissible, corrcen, shrink};
use super::ellipse::{EllipseMatrix, Stet};
use super::kinematics::KinematicChain;
use super::leeway::{Leeway, boundary_leeway};
use super::plane::{V2, along, minus, perp};
use super::reading::Reading;
use super::route::TimedRoute;
use super::rsc::{Rsc, cert};
use super::system::System;

/// The correction that lines 10 to 21 made at an instant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Correction {
    /// Line 20: there was leeway on both sides.
    None,
    /// Line 17: shifting the centre was enough.
    Centre,
    /// Lines 14 and 15: shift and shrink. The algorithm does not test whether that was enough.
    CentreAndShape,
}

/// One instant of the loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoopInstant {
    /// η of the last trailer, line 9.
    pub before: Leeway,
    /// η of the last trailer with q̃_0(i) and Q̃_0(i), after all corrections.
    pub after: Leeway,
    /// The correction made.
    pub correction: Correction,
    /// Δq_0 along the left normal, metres.
    pub shift_m: f64,
    /// γ_0.
    pub gamma: f64,
}

/// The result of Algorithm 1, with intermediate values.
#[derive(Debug, Clone, PartialEq)]
pub struct RouteCert {
    /// 𝒞 and its parts.
    pub rsc: Rsc,
    /// Corrected tubes 𝓔_i(q̃_i, Q̃_i) of all units: `[unit][instant]`. The first one is the prime mover's plan.
    pub tubes: Vec<Vec<Stet>>,
    /// One entry per instant.
    pub steps: Vec<LoopInstant>,
    /// The nominal motion: q_i, ê_i and δ_i.
    pub chain: KinematicChain,
}

impl RouteCert {
    /// 𝓔_i(q̃_i(t), Q̃_i(t)) of a unit at any t (seconds); q and Q are linear between instants. `None` outside [0, T]
    /// or for a unit that does not exist. `route` must be the route of this certificate.
    #[must_use]
    pub fn tube_at(&self, route: &TimedRoute, unit: usize, t_s: f64) -> Option<Stet> {
        let (i, fraction) = route.instant(t_s)?;
        let tube = self.tubes.get(unit)?;
        let before = tube.get(i)?;
        let after = tube.get(i + 1).unwrap_or(before);
        Some(Stet {
            centre: along(before.centre, fraction, minus(after.centre, before.centre)),
            shape: before.shape.combined(1.0 - fraction, &after.shape, fraction),
        })
    }
}

/// ROUTE_CERT(Σ, 𝓡(t), Ω, Ξ). `path` is q_0(t), nominally the route's centre, with one point per instant. `None` if the
/// route is empty or `path` has another length.
#[must_use]
pub fn route_cert(
    system: &System,
    route: &TimedRoute,
    path: &[V2],
    permissible: &Permissible,
    reading: &Reading,
) -> Option<RouteCert> {
    if route.is_empty() || path.len() != route.len() {
        return None;
    }
    let chain = KinematicChain::follow(system, path, route.tangent[0], reading);
    // Line 1: Safe and Unsafe are one bool, known in line 24.
    let mut tubes = vec![Vec::with_capacity(path.len()); system.trailers + 1];
    let mut steps = Vec::with_capacity(path.len());
    // Line 2.
    for (i, &q0) in path.iter().enumerate() {
        let at = Instant { system, route, chain: &chain, reading, i };
        let (step, prime) = at.corrected(q0, permissible);
        for (tube, stet) in tubes.iter_mut().zip(at.propagated(&prime)) {
            tube.push(stet);
        }
        steps.push(step);
    }
    // Line 23. Lines 24 to 28 are `Rsc::printed_safe`.
    let rsc = cert(route, &tubes, reading)?;
    Some(RouteCert { rsc, tubes, steps, chain })
}

/// One pass of the loop.
struct Instant<'a> {
    system: &'a System,
    route: &'a TimedRoute,
    chain: &'a KinematicChain,
    reading: &'a Reading,
    i: usize,
}

impl Instant<'_> {
    /// Lines 3 to 21: q̃_0(i), Q̃_0(i).
    fn corrected(&self, q0: V2, permissible: &Permissible) -> (LoopInstant, Stet) {
        let (i, reading) = (self.i, self.reading);
        // Lines 3 and 4.
        let heading = self.chain.link[0][i].direction;
        let nominal = Stet { centre: q0, shape: self.system.prime_shape(heading, reading.body) };
        // Lines 5 to 9. The normals of Def. 5 belong to the boundary; line 6 takes them from the direction of motion
        // ê_n. For a trailer that drives along the route, both are the route's normal at the foot.
        let before = self.leeway(&nominal);
        let uncorrected = LoopInstant { before, after: before, correction: Correction::None, shift_m: 0.0, gamma: 1.0 };
        // Lines 10 and 20.
        if before.least_m() > 0.0 {
            return (uncorrected, nominal);
        }
        // Line 11: "shift prime mover center opposite to last trailer violation side".
        let normal = perp(heading);
        let shift_m = corrcen(&before, permissible);
        let centred = Stet { centre: along(q0, shift_m, normal), ..nominal };
        // Line 12.
        let after = self.leeway(&centred);
        // Lines 13 and 17.
        if after.least_m() > 0.0 {
            return (LoopInstant { after, correction: Correction::Centre, shift_m, ..uncorrected }, centred);
        }
        // Lines 14 and 15.
        let (gamma, shape) = shrink(&nominal.shape, &after, normal, permissible, reading.radius);
        let shrunk = Stet { shape, ..centred };
        let after = self.leeway(&shrunk);
        (LoopInstant { before, after, correction: Correction::CentreAndShape, shift_m, gamma }, shrunk)
    }

    /// The tubes of all units, through Ω and Ξ.
    fn propagated(&self, prime: &Stet) -> impl Iterator<Item = Stet> + use<> {
        let centres = self.chain.omega(self.i, prime.centre);
        let shapes: Vec<EllipseMatrix> = self.chain.xi(self.i, &prime.shape, self.system, self.reading);
        centres.into_iter().zip(shapes).map(|(centre, shape)| Stet { centre, shape })
    }

    /// η_l and η_r of the last trailer.
    fn leeway(&self, prime: &Stet) -> Leeway {
        let last = self.propagated(prime).last().unwrap_or(*prime);
        boundary_leeway(self.route, &last, self.i, self.reading)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use netcert_base::corridor::Corridor;
    use netcert_base::speed_profile::SpeedProfile;

    const SYSTEM: System = System { trailers: 2, link_m: 4.0, sway_rad: 0.05, length_m: 8.0, width_m: 2.5 };
    const NONE: Permissible = Permissible { max_shift_m: 0.0, min_shrink: 1.0 };

    fn straight(half_m: f64) -> TimedRoute {
        TimedRoute::new(&Corridor::straight(60.0, half_m, half_m), &SpeedProfile::default())
    }

    #[test]
    fn on_a_straight_the_certificate_is_the_room_beyond_the_longest_radius() {
        let route = straight(6.0);
        let run = route_cert(&SYSTEM, &route, &route.centre, &NONE, &Reading::SIMULATED).unwrap();
        let last = &run.tubes[2][30].shape;
        assert!(run.rsc.h_omega_m < 1e-12);
        assert!((run.rsc.rsc_m - (6.0 - last.largest_radius_m())).abs() < 1e-12);
        // Tangent along the lateral normal: 1.25 + 2 · 4 sin 0.05.
        let tangent = Reading { beta: crate::published::Beta::Tangent, ..Reading::SIMULATED };
        let run = route_cert(&SYSTEM, &route, &route.centre, &NONE, &tangent).unwrap();
        let lateral = 1.25 + 2.0 * 4.0 * 0.05f64.sin();
        assert!((run.steps[30].before.left_m - (6.0 - lateral)).abs() < 1e-9);
        assert!(run.steps.iter().all(|s| s.correction == Correction::None && s.before == s.after));
    }

    #[test]
    fn on_a_steady_circle_the_offset_is_the_off_tracking() {
        let corridor = Corridor::from_curvature(0.5, [0.0; 2], 0.0, &[1.0 / 50.0; 400], 9.0, 9.0);
        let route = TimedRoute::new(&corridor, &SpeedProfile::default());
        let run = route_cert(&SYSTEM, &route, &route.centre, &NONE, &Reading::SIMULATED).unwrap();
        let expected = 50.0 - (2500.0f64 - 32.0).sqrt();
        assert!((run.rsc.h_omega_m - expected).abs() < 1e-3, "{} not {expected}", run.rsc.h_omega_m);
    }

    #[test]
    fn tubes_are_functions_of_time() {
        let route = straight(6.0);
        let run = route_cert(&SYSTEM, &route, &route.centre, &NONE, &Reading::SIMULATED).unwrap();
        let speed = SpeedProfile::default().limit_m_s;
        let halfway = run.tube_at(&route, 2, 30.5 / speed).unwrap();
        assert!((halfway.centre[0] - 22.5).abs() < 1e-9 && halfway.shape.distance(&run.tubes[2][30].shape) < 1e-12);
        let end = run.tube_at(&route, 0, *route.t_s.last().unwrap()).unwrap();
        assert!((end.centre[0] - 60.0).abs() < 1e-9);
        assert!(run.tube_at(&route, 0, -0.1).is_none() && run.tube_at(&route, 3, 0.0).is_none());
    }

    #[test]
    fn corrections_come_in_the_order_of_the_lines() {
        let tangent = Reading { beta: crate::published::Beta::Tangent, ..Reading::SIMULATED };
        let lateral = 1.25 + 2.0 * 4.0 * 0.05f64.sin();
        let allowed = Permissible { max_shift_m: 1.0, min_shrink: 0.5 };
        let off_centre = |half_m: f64, by: f64| {
            let route = straight(half_m);
            let path: Vec<V2> = route.centre.iter().map(|c| [c[0], c[1] + by]).collect();
            route_cert(&SYSTEM, &route, &path, &allowed, &tangent).unwrap().steps[30]
        };
        let centred = off_centre(lateral + 0.2, 0.6);
        assert_eq!((centred.correction, centred.gamma), (Correction::Centre, 1.0));
        assert!((centred.shift_m + 0.6).abs() < 1e-9 && (centred.after.least_m() - 0.2).abs() < 1e-9);
        let shrunk = off_centre(lateral - 0.3, 0.0);
        assert_eq!(shrunk.correction, Correction::CentreAndShape);
        assert!((shrunk.gamma - (1.0 - 0.3 / 1.25)).abs() < 1e-9 && shrunk.after.least_m() > -1e-9);
        assert!(route_cert(&SYSTEM, &straight(3.0), &[], &allowed, &tangent).is_none());
    }
}
