//! The extract written again with permits on its roads: every object kept, tags added, ways split where they must be.
//!
//! | what | how |
//! | --- | --- |
//! | a direction that is refused | `hgv:forward=no`, `hgv:backward=no`, both: `hgv=no`; for Valhalla `motor_vehicle:forward=no`, … for each of them, too |
//! | a road that is not in the network | as one of which both directions are refused |
//! | what is certified | `netcert:forward=yes`, `netcert:rsc:forward=0.31` (metres), … |
//! | a turn or passage that is refused, turning back, a restriction over ways | a relation `type=restriction`, `restriction:hgv=no_…`; for Valhalla `restriction=no_…`, of turns both |
//!
//! The first part of a split way keeps its id, the others get ids from [`FIRST_NEW_ID`] on; relations name the parts. Blobs of nodes
//! and blocks without a change are copied as they are. In memory: some bytes for each way that is split and each edge of a refused
//! turn, besides the bit for each edge and turn that every export has.

mod block;
mod refusals;
mod relations;
mod rewrite;
mod split;
mod tags;

pub(super) use rewrite::rewrite;

use super::{Options, Target};
use crate::export::{ExportError, Layout, Place, Source};

/// New objects have ids from here on: beyond those of OpenStreetMap (nodes reached 1.3e10 in 2026), within the 40 bits that
/// Valhalla keeps.
const FIRST_NEW_ID: i64 = 100_000_000_000;

/// For whom the tags are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Flavour {
    /// Tags as OpenStreetMap has them, that speak of heavy goods vehicles alone.
    Hgv,
    /// Valhalla does not read `hgv:forward`, and obeys `restriction:hgv` not everywhere: tags of all motor vehicles, in a file for
    /// this vehicle alone.
    Valhalla,
}

/// `osm-pbf`
pub(super) struct OsmPbf;

impl Target for OsmPbf {
    fn name(&self) -> &'static str {
        "osm-pbf"
    }

    fn about(&self) -> &'static str {
        "the extract with permit tags on its roads, for any program that reads OpenStreetMap"
    }

    fn layout(&self, _: &Options) -> Layout {
        Layout::File
    }

    fn needs_extract(&self) -> bool {
        true
    }

    fn write(&self, source: &Source<'_>, _: &Options, place: &mut Place) -> Result<(), ExportError> {
        rewrite(source, self.name(), Flavour::Hgv, place, "extract.osm.pbf")
    }
}
