//! The words for the program's enumerations in databases, exports, answers and options. They are stable, because users
//! filter by them. Each enumeration has its words beside it.

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

/// Gives an enumeration of values without fields its words.
#[macro_export]
macro_rules! named {
    ($kind:ident { $($value:ident = $word:literal),+ $(,)? }) => {
        impl $crate::words::Named for $kind {
            const ALL: &'static [Self] = &[$(Self::$value),+];

            fn name(self) -> &'static str {
                match self { $(Self::$value => $word),+ }
            }
        }
    };
}

/// The sentence that says of which time an answer is, such as ` At 2026-12-01T08:00:00, local time.`, with a space before it. Empty without
/// a time.
#[must_use]
pub fn at_local_time(time: Option<impl std::fmt::Display>) -> String {
    time.map_or_else(String::new, |time| format!(" At {time}, local time."))
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

named!(VerdictKind { Safe = "safe", Unsafe = "unsafe", Forbidden = "forbidden", Unknown = "unknown" });

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
    use super::{Named, VerdictKind};

    #[test]
    fn every_word_comes_back_to_its_value() {
        for &value in VerdictKind::ALL {
            assert_eq!(VerdictKind::named(value.name()), Some(value));
        }
        assert_eq!(VerdictKind::named("nothing of the kind"), None);
    }
}
