//! The edges near a tile: from the network in memory if it is loaded, otherwise from the file through its spatial index. Both
//! ways give the same rows.

use super::super::problem::Problem;
use super::super::region::Region;
use crate::network::Network;
use crate::osm::facts::{Policy, RoadClass};
use crate::rows::{Bounds, MapEdge, MapNumbers};
use crate::words::highway;

/// The edges of these classes (with their links) whose own box touches a box, in order of the network.
pub(super) fn edges(
    region: &Region,
    set: (&str, Policy),
    bounds: Bounds,
    classes: &[RoadClass],
) -> Result<Vec<MapEdge>, Problem> {
    if let Some(roads) = region.roads_if_loaded()
        && let Some(numbers) = region.numbers(&roads, set)?
    {
        let network = roads.network();
        let row = |&index: &u32| map_edge(network, index, *numbers.get(index as usize)?, classes);
        return Ok(roads.near(bounds).iter().filter_map(row).collect());
    }
    region.read(|database| database.map_edges(set, bounds, classes))
}

/// `None` if the edge is of another class.
fn map_edge(network: &Network, index: u32, numbers: MapNumbers, classes: &[RoadClass]) -> Option<MapEdge> {
    let edge = network.edges.get(index as usize)?;
    let road = network.road(edge);
    classes.contains(&road.class).then(|| MapEdge {
        edge: index,
        edge_id: edge.id,
        way_id: road.way_id,
        direction: edge.direction,
        oneway: road.oneway,
        highway: highway(road.class, road.link),
        name: road.name.map(|text| network.strings.text(text).to_owned()),
        reference: road.reference.map(|text| network.strings.text(text).to_owned()),
        numbers,
        line: network.positions(edge).collect(),
    })
}
