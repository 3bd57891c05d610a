//! Selects the ways that are roads for heavy vehicles, and reads all tags of a way in one pass.
//!
//! Kept are motorway to residential, `road`, living streets, busways (closed unless tagged open) and service roads with
//! alleys, because loading bays are on service roads. Parking aisles, driveways, drive-throughs and emergency accesses
//! are left out unless a tag opens them to heavy goods vehicles. Tracks are left out unless they are tagged open to
//! motor vehicles and are of grade 1 or known width. A way with denied access stays; its verdict says so.

use crate::osm::facts::limits::LegalTags;
use crate::osm::facts::notes::{Note, Notes};
use crate::osm::facts::section_reader::{SectionReader, Sharing};
use crate::osm::facts::speed::SpeedTags;
use crate::osm::facts::{Direction, Legal, Oneway, Permission, RoadClass, Tags, WayDraft, WayFacts, tag_lines};
use crate::words::Named as _;

/// Every reason for which [`way_facts`] leaves a way out.
pub const LEFT_OUT_REASONS: [&str; 6] = [NO_HIGHWAY, NOT_A_ROAD, NOT_IN_USE, AREA, MINOR_SERVICE, TRACK];

const NO_HIGHWAY: &str = "no_highway";
const NOT_A_ROAD: &str = "not_a_road";
const NOT_IN_USE: &str = "not_in_use";
const AREA: &str = "area";
const MINOR_SERVICE: &str = "minor_service";
const TRACK: &str = "track";

pub(super) fn road_class(highway: &str) -> Result<RoadClass, &'static str> {
    Ok(match highway.strip_suffix("_link").unwrap_or(highway) {
        "motorway" => RoadClass::Motorway,
        "trunk" => RoadClass::Trunk,
        "primary" => RoadClass::Primary,
        "secondary" => RoadClass::Secondary,
        "tertiary" => RoadClass::Tertiary,
        "unclassified" | "road" => RoadClass::Unclassified,
        "residential" => RoadClass::Residential,
        "living_street" => RoadClass::LivingStreet,
        "service" => RoadClass::Service,
        "track" => RoadClass::Track,
        "busway" | "bus_guideway" => RoadClass::Busway,
        "construction" | "proposed" | "planned" | "abandoned" | "disused" | "razed" | "demolished" => {
            return Err(NOT_IN_USE);
        }
        _ => return Err(NOT_A_ROAD),
    })
}

/// `oneway` with its exceptions for motor vehicles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum OnewayTag {
    No,
    Forward,
    Backward,
    Reversible,
    Alternating,
}

fn oneway_tag(value: &str, notes: &mut Notes) -> Option<OnewayTag> {
    Some(match value {
        "no" | "false" | "0" => OnewayTag::No,
        "yes" | "true" | "1" => OnewayTag::Forward,
        "-1" | "reverse" => OnewayTag::Backward,
        "reversible" => OnewayTag::Reversible,
        "alternating" => OnewayTag::Alternating,
        _ => {
            notes.add(Note::BadOneway);
            return None;
        }
    })
}

/// The tags that determine class and direction.
#[derive(Debug, Default)]
struct Basics<'t> {
    oneway: Option<OnewayTag>,
    /// `oneway:vehicle` and `oneway:motor_vehicle`, which say more of the traffic on the road than `oneway`.
    oneway_motor: [Option<OnewayTag>; 2],
    roundabout: bool,
    area: bool,
    service: &'t str,
    grade1: bool,
    name: Option<&'t str>,
    reference: Option<&'t str>,
}

impl<'t> Basics<'t> {
    fn take(&mut self, key: &str, value: &'t str, notes: &mut Notes) {
        match key {
            "oneway" => self.oneway = oneway_tag(value, notes),
            "oneway:vehicle" => self.oneway_motor[0] = oneway_tag(value, &mut Notes::default()),
            "oneway:motor_vehicle" => self.oneway_motor[1] = oneway_tag(value, &mut Notes::default()),
            "junction" => self.roundabout = matches!(value, "roundabout" | "circular"),
            "area" => self.area = value == "yes",
            "service" => self.service = value,
            "tracktype" => self.grade1 = value == "grade1",
            "name" => self.name = Some(value),
            "ref" => self.reference = Some(value),
            _ => {}
        }
    }

    /// The directions of a road that has no tag about them.
    fn untagged_oneway(&self, class: RoadClass, link: bool) -> Oneway {
        let implied = self.roundabout || (class == RoadClass::Motorway && !link);
        if implied { Oneway::Forward } else { Oneway::No }
    }
}

fn directions(tag: OnewayTag) -> Oneway {
    match tag {
        OnewayTag::Forward => Oneway::Forward,
        OnewayTag::Backward => Oneway::Backward,
        OnewayTag::No | OnewayTag::Reversible | OnewayTag::Alternating => Oneway::No,
    }
}

/// The directions for which the carriageway is laid out: those of general traffic. If lorries have others, both share the road.
fn traffic(basics: &Basics<'_>, legal: &LegalTags<'_>, untagged: Oneway, general: Oneway) -> Oneway {
    let [vehicle, motor_vehicle] = basics.oneway_motor;
    let general = motor_vehicle.or(vehicle).map_or(general, directions);
    let lorries = legal.oneway(untagged, |class| class.keys.iter().any(|key| key == "hgv")).unwrap_or(general);
    if lorries == general { general } else { Oneway::No }
}

