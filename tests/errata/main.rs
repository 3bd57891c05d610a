//! Errata of the paper, each a test in which the printed form fails and the repaired one, or netcert's own, holds.
//! `docs/errata.md` tells them to a reader of the paper; numbers there are printed by these tests
//! (`cargo test --test errata -- --nocapture`).
//!
//! What the two code paths are: `netcert::published` to the letter, and the same with the fault's switch in
//! `Reading` thrown, or `netcert::stet`.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

mod algorithm;
mod certificate;
mod leeway;
mod motion;
#[path = "../oracle/mod.rs"]
mod oracle;
mod property;
mod scene;
mod tubes;
