//! The result of both passes: roads as facts in flat arrays. Its size is bounded by the roads, not by the file.

use std::ops::Range;

use super::backdrop::Backdrop;
use super::read_account::ReadAccount;
use crate::osm::facts::{AreaKind, PointFacts, TurnRule, WayFacts};
use crate::osm::{LonLat, NodeId, StringPool};

/// A drivable way: its facts, and its node references in [`Extract::refs`]. There are at least two references, and
/// consecutive ones differ.
#[derive(Debug, Clone)]
pub struct Way {
    /// OSM way id.
    pub id: i64,
    /// Range of its node references in [`Extract::refs`].
    pub refs: Range<u32>,
    /// Facts from its tags.
    pub facts: WayFacts,
}

/// A turn restriction for heavy goods vehicles, as the relation gives it. Its members need not be in the file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Restriction {
    /// OSM relation id.
    pub id: i64,
    /// Its rules; at least one.
    pub rules: Vec<TurnRule>,
    /// Ways before the turn. If there are none, any way may be meant.
    pub from: Vec<i64>,
    /// Nodes or ways between.
    pub via: Via,
    /// Ways after the turn. If there are none, any way may be meant.
    pub to: Vec<i64>,
}

/// A closed way that maps the surface of a road or junction, or an island on it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RoadArea {
    /// OSM way id.
    pub id: i64,
    /// Surface or island.
    pub kind: AreaKind,
    /// Its node references in order: at least four, and the last equals the first.
    pub refs: Vec<NodeId>,
}

/// The members between the `from` and `to` ways of a restriction.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Via {
    /// A node. If there are several, the restriction holds at each of them. If there is none, it holds where the ways meet.
    Nodes(Vec<NodeId>),
    /// Ways, driven one after the other, usually in this order.
    Ways(Vec<i64>),
}

/// Node positions, sorted by id. The table has every node that a kept way or area names; a node that the file lacks has
/// no position.
#[derive(Debug, Clone, Default)]
pub struct NodeTable {
    /// Sorted, distinct node ids.
    pub ids: Vec<NodeId>,
    /// Parallel to `ids`. `None` if the file has no such node, or has it at an invalid place.
    pub places: Vec<Option<LonLat>>,
}

impl NodeTable {
    /// The position of a node, if the file had it.
    #[must_use]
    pub fn place(&self, id: NodeId) -> Option<LonLat> {
        self.index(id).and_then(|i| self.places[i])
    }

    /// The index of a node in the table, whether or not it has a position.
    #[must_use]
    pub fn index(&self, id: NodeId) -> Option<usize> {
        self.ids.binary_search(&id).ok()
    }
}

/// The data read from an extract.
#[derive(Debug, Clone, Default)]
pub struct Extract {
    /// Kept ways, sorted by id, ids distinct.
    pub ways: Vec<Way>,
    /// Node references of all ways, one way after the other.
    pub refs: Vec<NodeId>,
    /// Positions of those nodes.
    pub nodes: NodeTable,
    /// Tagged nodes on kept ways that narrow or bar the road: sorted by node id.
    pub points: Vec<(NodeId, PointFacts)>,
    /// Mapped surfaces of roads and islands on them, sorted by way id, ids distinct.
    pub areas: Vec<RoadArea>,
    /// Turn restrictions for heavy goods vehicles, sorted by relation id.
    pub restrictions: Vec<Restriction>,
    /// What a map shows behind the roads.
    pub backdrop: Vec<Backdrop>,
    /// Names and refs of the ways.
    pub strings: StringPool,
    /// The account of everything read: how many ways were left out, by reason.
    pub account: ReadAccount,
}
