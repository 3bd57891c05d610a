//! An oracle for the certifier: a second simulator, an adversary that disturbs it, and random corridors to drive.
//!
//! It is written from the kinematics alone and shares no code with the certifier. Its inputs are vehicles, corridors
//! and claims. It does not model tyres, speed or hinge stops. It is for tests.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]

pub mod adversary;
pub mod area;
pub mod area_attack;
pub mod attack;
pub mod claim;
pub mod crossing;
pub mod draw;
pub mod fleet;
pub mod journey;
pub mod least_room;
pub mod path;
pub mod planner;
pub mod road;
pub mod simulator;
pub mod turns;
