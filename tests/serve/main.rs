//! `netcert serve` over real HTTP on loopback: the built program, plain sockets, the demo region.
//!
//! What it answers is what the other verbs say; what it should refuse it refuses; what it promises of load and stopping
//! it keeps.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

#[path = "../support/program.rs"]
#[allow(dead_code)] // not every test needs all of it
mod program;
#[path = "../support/xml.rs"]
mod xml;

mod answers;
mod caching;
mod cut_off;
mod described;
mod http;
mod load;
mod refusals;
mod rides;
mod stopping;
mod tiles;
