//! The signs and networks on the map by which an authority says that a vehicle goes along a road or round a corner.

use crate::network::{EdgeNo, Network};
use crate::osm::facts::{Countries, Designation, Designations};
use crate::vehicle::Vehicle;

/// The designations that all of these edges have and that stand for the vehicle. None if the built-in borders cannot be read.
pub(super) fn of(network: &Network, edges: &[EdgeNo], vehicle: &Vehicle) -> Vec<&'static Designation> {
    let edges: Vec<_> = edges.iter().filter_map(|edge| network.edges.get(edge.index())).collect();
    let signed = |designation: &&Designation| {
        designation.vehicles.contains(&vehicle.id)
            && edges.iter().all(|edge| designation.signed(edge.legal.tags.as_deref()))
    };
    let mut all: Vec<&'static Designation> = Designations::builtin().all().iter().filter(signed).collect();
    if all.is_empty() || edges.is_empty() {
        return Vec::new();
    }
    let Ok(countries) = Countries::load() else { return Vec::new() };
    for edge in edges {
        let regions = network.positions(edge).next().map_or_else(Vec::new, |at| countries.regions(at));
        let country = network.road(edge).country;
        let country = std::str::from_utf8(&country).unwrap_or_default();
        all.retain(|designation| designation.holds_in(country, &regions));
    }
    all
}
