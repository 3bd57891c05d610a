//! Access tags: which of them decides for a heavy goods vehicle, per direction of travel.
//!
//! The most specific key wins (access < vehicle < motor_vehicle < hgv < hgv_articulated; a key with a direction beats
//! one without), as on the wiki page Key:access. `trailer=no` forbids, because every vehicle here may pull a trailer.
//! Conditions are not evaluated against a clock; see [`AccessTags::condition`].

use crate::osm::facts::notes::{Note, Notes};
use crate::osm::facts::{Direction, Permission};

/// Keys that apply to a heavy goods vehicle, least specific first.
const KEYS: [&str; 6] = ["access", "vehicle", "motor_vehicle", "hgv", "hgv_articulated", "trailer"];
const HGV: usize = 3;
const TRAILER: usize = 5;

/// Whether this module reads a key (the part before the first colon).
pub(super) fn is_access_key(head: &str) -> bool {
    KEYS.contains(&head)
}

/// The access tags of one object while they are collected. The inner arrays have the indices none, forward, backward.
#[derive(Debug, Default)]
pub(super) struct AccessTags {
    tagged: [[Option<Permission>; 3]; KEYS.len()],
    /// The strictest undecided conditional value per direction: for motor vehicles, then for heavy goods vehicles.
    undecided: [[Permission; 2]; 2],
}

/// The permission of a value or of a list. In a list the most permissive entry counts, except that `no` stays no.
pub(super) fn permission(value: &str, notes: &mut Notes) -> Permission {
    let mut best = Permission::No;
    for part in value.split(';') {
        let one = match part.trim() {
            "yes" | "designated" | "permissive" | "official" | "public" => Permission::Yes,
            "destination" | "delivery" | "customers" | "customer" | "discouraged" | "local" | "permit" => {
                Permission::Restricted
            }
            "no" => return Permission::No,
            "private" | "agricultural" | "forestry" | "emergency" | "military" | "residents" | "psv" | "bus"
            | "taxi" | "foot" | "bicycle" | "permissive_foot" | "employees" | "dismount" | "use_sidepath"
            | "restricted" => Permission::No,
            _ => {
                notes.add(Note::BadAccess);
                Permission::No
            }
        };
        best = best.min(one);
    }
    best
}

impl AccessTags {
    /// Takes `key[:forward|:backward]=value`. Other suffixes mean something else and are not read.
    pub(super) fn take(&mut self, head: &str, suffix: &str, value: &str, notes: &mut Notes) {
        let side = match suffix {
            "" => 0,
            "forward" => 1,
            "backward" => 2,
            _ => return,
        };
        if let Some(rank) = KEYS.iter().position(|key| *key == head) {
            self.tagged[rank][side] = Some(permission(value, notes));
        }
    }

    /// Takes a conditional value with an undecidable condition. A stricter value closes the road to through traffic; a
    /// more lenient one changes nothing.
    pub(super) fn condition(&mut self, head: &str, directions: [bool; 2], value: Permission) {
        let kind = usize::from(KEYS.iter().position(|key| *key == head).is_some_and(|rank| rank >= HGV));
        for (slot, on) in self.undecided[kind].iter_mut().zip(directions) {
            if on {
                *slot = (*slot).max(value);
            }
        }
    }

    /// Sets the implied value of busways if no tag gives one.
    pub(super) fn imply_no_motor_vehicles(&mut self) {
        if self.tagged.iter().flatten().all(Option::is_none) {
            self.tagged[2][0] = Some(Permission::No);
        }
    }

    /// Whether some tag explicitly admits motor vehicles or heavy goods vehicles, at least to a destination.
    pub(super) fn explicitly_open(&self) -> bool {
        self.tagged[..TRAILER].iter().any(|slots| slots[0].is_some_and(|p| p < Permission::No))
    }

    /// As [`Self::explicitly_open`], for the keys of heavy goods vehicles alone.
    pub(super) fn open_to_hgv(&self) -> bool {
        self.tagged[HGV..TRAILER].iter().any(|slots| slots[0].is_some_and(|p| p < Permission::No))
    }

    fn most_specific(&self, ranks: std::ops::Range<usize>, side: usize) -> Option<Permission> {
        self.tagged[ranks].iter().rev().find_map(|slots| slots[side].or(slots[0]))
    }

    /// (motor_vehicle, hgv) for a direction. A tag for heavy goods vehicles decides both: a general ban with
    /// `hgv=designated` does not apply to them.
    pub(super) fn resolve(&self, direction: Direction) -> (Permission, Permission) {
        let side = if direction == Direction::Forward { 1 } else { 2 };
        let general = self.most_specific(0..HGV, side).unwrap_or_default();
        let special = self.most_specific(HGV..TRAILER, side);
        let (mut motor, mut hgv) = match special {
            Some(Permission::No) => (general, Permission::No),
            Some(open) => (open, open),
            None => (general, Permission::Yes),
        };
        if self.most_specific(TRAILER..KEYS.len(), side) == Some(Permission::No) {
            hgv = Permission::No;
        }
        let [general_condition, special_condition] = self.undecided.map(|kind| kind[side - 1]);
        if general_condition > Permission::Yes {
            motor = motor.max(Permission::Restricted);
        }
        if special_condition > Permission::Yes {
            hgv = hgv.max(Permission::Restricted);
        }
        (motor, hgv)
    }
}
