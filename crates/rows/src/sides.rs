//! The driving sides of a region's edges. Most regions have one side; a region at the border of Hong Kong or Thailand has
//! both.

use netcert_base::corridor::Side;
use netcert_roads::network::EdgeNo;

/// The driving sides of a region.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DrivingSides {
    /// The side to which traffic keeps on most ways.
    usual: Side,
    /// Edges on which traffic keeps to the other side, sorted.
    others: Vec<EdgeNo>,
}

impl DrivingSides {
    /// `usual` is the side to which traffic keeps on most ways. `others` are the edges on which it keeps to the other side, sorted.
    pub fn new(usual: Side, others: Vec<EdgeNo>) -> Self {
        Self { usual, others }
    }

    /// Whether traffic keeps left on an edge. `None` if the whole region has one side.
    #[must_use]
    pub fn left(&self, edge: EdgeNo) -> Option<bool> {
        let mixed = !self.others.is_empty();
        mixed.then(|| (self.usual == Side::Left) != self.others.binary_search(&edge).is_ok())
    }
}
