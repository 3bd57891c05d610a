//! Tests of the certificate by an independent simulator, an adversary, closed forms, published values and the paper.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, unreachable_pub)]
#![allow(clippy::print_stdout, clippy::print_stderr)]

mod areas;
mod climbing_routes;
mod corrcen;
mod ends;
mod errata;
mod hinges;
mod no_curve;
mod properties;
mod published_values;
mod routes;
mod simulator;
mod soundness;
mod stations;
mod tubes;
mod verify_agreement;
mod verify_files;
