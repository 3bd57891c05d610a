//! An oracle for the certifier: another simulator, an adversary that disturbs it, and random corridors to drive.
//!
//! Written from the kinematics alone (design section 1 and the no-slip rule of section 3). It shares no code with
//! `netcert::stet`: only `Vehicle` and `Corridor` values go in. It does not model tyres, speed or hinge stops.
#![allow(dead_code, unreachable_pub)]

pub mod adversary;
pub mod claim;
pub mod draw;
pub mod duel;
pub mod fight;
pub mod files;
pub mod fleet;
pub mod path;
pub mod road;
pub mod simulator;
pub mod turns;
pub mod whole;
