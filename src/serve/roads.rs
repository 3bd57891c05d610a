//! The network in memory, for explanations and routes: loaded when it is first needed.

use std::sync::OnceLock;

use rustc_hash::FxHashMap;

use crate::network::{Movements, Network};
use crate::pipeline::Settings;
use crate::turns::{TurnFacts, turn_facts};

/// A network with what is looked up in it.
pub(super) struct Roads {
    pub(super) network: Network,
    pub(super) movements: Movements,
    by_id: FxHashMap<i64, u32>,
    turns: OnceLock<Vec<TurnFacts>>,
}

impl Roads {
    pub(super) fn new(network: Network) -> Self {
        let by_id = (0..).zip(&network.edges).map(|(index, edge)| (edge.id, index)).collect();
        let movements = network.movements();
        Self { network, movements, by_id, turns: OnceLock::new() }
    }

    /// The edge of an `edge_id`.
    pub(super) fn edge(&self, id: i64) -> Option<u32> {
        self.by_id.get(&id).copied()
    }

    /// The turn of a `turn_id`.
    pub(super) fn turn(&self, id: i64, settings: &Settings) -> Option<&TurnFacts> {
        let turns = self.turns.get_or_init(|| turn_facts(&self.network, &settings.turn_params().kerbs));
        turns.iter().find(|turn| turn.id == id)
    }
}
