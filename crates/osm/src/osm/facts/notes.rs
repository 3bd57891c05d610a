//! Remarks on tags that could not be used as they stand. The reader counts them over all kept ways. A remark by itself
//! drops nothing.

/// One kind of remark. The names are stable identifiers in the account.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Note {
    /// `width` and similar keys: not a positive length in a known unit, or over 40 m. If no other width can be read, the
    /// width is unknown.
    BadWidth,
    /// `lanes` and similar keys: not a whole number from 1 to 16. The tag is ignored, but 1.5 counts as 1.
    BadLanes,
    /// Lists of lanes with more than eight lanes or of different lengths, or an entry of `width:lanes` that is no width of a
    /// lane. What can be read counts: a width without its lane bounds all lanes.
    BadLaneWidths,
    /// `placement` outside the documented values. Ignored.
    BadPlacement,
    /// `oneway` and its keys by vehicle, outside the documented values. The verdict becomes `unknown` where the road may be one-way.
    BadOneway,
    /// A legal limit that cannot be read. The limit counts as unreadable, and the verdict becomes `unknown`.
    BadLimit,
    /// An access value that is not documented. It counts as no.
    BadAccess,
    /// `maxspeed` and similar keys: not a speed from 1 to 200 km/h in a known unit. The tag is ignored.
    BadSpeed,
    /// `maxspeed` and similar keys: a national default such as `DE:urban`, without a number. The tag is ignored.
    NationalSpeed,
    /// Tagged lanes and tagged width imply lanes under 1.8 m or over 6 m.
    WidthContradictsLanes,
    /// A rule with a condition that is not understood. Where it may close the road, the verdict becomes `unknown`.
    BadCondition,
    /// `oneway=reversible`: both directions exist, but not always. The verdict becomes `unknown`.
    Reversible,
    /// A rule that closes or limits the road at some times. Where it closes the road to a vehicle, the verdict becomes `unknown`.
    TimedRule,
}

const NAMES: [(Note, &str); 13] = [
    (Note::BadWidth, "bad_width"),
    (Note::BadLanes, "bad_lanes"),
    (Note::BadLaneWidths, "bad_lane_widths"),
    (Note::BadPlacement, "bad_placement"),
    (Note::BadOneway, "bad_oneway"),
    (Note::BadLimit, "bad_limit"),
    (Note::BadAccess, "bad_access"),
    (Note::BadSpeed, "bad_speed"),
    (Note::NationalSpeed, "national_speed"),
    (Note::WidthContradictsLanes, "width_contradicts_lanes"),
    (Note::BadCondition, "bad_condition"),
    (Note::Reversible, "reversible"),
    (Note::TimedRule, "timed_rule"),
];

/// A set of [`Note`]s.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Notes(pub u32);

impl Notes {
    /// Adds a remark. A repeated remark counts once per way.
    pub fn add(&mut self, note: Note) {
        self.0 |= 1 << note as u8;
    }

    /// Whether the set contains the remark.
    #[must_use]
    pub fn has(self, note: Note) -> bool {
        self.0 & (1 << note as u8) != 0
    }

    /// The names of the remarks in the set, in a fixed order.
    pub fn names(self) -> impl Iterator<Item = &'static str> {
        NAMES.iter().filter(move |(note, _)| self.has(*note)).map(|(_, name)| *name)
    }
}
