//! The second opinion: confirms or refutes certificates, in files and databases, without the code that made them.
//!
//! Written from `docs/proof.md` and the file formats. Nothing of `stet` or `pipeline` is used here, and nothing there
//! uses this (`tests/program/verify_independence.rs`). What the statement is about comes from those who make it: `vehicle`, `corridor`
//! (the road's shape and widths), `turns` (a turn's area, paths and widths) and `network`; what is claimed of it is worked out again.
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
//! | `file`, `document`, `members` | certificate files |
//! | `database`, `turns`, `said` | databases: their edges, their turns, what a row of either says |
//!
//! How numbers are trusted. What is *chosen* – the nominal motion, feet, kernels – is plain `f64`: another choice would
//! give another bound, not a wrong one, and what rounding does to it is counted (`motion::DEFECT_RAD`). What *bounds* is rounded
//! up: sums and products of numbers that are not negative, by a factor above all that rounding can do (`UP`). What
//! *decides* is repeated in intervals wherever it is within [`leeway::CLOSE_M`] of the claim.

mod adjoint;
mod chain;
mod claim;
mod database;
mod document;
mod file;
mod gains;
mod interval;
mod leeway;
mod members;
mod motion;
mod plan;
mod printed;
mod road;
mod said;
mod tubes;
mod turns;

pub use chain::Chain;
pub use claim::{Finding, Outcome, SpanClaim, Subject, TOLERANCE_M};
pub use database::{RowOutcome, SetClaim, SetReport};
pub use file::{Report, certificate, sealed};
pub use interval::Interval;
pub use plan::shift;
pub use road::RoadError;
pub use turns::TurnsClaim;

/// Rounds up a sum of at most some thousand products of non-negative numbers, each of a few factors.
pub(crate) const UP: f64 = 1.0 + 1e-12;
