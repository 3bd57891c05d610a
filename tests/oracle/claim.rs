//! What the certifier claims of a corridor, in the oracle's words.

use netcert::corridor::Corridor;
use netcert::stet::{self, Model, Options, Side};
use netcert::vehicle::Vehicle;

use super::path::V2;

/// A certificate's claims that the oracle can try to refute.
pub struct Claim {
    pub rsc_m: f64,
    /// γ: what the steer axle keeps to is γ ε.
    pub shrink: f64,
    pub hinge_margin_rad: f64,
    pub limiting: Place,
    pub plan: Vec<V2>,
}

/// A body point whose foot is at a station.
#[derive(Debug, Clone, Copy)]
pub struct Place {
    pub foot_m: f64,
    pub unit: usize,
    /// +1 left, −1 right.
    pub side: f64,
    pub ahead_m: f64,
}

/// Asks the certifier, with corrections as they are by default. `None`: it makes no claim worth refuting.
pub fn certify(corridor: &Corridor, vehicle: &Vehicle) -> Option<Claim> {
    claim(corridor, vehicle, &Options::default())
}

/// Asks the certifier. `None`: it makes no claim worth refuting.
pub fn claim(corridor: &Corridor, vehicle: &Vehicle, options: &Options) -> Option<Claim> {
    let model = Model::new(vehicle).expect("the oracle's vehicles are possible ones");
    let certificate = stet::certify(corridor, &model, options).expect("the corridor has stations");
    let result = certificate.result;
    let limiting = Place {
        foot_m: result.limiting.station as f64 * corridor.spacing_m,
        unit: result.limiting.unit,
        side: if result.limiting.side == Side::Left { 1.0 } else { -1.0 },
        ahead_m: result.limiting.point_m,
    };
    // Where the recursion of the bounds does not close there is no RSC: nothing to refute.
    let (rsc_m, shrink, hinge_margin_rad) = (result.rsc_m?, result.shrink, result.hinge_margin_rad?);
    (rsc_m > -50.0).then_some(Claim { rsc_m, shrink, hinge_margin_rad, limiting, plan: certificate.plan })
}
