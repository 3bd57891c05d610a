//! Signs and networks by which an authority says that certain vehicles go along a road (`data/designations.toml`).
//!
//! A designation is no certificate, and no certificate depends on one. A road is attested for the vehicles that the law admits there.

use std::sync::LazyLock;

use serde::Deserialize;

use super::tag_lines;
use crate::vehicle::Classes;

const SHIPPED: &str = include_str!("../../../../../data/designations.toml");

static BUILTIN: LazyLock<Designations> = LazyLock::new(|| Designations::from_toml(SHIPPED).unwrap_or_default());

/// Why a file of designations cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DesignationsError {
    /// The text is not TOML, or has other fields.
    #[error("designations: {0}")]
    Toml(#[from] toml::de::Error),
    /// A field is wrong.
    #[error("designations: {id}: {message}")]
    Value {
        /// The designation.
        id: String,
        /// What is wrong with it.
        message: String,
    },
}

/// A sign or a network.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Designation {
    /// A short name.
    pub id: String,
    /// What people call it.
    pub name: String,
    /// Tags as `key=value`. All of them hold on a road that has the designation.
    tags: Vec<String>,
    /// Codes of countries (ISO 3166-1) and states (ISO 3166-2).
    places: Vec<String>,
    /// Ids of the vehicles of the catalogue that the law admits there.
    pub vehicles: Vec<String>,
    /// The rule that admits them.
    pub law: String,
    /// Where the rule was read.
    pub source: String,
}

/// All known designations.
#[derive(Debug, Clone, Default, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Designations {
    designation: Vec<Designation>,
}

impl Designations {
    /// The shipped table.
    #[must_use]
    pub fn builtin() -> &'static Self {
        &BUILTIN
    }

    /// Reads a table.
    ///
    /// # Errors
    /// A field is missing or wrong. The error names the designation.
    pub fn from_toml(text: &str) -> Result<Self, DesignationsError> {
        let table: Self = toml::from_str(text)?;
        for (no, designation) in table.designation.iter().enumerate() {
            let wrong = |message: &str| {
                Err(DesignationsError::Value { id: designation.id.clone(), message: message.to_owned() })
            };
            if table.designation.iter().take(no).any(|other| other.id == designation.id) {
                return wrong("there are two with this id");
            }
            if designation.tags.is_empty() || designation.tags.iter().any(|tag| !tag.contains('=')) {
                return wrong("tags: give each as key=value");
            }
            if designation.places.is_empty() || designation.vehicles.is_empty() {
                return wrong("places and vehicles must not be empty");
            }
        }
        Ok(table)
    }

    /// The designations in the order of the file.
    #[must_use]
    pub fn all(&self) -> &[Designation] {
        &self.designation
    }

    /// Whether a tag of a road belongs to some designation.
    pub(super) fn has_tag(&self, key: &str, value: &str) -> bool {
        self.designation.iter().flat_map(|designation| &designation.tags).any(|tag| is_tag(tag, key, value))
    }
}

impl Designation {
    /// Whether roads of this country may have it. `regions` are the codes of the regions around the road, such as `US-OH`.
    #[must_use]
    pub fn holds_in(&self, country: &str, regions: &[&str]) -> bool {
        let of_country = |place: &str| place.split('-').next() == Some(country);
        self.places.iter().any(|place| place == country || (of_country(place) && regions.contains(&place.as_str())))
    }

    /// Whether a direction of a road has it. `tags` are those that the road keeps of the map: [`super::Legal::tags`].
    #[must_use]
    pub fn signed(&self, tags: Option<&str>) -> bool {
        self.tags.iter().all(|tag| tag_lines::tags(tags).any(|(key, value)| is_tag(tag, key, value)))
    }

    /// The value of its first tag. No direction of a road has the designation without it.
    #[must_use]
    pub fn first_value(&self) -> &str {
        self.tags.first().and_then(|tag| tag.split_once('=')).map_or("", |(_, value)| value)
    }

    /// Its tags, as people write them.
    #[must_use]
    pub fn tags(&self) -> String {
        self.tags.join(", ")
    }
}

