//! Convex hulls, and the shortest way from one to a segment.

use crate::vector::Point;

pub(crate) type Segment = [Point; 2];

/// The least and the greatest coordinates of some points.
pub(crate) fn bounds(points: &[Point]) -> [Point; 2] {
    points.iter().fold([[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]], |[low, high], p| {
        [[low[0].min(p[0]), low[1].min(p[1])], [high[0].max(p[0]), high[1].max(p[1])]]
    })
}

/// Twice the area of a triangle, positive if it is traversed to the left.
fn turn(a: Point, b: Point, c: Point) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// The vertices of the convex hull of some points, to the left (Andrew's monotone chain).
pub(crate) fn hull(points: &[Point]) -> Vec<Point> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    sorted.dedup();
    if sorted.len() < 3 {
        return sorted;
    }
    let chain = |points: &mut dyn Iterator<Item = Point>| {
        let mut chain: Vec<Point> = Vec::new();
        for p in points {
            while chain.len() >= 2 && turn(chain[chain.len() - 2], chain[chain.len() - 1], p) <= 0.0 {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut hull = chain(&mut sorted.iter().copied());
    hull.extend(chain(&mut sorted.iter().rev().copied()));
    hull
}

/// The shortest way from a convex polygon to a segment. A polygon of one or two vertices is a point or a segment.
pub(crate) fn way(hull: &[Point], segment: Segment) -> Point {
    let edges = || (0..hull.len()).map(|i| [hull[i], hull[(i + 1) % hull.len()]]);
    if hull.len() > 2 && edges().all(|[a, b]| turn(a, b, segment[0]) >= 0.0) {
        return [0.0; 2];
    }
    edges().map(|edge| apart(edge, segment)).fold([f64::INFINITY; 2], shorter)
}

fn shorter(x: Point, y: Point) -> Point {
    if y[0] * y[0] + y[1] * y[1] < x[0] * x[0] + x[1] * x[1] { y } else { x }
}

/// The shortest way from a segment to another.
fn apart([a, b]: Segment, [c, d]: Segment) -> Point {
    let crossed = turn(a, b, c) * turn(a, b, d) < 0.0 && turn(c, d, a) * turn(c, d, b) < 0.0;
    if crossed {
        return [0.0; 2];
    }
    let back = |p: Point| to_segment(p, [a, b]).map(|x| -x);
    [to_segment(b, [c, d]), back(c), back(d)].into_iter().fold(to_segment(a, [c, d]), shorter)
}

/// The shortest way from a place to a segment.
pub(crate) fn to_segment(p: Point, [a, b]: Segment) -> Point {
    let (way, from) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let square = way[0] * way[0] + way[1] * way[1];
    let share = if square > 0.0 { ((from[0] * way[0] + from[1] * way[1]) / square).clamp(0.0, 1.0) } else { 0.0 };
    [share * way[0] - from[0], share * way[1] - from[1]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vector::length;

    fn clearance(hull: &[Point], segment: Segment) -> f64 {
        length(way(hull, segment))
    }

    #[test]
    fn distances_of_hulls_are_exact() {
        let square = hull(&[[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0], [1.0, 1.0], [1.0, 0.0]]);
        assert_eq!(square.len(), 4);
        for (segment, expected) in [
            ([[3.0, -5.0], [3.0, 5.0]], 1.0),
            ([[3.0, 3.0], [3.0, 5.0]], f64::sqrt(2.0)),
            ([[1.0, 1.0], [1.5, 1.0]], 0.0),
            ([[-1.0, 1.0], [5.0, 1.0]], 0.0),
            ([[4.0, 0.0], [0.0, 4.0]], 0.0),
            ([[5.0, 0.0], [0.0, 5.0]], 0.5 * f64::sqrt(2.0)),
        ] {
            assert!((clearance(&square, segment) - expected).abs() < 1e-12, "{segment:?}");
        }
        let line = hull(&[[0.0, 0.0], [2.0, 0.0], [1.0, 0.0]]);
        assert!((clearance(&line, [[1.0, 1.0], [9.0, 1.0]]) - 1.0).abs() < 1e-12);
        assert!((clearance(&hull(&[[0.0; 2]; 3]), [[3.0, 4.0], [3.0, 9.0]]) - 5.0).abs() < 1e-12);
    }
}
