//! The roads of a region, shared by its planners.

use std::sync::Arc;

use crate::network::{Movements, Network};

/// A network and its movements. Planners of one region share them.
#[derive(Debug, Clone, Default)]
pub struct Roads {
    /// Edges, roads and strokes.
    pub network: Network,
    /// All movements of `network`.
    pub movements: Movements,
}

impl Roads {
    /// Derives the movements of a network.
    #[must_use]
    pub fn new(network: Network) -> Arc<Self> {
        let movements = network.movements();
        Arc::new(Self { network, movements })
    }
}
