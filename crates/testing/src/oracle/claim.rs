//! Runs the certifier and converts its claims to the oracle's types.

use netcert::corridor::Corridor;
use netcert::stet::{self, Certificate, Model, Options, Side};
use netcert::stop::Stop;
use netcert::vehicle::Vehicle;
pub use netcert_oracle::claim::{BodyPoint, Claim};

/// Runs the certifier with default corrections. `None` if it makes no claim worth refuting.
pub fn certify(corridor: &Corridor, vehicle: &Vehicle) -> Option<Claim> {
    claim(corridor, vehicle, &Options::default())
}

/// Runs the certifier. `None` if it makes no claim worth refuting.
pub fn claim(corridor: &Corridor, vehicle: &Vehicle, options: &Options) -> Option<Claim> {
    let model = Model::new(vehicle).expect("the oracle's vehicles are possible ones");
    let certificate = stet::certify(corridor, &model, options, &Stop::never())
        .expect("nobody cancels")
        .expect("the corridor has stations");
    of(corridor, certificate)
}

/// The claim of a certificate. `None` if it claims nothing worth refuting.
pub fn of(corridor: &Corridor, certificate: Certificate) -> Option<Claim> {
    let result = certificate.result;
    let limiting = BodyPoint {
        foot_m: result.limiting.station as f64 * corridor.spacing_m,
        unit: result.limiting.unit,
        side: if result.limiting.side == Side::Left { 1.0 } else { -1.0 },
        ahead_m: result.limiting.point_m,
    };
    // Where the recursion of the bounds does not close there is no RSC, so there is nothing to refute.
    let (rsc_m, shrink, hinge_margin_rad) = (result.rsc_m?, result.shrink, result.hinge_margin_rad?);
    (rsc_m > -50.0).then_some(Claim { rsc_m, shrink, hinge_margin_rad, limiting, plan: certificate.plan })
}
