//! `netcert serve` over real HTTP on loopback: the built program, plain sockets, the demo region.
//!
//! What it answers is what the other verbs say; what it should refuse it refuses; what it promises of load and stopping
//! it keeps.

mod answers;
mod caching;
mod cut_off;
mod described;
pub(crate) mod http;
mod load;
mod refusals;
mod rides;
mod stopping;
mod tiles;
mod time_up;
