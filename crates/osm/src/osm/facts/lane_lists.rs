//! Lists of lanes (`width:lanes`, `hgv:lanes` and the like), from left to right in direction of travel.
//!
//! A list is read as far as it goes. A gap, or an entry that is no width, leaves that lane's width unknown. What other
//! traffic has for itself is closed to heavy vehicles.

use crate::osm::facts::notes::{Note, Notes};
use crate::osm::facts::section::{LANE_STEP_M, LISTED, LaneTags};
use crate::osm::facts::value::{self, readable};
use crate::osm::facts::widths::LANE_M;

/// Lane lists of one direction, before their direction is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Lists {
    /// `lanes` and similar keys; 0 if untagged.
    pub(super) count: u8,
    /// Lanes with turns (`turn:lanes`); 0 if untagged.
    pub(super) turns: u8,
    pub(super) bus: u8,
    pub(super) hov: u8,
    /// Number of entries of the list of widths; 0 without one, or if it has too many.
    measured: u8,
    width_steps: [u8; LISTED],
    /// Narrowest listed width, in steps.
    narrowest: u8,
    /// Number of entries of the other lists.
    marked: u8,
    closed: u8,
    /// Whether the other lists disagree about the number of lanes.
    unusable: bool,
}

impl Lists {
    /// Takes `width:lanes`.
    pub(super) fn widths(&mut self, text: &str, notes: &mut Notes) {
        let mut steps = [0; LISTED];
        let mut count = 0;
        for entry in text.split('|') {
            let step = step(entry);
            if step == 0 && !entry.trim().is_empty() {
                notes.add(Note::BadLaneWidths);
            }
            if let Some(slot) = steps.get_mut(count) {
                *slot = step;
            }
            if step > 0 && (self.narrowest == 0 || step < self.narrowest) {
                self.narrowest = step;
            }
            count += 1;
        }
        if count > LISTED {
            notes.add(Note::BadLaneWidths);
            return;
        }
        (self.measured, self.width_steps) = (count as u8, steps);
        self.agree(notes);
    }

    /// Counts the lanes of `turn:lanes`. More than a road can have are a typing error.
    pub(super) fn turns(&mut self, text: &str) {
        let lanes = u8::try_from(text.split('|').count()).unwrap_or(u8::MAX);
        self.turns = if lanes <= value::MOST_LANES { lanes } else { 0 };
    }

    /// Closes lanes: those for other traffic, and those closed by an access key. `head` is the key before `:lanes`.
    pub(super) fn closed(&mut self, head: &str, text: &str, notes: &mut Notes) {
        let Some(closes) = closing(head) else { return };
        let (mut count, mut closed) = (0, 0_u8);
        for entry in text.split('|') {
            if count < LISTED && closes(entry.trim()) {
                closed |= 1 << count;
            }
            count += 1;
        }
        if count > LISTED || (self.marked != 0 && usize::from(self.marked) != count) {
            notes.add(Note::BadLaneWidths);
            self.unusable = true;
            return;
        }
        self.marked = count as u8;
        self.closed |= closed;
        self.agree(notes);
    }

    /// A number of bus lanes. The greatest one counts.
    pub(super) fn more_bus(&mut self, lanes: u8) {
        self.bus = self.bus.max(lanes);
    }

    /// A number of lanes for cars with several people.
    pub(super) fn more_hov(&mut self, lanes: u8) {
        self.hov = self.hov.max(lanes);
    }

    /// The number of lanes that the lists have; 0 without lists. Where they disagree, those that close lanes count.
    pub(super) fn lanes(&self) -> u8 {
        if self.unusable || self.marked == 0 { self.measured } else { self.marked }
    }

    /// The number of lanes that the list of widths has; 0 without one.
    pub(super) fn measured(&self) -> u8 {
        self.measured
    }

    /// The narrowest listed width, in steps of 5 cm; 0 without one.
    pub(super) fn narrowest(&self) -> u8 {
        self.narrowest
    }

    /// The lists without a suffix, or else those with one.
    pub(super) fn or(self, other: Lists) -> Lists {
        let lists = if self.lanes() > 0 { self } else { other };
        let narrowest = match (self.narrowest, other.narrowest) {
            (0, step) | (step, 0) => step,
            (a, b) => a.min(b),
        };
        Lists { bus: self.bus.max(other.bus), hov: self.hov.max(other.hov), narrowest, ..lists }
    }

    /// Gives lanes the list of widths, whose length may be another.
    pub(super) fn give_widths(&self, tags: &mut LaneTags) {
        (tags.listed, tags.closed, tags.width_steps) = (self.measured, 0, self.width_steps);
    }

    fn agree(&self, notes: &mut Notes) {
        if self.measured > 0 && self.marked > 0 && self.measured != self.marked {
            notes.add(Note::BadLaneWidths);
        }
    }

    /// The lanes. Widths without a position bound all lanes.
    pub(super) fn tags(&self) -> LaneTags {
        let Lists { count, bus, hov, .. } = *self;
        let mut tags = LaneTags { count, bus, hov, listed: self.lanes(), ..LaneTags::default() };
        if !self.unusable {
            tags.closed = self.closed;
        }
        if self.measured > 0 && self.measured == tags.listed {
            tags.width_steps = self.width_steps;
        } else {
            tags.most_steps = self.narrowest;
        }
        tags
    }
}

impl LaneTags {
    /// No lane of unknown width is wider than this; 0 for no bound.
    pub(super) fn bound(&mut self, steps: u8) {
        if steps > 0 && (self.most_steps == 0 || steps < self.most_steps) {
            self.most_steps = steps;
        }
    }
}

/// The width of an entry in steps of 5 cm, rounded down but at least one; 0 if it is no width of a lane.
fn step(entry: &str) -> u8 {
    match readable(entry) {
        Some(width) if width <= *LANE_M.end() => ((width / LANE_STEP_M + 1e-3).floor() as u8).max(1),
        _ => 0,
    }
}

/// Which entries of a list close a lane to heavy vehicles. `None` if the key concerns no such thing.
fn closing(head: &str) -> Option<fn(&str) -> bool> {
    Some(match head {
        "cycleway" => |entry| matches!(entry, "lane" | "track"),
        "hov" => |entry| matches!(entry, "designated" | "lane" | "only"),
        "bicycle" | "bus" | "psv" | "taxi" | "coach" | "minibus" | "motorcycle" | "emergency" => {
            |entry| entry == "designated"
        }
        "access" | "vehicle" | "motor_vehicle" | "hgv" | "hgv_articulated" | "trailer" => {
            |entry| !matches!(entry, "" | "yes" | "designated" | "permissive" | "destination" | "delivery")
        }
        _ => return None,
    })
}

/// Index into `[without, forward, backward]` of a suffix after the key's head.
pub(super) fn list_index(suffix: &str) -> Option<usize> {
    ["lanes", "lanes:forward", "lanes:backward"].iter().position(|side| *side == suffix)
}
