//! What a certifier claims of a corridor, in the oracle's words.

use crate::path::V2;

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
