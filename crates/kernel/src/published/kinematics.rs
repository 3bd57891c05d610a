//! Def. 4: the kinematic maps κ_i and ι_i of one hinge. Ω and Ξ compose them over a sway tuple δ̂.
//!
//! Eq. 5b lets ι_i depend on δ_i. Eq. 15 to 18, which define ι_i, stand at δ = 0, so there is no such dependence.

use super::ellipse::EllipseMatrix;
use super::plane::{V2, along, dot, link_direction, minus, perp, unit_or};
use super::reach::sway_shape;
use super::reading::{As, Reading, Sway};
use super::sum::{kurzhanski_varaiya, optimal_beta};
use super::system::System;

/// κ_i, Eq. 5a and 6: q_{i+1} = q_i − L û_i(t, δ_i), metres.
#[must_use]
pub fn follower_centre(q: V2, e: V2, sway_rad: f64, link_m: f64) -> V2 {
    along(q, -link_m, link_direction(e, sway_rad))
}

/// ι_i, Eq. 5b by Eq. 15, 17 and 18: Q_{i+1} from Q_i, with the leader moving along ê.
#[must_use]
pub fn follower_shape(shape: &EllipseMatrix, e: V2, system: &System, reading: &Reading) -> EllipseMatrix {
    let Some(limit) = sway_shape(e, system.link_m, system.sway_rad, reading.rotation) else { return *shape };
    let beta = optimal_beta(shape, &limit, perp(e), reading.beta);
    kurzhanski_varaiya(shape, &limit, beta)
}

/// One hinge at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Link {
    /// ê_i(t), a unit vector.
    pub direction: V2,
    /// δ_i(t), radians.
    pub sway_rad: f64,
}

/// The motion of the whole vehicle along a path of the prime mover, as Ω and Ξ need it at every instant.
#[derive(Debug, Clone, PartialEq)]
pub struct KinematicChain {
    /// q_i(t): `[unit][instant]`, metres.
    pub centre: Vec<Vec<V2>>,
    /// ê_i(t) and δ_i(t) of hinge i, between units i and i + 1: `[hinge][instant]`. One more entry holds the last
    /// unit's own direction of motion (δ = 0).
    pub link: Vec<Vec<Link>>,
    /// L, or its replacement where the sway ellipse is recentred (E2).
    link_m: f64,
}

impl KinematicChain {
    /// Follows the prime mover's path `q0`. The vehicle enters along `entry` with all units in line.
    #[must_use]
    pub fn follow(system: &System, q0: &[V2], entry: V2, reading: &Reading) -> Self {
        let link_m = match (reading.sway, reading.sway_centre) {
            (Sway::Zero, As::Repaired) => system.link_m * system.sway_rad.cos(),
            _ => system.link_m,
        };
        let mut chain = Self { centre: vec![q0.to_vec()], link: Vec::new(), link_m };
        let mut directions = velocities(q0, entry);
        for hinge in 0..system.trailers {
            let q = &chain.centre[hinge];
            let sways = match reading.sway {
                Sway::Zero => vec![0.0; q.len()],
                Sway::NoSlip => no_slip_sway(q, &directions, entry, link_m),
            };
            let links = directions.iter().zip(&sways).map(|(&direction, &sway_rad)| Link { direction, sway_rad });
            let links: Vec<Link> = links.collect();
            let follow = |(&q, link): (&V2, &Link)| follower_centre(q, link.direction, link.sway_rad, link_m);
            let follower: Vec<V2> = q.iter().zip(&links).map(follow).collect();
            // A rolling axle moves along its link. With δ = 0 throughout, it moves as its positions say instead.
            directions = match reading.sway {
                Sway::Zero => velocities(&follower, entry),
                Sway::NoSlip => links.iter().map(|l| link_direction(l.direction, l.sway_rad)).collect(),
            };
            chain.centre.push(follower);
            chain.link.push(links);
        }
        chain.link.push(directions.into_iter().map(|direction| Link { direction, sway_rad: 0.0 }).collect());
        chain
    }

    /// Ω(t, δ̂(t)) at instant `i` (Eq. 8a, 8c): the centres of all units for the prime mover's centre `q0`.
    #[must_use]
    pub fn omega(&self, i: usize, q0: V2) -> Vec<V2> {
        let mut centres = vec![q0];
        let mut q = q0;
        for links in &self.link[..self.link.len() - 1] {
            q = follower_centre(q, links[i].direction, links[i].sway_rad, self.link_m);
            centres.push(q);
        }
        centres
    }

