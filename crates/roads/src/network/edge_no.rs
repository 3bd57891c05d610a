//! The number of an edge in its network.

use super::{Edge, Network};

crate::number::number! {
    /// The number of an edge: its place in [`Network::edges`]. It holds within one network only; `Edge::id` is the same in the next one.
    EdgeNo
}

impl Network {
    /// All edges with their numbers, in order.
    pub fn numbered_edges(&self) -> impl Iterator<Item = (EdgeNo, &Edge)> + Clone {
        EdgeNo::all().zip(&self.edges)
    }
}
