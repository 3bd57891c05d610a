//! The two sides of a road.

use crate::named;

/// An edge of the corridor, seen in driving direction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Side {
    /// Left of travel.
    Left,
    /// Right of travel.
    Right,
}

named!(Side { Left = "left", Right = "right" });
