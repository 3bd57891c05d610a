//! `netcert serve` over real HTTP on loopback: the built program, plain sockets, the demo region.
//!
//! The tests cover its answers, its refusals, and its behaviour under load and when it is stopped.

mod answers;
mod backdrop;
mod caching;
mod changes;
mod conditional;
mod cut_off;
mod editing;
mod features;
pub(crate) mod http;
mod load;
mod openapi;
mod refusals;
mod rides;
mod schemathesis;
mod search;
mod stopping;
mod tiles;
mod time_up;
