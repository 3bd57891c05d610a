//! The name of a certified set.

use crate::osm::facts::Policy;

/// What names one certified set of a database: whose certificates, and for which strip of the road.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct SetKey<'a> {
    /// Id of the vehicle.
    pub vehicle: &'a str,
    /// The strip that the vehicle may use.
    pub policy: Policy,
}
