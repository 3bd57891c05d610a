//! One tag as a rule: whom it concerns, and what it says.

use super::condition::{Clause, clauses};
use super::property::Property;
use crate::osm::facts::access::permission;
use crate::osm::facts::keys::REMARKS;
use crate::osm::facts::notes::Notes;
use crate::osm::facts::{Direction, Limit, Permission};
use crate::vehicle::{Class, Classes, Member};

/// What a rule is about.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum About {
    /// Access, by key.
    Access(String),
    /// The direction of travel, for the vehicles of a key; empty for all.
    Oneway(String),
    /// A limit.
    Limit(Property),
    /// Nobody gets through.
    Impassable,
    /// Open at some times of the year.
    Seasonal,
    /// A width that cannot be read. It says nothing of the vehicle; it is kept so that people see why no width is known.
    Width,
}

/// What a rule says.
#[derive(Debug, Clone)]
pub(crate) enum Says {
    Plain(String),
    Conditional(Vec<Clause>),
}

/// A rule.
#[derive(Debug, Clone)]
pub(crate) struct Rule {
    /// `key=value`
    pub(crate) text: String,
    pub(crate) about: About,
    /// Keys of classes that the vehicle must belong to as well: `trailer` of `hgv:trailer`.
    pub(crate) scope: Vec<String>,
    /// Whether the key names the direction.
    pub(crate) directed: bool,
    pub(crate) says: Says,
}

/// Keys of vehicles that netcert does not have. Rules for them are none of its vehicles'.
pub(in crate::osm::facts) const OTHER_VEHICLES: [&str; 37] = [
    "agricultural",
    "atv",
    "bicycle",
    "canoe",
    "caravan",
    "carpool",
    "carriage",
    "cycle_rickshaw",
    "dog",
    "electric_bicycle",
    "emergency",
    "foot",
    "forestry",
    "golf_cart",
    "hand_cart",
    "hazmat",
    "horse",
    "hov",
    "inline_skates",
    "kick_scooter",
    "light_rail",
    "minibus",
    "mofa",
    "moped",
    "motorcar",
    "motorcycle",
    "motorhome",
    "mtb",
    "pedestrian",
    "share_taxi",
    "ski",
    "small_electric_vehicle",
    "snowmobile",
    "speed_pedelec",
    "taxi",
    "tram",
    "wheelchair",
];

/// Keys of widths, which become rules only where they cannot be read.
const WIDTHS: [&str; 3] = ["width", "width:carriageway", "est_width"];

/// A key that speaks of a limit but bars the passage whole, or seasons.
fn about_of(key: &str) -> Option<About> {
    Some(match key {
        "impassable" => About::Impassable,
        "seasonal" | "ice_road" | "winter_road" => About::Seasonal,
        _ => return None,
    })
}

/// Whether the first part of a key may begin a rule.
pub(crate) fn may_be_rule(head: &str) -> bool {
    matches!(
        head,
        "access"
            | "vehicle"
            | "motor_vehicle"
            | "goods"
            | "hgv"
            | "hgv_articulated"
            | "hgv_semitrailer"
            | "trailer"
            | "semitrailer"
            | "bdouble"
            | "b_double"
            | "b-double"
            | "roadtrain"
            | "road_train"
            | "lhv"
            | "longer_heavier_vehicle"
            | "psv"
            | "bus"
            | "tourist_bus"
            | "coach"
            | "oneway"
            | "impassable"
            | "seasonal"
            | "ice_road"
            | "winter_road"
            | "bridge"
    ) || head.starts_with("max") && Property::of_key(head).is_some()
}

/// A text on one line, without blanks around.
fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

