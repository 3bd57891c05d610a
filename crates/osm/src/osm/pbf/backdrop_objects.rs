//! Objects of the file that belong to the backdrop.

use crate::osm::facts::BackdropKind;
use crate::osm::{LonLat, NodeId};

/// A multipolygon whose tags make it part of the backdrop.
#[derive(Debug)]
pub(super) struct AreaRelation {
    pub(super) id: i64,
    pub(super) kind: BackdropKind,
    pub(super) name: Option<Box<str>>,
    /// The ways, and whether each is part of a hole.
    pub(super) members: Vec<(i64, bool)>,
}

/// A way of the backdrop. Its kind is `None` if only a multipolygon makes it part of it.
#[derive(Debug)]
pub(super) struct BackdropWay {
    pub(super) id: i64,
    pub(super) kind: Option<BackdropKind>,
    pub(super) name: Option<Box<str>>,
    pub(super) refs: Vec<NodeId>,
}

/// A node that names a place.
#[derive(Debug)]
pub(super) struct PlaceNode {
    pub(super) id: NodeId,
    pub(super) kind: BackdropKind,
    pub(super) name: Box<str>,
    pub(super) place: LonLat,
}
