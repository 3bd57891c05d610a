//! The roads of a region, and a vehicle with its permits on them. A planner is made from both.

use std::sync::Arc;

use super::permits::Permits;
use crate::network::{Movements, Network};
use crate::stet::Model;

/// A network and its movements. Planners of one region share them.
#[derive(Debug)]
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

/// A vehicle and its permits.
#[derive(Debug)]
pub struct Driver {
    /// The vehicle.
    pub model: Model,
    /// The vehicle's permits, with the settings of its certificates.
    pub permits: Permits,
}
