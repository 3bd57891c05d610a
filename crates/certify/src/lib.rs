//! Certificates of a whole network: of its edges, stroke by stroke, and of the turns between them.

use netcert_base::{stop, verdict, watch, words};
use netcert_kernel::stet;
use netcert_osm::{account, osm};
use netcert_roads::{corridor, network};
use netcert_rows as rows;
use netcert_rows::settings;

mod corners;
mod dependents;
mod job;
mod least;
mod narrower;
mod needs;
mod paths;
pub mod reporter;
mod strokes;
mod suppose;
mod turns;

pub use corners::{CORNER_ANGLES_DEG, CORNER_WIDTHS_M, Corners};
pub use dependents::{Dependents, NearNodes};
pub use job::Job;
pub use least::{least_of, least_that_does};
pub use needs::{KERBS_M, LineOf, MOST_KERB_M, MOST_MORE_M, TurnCase, edge_need, flares};
pub use paths::{best_of, fits};
pub use strokes::verdict;
pub use strokes::{CertificationOutcome, by_cell, certify_network, certify_strokes, make_strokes};
pub use suppose::{stroke_at_least, turn_as_it_is, turn_with_kerb};
pub use turns::{TurnJob, TurnOutcome, certify_some_turns, certify_turns, make_turns, turn_verdict};
