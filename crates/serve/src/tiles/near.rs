//! The edges near a tile: from the network in memory if it is loaded, otherwise from the file through its spatial index. Both
//! ways give the same rows.

use rayon::prelude::*;

use super::super::problem::Problem;
use super::super::region::RegionState;
use super::super::roads::RoadIndex;
use crate::network::{EdgeNo, Network};
use crate::osm::facts::RoadClass;
use crate::rows::{Bounds, EdgeKey, MapEdge, MapNumbers, RoadName, SetKey};

/// Fewer edges are not worth a second thread.
pub(super) const LEAST_IN_PARALLEL: usize = 500;

/// The edges of these classes (with their links) whose own box touches a box, in order of the network. `roads` is the network in memory,
/// if there is one. The rows borrow its texts.
pub(super) fn edges<'r>(
    region: &RegionState,
    roads: Option<&'r RoadIndex>,
    set: SetKey<'_>,
    bounds: Bounds,
    classes: &[RoadClass],
) -> Result<Vec<MapEdge<'r>>, Problem> {
    if let Some(roads) = roads
        && let Some(numbers) = region.numbers(roads, set)?
    {
        let network = roads.network();
        let row = |&index: &EdgeNo| map_edge(network, index, *numbers.get(index.index())?, classes);
        return Ok(roads.near(bounds).par_iter().with_min_len(LEAST_IN_PARALLEL).filter_map(row).collect());
    }
    region.read(|database| database.map_edges(set, bounds, classes))
}

/// `None` if the edge is of another class.
fn map_edge<'r>(
    network: &'r Network,
    index: EdgeNo,
    numbers: MapNumbers,
    classes: &[RoadClass],
) -> Option<MapEdge<'r>> {
    let (key, edge) = (EdgeKey::of(network, index)?, network.edges.get(index.index())?);
    let road = network.road(edge);
    classes.contains(&road.class).then(|| MapEdge {
        edge: key,
        oneway: road.oneway,
        road: RoadName::of(network, road),
        numbers,
        line: network.positions(edge).collect(),
    })
}
