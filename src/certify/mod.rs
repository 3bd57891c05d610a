//! Certificates of a whole network: of its edges, stroke by stroke, and of the turns between them.

mod strokes;
mod turns;

pub(crate) use strokes::verdict;
pub use strokes::{Job, certify_network};
pub use turns::{TurnJob, TurnOutcome, best_of, certify_turns, turn_verdict};
