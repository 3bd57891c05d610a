//! The network in memory, for explanations and routes: loaded when it is first needed.

use std::sync::Arc;

use rustc_hash::FxHashMap;

use super::made_once::Recent;
use super::problem::Problem;
use crate::network::Network;
use crate::route::Roads;
use crate::settings::Settings;
use crate::turns::{TurnFacts, turn_facts};

/// The roads of a region, with edges and turns by their ids.
pub(super) struct RoadIndex {
    /// Shared with the planners.
    pub(super) roads: Arc<Roads>,
    by_id: FxHashMap<i64, u32>,
    /// By kerbs: all sets of a database have the same.
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

    /// The edge of an `edge_id`.
    pub(super) fn edge(&self, id: i64) -> Option<u32> {
        self.by_id.get(&id).copied()
    }

    /// The turn of a `turn_id`, with its kerbs as the settings have them.
    pub(super) fn turn(&self, id: i64, settings: &Settings) -> Result<Option<TurnFacts>, Problem> {
        let key = format!("{:?}", settings.kerbs);
        let make = || Ok::<_, Problem>(turn_facts(self.network(), &settings.kerbs));
        let turns: Arc<Vec<TurnFacts>> = self.turns.get(&key, make)?;
        Ok(turns.iter().find(|turn| turn.id == id).cloned())
    }
}
