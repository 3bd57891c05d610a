//! The driving sides of a region's edges. Most regions have one side; a region at the border of Hong Kong or Thailand has
//! both.

/// The driving sides of a region.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DrivingSides {
    /// Whether traffic keeps left on most ways.
    mostly_left: bool,
    /// Edges on which traffic keeps to the other side, sorted.
    others: Vec<u32>,
}

impl DrivingSides {
    /// `others` are the edges on which traffic keeps to the other side than on most ways, sorted.
    pub fn new(mostly_left: bool, others: Vec<u32>) -> Self {
        Self { mostly_left, others }
    }

    /// Whether traffic keeps left on an edge (index into `Network::edges`). `None` if the whole region has one side.
    #[must_use]
    pub fn left(&self, edge: u32) -> Option<bool> {
        let mixed = !self.others.is_empty();
        mixed.then(|| self.mostly_left != self.others.binary_search(&edge).is_ok())
    }
}
