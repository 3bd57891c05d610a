//! The run-in: deviations of axles after any length of straight driving (docs/proof.md, section 8).
//!
//! The straight gains are those of the linear chain. The second order adds to them, on a straight, the least bound that
//! reproduces itself. Every sweep starts from that bound, and so does every stretch behind a place where the bounds did
//! not close.

use super::lanes::{Vector, by_instruction_set};
use super::model::MAX_UNITS;
use super::step::{self, MOST, Step, Straying, UnitLanes, hitch_remainder, remainder};

/// Most rounds to find a bound that reproduces itself. Each round at least halves the distance to it, if there is one.
const ROUNDS: usize = 64;
/// Each guess is raised by this factor and these metres.
const RAISED: f64 = 1.0 + 1e-4;
const RAISED_M: f64 = 1e-9;

by_instruction_set! {
    /// What the second order adds to the straight bound of each unit's axle, metres. It is [`MOST`] from the first unit on
    /// for which no bound reproduces itself. `tolerance` is the steer axle's; units behind the first `units` are stand-ins.
    pub(super) fn settled<V>(chain: &[UnitLanes<V>; MAX_UNITS], units: usize, tolerance: V) -> [V; MAX_UNITS] {
        let straight = &Step::STRAIGHT;
        let mut settled = [V::ZERO; MAX_UNITS];
        let mut straying = Straying::of_the_steer_axle(tolerance);
        let mut coupling = V::ZERO;
        for (unit, of) in chain.iter().enumerate().take(units) {
            let mut y = V::ZERO;
            for _ in 0..ROUNDS {
                let next = implied(of, coupling, y);
                let raised = (y - next).if_negative(next * RAISED + RAISED_M, y);
                if raised.array() == y.array() {
                    break;
                }
                y = raised;
            }
            let y = (y - implied(of, coupling, y)).if_negative(V::splat(MOST), y).min(V::splat(MOST));
            settled[unit] = y;
            let a = heading(of, coupling, y);
            let (r1, _) = remainder(of, straight, a, of.axle + y, of.coupling + coupling);
            straying = straying.next(of, straight, a);
            let follower = chain.get(unit + 1).map(|next| (next, straight));
            let zh = hitch_remainder(of, straight, follower, a, of.axle + y, r1, &straying);
            coupling = ((of.ratio + 1.0).abs() * y + of.ratio.abs() * coupling + zh).min(V::splat(MOST));
        }
        settled
    }
}

/// The bound of a unit's heading, if the second order adds `coupling` and `y` to the bounds of its coupling and its axle.
#[inline(always)]
fn heading<V: Vector>(of: &UnitLanes<V>, coupling: V, y: V) -> V {
    let first_order = (of.heading + (coupling + y) * of.inverse_length).min(V::splat(MOST));
    let (a, short) = step::heading(of, &Step::STRAIGHT, first_order, of.axle + y, of.coupling + coupling);
    short.if_negative(V::splat(MOST), a)
}

/// What the second order then adds to the bound of the axle.
#[inline(always)]
fn implied<V: Vector>(of: &UnitLanes<V>, coupling: V, y: V) -> V {
    let (_, z) = remainder(of, &Step::STRAIGHT, heading(of, coupling, y), of.axle + y, of.coupling + coupling);
    (coupling + z).min(V::splat(MOST))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::super::group::Group;
    use super::super::lanes::Portable;
    use super::super::model::Model;
    use super::*;
    use netcert_base::vehicle::Catalogue;

    #[test]
    fn the_second_order_of_a_straight_is_millimetres_for_catalogued_vehicles() {
        for vehicle in Catalogue::builtin().unwrap().iter() {
            let model = Model::new(vehicle).unwrap();
            let group = Group::<Portable>::new(&[(&model, 1.0)]);
            let last = group.chain[group.units - 1].settled.lane(0);
            assert!((0.0..0.03).contains(&last), "{}: {last}", vehicle.id);
        }
    }

    #[test]
    fn a_vehicle_whose_trailers_sway_too_far_has_no_bound_on_a_straight() {
        let mut vehicle = Catalogue::builtin().unwrap().get("AU-ATRIPLE53").unwrap().clone();
        for unit in &mut vehicle.units {
            unit.sway_rad = 0.2;
        }
        let model = Model::new(&vehicle).unwrap();
        let group = Group::<Portable>::new(&[(&model, 1.0)]);
        assert_eq!(group.chain[group.units - 1].settled.lane(0), MOST);
    }
}
