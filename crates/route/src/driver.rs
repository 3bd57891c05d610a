//! Who drives: a vehicle with its permits.

use super::attested::Attested;
use super::permits::Permits;
use crate::stet::Model;

/// A vehicle and what it may use.
#[derive(Debug)]
pub struct Driver {
    /// The vehicle.
    pub model: Model,
    /// Its permits, with the settings under which they were made.
    pub permits: Permits,
    /// Where it is attested to go. No permit depends on this.
    pub attested: Attested,
}
