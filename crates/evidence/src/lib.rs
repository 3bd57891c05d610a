//! Evidence: measurements that somebody made, read from files and matched to the road network.
//!
//! [`read`] takes a file as a whole or refuses it, with every faulty row. [`match_rows`] says which edges or junctions a row
//! means. Where two roads could be meant it says so and does not guess. [`decide`] says which measurements of a register count.

use netcert_base::{watch, words};
use netcert_osm::{osm, shape};
use netcert_roads::network;
use netcert_rows as rows;

mod cells;
mod columns;
mod error;
mod formats;
mod json;
mod matching;
mod places;
mod read;
mod register;
mod row;
mod surface;
mod table_columns;
#[cfg(test)]
mod tests;
mod values;

pub use error::{CellFault, EvidenceError};
pub use matching::{Match, match_rows};
pub use read::{read, read_geojson};
pub use register::Edges;
pub use register::{
    Conflict, Decision, Entry, MeasurementTarget, State, Usage, decide, entries, match_again, without_doubles,
};
pub use row::{Along, MeasurementRow, Place, Quantity, Value};
pub use surface::{Counted, surface};
pub use table_columns::{Columns, parts};
