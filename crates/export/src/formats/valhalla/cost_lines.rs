//! `wider.json`: what makes roads dearer in a request on which the vehicle needs more than its own lane.
//!
//! Valhalla walks each line along its edges and refuses the whole request if it cannot follow one. It cannot follow some lines that begin at a
//! junction with short steps (`findings/valhalla-line-of-short-steps.sh`). So a line begins a little behind the junction and ends a little before
//! the next one. Of 6,000 open roads of Heidelberg Valhalla 3.9.1 then follows all but 1, in place of all but 55.

use std::io::Write as _;

use crate::formats::geojson::position;
use crate::osm::LonLat;
use crate::wider::Wider;
use crate::{Destination, ExportError, Source};

/// How much of a line is left out at each end, metres; at most a third of it.
const LEFT_OUT_M: f64 = 6.0;
/// Length of a degree on a sphere of the earth's mean radius. The error of 1 in 300 does not matter here.
const M_PER_DEGREE: f64 = 111_195.0;

/// Writes the file, if the database knows where a narrower strip would do.
pub(super) fn write(source: &Source<'_>, destination: &mut Destination) -> Result<(), ExportError> {
    let wider = source.wider()?;
    if !wider.known() {
        return Ok(());
    }
    let mut sink = destination.create("wider.json")?;
    sink.write_all(b"{\"linear_cost_factors\":[")?;
    let mut lines = 0_u64;
    each(source, &wider, |line, factor| {
        write!(sink, "{}", if lines == 0 { "\n" } else { ",\n" })?;
        write!(sink, "{{\"type\":\"Feature\",\"properties\":{{\"factor\":{factor}}},\"geometry\":")?;
        sink.write_all(b"{\"type\":\"LineString\",\"coordinates\":[")?;
        for (i, place) in line.iter().enumerate() {
            sink.write_all(if i == 0 { b"" } else { b"," })?;
            position(&mut sink, *place)?;
        }
        sink.write_all(b"]}}")?;
        lines += 1;
        Ok(())
    })?;
    sink.write_all(b"\n]}\n")?;
    source
        .reporter
        .note(&format!("wider.json makes {lines} edges dearer on which the vehicle needs more than its own lane"));
    sink.close()
}

fn each(
    source: &Source<'_>,
    wider: &Wider,
    mut put: impl FnMut(&[LonLat], f64) -> Result<(), ExportError>,
) -> Result<(), ExportError> {
    let mut database = source.database()?;
    for edge in source.edges(&mut database)? {
        let row = edge?.row;
        if let Some(road) = wider.edge(row.edge.index) {
            put(&between_its_ends(&row.line), road.factor)?;
        }
    }
    Ok(())
}

/// The line without what is left out at both ends.
fn between_its_ends(line: &[LonLat]) -> Vec<LonLat> {
    let length_m: f64 = line.windows(2).map(step_m).sum();
    let left_out_m = LEFT_OUT_M.min(length_m / 3.0);
    let mut line = without_beginning(line, left_out_m);
    line.reverse();
    line = without_beginning(&line, left_out_m);
    line.reverse();
    line
}

/// The line from so many metres behind its beginning on. It must be longer.
fn without_beginning(line: &[LonLat], mut left_out_m: f64) -> Vec<LonLat> {
    for (at, pair) in line.windows(2).enumerate() {
        let length_m = step_m(pair);
        if length_m > left_out_m {
            let share = left_out_m / length_m;
            let along =
                |from: i32, to: i32| (f64::from(from) + share * (f64::from(to) - f64::from(from))).round() as i32;
            let first =
                LonLat { lon_e7: along(pair[0].lon_e7, pair[1].lon_e7), lat_e7: along(pair[0].lat_e7, pair[1].lat_e7) };
            return std::iter::once(first).chain(line.iter().copied().skip(at + 1)).collect();
        }
        left_out_m -= length_m;
    }
    line.to_vec()
}

/// Length of a step, metres.
fn step_m(pair: &[LonLat]) -> f64 {
    let ((lon, lat), (to_lon, to_lat)) = (pair[0].degrees(), pair[1].degrees());
    let shrink = (0.5 * (lat + to_lat)).to_radians().cos();
    M_PER_DEGREE * ((to_lon - lon) * shrink).hypot(to_lat - lat)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_lies_between_its_ends_and_keeps_its_corners() {
        // Steps of 1.11 m each along a meridian, and one of 111 m.
        let place = |lat_e7| LonLat { lon_e7: 0, lat_e7 };
        let line = between_its_ends(&[place(0), place(100), place(200), place(10_200), place(10_300)]);
        assert_eq!(line, [place(540), place(9_760)]);
        // Of a short line a third is left out at each end.
        assert_eq!(between_its_ends(&[place(0), place(90)]), [place(30), place(60)]);
        let corner = LonLat { lon_e7: 10_000, lat_e7: 10_000 };
        assert_eq!(between_its_ends(&[place(0), place(10_000), corner])[1], place(10_000));
    }
}
