//! Evidence: measurements that somebody made, read from files and matched to the road network.
//!
//! [`read`] takes a file as a whole or refuses it, with every faulty row. [`match_rows`] says which edges or junctions a row
//! means. Where two roads could be meant it says so and does not guess. What a measurement changes is decided elsewhere.

mod cells;
mod columns;
mod error;
mod formats;
mod matching;
mod places;
mod read;
mod row;
mod shape;
#[cfg(test)]
mod tests;
mod values;

pub use error::{EvidenceError, Fault};
pub use matching::{Match, match_rows};
pub use read::read;
pub use row::{Along, Place, Quantity, Row, Value};
