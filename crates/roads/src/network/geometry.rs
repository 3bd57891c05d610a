//! Lengths and headings of edges on a sphere, locally flat. They are accurate enough to choose the straight
//! continuation. Certificates use the metric frame of `corridor`.

use rayon::prelude::*;

use super::{Edge, EdgeNo, Network};
use crate::osm::LonLat;

/// Mean radius of the earth (IUGG), metres. Lengths are accurate to 0.6 %.
pub const EARTH_RADIUS_M: f64 = 6_371_008.8;

/// Geometry of every edge, for choosing continuations.
pub(super) struct EdgeGeometries {
    /// Length, metres.
    pub(super) length_m: Vec<f32>,
    /// Outward directions of the edge at its first and at its last node, in degrees from east towards north.
    pub(super) outward_deg: Vec<[f32; 2]>,
}

impl EdgeGeometries {
    /// Measures all edges. A heading is that of the chord over the first `reach_m` metres of an edge.
    pub(super) fn measure(network: &Network, reach_m: f64) -> Self {
        let (length_m, outward_deg) = network
            .edges
            .par_iter()
            .map(|edge| {
                let length_m = length_m(network.positions(edge));
                // The chord over the whole of a loop has no length.
                let reach_m = if edge.from_node == edge.to_node { reach_m.min(length_m / 2.0) } else { reach_m };
                let ahead = chord_deg(network.positions(edge), reach_m);
                let back = chord_deg(network.positions(edge).rev(), reach_m);
                (length_m as f32, [ahead as f32, back as f32])
            })
            .unzip();
        Self { length_m, outward_deg }
    }

    /// Turn of a vehicle from edge `a` into edge `b`, degrees, 0..=180.
    pub(super) fn deflection_deg(&self, a: EdgeNo, b: EdgeNo) -> f64 {
        deflection_deg(f64::from(self.outward_deg[a.index()][1]), f64::from(self.outward_deg[b.index()][0]))
    }
}

impl Network {
    /// Length of an edge, metres, accurate to 0.6 %. It serves to choose among roads, not for certificates.
    #[must_use]
    pub fn length_m(&self, edge: &Edge) -> f64 {
        length_m(self.positions(edge))
    }

    /// Turn of a vehicle from the end of edge `a` to the start of edge `b`, degrees, 0..=180. Directions are those of chords of
    /// `reach_m` metres, at least one segment.
    pub(super) fn deflection_over_deg(&self, a: &Edge, b: &Edge, reach_m: f64) -> f64 {
        deflection_deg(chord_deg(self.positions(a).rev(), reach_m), chord_deg(self.positions(b), reach_m))
    }
}

/// Deflection between two directions that leave a node: 0 for opposite directions.
pub(super) fn deflection_deg(back: f64, ahead: f64) -> f64 {
    let between = (back - ahead).abs() % 360.0;
    180.0 - between.min(360.0 - between)
}

/// Length of a line, metres, accurate to 0.6 %.
pub fn length_m(positions: impl Iterator<Item = LonLat>) -> f64 {
    let mut last = None;
    let mut sum = 0.0;
    for position in positions {
        if let Some(last) = last.replace(position) {
            let [x, y] = offset_m(last, position);
            sum += x.hypot(y);
        }
    }
    sum
}

/// Mean radius of a line, metres: its length divided by the angle through which it turns. `None` if it does not turn.
pub(super) fn mean_radius_m(positions: impl Iterator<Item = LonLat>) -> Option<f64> {
    let (mut last, mut chord) = (None::<LonLat>, None::<[f64; 2]>);
    let (mut turned_rad, mut along_m) = (0.0, 0.0);
    for position in positions {
        let Some(before) = last.replace(position) else { continue };
        let next = offset_m(before, position);
        if let Some([x, y]) = chord.replace(next) {
            turned_rad += (x * next[1] - y * next[0]).atan2(x * next[0] + y * next[1]);
            along_m += 0.5 * (x.hypot(y) + next[0].hypot(next[1]));
        }
    }
    let radius_m = along_m / turned_rad.abs();
    radius_m.is_finite().then_some(radius_m)
}

