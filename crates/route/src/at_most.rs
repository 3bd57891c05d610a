//! How high a route may climb: the widest strip that it may use, and where it may rest on conditions.

use crate::osm::facts::Policy;
use netcert_base::named;

/// The highest rung of a route.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AtMost {
    /// Its own lane.
    Lane,
    /// All lanes of its direction.
    Direction,
    /// The whole carriageway, with its oncoming lane.
    Carriageway,
    /// The whole carriageway. Where that is not enough, only places at which the vehicle is attested may lack room.
    Attested,
}

named!(AtMost { Lane = "lane", Direction = "direction", Carriageway = "carriageway", Attested = "attested" });

impl AtMost {
    /// The widest strip that a route may use.
    #[must_use]
    pub const fn strip(self) -> Policy {
        match self {
            Self::Lane => Policy::Lane,
            Self::Direction => Policy::Direction,
            Self::Carriageway | Self::Attested => Policy::Carriageway,
        }
    }

    /// Where a way may have conditions, if no way is certified.
    #[must_use]
    pub const fn conditions(self) -> Conditions {
        match self {
            Self::Attested => Conditions::WhereAttested,
            Self::Lane | Self::Direction | Self::Carriageway => Conditions::Anywhere,
        }
    }
}

/// Where a way may have conditions, if no way is certified.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Conditions {
    /// Nowhere: certified routes alone are looked for.
    Nowhere,
    /// Where a sign, a network or the register says that the vehicle goes.
    WhereAttested,
    /// Anywhere.
    Anywhere,
}