/// Whether a tag of one direction of a road is this `key=value`. Other names of a key count (`data/classes.toml`).
fn is_tag(tag: &str, key: &str, value: &str) -> bool {
    let plain = key.strip_suffix(":forward").or_else(|| key.strip_suffix(":backward")).unwrap_or(key);
    let (head, rest) = plain.split_at(plain.find(':').unwrap_or(plain.len()));
    tag.strip_prefix(Classes::builtin().main_name(head))
        .and_then(|left| left.strip_prefix(rest))
        .and_then(|left| left.strip_prefix('='))
        == Some(value)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::osm::facts::{Legal, way_facts};
    use crate::vehicle::Catalogue;

    /// Tags as `key=value`, separated by `|` with blanks around.
    fn legal(tags: &str) -> [Legal; 2] {
        let tags = tags.split(" | ").filter_map(|tag| tag.split_once('='));
        let all: Vec<(&str, &str)> = [("highway", "primary")].into_iter().chain(tags).collect();
        let facts = way_facts(&all).unwrap().facts;
        [facts.legal_forward.clone(), facts.legal_backward.clone()]
    }

    /// The designations of a direction, whatever its country.
    fn of(legal: &Legal) -> Vec<&'static str> {
        let all = Designations::builtin().all().iter();
        all.filter(|designation| designation.signed(legal.tags.as_deref())).map(|one| one.id.as_str()).collect()
    }

    #[test]
    fn the_shipped_file_names_vehicles_of_the_catalogue() {
        assert_eq!(Designations::from_toml(SHIPPED).unwrap(), *Designations::builtin());
        let catalogue = Catalogue::builtin().unwrap();
        for designation in Designations::builtin().all() {
            for vehicle in &designation.vehicles {
                assert!(catalogue.get(vehicle).is_ok(), "{}: {vehicle}", designation.id);
            }
            assert!(!designation.law.is_empty() && !designation.source.is_empty(), "{}", designation.id);
        }
    }

    #[test]
    fn tags_sign_a_direction() {
        let of_us = ["us-national-network", "us-national-network-53"];
        let of_au = ["au-road-train", "au-road-train-2"];
        for (tags, forward, backward) in [
            ("", &[][..], &[][..]),
            ("hgv=yes", &[], &[]),
            ("hgv=designated", &[], &[]),
            ("hgv:national_network:forward=yes", &of_us, &[]),
            ("bdouble:backward=designated | hgv=no", &[], &["au-b-double"]),
            ("hgv:national_network=yes | maxheight=4.2", &of_us, &of_us),
            ("b_double=designated", &["au-b-double"], &["au-b-double"]),
            ("roadtrain=designated | roadtrain:trailers=3", &of_au, &of_au),
            ("roadtrain=yes | roadtrain:trailers=3", &[], &[]),
        ] {
            let found = legal(tags);
            assert_eq!((&of(&found[0])[..], &of(&found[1])[..]), (forward, backward), "{tags:?}");
        }
    }

    #[test]
    fn a_state_has_its_own_and_those_of_its_country() {
        let of = |country: &str, regions: &[&str]| -> Vec<&str> {
            let all = Designations::builtin().all().iter();
            let mut all: Vec<&str> =
                all.filter(|one| one.holds_in(country, regions)).map(|one| one.id.as_str()).collect();
            all.sort_unstable();
            all
        };
        assert_eq!(of("US", &["US-OH", "US"]), ["us-national-network", "us-national-network-53"]);
        assert_eq!(of("US", &["US-CA", "US"]), ["us-national-network"]);
        assert_eq!(of("US", &[]), ["us-national-network"], "a state that nobody knows");
        assert_eq!(of("CA", &["US-OH"]), Vec::<&str>::new(), "a country that the user names");
        assert_eq!(of("AU", &["AU-TAS", "AU"]), ["au-b-double"]);
        assert_eq!(of("AU", &["AU-WA", "AU"]), Vec::<&str>::new());
    }

    #[test]
    fn a_file_that_is_wrong_names_the_designation() {
        let one = "[[designation]]\nid = \"a\"\nname = \"A\"\ntags = [\"hgv=designated\"]\nplaces = [\"DE\"]\n\
                   vehicles = [\"EU-SEMI16.5\"]\nlaw = \"L\"\nsource = \"S\"\n";
        assert_eq!(Designations::from_toml(one).unwrap().all().len(), 1);
        let wrong = |text: &str| Designations::from_toml(text).unwrap_err().to_string();
        assert_eq!(wrong(&one.repeat(2)), "designations: a: there are two with this id");
        assert_eq!(wrong(&one.replace("hgv=designated", "hgv")), "designations: a: tags: give each as key=value");
        assert!(wrong(&one.replace("\"DE\"", "")).ends_with("must not be empty"));
        assert!(wrong(&one.replace("law", "laws")).contains("laws"));
    }
}
