//! One unit of the vehicle in the proof's terms.

/// Slip added to the vehicle's own for rounding of headings. Headings are exact to 1e-13 per step of at least a
/// centimetre.
pub(crate) const DEFECT_RAD: f64 = 1e-9;

/// One unit, front to rear.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Link {
    /// L, metres.
    pub(crate) l: f64,
    /// d, metres.
    pub(crate) d: f64,
    /// d / L.
    pub(crate) k: f64,
    /// σ plus an allowance for rounding of the nominal motion, radians.
    pub(crate) sway: f64,
    /// θ, radians.
    pub(crate) limit: f64,
    /// b/2, metres.
    pub(crate) half_width: f64,
    /// The body's rear and front ends, metres ahead of the axle.
    pub(crate) rear: f64,
    pub(crate) front: f64,
}
