//! Writes the roads and turns that a vehicle may use in the formats of routing engines and map programs.
//!
//! - All targets share one rule of what is permitted ([`PermitPolicy`]), the rule of `netcert route`. What is not certified is
//!   refused.
//! - A header in or beside every output says what the permits depend on ([`Header`]).
//! - Rows are streamed in order of the network, and the same input gives the same bytes. GeoParquet and FlatGeobuf sort them along a curve,
//!   outside memory.
//! - An output is complete or absent ([`Destination`]).
//!
//! | file | for |
//! | --- | --- |
//! | `ask` | what an export is asked for |
//! | `permit` | the rule, and the edges and turns that it permits |
//! | `header` | the header of every output |
//! | `measurements` | the measurements behind the permits, for the header |
//! | `source` | rows from the database, each with its permit |
//! | `corners` | edges before a refused corner of a road |
//! | `sequences` | sequences of permitted edges that may not be driven |
//! | `wider` | where permits use more than the own lane, and what that costs |
//! | `ways` | the extract's ways beside the network's edges |
//! | `destination` | the output: a file, a folder or a stream |
//! | `unfinished` | what to remove if the program is stopped |
//! | `formats` | one file or folder for each target |
//! | `cluster` | the tables that machines of a cluster read and write |
//! | `error` | errors |
//!
//! An export does not certify whole routes. An engine joins edges and turns that are each safe by themselves; only `netcert
//! route` certifies the whole.

use netcert_base::{vehicle, verdict, words};
use netcert_certify::reporter;
use netcert_evidence as evidence;
use netcert_files::{folders, output_lock, scratch, sorter};
use netcert_osm::osm;
use netcert_pipeline as pipeline;
use netcert_route as route;
use netcert_rows as rows;
use netcert_store as store;

mod ask;
pub mod cluster;
mod corners;
mod destination;
mod error;
pub mod formats;
mod header;
mod measurements;
mod permit;
mod sequences;
mod source;
mod unfinished;
mod ways;
mod wider;

pub use ask::Ask;
pub use destination::{Destination, Layout, Out, Sink};
pub use error::ExportError;
pub use formats::Target;
pub use header::{Header, Provenance};
pub use measurements::{MeasuredBy, Measurements};
pub use permit::{Bits, PermitPolicy, PermitRefusal, Permitted, Tally};
pub use source::{ExportEdge, ExportTurn, Source};
pub use unfinished::Unfinished;

/// Writes one export from beginning to end.
///
/// # Errors
/// The database or extract cannot be read, or the output cannot be written. Nothing of the output is left then.
pub fn export(
    source: &Source<'_>,
    target: &dyn Target,
    options: &formats::Options,
    out: Out,
    unfinished: Unfinished,
) -> Result<(), ExportError> {
    formats::check_reference(target, source.ask.relative_to.as_deref())?;
    let mut destination = Destination::begin(out, target.layout(options), unfinished)?;
    let written = target.write(source, options, &mut destination).and_then(|()| {
        if destination.is_folder() {
            destination.write_whole("netcert.json", format!("{:#}\n", source.header.json()).as_bytes())?;
        }
        Ok(())
    });
    match written {
        Ok(()) => destination.finish(),
        Err(error) => Err(destination.name(error)),
    }
}
