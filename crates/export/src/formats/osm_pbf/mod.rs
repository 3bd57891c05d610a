//! Writes the extract again with permits on its roads. Every object is kept, tags are added, and ways are split where needed.
//!
//! | what | how |
//! | --- | --- |
//! | a direction that is refused | `hgv:forward=no`, `hgv:backward=no`, both: `hgv=no`; for Valhalla `motor_vehicle:forward=no`, … for each of them, too |
//! | a road that is not in the network | the tags of a road with both directions refused |
//! | a direction that is permitted | `netcert:forward=yes`, `netcert:rsc:forward=0.31` (metres), … |
//! | the strip that the vehicle needs there, if the database knows where a narrower one would do | `netcert:uses:forward=carriageway`, `netcert:cost:forward=4` (so many times its time), … |
//! | a limit with a unit, a limit of a node on the road | a number in metres or tonnes on the road (`limits.rs`) |
//! | a restriction with several `from` or `to` | a restriction for each pair of them |
//! | a turn or passage that is refused, turning back, a restriction over ways | a relation `type=restriction`, `restriction:hgv=no_…`; for Valhalla `restriction=no_…`, of turns both |
//!
//! The first part of a split way keeps the way's id, the others get ids from [`FIRST_NEW_ID`] on. Relations name the parts. Blobs
//! of nodes and blocks without a change are copied. Memory holds some bytes for each split way and each edge of a refused turn,
//! besides the bit for each edge and turn that every export has.

mod block;
mod limits;
mod refusals;
mod relations;
mod rewrite;
mod split;
mod tags;

pub(super) use rewrite::rewrite;

use super::{Options, Target};
use crate::{Destination, ExportError, Layout, Source};

/// The first id of new objects. It is beyond the ids of OpenStreetMap (nodes reached 1.3e10 in 2026) and within the 40 bits that
/// Valhalla stores.
const FIRST_NEW_ID: i64 = 100_000_000_000;

/// The reader of the tags.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Flavour {
    /// Programs that read OpenStreetMap's tags for heavy goods vehicles.
    Hgv,
    /// Valhalla. It does not read `hgv:forward` and does not obey `restriction:hgv` everywhere, so the tags are those of all motor
    /// vehicles, and the file is for this vehicle only.
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

    fn write(&self, source: &Source<'_>, _: &Options, destination: &mut Destination) -> Result<(), ExportError> {
        rewrite(source, self.name(), Flavour::Hgv, destination, "extract.osm.pbf")
    }
}
