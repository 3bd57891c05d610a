//! A second opinion on one vehicle and one corridor: it confirms or refutes claims without the code that made them.
//!
//! The crate is written from `docs/proof.md`. Its Cargo manifest keeps it independent of the kernel. It is pure: no
//! input or output.
//!
//! Files use only those above them in this table. `tests/program/circles.rs` tests that there is no circle.
//!
//! | file | for |
//! | --- | --- |
//! | `interval` | intervals that hold the exact result, for straight gains and for every close decision |
//! | `link` | one unit in the proof's terms |
//! | `gains` | exact gains on the straight (proof, section 4) |
//! | `chain` | the vehicle with its gains |
//! | `vector`, `hull` | places of the plane, convex hulls and distances |
//! | `curve`, `fit` | the centreline between two stations, and the test that stations fit |
//! | `areas` | areas that stand in for half-widths, with their boundaries |
//! | `road` | the corridor as a curve |
//! | `plan` | the planned shift from its coefficients |
//! | `motion` | the nominal motion (section 2), four steps per station |
//! | `coefficients`, `tubes` | what the motion is to deviations, and the bounds of deviations, step by step |
//! | `adjoint` | the exact time-varying bound (section 6), where the filter is too loose |
//! | `second_order`, `filter` | the second order (section 3), and the filter that finds the tubes (section 5) |
//! | `feet` | the place of the road on whose normal a point lies |
//! | `swept_vehicle` | the vehicle swept along its road: motion and tubes, and what the adjoint has said |
//! | `sharpen` | runs the adjoint where it is wanted |
//! | `hinges` | margins of hinges (section 10) |
//! | `cell`, `allowance` | leeway at the corners of a cell (section 7), and what its inside may lack |
//! | `targets` | what leeway is claimed, and where it is missing |
//! | `leeway` | decides a cell by branch and bound |
//! | `coarse` | coarse bounds of leeway, for the many places far above their claim |
//! | `search` | the search for places below their claim: first by coarse bounds, then by cells |
//! | `plane` | the same in areas (section 11), where bodies are held against a part of the plane |
//! | `claim` | the claims about one vehicle on one corridor, and their results |
//! | `subject` | a vehicle on a corridor along a plan |
//! | `limiting`, `spans`, `columns` | check limiting places, claims about spans, and columns of leeway |
//! | `paper_rsc` | the paper's 𝒞, which decides nothing |
//! | `test_vehicles` | drawn vehicles and numbers, for tests |
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
pub mod paper_rsc;
pub mod plan;
mod plane;
mod road;
mod search;
mod second_order;
mod sharpen;
mod spans;
mod subject;
mod swept_vehicle;
mod targets;
#[cfg(test)]
mod test_vehicles;
mod tubes;
mod vector;

pub use chain::Chain;
pub use claim::{Finding, Outcome, SpanClaim, Weight, finding};
pub use fit::{RoadError, StationReading};
pub use interval::Interval;
pub use subject::Subject;
pub use swept_vehicle::SweptVehicle;

/// A claim counts as proved if it is at most this far above the bound found here, metres. The two programs cut the road
/// into different steps. `claim` applies the tolerance, and nothing else does.
pub const TOLERANCE_M: f64 = 1e-3;

/// Steps of the nominal motion per station.
pub(crate) const STEPS: usize = 4;

/// Rounds up a sum of at most some thousand products of non-negative numbers, each of a few factors.
pub(crate) const UP: f64 = 1.0 + 1e-12;

/// Rounds up a sum over all steps of a history. Its terms decay by tens of orders, so few of them are rounded at its size.
pub(crate) const HISTORY_UP: f64 = 1.0 + 1e-10;
