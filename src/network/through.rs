//! Whether a road is open to through traffic, or to a destination only: `destination`, `delivery`, `customers`, `permit`.

use super::{Edge, Network};
use crate::osm::facts::Permission;
use crate::vehicle::Vehicle;

/// Whether a vehicle may pass through an edge on its way to another road. This is the one place that decides it.
#[must_use]
pub fn through(network: &Network, edge: &Edge, vehicle: &Vehicle) -> bool {
    destination_tag(network, edge, vehicle).is_none()
}

/// The tags that open an edge at the ends of a route only. `None` if it is open to through traffic or closed.
#[must_use]
pub fn destination_tag(network: &Network, edge: &Edge, _vehicle: &Vehicle) -> Option<&'static str> {
    let legal = network.legal(edge);
    match (legal.motor_vehicle, legal.hgv) {
        (Permission::Yes | Permission::Restricted, Permission::Restricted) => Some("hgv"),
        (Permission::Restricted, Permission::Yes) => Some("access, vehicle or motor_vehicle"),
        _ => None,
    }
}

/// The values that these tags have, for messages.
pub const DESTINATION_VALUES: &str = "destination, delivery, customers or permit";
