//! What is said of an edge and a vehicle, always with its reason.
//!
//! `Safe` holds within the stated model, widths and error bounds only. When in doubt the answer is `Unknown`
//! or `Unsafe`: no variant may be constructed from a guess.

use serde::{Deserialize, Serialize};

/// The answer for one edge and one vehicle. The reasons are stable, lower-case identifiers in files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Verdict {
    /// RSC ≥ 0 and hinge margin ≥ 0.
    Safe,
    /// The certificate refutes it, or cannot prove it.
    Unsafe(UnsafeReason),
    /// A tagged limit or access rule forbids it, whatever the geometry says.
    Forbidden(ForbiddenReason),
    /// Nothing can be said.
    Unknown(UnknownReason),
}

/// Why the certificate does not hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum UnsafeReason {
    /// RSC < 0: the swept bodies need more width than the corridor has.
    Width,
    /// A hinge would exceed its limit (or the bound's recursion does not close).
    Articulation,
    /// The prime mover would need more than its steering lock.
    SteeringLock,
}

/// Which tagged rule forbids the vehicle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
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
    /// `hgv=no` and its kind
    Hgv,
    /// `access`, `vehicle`, `motor_vehicle` = no or private
    Access,
    /// A barrier node that a vehicle of this kind cannot pass.
    Barrier,
    /// A turn restriction; of turns only.
    Restriction,
}

/// Why nothing can be said.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum UnknownReason {
    /// No width can be derived.
    Width,
    /// Too short, folded back on itself, or not smoothable within the tolerance.
    Geometry,
    /// The extract ends on this edge: what comes before or after is not known.
    Cut,
    /// A limit is tagged whose value could not be read.
    Limit,
}
