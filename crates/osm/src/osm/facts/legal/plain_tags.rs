//! Which tag stands behind a plain limit, plain access, a barrier or a designation.

use super::{Direction, Legal, Property, RuleTags};
use crate::osm::facts::access::permission;
use crate::osm::facts::keys::PASSAGE_KEYS;
use crate::osm::facts::notes::Notes;
use crate::osm::facts::{Designations, Limit, Permission, tag_lines};

/// Keys of access for lorries and for all motor vehicles, the most specific one first.
const HGV: [&str; 1] = ["hgv"];
const MOTOR_VEHICLE: [&str; 3] = ["motor_vehicle", "vehicle", "access"];

/// The vehicles whose access is meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum AccessOf {
    Lorries,
    MotorVehicles,
}

impl RuleTags<'_> {
    /// The tags behind the plain limits and access of a direction, `key=value` lines in order. `None` where nothing is limited.
    pub(in crate::osm::facts) fn told(&self, side: Direction) -> Option<Box<str>> {
        let own = if side == Direction::Forward { "forward" } else { "backward" };
        let other = if side == Direction::Forward { "backward" } else { "forward" };
        // The most specific key decides, and with a direction before one without.
        let decides = |keys: &[&str]| {
            let find = |wanted: String| self.tags().iter().find(|(key, _)| *key == wanted);
            keys.iter().find_map(|key| find(format!("{key}:{own}")).or_else(|| find((*key).to_owned())))
        };
        let permits = |value: &str| permission(value, &mut Notes::default());
        let hgv = decides(&HGV);
        // What is open to lorries is open to them, whatever holds for other motor vehicles.
        let general =
            if hgv.is_none_or(|(_, value)| permits(value) == Permission::No) { decides(&MOTOR_VEHICLE) } else { None };
        let closing = [hgv, general].into_iter().flatten().filter(|(_, value)| permits(value) > Permission::Yes);
        let is_limit = |key: &str| {
            let mut parts = key.split(':');
            parts.next().and_then(Property::of_key).is_some()
                && parts.all(|part| part != other && part != "conditional")
        };
        let limits = self.tags().iter().filter(|(key, _)| is_limit(key));
        in_order(closing.chain(limits))
    }

    /// The tags of [`Designations`] that a direction has, `key=value` lines in order.
    pub(in crate::osm::facts) fn signs(&self, side: Direction) -> Option<Box<str>> {
        let other = if side == Direction::Forward { ":backward" } else { ":forward" };
        let known = Designations::builtin();
        in_order(self.tags().iter().filter(|(key, value)| !key.ends_with(other) && known.has_tag(key, value)))
    }
}

/// Tags as lines in order. `None` if there are none.
fn in_order<'t>(tags: impl Iterator<Item = &'t (&'t str, &'t str)>) -> Option<Box<str>> {
    let mut all: Vec<&(&str, &str)> = tags.collect();
    all.sort_unstable();
    let mut lines = String::new();
    all.iter().for_each(|(key, value)| tag_lines::add(&mut lines, key, value));
    (!lines.is_empty()).then(|| lines.into())
}

impl Legal {
    /// The tags but those that limit these properties.
    pub(super) fn tags_but(&self, replaced: impl Fn(Property) -> bool) -> Option<Box<str>> {
        let stays = |(key, _): &(&str, &str)| {
            let of = key.split(':').next().and_then(Property::of_key);
            !of.is_some_and(&replaced)
        };
        let mut lines = String::new();
        tag_lines::tags(self.tags.as_deref())
            .filter(stays)
            .for_each(|(key, value)| tag_lines::add(&mut lines, key, value));
        (!lines.is_empty()).then(|| lines.into())
    }

    /// The tag behind a plain limit as `key=value`. `None` if it is not known.
    pub(super) fn tag_of_limit(&self, property: Property, limit: Limit) -> Option<String> {
        let says = |(key, value): &(&str, &str)| {
            let head = key.split(':').next().unwrap_or(key);
            let reads = |part: &str| property.read(part) == limit;
            Property::of_key(head) == Some(property)
                && if key.contains("lanes") { value.split('|').any(reads) } else { reads(value) }
        };
        let restrictor = |(key, value): &(&str, &str)| {
            (*key, *value, property, limit) == ("barrier", "height_restrictor", Property::Height, Limit::Unreadable)
        };
        let tags = || tag_lines::tags(self.tags.as_deref());
        tags().find(says).or_else(|| tags().find(restrictor)).map(|(key, value)| joined(key, value))
    }

    /// The tag behind a permission, as `key=value`. `None` if it is not known.
    pub(super) fn tag_of_access(&self, of: AccessOf, permitted: Permission) -> Option<String> {
        let keys = match of {
            AccessOf::Lorries => &HGV[..],
            AccessOf::MotorVehicles => &MOTOR_VEHICLE,
        };
        let says = |wanted: &str| {
            let is = |(key, value): &(&str, &str)| {
                key.split(':').next() == Some(wanted) && permission(value, &mut Notes::default()) == permitted
            };
            tag_lines::tags(self.tags.as_deref()).find(is)
        };
        keys.iter().find_map(|key| says(key)).map(|(key, value)| joined(key, value))
    }

    /// The tags that say how wide narrow places are, as `key=value`.
    #[must_use]
    pub fn passage_tags(&self) -> Vec<String> {
        tag_lines::tags(self.tags.as_deref())
            .filter(|(key, _)| PASSAGE_KEYS.contains(key))
            .map(|(key, value)| joined(key, value))
            .collect()
    }

    /// The tags of barriers, as `key=value` with commas between them. `None` if they are not known.
    #[must_use]
    pub fn barrier_tag(&self) -> Option<String> {
        let of = |(key, _): &(&str, &str)| matches!(*key, "barrier" | "locked");
        let tags: Vec<String> =
            tag_lines::tags(self.tags.as_deref()).filter(of).map(|(key, value)| joined(key, value)).collect();
        (!tags.is_empty()).then(|| tags.join(", "))
    }
}

fn joined(key: &str, value: &str) -> String {
    format!("{key}={value}")
}
