//! Certificates of a whole network: of its edges, stroke by stroke, and of the turns between them.

mod least;
mod needs;
mod strokes;
mod turns;

pub use least::least_that_does;
pub use needs::{LineOf, MOST_KERB_M, TurnCase};
pub(crate) use strokes::verdict;
pub use strokes::{Job, certify_network};
pub use turns::{TurnJob, TurnOutcome, best_of, certify_turns, fits, turn_verdict};