impl Rule {
    /// Reads a tag for a direction of travel. `None` if it is no rule, or none for this direction, or for vehicles that netcert does not have.
    pub(crate) fn read(key: &str, value: &str, side: Direction) -> Option<Self> {
        if WIDTHS.contains(&key) {
            let (text, says) = (format!("{key}={}", one_line(value)), Says::Plain(one_line(value)));
            return Some(Self { text, about: About::Width, scope: Vec::new(), directed: false, says });
        }
        let classes = Classes::builtin();
        let (mut about, mut scope): (Option<About>, Vec<String>) = (None, Vec::new());
        let (mut directed, mut conditional, mut lanes, mut strange) = (false, false, false, false);
        for part in key.split(':') {
            let main = classes.main_name(part);
            match part {
                "forward" | "backward" => {
                    if (part == "forward") != (side == Direction::Forward) {
                        return None;
                    }
                    directed = true;
                }
                "conditional" => conditional = true,
                "lanes" => lanes = true,
                "both_ways" | "physical" | "legal" | "signed" | "bridge" => {}
                "oneway" => about = Some(About::Oneway(String::new())),
                // `roadtrain:trailers`, and axles of a group: `maxaxleload:tandem`.
                "trailers" if !scope.is_empty() => about = Some(About::Limit(Property::Trailers)),
                "tandem" | "bogie" if about == Some(About::Limit(Property::AxleLoad)) => {
                    about = Some(About::Limit(Property::GroupLoad(if part == "tandem" { 2 } else { 3 })));
                }
                _ if classes.is_key(main) => scope.push(main.to_owned()),
                _ if OTHER_VEHICLES.contains(&part) || REMARKS.contains(&part) => return None,
                _ => match Property::of_key(part).map(About::Limit).or_else(|| about_of(part)) {
                    Some(other) if about.is_none() => about = Some(other),
                    _ => strange = true,
                },
            }
        }
        let value = one_line(value);
        let about = match about {
            Some(About::Oneway(_)) if !strange && !lanes => match scope.len() {
                0 => About::Oneway(String::new()),
                _ => About::Oneway(scope.remove(0)),
            },
            // A limit by a key with parts that nobody knows counts if its value is a number; else the tag is a remark, such as
            // `maxweight:signed=no`.
            Some(About::Limit(property)) if strange && !states_limit(property, &value) => return None,
            Some(About::Limit(property)) => limit_about(property, &scope, &value)?,
            // `seasonal=no`
            Some(About::Impassable | About::Seasonal) if strange || matches!(value.as_str(), "no" | "false" | "0") => {
                return None;
            }
            Some(other @ (About::Impassable | About::Seasonal)) => other,
            None if !scope.is_empty() && !strange && !lanes => About::Access(scope.remove(0)),
            _ => return None,
        };
        let says = if conditional { Says::Conditional(clauses(&value)) } else { Says::Plain(value.clone()) };
        Some(Self { text: format!("{}={value}", one_line(key)), about, scope, directed, says })
    }

    /// Whether the class is one that the rule's scope names. The rule may mean a class that only may be meant.
    pub(crate) fn concerns(&self, class: &Class) -> bool {
        self.scope.iter().all(|key| class.member(key) != Member::No)
    }

    /// Whether it says different things at different times.
    pub(crate) fn depends_on_time(&self) -> bool {
        match (&self.about, &self.says) {
            (About::Seasonal, _) => true,
            (About::Oneway(_), Says::Plain(value)) => value.contains("reversible"),
            (_, Says::Conditional(clauses)) => clauses.iter().any(|clause| clause.condition.depends_on_time()),
            _ => false,
        }
    }

    /// Whether a conditional rule has something that is not understood and may close the road.
    pub(crate) fn is_strange(&self) -> bool {
        match &self.says {
            Says::Conditional(clauses) => clauses.iter().any(|clause| clause.condition.has_strange()),
            Says::Plain(value) => {
                matches!(self.about, About::Oneway(_))
                    && [Direction::Forward, Direction::Backward]
                        .iter()
                        .any(|&side| oneway_closes(value, side) == Closes::Unclear)
            }
        }
    }
}

/// Whether a value says what the limit is, at all times or at some.
fn states_limit(property: Property, value: &str) -> bool {
    matches!(property.read(value), Limit::At(_)) || value.contains('@')
}

/// What a tag of a limit is about. `None` if it only says that there is none.
fn limit_about(property: Property, scope: &[String], value: &str) -> Option<About> {
    let remark = matches!(value, "yes" | "no");
    if remark && !states_limit(property, value) {
        // `maxweight=yes` says that there is a limit.
        return (value == "yes").then_some(About::Limit(property));
    }
    let of_trailers = scope.iter().any(|key| key == "trailer" || key == "semitrailer");
    Some(About::Limit(if of_trailers { property.of_trailers() } else { property }))
}

/// Whether a value of `oneway` closes a direction of travel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Closes {
    No,
    /// At some times.
    Sometimes,
    /// Nobody knows.
    Unclear,
    Yes,
}

/// Whether a value of `oneway` closes a direction of travel. Entries of a list that disagree leave it unclear.
pub(crate) fn oneway_closes(value: &str, side: Direction) -> Closes {
    let one = |part: &str| match part.trim().to_ascii_lowercase().as_str() {
        "no" | "false" | "0" | "alternating" => Closes::No,
        "yes" | "true" | "1" | "forward" => {
            if side == Direction::Backward {
                Closes::Yes
            } else {
                Closes::No
            }
        }
        "-1" | "reverse" | "backward" | "opposite" => {
            if side == Direction::Forward {
                Closes::Yes
            } else {
                Closes::No
            }
        }
        "reversible" => Closes::Sometimes,
        _ => Closes::Unclear,
    };
    let mut parts = value.split(';').map(one);
    let first = parts.next().unwrap_or(Closes::Unclear);
    if parts.all(|other| other == first) { first } else { Closes::Unclear }
}

/// The permission of a value for a class. `access=psv` is for buses.
pub(crate) fn permission_for(value: &str, class: &Class) -> Permission {
    let classes = Classes::builtin();
    let for_class = |part: &str| {
        let key = classes.main_name(part.trim());
        matches!(key, "psv" | "bus" | "tourist_bus") && class.member(key) == Member::Yes
    };
    if value.split(';').any(for_class) && !value.split(';').any(|part| part.trim() == "no") {
        return Permission::Yes;
    }
    permission(value, &mut Notes::default())
}
