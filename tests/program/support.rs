//! What these tests take from `tests/support/`.

#[path = "../support/catalogue.rs"]
pub(crate) mod catalogue;
#[path = "../support/demo.rs"]
pub(crate) mod demo;
#[path = "../support/extracts.rs"]
pub(crate) mod extracts;
#[path = "../support/program.rs"]
pub(crate) mod program;
#[path = "../support/python.rs"]
pub(crate) mod python;
#[path = "../support/sheet.rs"]
pub(crate) mod sheet;
#[path = "../support/skip.rs"]
pub(crate) mod skip;
#[path = "../support/store_network.rs"]
pub(crate) mod store_network;
#[path = "../support/xml.rs"]
pub(crate) mod xml;