/// Whether a tag says how wide a road or its lanes are, or how many lanes there are. Its key is split at the first colon.
fn is_width(head: &str, suffix: &str) -> bool {
    match head {
        "width" => suffix != "source",
        "lanes" => matches!(suffix, "" | "forward" | "backward"),
        "est_width" | "narrow" => suffix.is_empty(),
        _ => false,
    }
}

/// Why a way of a class is no road for heavy vehicles, by its other tags.
fn left_out(
    class: RoadClass,
    basics: &Basics<'_>,
    legal: &LegalTags<'_>,
    section: &SectionReader,
) -> Option<&'static str> {
    if basics.area {
        return Some(AREA);
    }
    let minor =
        matches!(basics.service, "parking_aisle" | "driveway" | "drive-through" | "drive_through" | "emergency_access");
    if class == RoadClass::Service && minor && !legal.access.open_to_hgv() {
        return Some(MINOR_SERVICE);
    }
    let known = basics.grade1 || section.has_width();
    (class == RoadClass::Track && !(legal.access.explicitly_open() && known)).then_some(TRACK)
}

/// Reads the facts of a way from its tags.
///
/// # Errors
/// The reason why the way is no road for heavy vehicles: one of [`LEFT_OUT_REASONS`], a stable identifier.
pub fn way_facts<'t>(tags: &Tags<'t>) -> Result<WayDraft<'t>, &'static str> {
    let highway = tags.iter().find(|(key, _)| *key == "highway").map(|(_, value)| *value).ok_or(NO_HIGHWAY)?;
    let class = road_class(highway)?;
    let link = highway.ends_with("_link");

    let mut notes = Notes::default();
    let mut basics = Basics::default();
    let mut legal = LegalTags::default();
    let mut speed = SpeedTags::default();
    let mut section = SectionReader::default();
    let mut unreadable = Vec::new();
    let mut width_tags = String::new();
    for &(key, value) in tags {
        basics.take(key, value, &mut notes);
        let (head, suffix) = key.split_once(':').unwrap_or((key, ""));
        legal.take(key, value, &mut notes);
        speed.take(head, suffix, value, &mut notes);
        if is_width(head, suffix) {
            tag_lines::add(&mut width_tags, key, value);
        }
        if !section.take(head, suffix, value, &mut notes) {
            unreadable.push((key, value));
        }
    }
    if !section.has_width() {
        unreadable.iter().for_each(|&(key, value)| legal.take_unreadable_width(key, value));
    }

    if let Some(reason) = left_out(class, &basics, &legal, &section) {
        return Err(reason);
    }
    if class == RoadClass::Busway {
        legal.access.imply_no_motor_vehicles();
    }

    let untagged = basics.untagged_oneway(class, link);
    let general = basics.oneway.map_or(untagged, directions);
    let oneway = legal.oneway(untagged, |_| true).unwrap_or(general);
    let traffic = traffic(&basics, &legal, untagged, general);
    legal.note_rules(&mut notes);
    let mut legals = [Direction::Forward, Direction::Backward].map(|direction| {
        let resolved = legal.resolve(direction, untagged);
        Legal { tags: tag_lines::merged(resolved.tags.as_deref(), legal.signs(direction).as_deref()), ..resolved }
    });
    let sharing = match basics.oneway {
        Some(OnewayTag::Reversible) => Sharing::Reversible,
        Some(OnewayTag::Alternating) => Sharing::Alternating,
        _ => Sharing::Never,
    };
    if sharing == Sharing::Reversible {
        notes.add(Note::Reversible);
        for legal in &mut legals {
            legal.hgv = legal.hgv.max(Permission::Restricted);
        }
    }
    let section = section.finish(traffic, sharing, &mut notes);
    let [legal_forward, legal_backward] = legals;
    Ok(WayDraft {
        facts: WayFacts {
            class,
            link,
            roundabout: basics.roundabout,
            oneway,
            name: None,
            reference: None,
            legal_forward,
            legal_backward,
            max_speed_km_h: speed.km_h,
            width_tags: (!width_tags.is_empty()).then(|| width_tags.into()),
            section,
        },
        name: basics.name,
        reference: basics.reference,
        notes,
    })
}

/// The value of `highway`: the class, with `_link` for links.
#[must_use]
pub fn highway(class: RoadClass, link: bool) -> String {
    format!("{}{}", class.name(), if link { "_link" } else { "" })
}

/// The reverse of [`highway`].
pub fn class_and_link(highway: &str) -> Option<(RoadClass, bool)> {
    let (class, link) = highway.strip_suffix("_link").map_or((highway, false), |class| (class, true));
    Some((RoadClass::named(class)?, link))
}

#[cfg(test)]
mod tests {
    use super::{class_and_link, highway};
    use crate::osm::facts::RoadClass;

    #[test]
    fn links_come_back_from_their_word() {
        assert_eq!(class_and_link(&highway(RoadClass::Motorway, true)), Some((RoadClass::Motorway, true)));
        assert_eq!(class_and_link("link"), None);
    }
}
