//! The number of an edge in its network.

use std::fmt;
use std::ops::Range;

use super::{Edge, Network};

/// The number of an edge: its place in [`Network::edges`]. It holds within one network only; `Edge::id` is the same in the next one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize)]
#[serde(transparent)]
pub struct EdgeNo(u32);

impl EdgeNo {
    /// The greatest number. No network has so many edges, so it stands for no edge where memory is short.
    pub const MAX: Self = Self(u32::MAX);

    /// The edge of a number.
    #[must_use]
    pub const fn new(number: u32) -> Self {
        Self(number)
    }

    /// The edge at an index of a slice that has an entry for each edge. A network has fewer than 2³² edges.
    #[must_use]
    pub const fn at(index: usize) -> Self {
        Self(index as u32)
    }

    /// The index into slices that have an entry for each edge.
    #[must_use]
    pub const fn index(self) -> usize {
        self.0 as usize
    }

    /// The bare number.
    #[must_use]
    pub const fn get(self) -> u32 {
        self.0
    }

    /// All numbers in order, from 0.
    pub fn all() -> impl Iterator<Item = Self> + Clone {
        (0..).map(Self)
    }

    /// The numbers of as many edges as there are, in order.
    pub fn first(count: usize) -> impl Iterator<Item = Self> + Clone {
        (0..count).map(Self::at)
    }

    /// The numbers of a range, in order.
    pub fn each(range: Range<Self>) -> impl Iterator<Item = Self> {
        (range.start.0..range.end.0).map(Self)
    }
}

impl fmt::Display for EdgeNo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl From<EdgeNo> for u64 {
    fn from(edge: EdgeNo) -> Self {
        Self::from(edge.0)
    }
}

impl From<EdgeNo> for i64 {
    fn from(edge: EdgeNo) -> Self {
        Self::from(edge.0)
    }
}

impl Network {
    /// All edges with their numbers, in order.
    pub fn numbered_edges(&self) -> impl Iterator<Item = (EdgeNo, &Edge)> + Clone {
        EdgeNo::all().zip(&self.edges)
    }
}
