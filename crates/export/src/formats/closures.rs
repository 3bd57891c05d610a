//! Small rectangles across refused roads, for engines that avoid areas, and across roads on which the vehicle needs more than its own lane.
//!
//! Every refused stretch between two junctions gets one rectangle, on its longest straight, so that the rectangle meets no other
//! road. An area has no direction, so a stretch that is refused in one direction is closed in both. An area cannot express a turn. A
//! stretch that leads only to a refused corner of the road is closed instead. Of a stretch with two directions that cost differently, the dearer one
//! counts.

use std::io::{self, Write};

use super::geojson::position;
use crate::osm::LonLat;
use crate::rows::EdgeNo;
use crate::wider::{EdgeUse, Wider};
use crate::{ExportError, Source};

/// Half the rectangle's size across the road, metres. Engines move lines by half a metre when they simplify them (GraphHopper:
/// `DEFAULT_WAY_POINT_MAX_DISTANCE`, 0.5 m).
const ACROSS_M: f64 = 0.75;
/// Half the rectangle's size along the road, metres.
const ALONG_M: f64 = 0.25;
/// Length of a degree on a sphere of the earth's mean radius. The error of 1 in 300 does not matter here.
const M_PER_DEGREE: f64 = 111_195.0;

/// A closed ring, counterclockwise.
pub(super) type ClosureRing = [LonLat; 5];

/// Counts of closed stretches.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Closed {
    /// Number of closed stretches.
    pub(super) stretches: u64,
    /// Number of closed stretches with a permitted direction.
    pub(super) too_much: u64,
}

impl Closed {
    /// The counts in words for the user.
    pub(super) fn note(self) -> String {
        let Self { stretches, too_much } = self;
        format!(
            "{stretches} stretches are closed, {too_much} of them permitted in a direction (an area has no direction, and a stretch \
             before a refused corner is closed); areas cannot express refused turns"
        )
    }
}

/// What a rectangle stands across.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Across {
    /// A stretch that is closed.
    Closed,
    /// A stretch that is open and uses more than the own lane.
    Wider(EdgeUse),
}

/// Calls `put` with the rectangle of every stretch that is refused or uses more than the own lane, in order of the network.
pub(super) fn each(
    source: &Source<'_>,
    wider: &Wider,
    mut put: impl FnMut(Across, &ClosureRing) -> Result<(), ExportError>,
) -> Result<Closed, ExportError> {
    let mut closed = Closed::default();
    let mut last: Option<Stretch> = None;
    let mut end = |stretch: Stretch| -> Result<(), ExportError> {
        let Some(ring) = across(&stretch.line) else { return Ok(()) };
        if stretch.refused {
            closed.stretches += 1;
            closed.too_much += u64::from(stretch.permitted);
            put(Across::Closed, &ring)?;
        } else if let Some(road) = stretch.wider {
            put(Across::Wider(road), &ring)?;
        }
        Ok(())
    };
    let stopped = source.stopped()?;
    let mut database = source.database()?;
    for (index, edge) in EdgeNo::all().zip(source.edges(&mut database)?) {
        let edge = edge?;
        let permitted = edge.refusal.is_none();
        let refused = !permitted || stopped.contains(&index);
        // The two directions of a stretch are successive edges.
        if let Some(stretch) = &mut last
            && stretch.way_id == edge.row.edge.way_id
            && stretch.line.iter().rev().eq(&edge.row.line)
        {
            stretch.refused |= refused;
            stretch.permitted |= permitted;
            stretch.wider = dearer(stretch.wider, wider.edge(index));
            continue;
        }
        let (way_id, wider) = (edge.row.edge.way_id, wider.edge(index));
        let stretch = Stretch { way_id, line: edge.row.line, refused, permitted, wider };
        if let Some(done) = last.replace(stretch) {
            end(done)?;
        }
    }
    last.map_or(Ok(()), end)?;
    Ok(closed)
}

struct Stretch {
    way_id: i64,
    line: Vec<LonLat>,
    refused: bool,
    permitted: bool,
    wider: Option<EdgeUse>,
}

fn dearer(a: Option<EdgeUse>, b: Option<EdgeUse>) -> Option<EdgeUse> {
    a.into_iter().chain(b).max_by(|a, b| a.factor.total_cmp(&b.factor))
}

/// The coordinates of a `Polygon`.
pub(super) fn polygon(out: &mut dyn Write, ring: &ClosureRing) -> io::Result<()> {
    for (i, place) in ring.iter().enumerate() {
        out.write_all(if i == 0 { b"[[" } else { b"," })?;
        position(out, *place)?;
    }
    out.write_all(b"]]")
}

/// The rectangle across the middle of a line's longest straight.
fn across(line: &[LonLat]) -> Option<ClosureRing> {
    let step = |pair: &[LonLat]| {
        let ((lon, lat), (to_lon, to_lat)) = (pair[0].degrees(), pair[1].degrees());
        let shrink = (0.5 * (lat + to_lat)).to_radians().cos();
        [(to_lon - lon) * shrink * M_PER_DEGREE, (to_lat - lat) * M_PER_DEGREE]
    };
    let length_m = |pair: &[LonLat]| step(pair).into_iter().map(|m| m * m).sum::<f64>().sqrt();
    let longest = line.windows(2).max_by(|a, b| length_m(a).total_cmp(&length_m(b)))?;
    let ([east_m, north_m], length_m) = (step(longest), length_m(longest));
    if length_m <= 0.0 {
        return None;
    }
    let along = [east_m / length_m, north_m / length_m];
    let ((lon, lat), (to_lon, to_lat)) = (longest[0].degrees(), longest[1].degrees());
    let middle = [0.5 * (lon + to_lon), 0.5 * (lat + to_lat)];
    let corner = |forward: f64, left: f64| {
        let east_m = forward * along[0] - left * along[1];
        let north_m = forward * along[1] + left * along[0];
        let lon = middle[0] + east_m / (M_PER_DEGREE * middle[1].to_radians().cos());
        let e7 = |degrees: f64| (degrees * 1e7).round() as i32;
        LonLat { lon_e7: e7(lon), lat_e7: e7(middle[1] + north_m / M_PER_DEGREE) }
    };
    let first = corner(-ALONG_M, -ACROSS_M);
    Some([first, corner(ALONG_M, -ACROSS_M), corner(ALONG_M, ACROSS_M), corner(-ALONG_M, ACROSS_M), first])
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use geo::{Area as _, Intersects as _};

    #[test]
    fn a_rectangle_stands_across_the_longest_straight() {
        let place = |lon_e7, lat_e7| LonLat { lon_e7, lat_e7 };
        let line = [place(86_900_000, 494_000_000), place(86_901_000, 494_000_500), place(86_901_000, 493_995_000)];
        let ring = across(&line).unwrap();
        let degrees = |line: &[LonLat]| line.iter().map(|place| place.degrees()).collect::<geo::LineString>();
        let polygon = geo::Polygon::new(degrees(&ring), vec![]);
        assert!(polygon.intersects(&degrees(&line)) && !polygon.intersects(&degrees(&line[..2])));
        // The rectangle is 1.5 m by 0.5 m; positions are rounded to 1.1 cm.
        let area_m2 = polygon.signed_area() * M_PER_DEGREE.powi(2) * 49.4_f64.to_radians().cos();
        assert!((0.70..0.80).contains(&area_m2), "{area_m2}");
        assert!(across(&line[..1]).is_none());
    }
}
