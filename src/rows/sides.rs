//! On which side of the road one drives: most regions know one side only, one at Hong Kong's border or Thailand's both.

/// The sides of a region.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DrivingSides {
    /// Whether most ways are driven on the left.
    mostly_left: bool,
    /// Edges that are driven on the other side, sorted.
    others: Vec<u32>,
}

impl DrivingSides {
    /// `others` are the edges driven on the other side than most are, sorted.
    pub(crate) fn new(mostly_left: bool, others: Vec<u32>) -> Self {
        Self { mostly_left, others }
    }

    /// Whether an edge (index into `Network::edges`) is driven on the left; `None` where all are driven as most are.
    #[must_use]
    pub fn left(&self, edge: u32) -> Option<bool> {
        let mixed = !self.others.is_empty();
        mixed.then(|| self.mostly_left != self.others.binary_search(&edge).is_ok())
    }
}
