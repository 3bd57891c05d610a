//! The connectors of all files, by key.

use rustc_hash::FxHashMap;

use super::account::{Account, CONNECTOR};
use super::ids::FeatureKey;
use crate::osm::{LonLat, NodeId};

/// Where connectors are.
#[derive(Debug, Default)]
pub(super) struct Connectors {
    places: FxHashMap<FeatureKey, LonLat>,
    read: u64,
}

impl Connectors {
    /// Adds connectors. Of several with the same id the first one counts; files of neighbouring places repeat them.
    pub(super) fn add(&mut self, some: Vec<(FeatureKey, LonLat)>) {
        self.read += some.len() as u64;
        for (key, place) in some {
            self.places.entry(key).or_insert(place);
        }
    }

    pub(super) fn place(&self, key: FeatureKey) -> Option<LonLat> {
        self.places.get(&key).copied()
    }

    /// Counts those that are on roads. `on_roads`: whether a road has the node.
    pub(super) fn count(&self, account: &mut Account, on_roads: impl Fn(NodeId) -> bool) {
        let kept = self.places.keys().filter(|key| on_roads(NodeId::new(key.number()))).count() as u64;
        account.kept(CONNECTOR, kept);
        account.left_out(CONNECTOR, "not_on_a_road", self.places.len() as u64 - kept);
        account.left_out(CONNECTOR, "duplicate_id", self.read - self.places.len() as u64);
    }

    /// The box around all connectors (west, south, east, north), 1e-7 degree.
    pub(super) fn bounds(&self) -> Option<[i32; 4]> {
        let around = |bounds: Option<[i32; 4]>, place: &LonLat| {
            let LonLat { lon_e7: x, lat_e7: y } = *place;
            let [west, south, east, north] = bounds.unwrap_or([x, y, x, y]);
            Some([west.min(x), south.min(y), east.max(x), north.max(y)])
        };
        self.places.values().fold(None, around)
    }
}
