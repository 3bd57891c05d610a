//! Which program this is.

/// The version of the program and a hash of its sources: two builds of one version may differ.
pub const PROGRAM: &str = concat!(env!("CARGO_PKG_VERSION"), "+", env!("NETCERT_SOURCES"));