    /// Ξ(t, δ̂(t)) at instant `i` (Eq. 8b, 8d): the shapes of all units from the prime mover's shape.
    #[must_use]
    pub fn xi(&self, i: usize, shape: &EllipseMatrix, system: &System, reading: &Reading) -> Vec<EllipseMatrix> {
        let mut shapes = vec![*shape];
        let mut q = *shape;
        for links in &self.link[..self.link.len() - 1] {
            q = follower_shape(&q, links[i].direction, system, reading);
            shapes.push(q);
        }
        shapes
    }

    /// Whether δ̂(t) ∈ Θ at every instant (Assumption 1). Algorithm 1 does not test it.
    #[must_use]
    pub fn sways_are_allowed(&self, system: &System) -> bool {
        self.link.iter().flatten().all(|link| link.sway_rad.abs() <= system.sway_rad)
    }
}

/// Unit velocity vectors along a path, by central differences inside and one-sided differences at the ends.
fn velocities(path: &[V2], entry: V2) -> Vec<V2> {
    let last = path.len().saturating_sub(1);
    let mut before = entry;
    let at = |i: usize| {
        let step = minus(path[(i + 1).min(last)], path[i.saturating_sub(1)]);
        before = unit_or(step, before);
        before
    };
    (0..path.len()).map(at).collect()
}

/// δ_i(t) of an axle that rolls without slip `link_m` behind a hinge. The hinge moves along `path` in the `directions`.
/// Each step is exact for a straight step of the hinge: tan(β/2) falls by exp(−ℓ/L), with β the angle from link to
/// step.
#[must_use]
pub fn no_slip_sway(path: &[V2], directions: &[V2], entry: V2, link_m: f64) -> Vec<f64> {
    let angle = |from: V2, to: V2| dot(perp(from), to).atan2(dot(from, to));
    let mut link = entry;
    let mut sways = Vec::with_capacity(path.len());
    for (i, &direction) in directions.iter().enumerate() {
        if i > 0 {
            let step = minus(path[i], path[i - 1]);
            let along = unit_or(step, link);
            let half = (0.5 * angle(link, along)).tan() * (-step[0].hypot(step[1]) / link_m).exp();
            link = link_direction(along, -2.0 * half.atan());
        }
        sways.push(angle(direction, link));
    }
    sways
}

#[cfg(test)]
mod tests {
    use super::*;

    const SYSTEM: System = System { trailers: 2, link_m: 5.0, sway_rad: 0.3, length_m: 8.0, width_m: 2.5 };

    fn circle(radius: f64, arc_m: f64) -> Vec<V2> {
        (0..(arc_m / 0.05) as usize)
            .map(|i| (i as f64 * 0.05 / radius).sin_cos())
            .map(|(s, c)| [radius * s, radius * (1.0 - c)])
            .collect()
    }

    fn steady_radius(reading: &Reading) -> f64 {
        let chain = KinematicChain::follow(&SYSTEM, &circle(40.0, 150.0), [1.0, 0.0], reading);
        let q = &chain.centre[2];
        // Away from the end, where velocities are one-sided.
        let p = q[q.len() - 20];
        p[0].hypot(p[1] - 40.0)
    }

    #[test]
    fn rolling_axles_cut_in_on_a_steady_circle_by_the_closed_form() {
        let radius = steady_radius(&Reading::SIMULATED);
        assert!((radius - (1600.0f64 - 50.0).sqrt()).abs() < 1e-3, "{radius}");
    }

    #[test]
    fn without_sway_the_printed_map_swings_them_out() {
        let radius = steady_radius(&Reading::PRINTED);
        assert!((radius - (1600.0f64 + 50.0).sqrt()).abs() < 1e-3, "{radius}");
    }

    #[test]
    fn on_a_straight_all_units_are_in_line() {
        let path: Vec<V2> = (0..100).map(|i| [f64::from(i), 0.0]).collect();
        for reading in [Reading::PRINTED, Reading::SIMULATED] {
            let chain = KinematicChain::follow(&SYSTEM, &path, [1.0, 0.0], &reading);
            for i in [0, 50, 99] {
                assert_eq!(chain.centre[2][i], [i as f64 - 10.0, 0.0]);
                assert_eq!(chain.omega(i, path[i])[2], chain.centre[2][i]);
            }
            assert!(chain.sways_are_allowed(&SYSTEM));
        }
    }

    #[test]
    fn the_composed_maps_give_back_the_chain() {
        let path = circle(30.0, 60.0);
        for reading in [Reading::PRINTED, Reading::SIMULATED] {
            let chain = KinematicChain::follow(&SYSTEM, &path, [1.0, 0.0], &reading);
            for i in (0..path.len()).step_by(100) {
                for (unit, q) in chain.omega(i, path[i]).into_iter().enumerate() {
                    let gap = minus(q, chain.centre[unit][i]);
                    assert!(gap[0].hypot(gap[1]) < 1e-9);
                }
            }
        }
    }
}
