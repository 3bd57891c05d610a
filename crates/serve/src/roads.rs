//! The network in memory, which explanations and routes need. It is loaded on first use.

use std::sync::Arc;

use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};
use rustc_hash::FxHashMap;

use super::memo::Recent;
use super::problem::Problem;
use crate::network::{EARTH_RADIUS_M, EdgeNo, Network, offset_m};
use crate::osm::LonLat;
use crate::route::{Position, Roads, foot};
use crate::rows::Bounds;
use crate::settings::Settings;
use crate::turns::{TurnFacts, turn_facts};

/// The roads of a region, with look-up of edges and turns by id.
pub(super) struct RoadIndex {
    /// The roads, which the planners share.
    pub(super) roads: Arc<Roads>,
    by_id: FxHashMap<i64, EdgeNo>,
    /// The boxes of the edges, in degrees.
    by_place: RTree<GeomWithData<Rectangle<[f64; 2]>, EdgeNo>>,
    /// The turns by kerb settings. One entry suffices, because all sets of a database have the same kerbs.
    turns: Recent<Vec<TurnFacts>>,
}

impl RoadIndex {
    pub(super) fn new(network: Network) -> Self {
        let by_id = network.numbered_edges().map(|(index, edge)| (edge.id, index)).collect();
        let boxes = network.numbered_edges().filter_map(|(index, edge)| {
            let own = Bounds::around(network.positions(edge))?;
            Some(GeomWithData::new(Rectangle::from_corners([own.west, own.south], [own.east, own.north]), index))
        });
        let by_place = RTree::bulk_load(boxes.collect());
        Self { roads: Roads::new(network), by_id, by_place, turns: Recent::new(1) }
    }

    pub(super) fn network(&self) -> &Network {
        &self.roads.network
    }

    /// The edge with this `edge_id`.
    pub(super) fn edge(&self, id: i64) -> Option<EdgeNo> {
        self.by_id.get(&id).copied()
    }

    /// The edges whose own box touches a box, sorted.
    pub(super) fn near(&self, Bounds { west, south, east, north }: Bounds) -> Vec<EdgeNo> {
        let around = AABB::from_corners([west, south], [east, north]);
        let mut edges: Vec<EdgeNo> =
            self.by_place.locate_in_envelope_intersecting(&around).map(|edge| edge.data).collect();
        edges.sort_unstable();
        edges
    }

    /// The edge whose line is nearest to a place, with the distance in metres, if there is one within `most_m`.
    pub(super) fn nearest(&self, place: Position, most_m: f64) -> Option<(EdgeNo, f64)> {
        let (here, network) = (LonLat::from(place), self.network());
        let dy = (most_m / EARTH_RADIUS_M).to_degrees();
        let dx = dy / place.lat.to_radians().cos().max(0.01);
        let around =
            Bounds { west: place.lon - dx, south: place.lat - dy, east: place.lon + dx, north: place.lat + dy };
        let distance = |index: EdgeNo| {
            let line: Vec<[f64; 2]> =
                network.positions(network.edges.get(index.index())?).map(|position| offset_m(here, position)).collect();
            let nearest = line.windows(2).map(|pair| foot([pair[0], pair[1]]).0).min_by(f64::total_cmp)?;
            (nearest <= most_m).then_some((index, nearest))
        };
        self.near(around).into_iter().filter_map(distance).min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// The turn with this `turn_id`, with kerbs by `settings`.
    pub(super) fn turn(&self, id: i64, settings: &Settings) -> Result<Option<TurnFacts>, Problem> {
        let key = format!("{:?}", settings.kerbs);
        let make = || Ok::<_, Problem>(turn_facts(self.network(), &settings.kerbs));
        let turns: Arc<Vec<TurnFacts>> = self.turns.get(&key, make)?;
        Ok(turns.iter().find(|turn| turn.id == id).cloned())
    }
}
