//! An oracle for the certifier: another simulator, an adversary that disturbs it, and random corridors to drive.
//!
//! Written from the kinematics alone. It shares no code with the certifier and depends on neither kernel nor checker: only vehicles,
//! corridors and claims go in. It does not model tyres, speed or hinge stops. For tests.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]

pub mod adversary;
pub mod claim;
pub mod draw;
pub mod duel;
pub mod fleet;
pub mod path;
pub mod road;
pub mod simulator;
pub mod turns;
