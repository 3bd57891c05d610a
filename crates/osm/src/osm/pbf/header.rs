//! The file's header: the features it requires of a reader, and its metadata.

use osmpbfreader::osmformat::HeaderBlock;
use protobuf::Message;

use super::{
    error::Problem,
    wire::{self, Shape},
};

/// Features that this reader supports. Any other required feature is refused by name.
const SUPPORTED: [&str; 3] = ["OsmSchema-V0.6", "DenseNodes", "LocationsOnWays"];

/// Data of the file's first header. Missing texts are empty.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct HeaderInfo {
    /// West, south, east, north in nanodegrees, if given.
    pub bbox_nanodegrees: Option<[i64; 4]>,
    /// Program that wrote the file.
    pub writing_program: String,
    /// Source of the data.
    pub source: String,
    /// Seconds since 1970 (UTC) up to which the data is complete, if given.
    pub replication_timestamp_s: Option<i64>,
    /// Sequence number of the replication, if given.
    pub replication_sequence: Option<i64>,
    /// Whether the file claims to be sorted by type and id. The claim is always checked.
    pub sorted: bool,
    /// Whether the file claims that ways carry the positions of their nodes.
    pub locations_on_ways: bool,
}

impl HeaderInfo {
    /// West, south, east, north in degrees, if given.
    #[must_use]
    pub fn bbox_deg(&self) -> Option<[f64; 4]> {
        self.bbox_nanodegrees.map(|sides| sides.map(|side| side as f64 * 1e-9))
    }
}

/// Reads a header block. Refuses files that cannot be read correctly.
pub(super) fn parse(block: &[u8]) -> Result<HeaderInfo, Problem> {
    use Shape::{Bytes, Number};
    wire::check(block, &[(1, Bytes), (4, Bytes), (5, Bytes), (16, Bytes), (17, Bytes), (32, Number), (33, Number)])?;
    let damaged = |error: protobuf::Error| Problem::Message { what: "OSMHeader", detail: error.to_string() };
    let header = HeaderBlock::parse_from_bytes(block).map_err(damaged)?;
    for feature in &header.required_features {
        match feature.as_str() {
            "HistoricalInformation" => return Err(Problem::History),
            known if SUPPORTED.contains(&known) => {}
            other => return Err(Problem::Feature(other.to_owned())),
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
