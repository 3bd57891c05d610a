//! A drawn roundabout: a ring of 24 points with four arms at right angles.

use netcert::osm::facts::TrafficSide;

use crate::ascii_map::AsciiMap;

/// The ring's nodes. Its way begins and ends at the first one.
pub const RING: &str = "abcdefghijklmnopqrstuvwx";

/// The end of each arm, and its node on the ring.
const ARMS: [(char, char); 4] = [('W', 'a'), ('S', 'g'), ('E', 'm'), ('N', 's')];

/// A map whose ring is way 1, followed by the arms. The ring runs counter-clockwise from the west, or clockwise for
/// left-hand traffic, where N is in the south.
pub fn map(radius_m: f64, ring: &str, arm: &str, side: TrafficSide) -> AsciiMap {
    let mirror = if side == TrafficSide::Left { -1.0 } else { 1.0 };
    let at = |turn: f64, m: f64| {
        let (sin, cos) = (std::f64::consts::PI + turn * std::f64::consts::TAU).sin_cos();
        [m * cos, m * sin * mirror]
    };
    let mut nodes: Vec<_> = RING.chars().zip(0..).map(|(c, i)| (c, at(f64::from(i) / 24.0, radius_m))).collect();
    nodes.extend(ARMS.into_iter().zip(0..).map(|((c, _), i)| (c, at(f64::from(i) / 4.0, radius_m + 150.0))));
    let mut map = AsciiMap::placed(&nodes).way(&format!("{RING}a"), &format!("junction=roundabout {ring}"));
    for (end, node) in ARMS {
        map = map.way(&format!("{end}{node}"), arm);
    }
    map
}