/// Direction of the chord from the first position to the point `reach_m` along the line. The chord spans at least one
/// segment and at most the whole line.
pub(super) fn chord_deg(mut positions: impl Iterator<Item = LonLat>, reach_m: f64) -> f64 {
    let Some(mut last) = positions.next() else { return 0.0 };
    let mut chord = [0.0_f64; 2];
    let mut left_m = reach_m;
    for position in positions {
        let [x, y] = offset_m(last, position);
        let length_m = x.hypot(y);
        let share = if chord == [0.0, 0.0] && left_m <= 0.0 { 1.0 } else { (left_m / length_m).min(1.0) };
        chord = [chord[0] + share * x, chord[1] + share * y];
        left_m -= length_m;
        last = position;
        if left_m <= 0.0 {
            break;
        }
    }
    chord[1].atan2(chord[0]).to_degrees()
}

/// Metres east and north from `a` to `b`, by the short way across the date line.
pub fn offset_m(a: LonLat, b: LonLat) -> [f64; 2] {
    const TURN_E7: i64 = 3_600_000_000;
    let mut lon_e7 = i64::from(b.lon_e7) - i64::from(a.lon_e7);
    if lon_e7.abs() > TURN_E7 / 2 {
        lon_e7 -= lon_e7.signum() * TURN_E7;
    }
    let (lat_a, lat_b) = (a.degrees().1.to_radians(), b.degrees().1.to_radians());
    let lon = (lon_e7 as f64 * 1e-7).to_radians();
    [EARTH_RADIUS_M * lon * f64::midpoint(lat_a, lat_b).cos(), EARTH_RADIUS_M * (lat_b - lat_a)]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(lon: f64, lat: f64) -> LonLat {
        LonLat { lon_e7: (lon * 1e7).round() as i32, lat_e7: (lat * 1e7).round() as i32 }
    }

    #[test]
    fn a_ring_and_a_part_of_it_have_its_radius() {
        let on_ring = |i: i32| {
            let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / 24.0).sin_cos();
            let degree_m = EARTH_RADIUS_M.to_radians();
            at(8.7 + 15.0 * cos / degree_m / 49.4_f64.to_radians().cos(), 49.4 + 15.0 * sin / degree_m)
        };
        for to in [24, 5] {
            let radius_m = mean_radius_m((0..=to).map(on_ring));
            assert!(radius_m.is_some_and(|radius_m| (radius_m - 15.0).abs() < 0.1), "{radius_m:?}");
        }
        assert_eq!(mean_radius_m((0..2).map(on_ring)), None);
    }

    #[test]
    fn a_degree_has_its_length_also_across_the_date_line() {
        let degree_m = EARTH_RADIUS_M.to_radians();
        let across = length_m([at(179.5, 60.0), at(-179.5, 60.0)].into_iter());
        assert!((across - degree_m / 2.0).abs() < 1e-3, "{across}");
        let north = length_m([at(0.0, -0.5), at(0.0, 0.5)].into_iter());
        assert!((north - degree_m).abs() < 1e-6, "{north}");
    }

    #[test]
    fn a_heading_looks_past_a_tiny_first_segment() {
        // One metre north, then a hundred metres east.
        let line = [at(0.0, 0.0), at(0.0, 0.000_009), at(0.000_9, 0.000_009)];
        assert!((chord_deg(line.into_iter(), 0.0) - 90.0).abs() < 1e-9);
        let far = chord_deg(line.into_iter(), 15.0);
        assert!((3.0..6.0).contains(&far), "{far}");
    }

    #[test]
    fn straight_on_is_no_deflection_and_back_is_all() {
        assert!(deflection_deg(180.0, 0.0).abs() < 1e-12);
        assert!(deflection_deg(-170.0, 10.0).abs() < 1e-12);
        assert!((deflection_deg(30.0, 30.0) - 180.0).abs() < 1e-12);
        assert!((deflection_deg(-175.0, 95.0) - 90.0).abs() < 1e-12);
    }
}
