//! What rules of the road see in a vehicle: its class, its trailers, its axles (`data/classes.toml`, compiled in).

use std::collections::BTreeMap;
use std::sync::LazyLock;

use serde::Deserialize;

use super::Vehicle;

const BUILTIN: &str = include_str!("../../../../data/classes.toml");

/// Keys that every vehicle obeys, least specific first.
pub const EVERYBODY: [&str; 3] = ["access", "vehicle", "motor_vehicle"];

/// Longest combination under directive 96/53/EC, metres. What is longer needs a permit of its own in Europe.
const LONGEST_ORDINARY_M: f64 = 18.75;

static CLASSES: LazyLock<Classes> = LazyLock::new(|| toml::from_str(BUILTIN).unwrap_or_default());

/// A class of vehicles, as `data/classes.toml` has it.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Class {
    /// As in vehicle files.
    pub id: String,
    /// Name for people.
    pub name: String,
    /// Keys beyond [`EVERYBODY`], least specific first.
    pub keys: Vec<String>,
    /// Those of `keys` that may close a road for the class and never open one.
    #[serde(default)]
    pub only_closes: Vec<String>,
    /// Least and greatest number of trailers. `None`: the units are counted.
    #[serde(default)]
    pub trailers: Option<[u32; 2]>,
    /// Whether a dolly may count as a trailer.
    #[serde(default)]
    pub dolly_is_trailer: bool,
    /// Whether it is articulated in the sense of a condition. `None`: it may be.
    #[serde(default)]
    pub articulated: Option<bool>,
    /// Whether it pulls a semi-trailer. `None`: it may.
    #[serde(default)]
    pub semitrailer: Option<bool>,
    /// Where the memberships come from.
    pub source: String,
}

/// How a class stands to a key.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Member {
    /// The key is for the class.
    Yes,
    /// The key may be meant for the class. It closes and never opens.
    Maybe,
    /// The key is for others.
    No,
}

/// All classes.
#[derive(Debug, Clone, Default, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Classes {
    alias: BTreeMap<String, String>,
    class: Vec<Class>,
}

impl Classes {
    /// The shipped classes.
    #[must_use]
    pub fn builtin() -> &'static Self {
        &CLASSES
    }

    /// The classes in file order.
    #[must_use]
    pub fn all(&self) -> &[Class] {
        &self.class
    }

    /// The class with this id.
    #[must_use]
    pub fn get(&self, id: &str) -> Option<&Class> {
        self.class.iter().find(|class| class.id == id)
    }

    /// Whether some class obeys a key, [`EVERYBODY`]'s included.
    #[must_use]
    pub fn is_key(&self, key: &str) -> bool {
        EVERYBODY.contains(&key) || self.class.iter().any(|class| class.keys.iter().any(|own| own == key))
    }

    /// A key by its main name.
    #[must_use]
    pub fn main_name<'k>(&'k self, key: &'k str) -> &'k str {
        self.alias.get(key).map_or(key, String::as_str)
    }

    /// Other names and the main names that they stand for.
    pub fn aliases(&self) -> impl Iterator<Item = (&str, &str)> {
        self.alias.iter().map(|(other, main)| (other.as_str(), main.as_str()))
    }
}

impl Class {
    /// How the class stands to a key, given by its main name.
    #[must_use]
    pub fn member(&self, key: &str) -> Member {
        if EVERYBODY.contains(&key) {
            return Member::Yes;
        }
        match (self.keys.iter().any(|own| own == key), self.only_closes.iter().any(|own| own == key)) {
            (_, true) => Member::Maybe,
            (true, false) => Member::Yes,
            (false, false) => Member::No,
        }
    }
}

