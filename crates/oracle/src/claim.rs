//! A certifier's claims about a corridor, in the oracle's types.

use crate::path::V2;

/// The claims of a certificate that the oracle tries to refute.
pub struct Claim {
    pub rsc_m: f64,
    /// γ: the steer axle keeps within ±γ ε.
    pub shrink: f64,
    pub hinge_margin_rad: f64,
    pub limiting: BodyPoint,
    pub plan: Vec<V2>,
}

/// A body point, given by the station of its foot.
#[derive(Debug, Clone, Copy)]
pub struct BodyPoint {
    pub foot_m: f64,
    pub unit: usize,
    /// +1 left, −1 right.
    pub side: f64,
    pub ahead_m: f64,
}
