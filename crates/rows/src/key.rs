//! Which edge or turn is meant, and what a road is called.

use std::borrow::Cow;

use crate::osm::facts::{Direction, highway};
use crate::osm::{NodeId, StringId};
use crate::words::Named as _;
use netcert_roads::network::{EdgeNo, Network, Road};
use netcert_roads::turns::TurnNo;

/// Which edge is meant: its ids, and its place on its way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct EdgeKey {
    /// Its place in `Network::edges`.
    pub index: EdgeNo,
    /// The stable id, `edge_id`.
    pub id: i64,
    /// The way in OpenStreetMap.
    pub way_id: i64,
    /// OpenStreetMap's node where the edge begins.
    pub from_node: NodeId,
    /// OpenStreetMap's node where the edge ends.
    pub to_node: NodeId,
    /// Along the way, or against it.
    pub direction: Direction,
}

impl EdgeKey {
    /// The key of an edge of a network. `None` if there is no such edge.
    #[must_use]
    pub fn of(network: &Network, index: EdgeNo) -> Option<Self> {
        let edge = network.edges.get(index.index())?;
        let way_id = network.road(edge).way_id;
        let (from_node, to_node, direction) = (edge.from_node, edge.to_node, edge.direction);
        Some(Self { index, id: edge.id, way_id, from_node, to_node, direction })
    }
}

/// What a road is called on the map, and its class.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RoadName<T = String> {
    /// The class of road as in `highway`, with `_link` for links.
    pub highway: T,
    /// `name`
    pub name: Option<T>,
    /// `ref`
    pub reference: Option<T>,
}

impl<'n> RoadName<Cow<'n, str>> {
    /// The name of a road of a network.
    #[must_use]
    pub fn of(network: &'n Network, road: &Road) -> Self {
        let text = |id: StringId| Cow::Borrowed(network.strings.text(id));
        let highway = if road.link { highway(road.class, road.link).into() } else { road.class.name().into() };
        Self { highway, name: road.name.map(text), reference: road.reference.map(text) }
    }

    /// The name with texts of its own.
    #[must_use]
    pub fn into_owned(self) -> RoadName {
        RoadName {
            highway: self.highway.into_owned(),
            name: self.name.map(Cow::into_owned),
            reference: self.reference.map(Cow::into_owned),
        }
    }
}

impl From<RoadName> for RoadName<Cow<'_, str>> {
    fn from(name: RoadName) -> Self {
        Self {
            highway: name.highway.into(),
            name: name.name.map(Into::into),
            reference: name.reference.map(Into::into),
        }
    }
}

/// Which turn is meant: its ids, and the roads that it joins.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TurnKey {
    /// Its place among the network's turns.
    pub index: TurnNo,
    /// The stable id, `turn_id`.
    pub id: i64,
    /// The `edge_id` of the edge before the turn.
    pub from_edge: i64,
    /// The `edge_id` of the edge after the turn.
    pub to_edge: i64,
    /// The name or ref of the road before the turn.
    pub from_name: Option<String>,
    /// The name or ref of the road after the turn.
    pub to_name: Option<String>,
}