impl Vehicle {
    /// The class that rules of the road see: the stated one, else the one of the units. `None` only if the shipped classes are damaged.
    #[must_use]
    pub fn class(&self) -> Option<&'static Class> {
        let id = self.class.as_deref().unwrap_or_else(|| self.class_of_units());
        Classes::builtin().get(id)
    }

    /// Trailers, dollies not counted.
    fn trailers_without_dollies(&self) -> u32 {
        (1..self.units.len()).filter(|&unit| !self.is_dolly(unit)).count() as u32
    }

    /// A class that is no more permissive than what the vehicle may be.
    fn class_of_units(&self) -> &'static str {
        match (self.units.len(), self.trailers_without_dollies()) {
            (..2, _) => "rigid",
            (2, 1) if self.carries(0) && self.length_m <= LONGEST_ORDINARY_M => "semi",
            (2, 1) if self.carries(0) => "semi_long",
            (_, 1) if self.length_m <= LONGEST_ORDINARY_M => "drawbar",
            _ => "combination",
        }
    }

    /// Least and greatest number of trailers that rules may count.
    #[must_use]
    pub fn trailers(&self) -> [u32; 2] {
        let counted = self.trailers_without_dollies();
        match self.class() {
            Some(Class { trailers: Some(trailers), .. }) => *trailers,
            Some(Class { dolly_is_trailer: false, .. }) => [counted; 2],
            _ => [counted, (self.units.len() as u32).saturating_sub(1)],
        }
    }

    /// Least number of axles, and the greatest if it is known.
    #[must_use]
    pub fn axle_range(&self) -> (u32, Option<u32>) {
        match self.axles {
            Some(axles) => (axles, Some(axles)),
            // The prime mover has two, and every other unit one at least.
            None => (self.units.len() as u32 + 1, None),
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::vehicle::Catalogue;

    #[test]
    fn classes_are_whole_and_every_catalogue_vehicle_states_its_own() {
        let classes = Classes::builtin();
        assert!(classes.all().len() >= 12);
        for class in classes.all() {
            assert!(
                !class.source.is_empty() && class.only_closes.iter().all(|key| class.keys.contains(key)),
                "{}",
                class.id
            );
            assert!(class.keys.iter().all(|key| classes.main_name(key) == key), "{}", class.id);
        }
        for (_, main) in classes.aliases() {
            assert!(classes.is_key(main), "{main}");
        }
        for vehicle in Catalogue::builtin().unwrap().iter() {
            let stated = vehicle.class.as_deref().unwrap();
            assert_eq!(vehicle.class().unwrap().id, stated);
            let [least, most] = vehicle.trailers();
            assert!(
                least <= most && vehicle.axles.is_none_or(|axles| axles as usize > vehicle.units.len()),
                "{}",
                vehicle.id
            );
        }
    }

    #[test]
    fn members_and_numbers_are_those_of_the_law() {
        let catalogue = Catalogue::builtin().unwrap();
        let member = |id: &str, key: &str| catalogue.get(id).unwrap().class().unwrap().member(key);
        for (id, key, expected) in [
            ("EU-SEMI16.5", "hgv_articulated", Member::Yes),
            ("EU-SEMI16.5", "lhv", Member::No),
            ("EU-SEMI16.5", "bus", Member::No),
            ("EU-DRAWBAR18.75", "hgv_articulated", Member::Maybe),
            ("AU-BDOUBLE26", "bdouble", Member::Yes),
            ("AU-BDOUBLE26", "roadtrain", Member::No),
            ("AU-ATRIPLE53", "bdouble", Member::Maybe),
            ("AU-ATRIPLE53", "roadtrain", Member::Yes),
            ("EU-EMS25-D", "lhv", Member::Yes),
            ("EU-EMS2-AB34.5", "lhv", Member::Maybe),
            ("BUS-ART18-EU", "hgv", Member::No),
            ("BUS-ART18-EU", "psv", Member::Yes),
            ("BUS-ART18-EU", "trailer", Member::No),
            ("AGV-TUG4", "hgv", Member::Maybe),
        ] {
            assert_eq!(member(id, key), expected, "{id} {key}");
        }
        for (id, trailers) in [
            ("EU-SEMI16.5", [1, 1]),
            ("EU-DRAWBAR18.75", [1, 1]),
            ("EU-EMS25-D", [1, 2]),
            ("EU-EMS25-C", [2, 2]),
            ("AU-BDOUBLE26", [2, 2]),
            ("AU-ATRIPLE53", [3, 3]),
            ("BUS-BIART24", [0, 0]),
        ] {
            assert_eq!(catalogue.get(id).unwrap().trailers(), trailers, "{id}");
        }
    }

    /// Without a class, no road is open to a vehicle that is closed to it with its class, but for buses and tugs, which nobody can tell
    /// from lorries.
    #[test]
    fn the_class_of_the_units_is_no_more_permissive() {
        for vehicle in Catalogue::builtin().unwrap().iter() {
            let stated = vehicle.class().unwrap();
            let bare = Vehicle { class: None, ..vehicle.clone() };
            let derived = bare.class().unwrap();
            if matches!(stated.id.as_str(), "bus" | "tug") {
                continue;
            }
            for key in &derived.keys {
                let (with, without) = (stated.member(key), derived.member(key));
                assert!(without != Member::Yes || with == Member::Yes, "{} {key}", vehicle.id);
            }
            for key in &stated.keys {
                assert!(derived.member(key) != Member::No, "{} {key}", vehicle.id);
            }
        }
    }
}
