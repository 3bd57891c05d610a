//! Certificates of a whole network: of its edges, stroke by stroke, and of the turns between them.

mod least;
mod narrower;
mod needs;
mod strokes;
mod suppose;
mod touched;
mod turns;

pub use least::{least_of, least_that_does};
pub use needs::{KERBS_M, LineOf, MOST_KERB_M, MOST_MORE_M, TurnCase, edge_need, flares};
pub(crate) use strokes::verdict;
pub use strokes::{Job, Outcome, by_cell, certify_network, certify_strokes, make_strokes};
pub use suppose::{stroke_at_least, turn_with_kerb};
pub use touched::{NearNodes, Touched};
pub use turns::{TurnJob, TurnOutcome, best_of, certify_some_turns, certify_turns, fits, make_turns, turn_verdict};
