//! Conditions of a route: what has to hold on site so that a way is certified, and what the search for such a way pays for it.
//!
//! A condition is a width or a kerb radius that somebody can measure on site. The route has one certificate over the whole, made on
//! a network on which every condition holds. Without its conditions the route is not safe, and nothing here says that they hold.

mod failing;
mod fit;
mod fitter;
mod joint;
mod less;
mod level;
mod mend;
mod parts;
mod prices;
mod report;
mod sections;
mod sheet;
mod stretch;
mod suppositions;
mod together;
mod turn_need;
mod way_roads;

// What the search for a way fits ways with.
pub(super) use fitter::{Fitted, Fitter, Unfit};
pub(super) use prices::{ConditionalAccess, RoadPrice};

pub use report::SHEET_COLUMNS;
pub use sheet::{csv as sheet_csv, features as sheet_features, geojson as sheet_geojson};

// What `survey` opens places with.
pub(super) use parts::BESIDE_M;
pub(super) use prices::{edge_price, turn_price};
pub(super) use suppositions::Suppositions;
pub(super) use turn_need::Turning;

use super::attested::Attested;
use super::drive::Drive;
use super::route::Route;
use super::snap::Snapped;
use crate::evidence::Quantity;
use crate::network::{EdgeNo, Network};
use crate::osm::NodeId;
use crate::osm::facts::Policy;
use crate::rows::AttestedBy;

/// A route that is certified if all conditions hold.
#[derive(Debug, Clone)]
pub struct Conditional {
    /// The route. Its certificate is safe on a network on which the conditions hold.
    pub route: Route,
    /// The conditions in driving order. Empty if the way passes as it is: then it is a certified route.
    pub conditions: Vec<Condition>,
    /// Whether measurements that are exactly as the conditions say make the route a certified one. Otherwise the route needs them, and the
    /// search may then ask for more.
    pub suffices: bool,
    /// The requested places, moved to the road.
    pub snapped: Vec<Snapped>,
}

impl Conditional {
    /// Whether somebody attests the place of every condition.
    #[must_use]
    pub fn attested(&self) -> bool {
        self.conditions.iter().all(|condition| condition.attested_by.is_some())
    }
}

/// Something that has to be so on site.
#[derive(Debug, Clone, PartialEq)]
pub struct Condition {
    /// What has to be measured: a width, a kerb radius or a paved surface.
    pub quantity: Quantity,
    /// Where.
    pub at: ConditionAt,
    /// The least value as the map or an assumption has it, metres. `None` for a surface.
    pub assumed_m: Option<f64>,
    /// The value that it must have at least, metres.
    pub needed_m: f64,
    /// Who says that the vehicle goes there all the same: an authority by a sign, or the register. That is no measurement, and makes nothing
    /// safe.
    pub attested_by: Option<AttestedBy>,
}

/// The place of a condition.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ConditionAt {
    /// Along edges of one road, in driving order.
    Road(Vec<EdgeNo>),
    /// At the corner between an edge that ends and one that begins at a node.
    Corner {
        /// OSM node id.
        node: NodeId,
        /// The two edges.
        between: [EdgeNo; 2],
    },
    /// Around an OSM node: everything is paved, without kerbs and islands, up to the needed distance from it.
    Junction(NodeId),
}

impl Condition {
    /// Length of the road of the condition, metres; 0 for a corner.
    #[must_use]
    pub fn length_m(&self, network: &Network) -> f64 {
        match &self.at {
            ConditionAt::Road(edges) => edges
                .iter()
                .filter_map(|&edge| network.edges.get(edge.index()))
                .map(|edge| network.length_m(edge))
                .sum(),
            ConditionAt::Corner { .. } | ConditionAt::Junction(_) => 0.0,
        }
    }
}

/// Tells each condition of a way who attests the place of it.
pub(super) fn tell_who_attests(attested: &Attested, network: &Network, drive: &Drive, conditions: &mut [Condition]) {
    if attested.is_empty() {
        return;
    }
    let strokes = network.strokes_of_edges();
    for condition in conditions {
        condition.attested_by = match &condition.at {
            ConditionAt::Road(edges) => attested.road(edges),
            ConditionAt::Corner { node, .. } | ConditionAt::Junction(node) => {
                attested.node(network, &strokes, drive, *node)
            }
        };
    }
}

/// The quantity that is the width for a policy.
pub(super) const fn width_of(policy: Policy) -> Quantity {
    match policy {
        Policy::Lane => Quantity::LaneWidth,
        Policy::Direction => Quantity::DirectionWidth,
        Policy::Carriageway => Quantity::CarriagewayWidth,
    }
}
