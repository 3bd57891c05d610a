//! Access tags: which of them speaks for a heavy goods vehicle, per direction of travel.
//!
//! The most specific key wins (access < vehicle < motor_vehicle < hgv < hgv_articulated; with a direction before
//! without), as on the wiki page Key:access. `trailer=no` forbids, since every vehicle here may pull one. Conditions
//! are not evaluated against a clock; see [`Access::condition`].

use crate::osm::facts::notes::{Note, Notes};
use crate::osm::facts::{Direction, Permission};

/// Keys that speak for a heavy goods vehicle, least specific first.
const KEYS: [&str; 6] = ["access", "vehicle", "motor_vehicle", "hgv", "hgv_articulated", "trailer"];
const HGV: usize = 3;
const TRAILER: usize = 5;

/// Whether a key (before its first colon) is read here.
pub(super) fn is_access_key(head: &str) -> bool {
    KEYS.contains(&head)
}

/// The access tags of one object, while they are collected. Index of the inner arrays: none, forward, backward.
#[derive(Debug, Default)]
pub(super) struct Access {
    tagged: [[Option<Permission>; 3]; KEYS.len()],
    /// The strictest undecided conditional value per direction: for motor vehicles, for heavy goods vehicles.
    undecided: [[Permission; 2]; 2],
}

/// One value, or a list of which any entry is enough. `no` in a list stays no.
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

impl Access {
    /// `key[:forward|:backward]=value`; other suffixes mean something else and are not read.
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

    /// A conditional value whose condition cannot be decided. A stricter one makes the road not for through traffic; a
    /// more lenient one changes nothing.
    pub(super) fn condition(&mut self, head: &str, directions: [bool; 2], value: Permission) {
        let kind = usize::from(KEYS.iter().position(|key| *key == head).is_some_and(|rank| rank >= HGV));
        for (slot, on) in self.undecided[kind].iter_mut().zip(directions) {
            if on {
                *slot = (*slot).max(value);
            }
        }
    }

    /// An implied value, where no tag speaks (busways).
    pub(super) fn imply_no_motor_vehicles(&mut self) {
        if self.tagged.iter().flatten().all(Option::is_none) {
            self.tagged[2][0] = Some(Permission::No);
        }
    }

    /// Whether some tag explicitly lets motor vehicles or heavy goods vehicles in, at least to a destination.
    pub(super) fn explicitly_open(&self) -> bool {
        self.tagged[..TRAILER].iter().any(|slots| slots[0].is_some_and(|p| p < Permission::No))
    }

    /// The same, of the keys for heavy goods vehicles alone.
    pub(super) fn open_to_hgv(&self) -> bool {
        self.tagged[HGV..TRAILER].iter().any(|slots| slots[0].is_some_and(|p| p < Permission::No))
    }

    fn most_specific(&self, ranks: std::ops::Range<usize>, side: usize) -> Option<Permission> {
        self.tagged[ranks].iter().rev().find_map(|slots| slots[side].or(slots[0]))
    }

    /// (motor_vehicle, hgv) for a direction. Where a tag for heavy goods vehicles speaks, it decides both: a general
    /// ban with `hgv=designated` is none for them.
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
