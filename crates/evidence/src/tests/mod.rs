//! Tests of reading and matching. Files are written by the tests, networks are drawn by them.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod cells;
mod cuts;
mod drawing;
mod faults;
mod formats;
mod ids;
mod lines;
mod noise;
mod points;
mod reference;
mod write;
