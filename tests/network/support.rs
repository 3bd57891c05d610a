//! Parts of `tests/support/` that these tests use.

#[path = "../support/accounts.rs"]
pub(crate) mod accounts;
#[path = "../support/ascii_map.rs"]
pub(crate) mod ascii_map;
#[path = "../support/catalogue.rs"]
pub(crate) mod catalogue;
#[path = "../support/demo.rs"]
pub(crate) mod demo;
#[path = "../support/extracts.rs"]
pub(crate) mod extracts;
#[path = "../support/junctions.rs"]
pub(crate) mod junctions;
#[path = "../support/roundabout.rs"]
pub(crate) mod roundabout;
#[path = "../support/routing.rs"]
pub(crate) mod routing;
#[path = "../support/skip.rs"]
pub(crate) mod skip;
