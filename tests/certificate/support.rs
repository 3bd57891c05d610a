//! Parts of `tests/support/` that these tests use.

#[path = "../support/catalogue.rs"]
pub(crate) mod catalogue;
#[path = "../support/demo.rs"]
pub(crate) mod demo;
#[path = "../support/extracts.rs"]
pub(crate) mod extracts;
// The network's tests use more of it.
#[path = "../support/routing.rs"]
#[allow(dead_code)]
pub(crate) mod routing;
#[path = "../support/skip.rs"]
pub(crate) mod skip;
