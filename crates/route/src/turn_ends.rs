//! The edges before and after a turn, which name it on a way.

use crate::network::{EdgeNo, Movement};

/// The edges before and after a turn or passage, which tell it from every other one of a way.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct TurnEnds {
    /// The edge that the vehicle comes from.
    pub from: EdgeNo,
    /// The edge that the vehicle goes into.
    pub to: EdgeNo,
}

impl TurnEnds {
    pub(super) fn of(movement: &Movement) -> Self {
        Self { from: movement.from, to: movement.to }
    }
}
