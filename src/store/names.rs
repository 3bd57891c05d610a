//! The words that stand in the database for the program's enumerations. Stable: users filter by them.

use crate::osm::facts::{Direction, Oneway, Permission, Policy, RoadClass, WidthSource};
use crate::stet::Side;
use crate::verdict::{ForbiddenReason, UnknownReason, UnsafeReason, Verdict};

/// An enumeration with a word for each value.
pub trait Named: Copy + PartialEq + 'static {
    /// Every value.
    const ALL: &'static [Self];

    /// The word for it.
    fn name(self) -> &'static str;

    /// The value of a word.
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
named!(Permission { Yes = "yes", Restricted = "restricted", No = "no" });
named!(Side { Left = "left", Right = "right" });

/// `highway` as a user knows it: the class, with `_link`.
pub(super) fn highway(class: RoadClass, link: bool) -> String {
    format!("{}{}", class.name(), if link { "_link" } else { "" })
}

/// The reverse of [`highway`].
pub(super) fn class_and_link(highway: &str) -> Option<(RoadClass, bool)> {
    let (class, link) = highway.strip_suffix("_link").map_or((highway, false), |class| (class, true));
    Some((RoadClass::named(class)?, link))
}

/// Every verdict, its number in the database and its words. Numbers are never reused.
pub(super) const VERDICTS: &[(u8, Verdict, &str, Option<&str>)] = &[
    (SAFE, Verdict::Safe, "safe", None),
    (10, Verdict::Unsafe(UnsafeReason::Width), "unsafe", Some("width")),
    (11, Verdict::Unsafe(UnsafeReason::Articulation), "unsafe", Some("articulation")),
    (12, Verdict::Unsafe(UnsafeReason::SteeringLock), "unsafe", Some("steering_lock")),
    (20, Verdict::Forbidden(ForbiddenReason::Height), "forbidden", Some("height")),
    (21, Verdict::Forbidden(ForbiddenReason::Weight), "forbidden", Some("weight")),
    (22, Verdict::Forbidden(ForbiddenReason::AxleLoad), "forbidden", Some("axle_load")),
    (23, Verdict::Forbidden(ForbiddenReason::Length), "forbidden", Some("length")),
    (24, Verdict::Forbidden(ForbiddenReason::Width), "forbidden", Some("width")),
    (25, Verdict::Forbidden(ForbiddenReason::Hgv), "forbidden", Some("hgv")),
    (26, Verdict::Forbidden(ForbiddenReason::Access), "forbidden", Some("access")),
    (27, Verdict::Forbidden(ForbiddenReason::Barrier), "forbidden", Some("barrier")),
    (28, Verdict::Forbidden(ForbiddenReason::Restriction), "forbidden", Some("restriction")),
    (30, Verdict::Unknown(UnknownReason::Width), "unknown", Some("width")),
    (31, Verdict::Unknown(UnknownReason::Geometry), "unknown", Some("geometry")),
    (32, Verdict::Unknown(UnknownReason::Cut), "unknown", Some("cut")),
    (33, Verdict::Unknown(UnknownReason::Limit), "unknown", Some("limit")),
];

/// The number of [`Verdict::Safe`]; the views in `migrations/` rely on it.
pub(super) const SAFE: u8 = 0;

/// A verdict's number, or `None` for one that [`VERDICTS`] lacks (a test sees to it that there is none).
pub(super) fn verdict_no(verdict: Verdict) -> Option<u8> {
    VERDICTS.iter().find(|row| row.1 == verdict).map(|row| row.0)
}

/// The verdict of a number.
pub(super) fn verdict_of(no: i64) -> Option<Verdict> {
    VERDICTS.iter().find(|row| i64::from(row.0) == no).map(|row| row.1)
}

/// A verdict's words: the verdict, and its reason (empty for `safe`).
#[must_use]
pub fn verdict_words(verdict: Verdict) -> (&'static str, &'static str) {
    VERDICTS.iter().find(|row| row.1 == verdict).map_or(("unknown", ""), |row| (row.2, row.3.unwrap_or("")))
}

/// The columns of `edge` that belong to a policy: width, and where it comes from.
pub(super) const fn width_columns(policy: Policy) -> [&'static str; 2] {
    match policy {
        Policy::Lane => ["lane_width_m", "width_source"],
        Policy::Direction => ["direction_width_m", "direction_width_source"],
        Policy::Carriageway => ["carriageway_width_m", "carriageway_width_source"],
    }
}

/// A policy's number in the database: its place in [`Policy::ALL`].
pub(super) fn corridor_no(policy: Policy) -> u8 {
    policy as u8
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
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
        words_come_back::<Permission>();
        words_come_back::<Side>();
        assert_eq!(class_and_link("motorway_link"), Some((RoadClass::Motorway, true)));
        assert_eq!(class_and_link("link"), None);
        for (no, &policy) in Policy::ALL.iter().enumerate() {
            assert_eq!(usize::from(corridor_no(policy)), no);
        }
    }

    /// The match is exhaustive: a new reason does not compile until it stands here, and then must have a number.
    fn successor(verdict: Verdict) -> Option<Verdict> {
        use {ForbiddenReason as F, UnknownReason as N, Verdict as V};
        Some(match verdict {
            V::Safe => V::Unsafe(UnsafeReason::Width),
            V::Unsafe(UnsafeReason::Width) => V::Unsafe(UnsafeReason::Articulation),
            V::Unsafe(UnsafeReason::Articulation) => V::Unsafe(UnsafeReason::SteeringLock),
            V::Unsafe(UnsafeReason::SteeringLock) => V::Forbidden(F::Height),
            V::Forbidden(F::Height) => V::Forbidden(F::Weight),
            V::Forbidden(F::Weight) => V::Forbidden(F::AxleLoad),
            V::Forbidden(F::AxleLoad) => V::Forbidden(F::Length),
            V::Forbidden(F::Length) => V::Forbidden(F::Width),
            V::Forbidden(F::Width) => V::Forbidden(F::Hgv),
            V::Forbidden(F::Hgv) => V::Forbidden(F::Access),
            V::Forbidden(F::Access) => V::Forbidden(F::Barrier),
            V::Forbidden(F::Barrier) => V::Forbidden(F::Restriction),
            V::Forbidden(F::Restriction) => V::Unknown(N::Width),
            V::Unknown(N::Width) => V::Unknown(N::Geometry),
            V::Unknown(N::Geometry) => V::Unknown(N::Cut),
            V::Unknown(N::Cut) => V::Unknown(N::Limit),
            V::Unknown(N::Limit) => return None,
        })
    }

    #[test]
    fn every_verdict_has_a_number_and_words_of_its_own() {
        let all: Vec<Verdict> = std::iter::successors(Some(Verdict::Safe), |&v| successor(v)).collect();
        assert_eq!(all.len(), VERDICTS.len());
        for &verdict in &all {
            let no = verdict_no(verdict).unwrap();
            assert_eq!(verdict_of(i64::from(no)), Some(verdict));
            assert_eq!(all.iter().filter(|&&v| verdict_words(v) == verdict_words(verdict)).count(), 1);
        }
    }
}
