//! When something holds.

/// When a condition holds for a vehicle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Truth {
    /// At no time.
    Never,
    /// At some times, or in some weather.
    Sometimes,
    /// Nobody knows.
    Unclear,
    /// At all times.
    Always,
}
