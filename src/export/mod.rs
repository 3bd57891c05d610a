//! What a vehicle may use, in the form that a routing engine or a map program reads.
//!
//! Promises: one rule of what is permitted ([`PermitPolicy`]), that of `netcert route`, for every target; a header in or beside
//! every output that says what it rests on ([`Header`]); rows streamed in order of the network, the same input giving the
//! same bytes; outputs that are whole or not there ([`Place`]). What is not certified is refused.
//!
//! | file | for |
//! | --- | --- |
//! | `permit` | the rule, and which edges and turns it lets through |
//! | `header` | what every output says of itself |
//! | `source` | rows from the database, each with its permit |
//! | `rings` | the arcs of a passage |
//! | `sequences` | what may not follow what, of edges that may be used |
//! | `ways` | the extract's ways beside the network's edges |
//! | `place` | where an output is written: a file, a folder, a stream |
//! | `unfinished` | what goes if the program is stopped |
//! | `sorter` | order without holding everything in memory |
//! | `target` | one file or folder a target |
//!
//! Left out: the certificate over a whole route. An engine strings together edges and turns that are safe each by itself; only
//! `netcert route` certifies the whole.

mod destination;
mod error;
pub mod formats;
mod header;
mod permit;
mod rings;
mod sequences;
mod sorter;
mod source;
mod unfinished;
mod ways;

pub use destination::{Layout, Out, Place, Sink};
pub use error::ExportError;
pub use formats::Target;
pub use header::{Header, Provenance};
pub use permit::{Bits, PermitPolicy, Permitted, Refusal, Tally};
pub use source::{Ask, ExportEdge, ExportTurn, Source};
pub use unfinished::Unfinished;

/// Writes one export from beginning to end.
///
/// # Errors
/// The database or extract cannot be read, or the output not written; then nothing of it is left behind.
pub fn export(
    source: &Source<'_>,
    target: &dyn Target,
    options: &formats::Options,
    (out, unfinished): (Out, Unfinished),
) -> Result<(), ExportError> {
    let mut place = Place::begin(out, target.layout(options), unfinished)?;
    let written = target.write(source, options, &mut place).and_then(|()| {
        if place.is_folder() {
            place.write_whole("netcert.json", format!("{:#}\n", source.header.json()).as_bytes())?;
        }
        Ok(())
    });
    match written {
        Ok(()) => place.finish(),
        Err(error) => Err(place.name(error)),
    }
}
