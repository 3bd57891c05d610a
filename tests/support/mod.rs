//! What several tests use. None of the crates that the tests are built as needs all of it.
#![allow(dead_code)]

pub(crate) mod ascii_map;
pub(crate) mod program;
pub(crate) mod python;
pub(crate) mod routing;
pub(crate) mod store_network;
pub(crate) mod xml;
