//! The numbers of verdicts and policies in the database, and the names of columns. The words in the database are those of
//! `words`.

use crate::osm::facts::Policy;
use crate::verdict::{ForbiddenReason, UnknownReason, UnsafeReason, Verdict};
use crate::words::VerdictKind;

/// Every verdict and its number in the database. Numbers are never reused. A kind has ten numbers, and ten more from 50 on.
pub(crate) const VERDICTS: &[(u8, Verdict)] = &[
    (SAFE, Verdict::Safe),
    (10, Verdict::Unsafe(UnsafeReason::Width)),
    (11, Verdict::Unsafe(UnsafeReason::Articulation)),
    (12, Verdict::Unsafe(UnsafeReason::SteeringLock)),
    (20, Verdict::Forbidden(ForbiddenReason::Height)),
    (21, Verdict::Forbidden(ForbiddenReason::Weight)),
    (22, Verdict::Forbidden(ForbiddenReason::AxleLoad)),
    (23, Verdict::Forbidden(ForbiddenReason::Length)),
    (24, Verdict::Forbidden(ForbiddenReason::Width)),
    (25, Verdict::Forbidden(ForbiddenReason::Hgv)),
    (26, Verdict::Forbidden(ForbiddenReason::Access)),
    (27, Verdict::Forbidden(ForbiddenReason::Barrier)),
    (28, Verdict::Forbidden(ForbiddenReason::Restriction)),
    (70, Verdict::Forbidden(ForbiddenReason::Oneway)),
    (71, Verdict::Forbidden(ForbiddenReason::Axles)),
    (72, Verdict::Forbidden(ForbiddenReason::Trailers)),
    (73, Verdict::Forbidden(ForbiddenReason::Class)),
    (30, Verdict::Unknown(UnknownReason::Width)),
    (31, Verdict::Unknown(UnknownReason::Geometry)),
    (32, Verdict::Unknown(UnknownReason::Cut)),
    (33, Verdict::Unknown(UnknownReason::Limit)),
    (34, Verdict::Unknown(UnknownReason::Failed)),
    (35, Verdict::Unknown(UnknownReason::Time)),
    (36, Verdict::Unknown(UnknownReason::Rule)),
    (37, Verdict::Unknown(UnknownReason::TookTooLong)),
];

/// The condition that `column` has a number of a kind.
pub(crate) fn of_kind(column: &str, kind: VerdictKind) -> String {
    let first = 10 * kind as u8;
    format!("{column} % 50 BETWEEN {first} AND {}", first + 9)
}

/// The number of [`Verdict::Safe`]. The views in `migrations/` use this number.
pub(crate) const SAFE: u8 = 0;

/// The number of a verdict. `None` if [`VERDICTS`] lacks the verdict, which a test rules out.
pub(crate) fn verdict_no(verdict: Verdict) -> Option<u8> {
    VERDICTS.iter().find(|row| row.1 == verdict).map(|row| row.0)
}

/// The verdict with this number.
pub(crate) fn verdict_of(no: i64) -> Option<Verdict> {
    VERDICTS.iter().find(|row| i64::from(row.0) == no).map(|row| row.1)
}

/// The columns of `edge` that belong to a policy: the width and its source.
pub(crate) const fn width_columns(policy: Policy) -> [&'static str; 2] {
    match policy {
        Policy::Lane => ["lane_width_m", "width_source"],
        Policy::Direction => ["direction_width_m", "direction_width_source"],
        Policy::Carriageway => ["carriageway_width_m", "carriageway_width_source"],
    }
}

/// The number of a policy in the database, which is its index in [`Policy::ALL`].
pub(crate) fn corridor_no(policy: Policy) -> u8 {
    policy as u8
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::words::{Named as _, verdict_words};

    #[test]
    fn policies_are_numbered_in_their_order() {
        for (no, &policy) in Policy::ALL.iter().enumerate() {
            assert_eq!(usize::from(corridor_no(policy)), no);
        }
    }

    /// Queries select a kind of verdict by its tens.
    #[test]
    fn each_kind_of_verdict_has_its_ten() {
        for &(no, verdict) in VERDICTS {
            assert_eq!(VerdictKind::ALL[usize::from(no % 50 / 10)].name(), verdict_words(verdict).0);
        }
    }

    #[test]
    fn every_verdict_has_a_number_and_words_of_its_own() {
        let all: Vec<Verdict> = Verdict::every().collect();
        assert_eq!(all.len(), VERDICTS.len());
        for &verdict in &all {
            let no = verdict_no(verdict).unwrap();
            assert_eq!(verdict_of(i64::from(no)), Some(verdict));
            assert_eq!(all.iter().filter(|&&v| verdict_words(v) == verdict_words(verdict)).count(), 1);
        }
    }
}
