//! Areas: where a junction is wider than a corridor, bodies are held against the junction's area instead.

use std::ops::Range;
use std::sync::Arc;

/// A part of the plane: what lies inside an odd number of rings. The last vertex of a ring joins the first. Positions are
/// metres in the corridor's frame.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PlaneArea {
    /// The boundary.
    pub rings: Vec<Vec<[f64; 2]>>,
}

/// Stations of the steer axle over which bodies are held against an area instead of the corridor's half-widths.
///
/// The area counts between the first and the last of these stations. Where several spans of a corridor count, a body may be
/// in any of their areas, and the one that leaves it the most room decides.
#[derive(Debug, Clone, PartialEq)]
pub struct AreaSpan {
    /// Stations of the steer axle; at least two.
    pub heads: Range<usize>,
    /// The area. All of the vehicle is inside, from its front to its rear, while the steer axle is at these stations.
    pub area: Arc<PlaneArea>,
}

impl PlaneArea {
    /// The boundary's segments.
    pub fn segments(&self) -> impl Iterator<Item = [[f64; 2]; 2]> {
        self.rings.iter().flat_map(|ring| (0..ring.len()).map(|i| [ring[i], ring[(i + 1) % ring.len()]]))
    }

    /// The place of the boundary that is nearest to `p`. `None` without a boundary.
    #[must_use]
    pub fn nearest(&self, p: [f64; 2]) -> Option<[f64; 2]> {
        let on = |[a, b]: [[f64; 2]; 2]| {
            let (along, from) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
            let square = along[0] * along[0] + along[1] * along[1];
            let share = ((along[0] * from[0] + along[1] * from[1]) / square.max(1e-18)).clamp(0.0, 1.0);
            [a[0] + share * along[0], a[1] + share * along[1]]
        };
        let far = |q: &[f64; 2]| (q[0] - p[0]).powi(2) + (q[1] - p[1]).powi(2);
        self.segments().map(on).min_by(|a, b| far(a).total_cmp(&far(b)))
    }

    /// Whether a place lies inside. Places on the boundary may count either way.
    #[must_use]
    pub fn contains(&self, [x, y]: [f64; 2]) -> bool {
        let crossed =
            |[a, b]: [[f64; 2]; 2]| (a[1] > y) != (b[1] > y) && x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
        self.segments().filter(|segment| crossed(*segment)).count() % 2 == 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_in_a_hole_is_outside() {
        let square = |half: f64| vec![[-half, -half], [half, -half], [half, half], [-half, half]];
        let area = PlaneArea { rings: vec![square(5.0), square(1.0)] };
        assert!(area.contains([3.0, 0.5]));
        assert!(!area.contains([0.3, 0.2]));
        assert!(!area.contains([7.0, 0.0]));
        assert_eq!(area.segments().count(), 8);
        assert_eq!(area.nearest([2.5, 0.5]), Some([1.0, 0.5]));
        assert_eq!(PlaneArea::default().nearest([3.0, 0.5]), None);
    }
}
