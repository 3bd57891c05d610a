//! Changes of an existing database: each in one transaction, or in a copy that takes its place.

pub(crate) mod amendment;
pub(crate) mod renewal;
pub(crate) mod replacement;
