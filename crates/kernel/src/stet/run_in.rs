//! The run-in: deviations of axles after any length of straight driving (docs/proof.md, section 8).
//!
//! The straight gains are those of the linear chain. The second order adds to them, on a straight, the least bound that
//! reproduces itself. Every sweep starts from that bound, and so does every stretch behind a place where the bounds did
//! not close.

use super::lanes::{V, ZERO, select_negative};
use super::model::MAX_UNITS;
use super::step::{self, MOST, Step, Straying, UnitLanes, hitch_remainder, remainder};

/// Most rounds to find a bound that reproduces itself. Each round at least halves the distance to it, if there is one.
const ROUNDS: usize = 64;
/// Each guess is raised by this factor and these metres.
const RAISED: f64 = 1.0 + 1e-4;
const RAISED_M: f64 = 1e-9;

/// What the second order adds to the straight bound of each unit's axle, metres. It is [`MOST`] from the first unit on
/// for which no bound reproduces itself. `tolerance` is the steer axle's; units behind the first `units` are stand-ins.
pub(super) fn settled(chain: &[UnitLanes; MAX_UNITS], units: usize, tolerance: V) -> [V; MAX_UNITS] {
    let mut settled = [ZERO; MAX_UNITS];
    let mut straying = Straying::of_the_steer_axle(tolerance);
    let mut coupling = ZERO;
    for (unit, of) in chain.iter().enumerate().take(units) {
        let heading = |y: V| {
            let first_order = (of.heading + (coupling + y) * of.inverse_length).min(V::splat(MOST));
            let (a, short) = step::heading(of, &Step::STRAIGHT, first_order, of.axle + y, of.coupling + coupling);
            select_negative(short, V::splat(MOST), a)
        };
        let implied = |y: V| {
            (coupling + remainder(of, &Step::STRAIGHT, heading(y), of.axle + y, of.coupling + coupling).1)
                .min(V::splat(MOST))
        };
        let mut y = ZERO;
        for _ in 0..ROUNDS {
            let next = implied(y);
            let raised = select_negative(y - next, next * RAISED + RAISED_M, y);
            if raised.0 == y.0 {
                break;
            }
            y = raised;
        }
        let y = select_negative(y - implied(y), V::splat(MOST), y).min(V::splat(MOST));
        settled[unit] = y;
        let a = heading(y);
        let (r1, _) = remainder(of, &Step::STRAIGHT, a, of.axle + y, of.coupling + coupling);
        straying = straying.next(of, &Step::STRAIGHT, a);
        let follower = chain.get(unit + 1).map(|next| (next, &Step::STRAIGHT));
        let zh = hitch_remainder(of, &Step::STRAIGHT, follower, a, of.axle + y, r1, &straying);
        coupling = ((of.ratio + 1.0).abs() * y + of.ratio.abs() * coupling + zh).min(V::splat(MOST));
    }
    settled
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::super::group::Group;
    use super::super::model::Model;
    use super::*;
    use netcert_base::vehicle::Catalogue;

    #[test]
    fn the_second_order_of_a_straight_is_millimetres_for_catalogued_vehicles() {
        for vehicle in Catalogue::builtin().unwrap().iter() {
            let model = Model::new(vehicle).unwrap();
            let group = Group::new(&[(&model, 1.0)]);
            let last = group.chain[group.units - 1].settled.0[0];
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
        let group = Group::new(&[(&model, 1.0)]);
        assert_eq!(group.chain[group.units - 1].settled.0[0], MOST);
    }
}
