//! Whether a road is open to through traffic, or to a destination only: `destination`, `delivery`, `customers`, `permit`.

use super::{Edge, Network};
use crate::osm::facts::{At, Permission};
use crate::vehicle::Vehicle;

/// Whether a vehicle may pass through an edge on its way to another road. This is the one place that decides it.
#[must_use]
pub fn through(network: &Network, edge: &Edge, vehicle: &Vehicle) -> bool {
    network.legal(edge).judge(vehicle, At::Always).permission != Permission::Restricted
}

/// The tag that opens an edge at the ends of a route only. `None` if it is open to through traffic or closed. It may lack its value:
/// see [`destination_words`].
#[must_use]
pub fn destination_tag(network: &Network, edge: &Edge, vehicle: &Vehicle) -> Option<String> {
    network.legal(edge).judge(vehicle, At::Always).destination
}

/// The values that such a tag has.
const DESTINATION_VALUES: &str = "destination, delivery, customers or permit";

/// A tag of [`destination_tag`] with its values, for messages.
#[must_use]
pub fn destination_words(tag: &str) -> String {
    if tag.contains('=') { tag.to_owned() } else { format!("{tag} = {DESTINATION_VALUES}") }
}
