//! What netcert's tests, benches and examples of the documentation stand on.
//!
//! | modules | what they do |
//! | --- | --- |
//! | `ascii_map`, `roundabout`, `junctions`, `routing`, `store_network` | draw roads, and make networks and routes of them |
//! | `demo`, `extracts`, `catalogue`, `documentation` | the shipped region, real extracts, the catalogue's vehicles |
//! | `program`, `python`, `skip` | run the built program and Python packages, and say what is not there |
//! | `thorough` | how many cases a test looks at |
//! | `accounts`, `sheet`, `xml` | look at what was written |
//! | `mutations` | change certificate files so that `verify` must refute them |
//! | `oracle` | the link between the certifier and the oracle |
//!
//! A fault here is a test that fails, so everything may panic.
#![allow(missing_docs)]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, clippy::print_stderr)]

use std::path::Path;

pub mod accounts;
pub mod ascii_map;
pub mod catalogue;
pub mod demo;
pub mod documentation;
pub mod extracts;
pub mod junctions;
pub mod mutations;
pub mod oracle;
pub mod program;
pub mod python;
pub mod roundabout;
pub mod routing;
pub mod sheet;
pub mod skip;
pub mod store_network;
pub mod thorough;
pub mod xml;

/// The folder of the repository.
fn repository() -> &'static Path {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).parent();
    crates.and_then(Path::parent).expect("the crate lies in crates/ of the repository")
}
