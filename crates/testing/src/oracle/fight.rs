//! Certificates of turns and passages against the adversary: the best path and another one.

use netcert::certify::best_of;
use netcert::stet::{Model, Options};
use netcert::turns::TurnCorridors;

use super::draw::Draw;
use super::{area_attack, attack, claim, fleet};

/// Paths with less leeway are not attacked, metres.
const HOPELESS_M: f64 = -3.0;
/// Places of the bodies that are attacked where areas count.
const PLACES: usize = 4;

/// Drives the vehicle along the best path and along another one on the road, one `part`th of the way through them, with
/// all attacks. Returns the number of claims that held.
///
/// # Panics
/// If a claim is refuted. The message begins with `what`.
pub fn none_is_refuted(made: &TurnCorridors, id: &str, part: usize, what: &str, draw: &mut Draw) -> usize {
    let vehicle = fleet::vehicle(id);
    let model = Model::new(&vehicle).expect("the oracle's vehicles are possible ones");
    let best = best_of(made, &[&model], &Options::default()).pop().flatten();
    let mut others = made.on_road();
    let other = (!others.is_empty()).then(|| others.swap_remove(others.len() / part));
    let mut held = 0;
    for path in best.map(|(path, _)| path).into_iter().chain(other) {
        let Some(claim) = claim::certify(&path.corridor, &vehicle).filter(|claim| claim.rsc_m >= HOPELESS_M) else {
            continue;
        };
        if !path.corridor.areas.is_empty() {
            let refuted = area_attack::attack_areas(&path.corridor, &vehicle, &claim, draw, PLACES).refutes(&claim);
            assert!(refuted.is_none(), "{what} {id}: {refuted:?}");
            held += 1;
            continue;
        }
        let (gap_m, outcome) = attack::margin_m(&path.corridor, &vehicle, &claim, draw, 1);
        assert!(gap_m > -2e-5, "{what} {id}: {gap_m} {}", attack::describe(&outcome));
        held += 1;
    }
    held
}
