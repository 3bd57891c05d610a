//! What a map shows behind its roads: water, woods, rivers, coasts and names of places. No certificate rests on any of it.

use netcert_base::named;
use serde::{Deserialize, Serialize};

use crate::osm::facts::Tags;

/// A kind of thing behind the roads, in the order in which maps draw them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum BackdropKind {
    /// natural=wood, landuse=forest
    Wood,
    /// natural=water, waterway=riverbank or dock, landuse=reservoir or basin
    Water,
    /// natural=coastline. The sea beside it is no object of the map.
    Coast,
    /// waterway=river
    River,
    /// waterway=canal
    Canal,
    /// place=city
    City,
    /// place=town
    Town,
    /// place=suburb
    Suburb,
    /// place=village
    Village,
    /// place=hamlet
    Hamlet,
}

named!(BackdropKind {
    Wood = "wood",
    Water = "water",
    Coast = "coast",
    River = "river",
    Canal = "canal",
    City = "city",
    Town = "town",
    Suburb = "suburb",
    Village = "village",
    Hamlet = "hamlet",
});

/// The form that the objects of a kind have on a map.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BackdropForm {
    /// A closed way or a multipolygon.
    Area,
    /// A way.
    Line,
    /// A node with a name.
    Place,
}

impl BackdropKind {
    /// The form of its objects.
    #[must_use]
    pub fn form(self) -> BackdropForm {
        match self {
            Self::Wood | Self::Water => BackdropForm::Area,
            Self::Coast | Self::River | Self::Canal => BackdropForm::Line,
            Self::City | Self::Town | Self::Suburb | Self::Village | Self::Hamlet => BackdropForm::Place,
        }
    }
}

/// The kind of a way's or multipolygon's object. What lies underground or under a roof has none.
#[must_use]
pub fn backdrop_kind(tags: &Tags<'_>) -> Option<BackdropKind> {
    let mut found = None;
    for &(key, value) in tags {
        let kind = match (key, value) {
            ("tunnel" | "covered", value) if value != "no" => return None,
            ("location", "underground" | "indoor") => return None,
            ("natural", "water") | ("waterway", "riverbank" | "dock") | ("landuse", "reservoir" | "basin") => {
                BackdropKind::Water
            }
            ("natural", "wood") | ("landuse", "forest") => BackdropKind::Wood,
            ("natural", "coastline") => BackdropKind::Coast,
            ("waterway", "river") => BackdropKind::River,
            ("waterway", "canal") => BackdropKind::Canal,
            _ => continue,
        };
        // An area says more than a line.
        found = found.filter(|&before| before <= kind).or(Some(kind));
    }
    found
}

/// The kind of a node that names a place, and the name.
#[must_use]
pub fn place_of<'t>(tags: &Tags<'t>) -> Option<(BackdropKind, &'t str)> {
    let value = |wanted: &str| tags.iter().find(|(key, _)| *key == wanted).map(|tag| tag.1);
    let kind = match value("place")? {
        "city" => BackdropKind::City,
        "town" => BackdropKind::Town,
        "suburb" => BackdropKind::Suburb,
        "village" => BackdropKind::Village,
        "hamlet" => BackdropKind::Hamlet,
        _ => return None,
    };
    Some((kind, value("name").filter(|name| !name.trim().is_empty())?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn water_woods_and_rivers_count_where_they_are_seen() {
        for (tags, kind) in [
            (&[("natural", "water"), ("water", "lake")][..], Some(BackdropKind::Water)),
            (&[("natural", "water"), ("tunnel", "no")], Some(BackdropKind::Water)),
            (&[("natural", "water"), ("covered", "yes")], None),
            (&[("location", "underground"), ("landuse", "reservoir")], None),
            (&[("landuse", "forest")], Some(BackdropKind::Wood)),
            (&[("natural", "wood"), ("name", "Grove")], Some(BackdropKind::Wood)),
            (&[("natural", "coastline")], Some(BackdropKind::Coast)),
            (&[("waterway", "river")], Some(BackdropKind::River)),
            (&[("waterway", "canal"), ("tunnel", "culvert")], None),
            (&[("waterway", "stream")], None),
            (&[("leisure", "swimming_pool")], None),
            (&[("building", "yes")], None),
        ] {
            assert_eq!(backdrop_kind(tags), kind, "{tags:?}");
        }
    }

    #[test]
    fn places_have_names() {
        let town = [("place", "town"), ("name", "Ede")];
        assert_eq!(place_of(&town), Some((BackdropKind::Town, "Ede")));
        assert_eq!(place_of(&[("place", "town"), ("name", " ")]), None);
        assert_eq!(place_of(&[("place", "town")]), None);
        assert_eq!(place_of(&[("place", "locality"), ("name", "Corner")]), None);
    }
}
