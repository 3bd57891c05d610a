//! The words for the program's enumerations in databases, exports, answers and options. They are stable, because users
//! filter by them.

use crate::diff::Standing;
use crate::evidence::{Along, Quantity, State, Usage};
use crate::osm::facts::{BackdropKind, Direction, Oneway, Permission, Policy, RoadClass, WidthSource};
use crate::settings::Needs;
use crate::stet::Side;
use crate::verdict::{ForbiddenReason, UnknownReason, UnsafeReason, Verdict};

/// An enumeration with a word for each value.
pub trait Named: Copy + PartialEq + 'static {
    /// Every value.
    const ALL: &'static [Self];

    /// The word for this value.
    fn name(self) -> &'static str;

    /// The value with this word.
    #[must_use]
    fn named(word: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|value| value.name() == word)
    }
}

macro_rules! named {
    ($kind:ident { $($value:ident = $word:literal),+ $(,)? }) => {
        impl Named for $kind {
            const ALL: &'static [Self] = &[$(Self::$value),+];

            fn name(self) -> &'static str {
                match self { $(Self::$value => $word),+ }
            }
        }
    };
}

named!(RoadClass {
    Motorway = "motorway",
    Trunk = "trunk",
    Primary = "primary",
    Secondary = "secondary",
    Tertiary = "tertiary",
    Unclassified = "unclassified",
    Residential = "residential",
    LivingStreet = "living_street",
    Service = "service",
    Track = "track",
    Busway = "busway",
});
named!(Oneway { No = "no", Forward = "forward", Backward = "backward" });
named!(Direction { Forward = "forward", Backward = "backward" });
named!(WidthSource {
    Assumed = "assumed",
    FromLanes = "from_lanes",
    Estimated = "estimated",
    Tagged = "tagged",
    Surveyed = "surveyed",
});
named!(Policy { Lane = "lane", Direction = "direction", Carriageway = "carriageway" });
named!(Standing {
    Safe = "safe",
    Conditional = "conditional",
    Unsafe = "unsafe",
    Forbidden = "forbidden",
    Unknown = "unknown",
});
named!(Needs { Off = "off", Edges = "edges", All = "all" });
named!(Permission { Yes = "yes", Restricted = "restricted", No = "no" });
named!(Side { Left = "left", Right = "right" });
named!(Along { Both = "both", Forward = "forward", Backward = "backward" });
named!(Quantity {
    CarriagewayWidth = "carriageway_width",
    DirectionWidth = "direction_width",
    LaneWidth = "lane_width",
    KerbRadius = "kerb_radius",
    MaxHeight = "max_height",
    MaxWeight = "max_weight",
    DrivableBy = "drivable_by",
    Surface = "surface",
});

named!(BackdropKind {
    Wood = "wood",
    Water = "water",
    Coast = "coast",
    River = "river",
    Canal = "canal",
    City = "city",
    Town = "town",
    Suburb = "suburb",
    Village = "village",
    Hamlet = "hamlet",
});

named!(State { Matched = "matched", Unmatched = "unmatched", Ambiguous = "ambiguous" });
named!(Usage { Counts = "counts", Superseded = "superseded", Kept = "kept" });

/// The value of `highway`: the class, with `_link` for links.
#[must_use]
pub fn highway(class: RoadClass, link: bool) -> String {
    format!("{}{}", class.name(), if link { "_link" } else { "" })
}

/// The reverse of [`highway`].
pub(crate) fn class_and_link(highway: &str) -> Option<(RoadClass, bool)> {
    let (class, link) = highway.strip_suffix("_link").map_or((highway, false), |class| (class, true));
    Some((RoadClass::named(class)?, link))
}

/// A verdict without its reason.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)] // as in `Verdict`
pub enum VerdictKind {
    Safe,
    Unsafe,
    Forbidden,
    Unknown,
}

impl Named for VerdictKind {
    const ALL: &'static [Self] = &[Self::Safe, Self::Unsafe, Self::Forbidden, Self::Unknown];

    fn name(self) -> &'static str {
        match self {
            Self::Safe => "safe",
            Self::Unsafe => "unsafe",
            Self::Forbidden => "forbidden",
            Self::Unknown => "unknown",
        }
    }
}

/// The words for a verdict and for its reason. The reason of `safe` is empty.
#[must_use]
pub const fn verdict_words(verdict: Verdict) -> (&'static str, &'static str) {
    match verdict {
        Verdict::Safe => ("safe", ""),
        Verdict::Unsafe(reason) => {
            let reason = match reason {
                UnsafeReason::Width => "width",
                UnsafeReason::Articulation => "articulation",
                UnsafeReason::SteeringLock => "steering_lock",
            };
            ("unsafe", reason)
        }
        Verdict::Forbidden(reason) => {
            let reason = match reason {
                ForbiddenReason::Height => "height",
                ForbiddenReason::Weight => "weight",
                ForbiddenReason::AxleLoad => "axle_load",
                ForbiddenReason::Length => "length",
                ForbiddenReason::Width => "width",
                ForbiddenReason::Hgv => "hgv",
                ForbiddenReason::Access => "access",
                ForbiddenReason::Barrier => "barrier",
                ForbiddenReason::Restriction => "restriction",
                ForbiddenReason::Oneway => "oneway",
                ForbiddenReason::Axles => "axles",
                ForbiddenReason::Trailers => "trailers",
                ForbiddenReason::Class => "class",
            };
            ("forbidden", reason)
        }
        Verdict::Unknown(reason) => {
            let reason = match reason {
                UnknownReason::Width => "width",
                UnknownReason::Geometry => "geometry",
                UnknownReason::Cut => "cut",
                UnknownReason::Limit => "limit",
                UnknownReason::Failed => "failed",
                UnknownReason::TookTooLong => "took_too_long",
                UnknownReason::Time => "time",
                UnknownReason::Rule => "rule",
            };
            ("unknown", reason)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words_come_back<T: Named + std::fmt::Debug>() {
        for &value in T::ALL {
            assert_eq!(T::named(value.name()), Some(value));
        }
        assert_eq!(T::named("nothing of the kind"), None);
    }

    #[test]
    fn every_word_comes_back_to_its_value() {
        words_come_back::<RoadClass>();
        words_come_back::<Oneway>();
        words_come_back::<Direction>();
        words_come_back::<WidthSource>();
        words_come_back::<Policy>();
        words_come_back::<Needs>();
        words_come_back::<Permission>();
        words_come_back::<Side>();
        assert_eq!(class_and_link("motorway_link"), Some((RoadClass::Motorway, true)));
        assert_eq!(class_and_link("link"), None);
    }
}
