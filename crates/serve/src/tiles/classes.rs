//! The classes of road that each zoom shows: the main classes at low zooms, all classes from zoom 13 on.

use crate::osm::facts::RoadClass;

/// Turns are drawn from this zoom on. At lower zooms they would overlap.
pub(super) const FIRST_WITH_TURNS: u8 = 15;

/// All classes, from the most important to the least.
pub(super) const BY_RANK: &[RoadClass] = {
    use RoadClass::{
        Busway, LivingStreet, Motorway, Primary, Residential, Secondary, Service, Tertiary, Track, Trunk, Unclassified,
    };
    &[Motorway, Trunk, Primary, Secondary, Tertiary, Unclassified, Residential, LivingStreet, Busway, Service, Track]
};

/// The classes that a zoom shows, each with its links. As on general maps, a class appears when its roads are some pixels
/// apart.
pub(super) fn classes(z: u8) -> &'static [RoadClass] {
    let shown = match z {
        0..=6 => 2,
        7..=8 => 3,
        9 => 4,
        10 => 5,
        11 => 6,
        12 => 9,
        _ => BY_RANK.len(),
    };
    BY_RANK.get(..shown).unwrap_or(BY_RANK)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_zoom_shows_all_that_the_one_before_did_and_at_last_everything() {
        for z in 1..=super::super::MOST_ZOOM {
            assert!(classes(z).starts_with(classes(z - 1)));
        }
        let all = classes(13);
        assert!(RoadClass::ALL.iter().all(|class| all.contains(class)) && all.len() == RoadClass::ALL.len());
    }
}
