//! The road beside a place from which no route can begin: which it is, and why it may not be used.

use super::permits::Permit;
use super::plan::Planner;
use super::snap::Position;
use crate::network::EdgeNo;

/// The road nearest to a place, whatever its verdict.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearestRoad {
    /// The edge, as an index into the network's edges.
    pub edge: EdgeNo,
    /// The point on it.
    pub position: Position,
    /// Distance from the place, metres.
    pub distance_m: f64,
    /// The vehicle's permit on the edge.
    pub permit: Permit,
}

impl Planner {
    /// The road nearest to a place. Of two directions it is the first one that may not be used. `None` if there is no road within
    /// `most_m`, or if the nearest one may be used in all directions.
    #[must_use]
    pub fn beside(&self, place: Position, most_m: f64) -> Option<NearestRoad> {
        let snapped = self.snapper.snap(place, most_m, |_| true).ok()?;
        let permits = &self.driver.permits;
        let edge = snapped.on.iter().map(|goal| goal.edge).find(|&edge| !permits.edge(edge))?;
        let permit = *permits.edges.get(edge.index())?;
        Some(NearestRoad { edge, position: snapped.position, distance_m: snapped.distance_m, permit })
    }
}
