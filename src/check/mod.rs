//! The second opinion: confirms or refutes certificates, in files and databases, without the code that made them.
//!
//! Written from `docs/proof.md` and the file formats. One vehicle on one corridor is the crate `netcert-check`'s, which cannot depend
//! on the kernel. Nothing of `stet` or `pipeline` is used here, and nothing there
//! uses this (`tests/program/verify_independence.rs`). What the statement is about comes from those who make it: `vehicle`, `corridor`
//! (the road's shape and widths), `turns` (a turn's area, paths and widths) and `network`; what is claimed of it is worked out again.
//!
//! | file | for |
//! | --- | --- |
//! | `file`, `document`, `members` | certificate files |
//! | `database`, `turns`, `said` | databases: their edges, their turns, what a row of either says |

mod database;
mod document;
mod file;
mod members;
mod row_claim;
mod turns;

pub use database::{RowOutcome, SetClaim, SetReport};
pub use file::{Report, certificate};
pub use netcert_check::plan::shift;
pub use netcert_check::{Chain, Finding, Interval, Outcome, RoadError, SpanClaim, Subject, TOLERANCE_M};
pub use turns::TurnsClaim;
