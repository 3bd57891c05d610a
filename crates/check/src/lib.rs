//! A second opinion on one vehicle and one corridor: it confirms or refutes claims without the code that made them.
//!
//! The crate is written from `docs/proof.md`. Its Cargo manifest keeps it independent of the kernel. It is pure: no
//! input or output.
//!
//! | file | for |
//! | --- | --- |
//! | `interval` | intervals that hold the exact result, for straight gains and for every close decision |
//! | `link`, `chain` | the vehicle in the proof's terms |
//! | `gains` | exact gains on the straight (proof, section 4) |
//! | `road` | the corridor as a curve, and the test that its stations fit |
//! | `plan` | the planned shift from its coefficients |
//! | `motion` | the nominal motion (section 2), four steps per station |
//! | `tubes` | the filter and the second order (sections 3 and 5) |
//! | `adjoint` | the exact time-varying bound (section 6), where the filter is too loose |
//! | `leeway` | from tubes to leeway (section 7), compared with the claims by branch and bound |
//! | `coarse` | coarse bounds of leeway, for the many places far above their claim |
//! | `search` | the search for places below their claim: first by coarse bounds, then by cells |
//! | `plane` | the same in areas, where bodies are held against a part of the plane |
//! | `claim` | the claims about one vehicle on one corridor, and their results |
//! | `printed` | the paper's 𝒞, which decides nothing |
//!
//! Rounding is handled in three ways. Nominal motion, feet and kernels are *chosen* in plain `f64`: another choice
//! would give another bound and not a wrong one, and their rounding is counted (`link::DEFECT_RAD`). *Bounds* are
//! rounded up: sums and products of non-negative numbers grow by a factor larger than all rounding (`UP`). *Decisions*
//! within `leeway::CLOSE_M` of the claim are repeated in intervals.

mod adjoint;
mod allowance;
mod areas;
mod cell;
mod chain;
mod claim;
mod coarse;
mod coefficients;
mod columns;
mod curve;
#[cfg(test)]
mod drawn;
mod feet;
mod filter;
mod fit;
mod gains;
mod hinges;
mod hull;
mod interval;
mod leeway;
mod limiting;
mod link;
mod motion;
pub mod plan;
mod plane;
pub mod printed;
mod road;
mod search;
mod second_order;
mod sharpen;
mod spans;
mod subject;
mod swept;
mod targets;
mod tubes;
mod vector;

pub use chain::Chain;
pub use claim::{Finding, Outcome, SpanClaim, Weight, finding};
pub use fit::RoadError;
pub use interval::Interval;
pub use subject::Subject;
pub use swept::Swept;

/// A claim counts as proved if it is at most this far above the bound found here, metres. The two programs cut the road
/// into different steps. `claim` applies the tolerance, and nothing else does.
pub const TOLERANCE_M: f64 = 1e-3;

/// Steps of the nominal motion per station.
pub(crate) const STEPS: usize = 4;

/// Rounds up a sum of at most some thousand products of non-negative numbers, each of a few factors.
pub(crate) const UP: f64 = 1.0 + 1e-12;
