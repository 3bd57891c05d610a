//! Speed limits per direction of travel. They give the time of a route; no verdict depends on them.
//!
//! The keys are `maxspeed` and `maxspeed:hgv`, each with or without a direction. The lowest value counts. Limits by lane,
//! by condition and for other vehicles are not read.

use std::num::NonZeroU8;

use crate::osm::facts::notes::{Note, Notes};
use crate::osm::facts::value::{self, Speed};

/// Speed limits of one way while its tags are read.
#[derive(Debug, Default)]
pub(super) struct SpeedTags {
    /// Km/h along the node order, and against it.
    pub(super) km_h: [Option<NonZeroU8>; 2],
}

impl SpeedTags {
    /// Takes a tag if its key (split at the first colon) is one of the keys above.
    pub(super) fn take(&mut self, head: &str, suffix: &str, text: &str, notes: &mut Notes) {
        if head != "maxspeed" {
            return;
        }
        let directions = match suffix {
            "" | "hgv" => [true, true],
            "forward" | "hgv:forward" => [true, false],
            "backward" | "hgv:backward" => [false, true],
            _ => return,
        };
        match value::speed(text) {
            Speed::KmH(limit) => {
                for (slot, _) in self.km_h.iter_mut().zip(directions).filter(|(_, on)| *on) {
                    *slot = Some(slot.map_or(limit, |known| known.min(limit)));
                }
            }
            Speed::Unlimited => {}
            Speed::National => notes.add(Note::NationalSpeed),
            Speed::Unreadable => notes.add(Note::BadSpeed),
        }
    }
}
