//! What certifying, checking and simulating share, and nothing else: vehicles, corridors, the words of a verdict. No computing of certificates,
//! no maps, no databases.

pub mod corridor;
pub mod speed_profile;
pub mod stop;
pub mod vehicle;
pub mod verdict;
