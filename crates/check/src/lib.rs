//! The second opinion on one vehicle and one corridor: confirms or refutes what is claimed of them, without the code that claimed it.
//!
//! Written from `docs/proof.md`. It cannot depend on the kernel: Cargo says so. Pure: no input or output.
//!
//! | file | for |
//! | --- | --- |
//! | `interval` | numbers that hold the exact result: straight gains, and every decision that is close |
//! | `chain` | the vehicle as the proof has it |
//! | `gains` | exact gains on the straight (proof, section 4) |
//! | `road` | the corridor as a curve, and its own consistency |
//! | `plan` | the planned shift from its coefficients |
//! | `motion` | the nominal motion (section 2), four steps a station |
//! | `tubes` | the filter and the second order (sections 3 and 5) |
//! | `adjoint` | the exact time-varying bound (section 6), where the filter does not do |
//! | `leeway` | from tubes to leeway (section 7), by branch and bound against what is claimed |
//! | `claim` | what is said of one vehicle on one corridor, and what comes of it |
//! | `printed` | the paper's 𝒞, which decides nothing |
//!
//! How numbers are trusted. What is *chosen* – the nominal motion, feet, kernels – is plain `f64`: another choice would
//! give another bound, not a wrong one, and what rounding does to it is counted (`motion::DEFECT_RAD`). What *bounds* is rounded
//! up: sums and products of numbers that are not negative, by a factor above all that rounding can do (`UP`). What
//! *decides* is repeated in intervals wherever it is within `leeway::CLOSE_M` of the claim.

mod adjoint;
mod chain;
mod claim;
mod gains;
mod interval;
mod leeway;
mod motion;
pub mod plan;
pub mod printed;
mod road;
mod tubes;

pub use chain::Chain;
pub use claim::{Finding, Outcome, SpanClaim, Subject, TOLERANCE_M, finding};
pub use interval::Interval;
pub use leeway::Swept;
pub use road::RoadError;

/// Rounds up a sum of at most some thousand products of non-negative numbers, each of a few factors.
pub(crate) const UP: f64 = 1.0 + 1e-12;
