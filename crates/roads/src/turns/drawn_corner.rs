//! A drawn corner: two straight roads that cross, with one kerb between them. It needs no map.

use super::arm::{Arm, StrokeLine};
use super::arms::{Arms, MEET_M};
use super::junction::{JOIN_M, Junction, LEAVE_M};
use super::{LengthClass, TurnCorridors};
use crate::corridor::{Corridor, EdgeSpan, Frame, StrokeCorridor};
use crate::network::{EdgeNo, Network};
use crate::osm::facts::Policy;
use crate::verdict::UnknownReason;

/// Length of each road before and after the crossing, metres. No vehicle sees its ends.
const ROAD_M: f64 = 300.0;
/// Distance between stations, metres, as on mapped roads.
const SPACING_M: f64 = 1.0;

/// A corner between two straight roads that cross. The vehicle uses the whole width of both, and turns round the kerb between them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DrawnCorner {
    /// Angle by which the vehicle turns, radians, between 0 and π.
    pub turn_rad: f64,
    /// Widths of the road that is left and of the road that is entered, metres.
    pub widths_m: [f64; 2],
    /// Radius of the kerb on the inside of the turn, metres; 0: a sharp corner.
    pub kerb_radius_m: f64,
}

impl DrawnCorner {
    /// The corridors of the turn, to the right.
    ///
    /// # Errors
    /// `Geometry`: a width or the angle cannot be drawn.
    pub fn corridors(&self, length_class: LengthClass) -> Result<TurnCorridors, UnknownReason> {
        let possible = self.widths_m.iter().all(|width_m| *width_m > 0.0 && width_m.is_finite())
            && self.turn_rad > 0.0
            && self.turn_rad < std::f64::consts::PI;
        if !possible {
            return Err(UnknownReason::Geometry);
        }
        let frame = Frame::around_degrees([(0.0, 0.0)]).map_err(|_| UnknownReason::Geometry)?;
        let [from_m, to_m] = self.widths_m;
        let (from, to) = (road(0, frame, 0.0, from_m), road(1, frame, -self.turn_rad, to_m));
        let before_m = length_class.run_in_m() + length_class.counted_before_m() + LEAVE_M;
        let after_m = length_class.counted_after_m() + MEET_M + JOIN_M;
        let arriving = Arm::arriving(&from, edge(0, Half::Before), frame, Policy::Lane, [before_m, MEET_M])?;
        let leaving = Arm::leaving(&to, edge(1, Half::After), frame, Policy::Lane, [MEET_M, after_m])?;
        let junction = Junction::drawn(Arms::new(arriving, leaving, [0, 1], length_class), self.kerb_radius_m);
        TurnCorridors::at(junction, &Network::default(), frame)
    }
}

/// The half of a road before or after the crossing.
#[derive(Clone, Copy)]
enum Half {
    Before,
    After,
}

/// The edge of one half of a road.
fn edge(road: u32, half: Half) -> EdgeNo {
    EdgeNo::new(2 * road + half as u32)
}

/// A straight road through the origin.
fn road(number: u32, frame: Frame, heading: f64, width_m: f64) -> StrokeLine {
    let (sin, cos) = heading.sin_cos();
    let middle = (ROAD_M / SPACING_M) as usize;
    let straight = vec![0.0; 2 * middle + 1];
    let start = [-ROAD_M * cos, -ROAD_M * sin];
    let corridor = Corridor::from_curvature(SPACING_M, start, heading, &straight, 0.5 * width_m, 0.5 * width_m);
    let span = |half: Half| EdgeSpan {
        edge: edge(number, half),
        stations: match half {
            Half::Before => 0..middle + 1,
            Half::After => middle..2 * middle + 1,
        },
        min_radius_m: f64::INFINITY,
        centreline_deviation_m: 0.0,
        unknown: None,
    };
    let spans = vec![span(Half::Before), span(Half::After)];
    StrokeLine::drawn(number, StrokeCorridor { frame, corridor, spans, tapers: Vec::new() })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use geo::Area as _;

    use super::super::area::polygon;
    use super::*;

    /// What the rings that certificates count with enclose, square metres.
    fn ground_m2(made: &TurnCorridors) -> f64 {
        let path = made.seeds().into_iter().find_map(|code| made.path(code)?.area).unwrap();
        path.area.rings.iter().map(|ring| polygon(ring).unsigned_area()).sum()
    }

    /// The rings enclose what the roads and the kerb cover. At right angles unions draw corners twice.
    #[test]
    fn the_ground_of_a_corner_is_that_of_its_roads_at_every_angle() {
        for turn_deg in [30.0, 45.0, 60.0, 75.0, 89.99, 90.0, 90.01, 105.0, 120.0, 135.0, 150.0] {
            for widths_m in [[2.75, 2.75], [4.5, 4.5], [3.25, 7.5], [14.0, 5.5]] {
                for kerb_radius_m in [0.0, 2.0, 6.0, 10.0] {
                    let corner = DrawnCorner { turn_rad: f64::to_radians(turn_deg), widths_m, kerb_radius_m };
                    let made = corner.corridors(LengthClass::Short).unwrap();
                    let (rings_m2, area_m2) = (ground_m2(&made), made.area.unsigned_area());
                    assert!((rings_m2 - area_m2).abs() < 0.05, "{corner:?}: {rings_m2} {area_m2}");
                    assert!((made.turn_rad.abs() - corner.turn_rad).abs() < 1e-9);
                }
            }
        }
    }

    #[test]
    fn what_cannot_be_drawn_is_no_corner() {
        for (turn_rad, width_m) in [(0.0, 4.0), (3.2, 4.0), (1.5, 0.0), (1.5, f64::NAN), (f64::NAN, 4.0)] {
            let corner = DrawnCorner { turn_rad, widths_m: [4.0, width_m], kerb_radius_m: 5.0 };
            assert_eq!(corner.corridors(LengthClass::Short).err(), Some(UnknownReason::Geometry), "{corner:?}");
        }
    }
}
