//! What these tests take from `tests/support/`.

#[path = "../support/catalogue.rs"]
pub(crate) mod catalogue;
#[path = "../support/demo.rs"]
pub(crate) mod demo;
#[path = "../support/extracts.rs"]
pub(crate) mod extracts;
