//! A corridor prepared for one vehicle, with the stations marked that its spans ask for.

use std::ops::Range;
use std::rc::Rc;

use netcert_base::corridor::Corridor;

use super::areas::Grounds;
use super::model::Model;
use super::reach::VehicleReach;
use super::spans;
use super::track::Track;

/// The stations at which the leeway between two points of a side is examined.
#[derive(Debug, Clone, Copy)]
pub(super) enum Marks {
    /// The first and the last station of each span.
    Ends,
    /// All stations. A certificate gives the leeway of each station by itself.
    All,
}

/// The corridor, prepared for a vehicle and spans.
pub(super) fn marked(
    corridor: &Corridor,
    model: &Model,
    spans: &[Range<usize>],
    marks: Marks,
    grounds: &Grounds,
) -> Rc<Track> {
    let mut track = Track::on(corridor, VehicleReach::of(model).extensions(corridor.spacing_m), grounds);
    match marks {
        Marks::Ends => track.mark(spans.iter().flat_map(|span| spans::marks(corridor.spacing_m, span))),
        Marks::All => track.mark(0..corridor.len()),
    }
    Rc::new(track)
}
