//! The verdict on an edge and a vehicle, always with its reason.
//!
//! `Safe` holds only within the stated model, widths and error bounds. In doubt the verdict is `Unknown` or `Unsafe`.
//! No verdict may be made from a guess.

use serde::{Deserialize, Serialize};

/// The verdict on one edge and one vehicle. Files write the reasons as stable, lower-case identifiers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Verdict {
    /// RSC ≥ 0 and hinge margin ≥ 0.
    Safe,
    /// The certificate refutes the passage, or cannot prove it.
    Unsafe(UnsafeReason),
    /// A tagged limit or access rule forbids the passage, whatever the geometry says.
    Forbidden(ForbiddenReason),
    /// Too little is known for a verdict.
    Unknown(UnknownReason),
}

impl Verdict {
    /// Whether nothing may lead over the edge, not even a turn or passage with a certificate of its own: the vehicle is forbidden there, or
    /// that is not known.
    #[must_use]
    pub fn bars_passage(self) -> bool {
        match self {
            Self::Forbidden(_) => true,
            Self::Unknown(reason) => match reason {
                UnknownReason::Limit
                | UnknownReason::Failed
                | UnknownReason::TookTooLong
                | UnknownReason::Time
                | UnknownReason::Rule => true,
                UnknownReason::Width | UnknownReason::Geometry | UnknownReason::Cut => false,
            },
            Self::Safe | Self::Unsafe(_) => false,
        }
    }

    /// Whether the work behind it was not done, so that it claims nothing.
    #[must_use]
    pub fn claims_nothing(self) -> bool {
        matches!(self, Self::Unknown(UnknownReason::Failed | UnknownReason::TookTooLong))
    }

    /// Every verdict with each of its reasons. Other crates cannot list the reasons without a case for reasons that are yet to come.
    pub fn every() -> impl Iterator<Item = Self> {
        std::iter::successors(Some(Self::Safe), |verdict| verdict.successor())
    }

    /// The next one of [`Self::every`]. The match is exhaustive, so a new reason does not compile until it is added here.
    fn successor(self) -> Option<Self> {
        use {ForbiddenReason as F, UnknownReason as N};
        Some(match self {
            Self::Safe => Self::Unsafe(UnsafeReason::Width),
            Self::Unsafe(UnsafeReason::Width) => Self::Unsafe(UnsafeReason::Articulation),
            Self::Unsafe(UnsafeReason::Articulation) => Self::Unsafe(UnsafeReason::SteeringLock),
            Self::Unsafe(UnsafeReason::SteeringLock) => Self::Forbidden(F::Height),
            Self::Forbidden(F::Height) => Self::Forbidden(F::Weight),
            Self::Forbidden(F::Weight) => Self::Forbidden(F::AxleLoad),
            Self::Forbidden(F::AxleLoad) => Self::Forbidden(F::Length),
            Self::Forbidden(F::Length) => Self::Forbidden(F::Width),
            Self::Forbidden(F::Width) => Self::Forbidden(F::Hgv),
            Self::Forbidden(F::Hgv) => Self::Forbidden(F::Access),
            Self::Forbidden(F::Access) => Self::Forbidden(F::Barrier),
            Self::Forbidden(F::Barrier) => Self::Forbidden(F::Restriction),
            Self::Forbidden(F::Restriction) => Self::Forbidden(F::Oneway),
            Self::Forbidden(F::Oneway) => Self::Forbidden(F::Axles),
            Self::Forbidden(F::Axles) => Self::Forbidden(F::Trailers),
            Self::Forbidden(F::Trailers) => Self::Forbidden(F::Class),
            Self::Forbidden(F::Class) => Self::Unknown(N::Width),
            Self::Unknown(N::Width) => Self::Unknown(N::Geometry),
            Self::Unknown(N::Geometry) => Self::Unknown(N::Cut),
            Self::Unknown(N::Cut) => Self::Unknown(N::Limit),
            Self::Unknown(N::Limit) => Self::Unknown(N::Failed),
            Self::Unknown(N::Failed) => Self::Unknown(N::Time),
            Self::Unknown(N::Time) => Self::Unknown(N::Rule),
            Self::Unknown(N::Rule) => Self::Unknown(N::TookTooLong),
            Self::Unknown(N::TookTooLong) => return None,
        })
    }
}

/// Why the certificate does not hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum UnsafeReason {
    /// RSC < 0: the swept bodies need more width than the corridor has.
    Width,
    /// A hinge would exceed its limit, or the recursion of the bounds does not close.
    Articulation,
    /// The prime mover would need more than its steering lock.
    SteeringLock,
}

/// The tagged rule that forbids the vehicle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum ForbiddenReason {
    /// `maxheight`, `maxheight:physical`
    Height,
    /// `maxweight`, `maxweight:hgv`, `maxweightrating:hgv`
    Weight,
    /// `maxaxleload`
    AxleLoad,
    /// `maxlength`
    Length,
    /// `maxwidth`, `maxwidth:physical`
    Width,
    /// `hgv=no` and its variants.
    Hgv,
    /// `access`, `vehicle`, `motor_vehicle` = no or private
    Access,
    /// A barrier node that a vehicle of this kind cannot pass.
    Barrier,
    /// A turn restriction. Turns only.
    Restriction,
    /// One-way for this vehicle in the other direction.
    Oneway,
    /// `maxaxles`
    Axles,
    /// `maxtrailers`, `roadtrain:trailers`
    Trailers,
    /// A rule for the vehicle's class: `bus=no`, `lhv=no`, `bdouble=no` …
    Class,
}

/// Why there is no verdict.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum UnknownReason {
    /// No width can be derived.
    Width,
    /// Too short, folded back on itself, or not smoothable within the tolerance.
    Geometry,
    /// The extract ends on this edge, so the road before or after it is unknown.
    Cut,
    /// A tagged limit has a value that cannot be read, or that cannot be compared with what is known of the vehicle.
    Limit,
    /// The machine that was to certify it failed.
    Failed,
    /// The certificate took longer than the program's patience ([`crate::watch`]).
    TookTooLong,
    /// Closed to the vehicle at some times, and the certificate has no clock.
    Time,
    /// A rule that is not understood, and that may close the road to the vehicle.
    Rule,
}
