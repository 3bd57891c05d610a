//! The independent checker: confirms or refutes certificates in files and databases without the code that made them.
//!
//! It was written from `docs/proof.md` and the file formats. The crate `netcert-check` checks one vehicle on one corridor; it
//! cannot depend on the kernel. Nothing of `stet` or `pipeline` is used here, and nothing there uses this module
//! (`tests/program/walls.rs`). The subject of a claim comes from the modules that the prover uses, too:
//! `vehicle`, `corridor` (the road's shape and widths), `turns` (a turn's area, paths and widths) and `network`. The claims
//! themselves are computed again.
//!
//! | file | for |
//! | --- | --- |
//! | `file`, `document`, `members` | certificate files |
//! | `database`, `turns`, `row_claim` | databases: edges, turns, and the claims of a row |
//! | `rules` | what a certificate may claim, in files and in databases |

mod database;
mod document;
mod file;
mod members;
mod row_claim;
mod rules;
mod turns;

pub use database::{RowOutcome, SetClaim, SetReport};
pub use file::{Report, certificate};
pub use netcert_check::plan::shift;
pub use netcert_check::{
    Chain, Finding, Interval, Outcome, RoadError, SpanClaim, StationReading, Subject, TOLERANCE_M, Weight,
};
pub use rules::ENDED;
pub use turns::TurnsClaim;
