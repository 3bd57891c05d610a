//! The tags of a way's cross section: widths, lanes, kerb-side uses, and the position of the way's line.
//!
//! The type is compact, because a region has one per way. `widths` computes positions from it. Directions are relative
//! to the way's node order. Lanes are listed from left to right in direction of travel (wiki: Lanes).

use std::num::NonZeroU16;

use serde::Serialize;

use crate::osm::facts::{Direction, WidthSource};

/// Most lanes with given widths per direction.
pub(super) const LISTED: usize = 8;
/// Resolution of `width:lanes`, metres; values are rounded down.
pub(super) const LANE_STEP_M: f32 = 0.05;

/// A length up to 65 m, rounded down, but at least 1 mm. It is exact for lengths in tags.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub(super) struct Millimetres(NonZeroU16);

impl Millimetres {
    pub(super) fn from_metres(metres: f32) -> Option<Millimetres> {
        // The addition covers rounding: 3.3 m is 3299.9999 mm in f32.
        let whole = (f64::from(metres) * 1000.0 + 0.01).floor();
        if metres > 0.0 && whole <= 65535.0 { NonZeroU16::new((whole as u16).max(1)).map(Millimetres) } else { None }
    }

    pub(super) fn metres(self) -> f32 {
        f32::from(self.0.get()) / 1000.0
    }
}

/// Cars parked on the carriageway. The more room they take, the greater the value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Serialize)]
pub(super) enum Parking {
    #[default]
    None,
    Parallel,
    Diagonal,
    Perpendicular,
}

/// Width of a kerb-side use in decimetres, rounded up. 0 means no such use, 255 means an untagged width.
pub(super) type Decimetres = u8;
pub(super) const UNTAGGED: Decimetres = u8::MAX;

/// Uses that take room between the lanes and one edge of the carriageway.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub(super) struct Kerb {
    pub(super) parking: Parking,
    pub(super) parking_dm: Decimetres,
    pub(super) cycle_dm: Decimetres,
    pub(super) shoulder_dm: Decimetres,
}

/// Lanes of one direction of travel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub(super) struct LaneTags {
    /// `lanes:forward` and similar keys; 0 if untagged.
    pub(super) count: u8,
    /// Number of lanes in access or width lists, including cycle lanes; 0 without lists.
    pub(super) listed: u8,
    /// Bit i is set if listed lane i (from the left in direction of travel) is closed to heavy vehicles.
    pub(super) closed: u8,
    /// Widths of the listed lanes in steps of 5 cm; 0 where the list gives none.
    pub(super) width_steps: [u8; LISTED],
    /// Narrowest width of a list that does not tell which lane it means, in steps of 5 cm; 0 without one. No lane of
    /// unknown width is wider.
    pub(super) most_steps: u8,
    /// Bus lanes without a position (`lanes:psv=1`, `busway=lane`). They are taken to be at the kerb.
    pub(super) bus: u8,
    /// Lanes for cars with several people, without a position (`lanes:hov=1`, `hov=lane`). They are taken to be at the
    /// middle of the road.
    pub(super) hov: u8,
}

impl LaneTags {
    pub(super) fn is_closed(&self, lane: usize) -> bool {
        lane < LISTED && self.closed & (1 << lane) != 0
    }

    /// Width of a listed lane, metres.
    pub(super) fn width_m(&self, lane: usize) -> Option<f32> {
        self.width_steps[..usize::from(self.listed).min(LISTED)].get(lane).copied().and_then(in_metres)
    }

    /// The narrowest listed width, metres.
    pub(super) fn narrowest_m(&self) -> Option<f32> {
        (0..LISTED).filter_map(|lane| self.width_m(lane)).reduce(f32::min)
    }

    /// What no lane of unknown width exceeds, metres. A list that is shorter than the road has lanes bounds the others.
    pub(super) fn most_m(&self, lanes: u8) -> Option<f32> {
        let of_list = if self.listed < lanes { self.narrowest_m() } else { None };
        of_list.into_iter().chain(in_metres(self.most_steps)).reduce(f32::min)
    }
}

/// A number of steps as metres. 0 means no width.
pub(super) fn in_metres(steps: u8) -> Option<f32> {
    (steps > 0).then(|| f32::from(steps) * LANE_STEP_M)
}

/// The line of a lane that the way's line follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub(super) enum Placement {
    /// The middle of the carriageway.
    #[default]
    Middle,
    /// Between two placements: unknown.
    Transition,
    /// A line of a lane, with lanes counted from 1 at the left in direction of travel.
    At(LaneLine, u8, Direction),
}

/// The line of a lane, for [`Placement::At`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub(super) enum LaneLine {
    Left,
    Middle,
    Right,
}

/// What a tag says of the whole cross section, one bit each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub(super) enum Mark {
    /// A width is tagged that cannot be read, and no other one can.
    Unreadable = 1,
    /// `narrow=yes`
    Narrow = 2,
    /// All lanes go one way at a time.
    Reversible = 4,
    /// Both directions share one lane by turns.
    Alternating = 8,
    /// The lists of one direction cover the whole road, from left to right in that direction. It is forward on a two-way
    /// road.
    WholeRoad = 16,
    /// The carriageway is laid out for traffic along the way's node order only.
    Along = 32,
    /// The carriageway is laid out for traffic against the way's node order only.
    Against = 64,
    /// A tag says something of lanes, even if it does not count them all, or the source does not say which roads are rings. No group of
    /// roads then says how many lanes this one has.
    Ungrouped = 128,
}

/// A set of [`Mark`]s.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub(super) struct MarkSet(u8);

impl MarkSet {
    pub(super) fn of(marks: &[(Mark, bool)]) -> MarkSet {
        MarkSet(marks.iter().filter(|(_, set)| *set).map(|(mark, _)| *mark as u8).sum())
    }
}

/// All tags of the cross section.
#[derive(Debug, Clone, Serialize)]
pub(super) struct SectionTags {
    /// Width between the edges of the carriageway.
    pub(super) carriageway: Option<Millimetres>,
    pub(super) source: WidthSource,
    /// `maxwidth:physical`
    pub(super) physical: Option<Millimetres>,
    pub(super) marks: MarkSet,
    /// `lanes`; 0 if untagged.
    pub(super) lanes: u8,
    /// `lanes:both_ways`
    pub(super) both_ways: u8,
    /// Width of the lane for both directions, in steps of 5 cm; 0 if untagged.
    pub(super) both_ways_steps: u8,
    /// Forward, backward. On a one-way road the lanes of the other direction are for oncoming buses.
    pub(super) directions: [LaneTags; 2],
    /// On the left and on the right of the way's node order.
    pub(super) kerbs: [Kerb; 2],
    pub(super) placement: Placement,
}

impl SectionTags {
    pub(super) fn is(&self, mark: Mark) -> bool {
        self.marks.0 & mark as u8 != 0
    }

    pub(super) fn tagged_lanes(&self) -> Option<u8> {
        let by_direction = self.directions[0].count.saturating_add(self.directions[1].count);
        if self.lanes > 0 {
            return Some(self.lanes);
        }
        // A lane for both directions alone says nothing of the others.
        (by_direction > 0).then_some(by_direction.saturating_add(self.both_ways))
    }
}
