//! A certificate over a whole corridor against the adversary.

use netcert::corridor::Corridor;
use netcert::stet::{Certificate, Side};
use netcert::vehicle::Vehicle;

use super::claim::{BodyPoint, Claim};
use super::draw::Draw;
use super::{area_attack, attack};

/// Errors of RK4 at 0.1 m and of the plan's cubic, as in `tests/certificate/soundness.rs`.
const ALLOWANCE_M: f64 = 2e-5;
/// Places of the bodies that are attacked where areas count.
const PLACES: usize = 8;

/// Asserts that the adversary finds nothing below the RSC, and no hinge beyond its margin.
pub fn hold(vehicle: &Vehicle, corridor: &Corridor, certificate: &Certificate, seed: u64) {
    let claim = claim(corridor, certificate);
    if !corridor.areas.is_empty() {
        let found = area_attack::attack_areas(corridor, vehicle, &claim, &mut Draw(seed), PLACES);
        let length_m = corridor.len() as f64 * corridor.spacing_m;
        println!("{length_m:.0} m, RSC {:.3} m, least room found {:.3} m", claim.rsc_m, found.least_m());
        let refuted = found.refutes(&claim);
        assert!(refuted.is_none(), "{refuted:?}");
        return;
    }
    let (gap_m, outcome) = attack::margin_m(corridor, vehicle, &claim, &mut Draw(seed), 2);
    let length_m = corridor.len() as f64 * corridor.spacing_m;
    println!("{length_m:.0} m, RSC {:.3} m, {}", claim.rsc_m, attack::describe(&outcome));
    assert!(gap_m >= -ALLOWANCE_M, "RSC {:.4} m refuted: {}", claim.rsc_m, attack::describe(&outcome));
    assert!(outcome.hinge.0 >= claim.hinge_margin_rad - 1e-6);
}

/// Places of all bodies on a drive under disturbances that the certificate allows, metres in the corridor's frame.
pub fn driven(vehicle: &Vehicle, corridor: &Corridor, certificate: &Certificate, draw: &mut Draw) -> Vec<[f64; 2]> {
    let claim = claim(corridor, certificate);
    let path = attack::path(corridor, vehicle, &claim);
    attack::Attack::new(corridor, vehicle, &path, claim.shrink).driven(draw)
}

fn claim(corridor: &Corridor, certificate: &Certificate) -> Claim {
    let result = &certificate.result;
    let at = &result.limiting;
    let limiting = BodyPoint {
        foot_m: at.station as f64 * corridor.spacing_m,
        unit: at.unit,
        side: if at.side == Side::Left { 1.0 } else { -1.0 },
        ahead_m: at.point_m,
    };
    let plan = certificate.plan.clone();
    let (rsc_m, shrink, hinge_margin_rad) = (result.rsc_m.unwrap(), result.shrink, result.hinge_margin_rad.unwrap());
    Claim { rsc_m, shrink, hinge_margin_rad, limiting, plan }
}
