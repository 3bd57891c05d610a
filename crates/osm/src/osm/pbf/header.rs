//! The file's header: the features it requires of a reader, and its metadata.

use osmpbfreader::osmformat::HeaderBlock;
use protobuf::Message;

use crate::osm::read_account::HeaderInfo;

use super::{
    error::PbfProblem,
    wire::{self, FieldEncoding},
};

/// Features that this reader supports. Any other required feature is refused by name.
const SUPPORTED: [&str; 3] = ["OsmSchema-V0.6", "DenseNodes", "LocationsOnWays"];

/// Reads a header block. Refuses files that cannot be read correctly.
pub(super) fn parse(block: &[u8]) -> Result<HeaderInfo, PbfProblem> {
    use FieldEncoding::{Bytes, Number};
    wire::check(block, &[(1, Bytes), (4, Bytes), (5, Bytes), (16, Bytes), (17, Bytes), (32, Number), (33, Number)])?;
    let damaged = |error: protobuf::Error| PbfProblem::Message { what: "OSMHeader", detail: error.to_string() };
    let header = HeaderBlock::parse_from_bytes(block).map_err(damaged)?;
    for feature in &header.required_features {
        match feature.as_str() {
            "HistoricalInformation" => return Err(PbfProblem::History),
            known if SUPPORTED.contains(&known) => {}
            other => return Err(PbfProblem::Feature(other.to_owned())),
        }
    }
    let says = |wanted: &str| header.optional_features.iter().any(|feature| feature == wanted);
    let locations = "LocationsOnWays";
    Ok(HeaderInfo {
        bbox_nanodegrees: header.bbox.as_ref().map(|b| [b.left(), b.bottom(), b.right(), b.top()]),
        writing_program: header.writingprogram().to_owned(),
        source: header.source().to_owned(),
        replication_timestamp_s: header.osmosis_replication_timestamp,
        replication_sequence: header.osmosis_replication_sequence_number,
        sorted: says("Sort.Type_then_ID"),
        locations_on_ways: says(locations) || header.required_features.iter().any(|f| f == locations),
    })
}
