//! The network in memory, which explanations and routes need. It is loaded on first use.

use std::sync::Arc;

use rustc_hash::FxHashMap;

use super::made_once::Recent;
use super::problem::Problem;
use crate::network::Network;
use crate::route::Roads;
use crate::settings::Settings;
use crate::turns::{TurnFacts, turn_facts};

/// The roads of a region, with look-up of edges and turns by id.
pub(super) struct RoadIndex {
    /// The roads, which the planners share.
    pub(super) roads: Arc<Roads>,
    by_id: FxHashMap<i64, u32>,
    /// The turns by kerb settings. One entry suffices, because all sets of a database have the same kerbs.
    turns: Recent<Vec<TurnFacts>>,
}

impl RoadIndex {
    pub(super) fn new(network: Network) -> Self {
        let by_id = (0..).zip(&network.edges).map(|(index, edge)| (edge.id, index)).collect();
        Self { roads: Roads::new(network), by_id, turns: Recent::new(1) }
    }

    pub(super) fn network(&self) -> &Network {
        &self.roads.network
    }

    /// The index of the edge with this `edge_id`.
    pub(super) fn edge(&self, id: i64) -> Option<u32> {
        self.by_id.get(&id).copied()
    }

    /// The turn with this `turn_id`, with kerbs by `settings`.
    pub(super) fn turn(&self, id: i64, settings: &Settings) -> Result<Option<TurnFacts>, Problem> {
        let key = format!("{:?}", settings.kerbs);
        let make = || Ok::<_, Problem>(turn_facts(self.network(), &settings.kerbs));
        let turns: Arc<Vec<TurnFacts>> = self.turns.get(&key, make)?;
        Ok(turns.iter().find(|turn| turn.id == id).cloned())
    }
}
