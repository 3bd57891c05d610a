//! What a prover may try beyond the centreline.

/// Bounds of the corrections, and the number of sweeps spent on them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Δq_max: largest shift of the steer path off the centreline, metres. 0 allows no correction.
    pub max_shift_m: f64,
    /// Number of CORRCEN sweeps after the centred one.
    pub correction_sweeps: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self { max_shift_m: 1.5, correction_sweeps: 2 }
    }
}

impl Options {
    /// Whether any correction is allowed.
    #[must_use]
    pub fn correct(&self) -> bool {
        self.max_shift_m > 0.0 && self.correction_sweeps > 0
    }
}
