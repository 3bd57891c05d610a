//! Prepares a line in tile units for drawing: clips it to the tile and its buffer, drops vertices that nobody would see, and
//! rounds to whole units.

use geo::{BooleanOps as _, BoundingRect as _, LineString, MultiPolygon, Polygon, Rect};

use super::grid::{BUFFER, EXTENT};

type Point = [f64; 2];

/// The greatest distance of the drawn line from the true line, units. Two units are a quarter of a pixel of a tile of 512
/// pixels.
pub(super) const TOLERANCE: f64 = 2.0;
/// Vertices that are simplified together.
const TOGETHER: usize = 4096;
/// The tolerance at the deepest zoom, which clients enlarge. Rounding alone moves points by as much.
pub(super) const FINE_TOLERANCE: f64 = 0.5;

/// The drawn parts of a line within the tile and its buffer, at most `tolerance` units from it before they are rounded. Each part has at
/// least two different points.
pub(super) fn drawn(line: &[Point], tolerance: f64) -> Vec<Vec<[i32; 2]>> {
    clipped(line).into_iter().map(|part| rounded(&simplified(&part, tolerance))).filter(|part| part.len() > 1).collect()
}

/// The drawn parts of polygons within the tile and its buffer, as open rings: outer rings clockwise on the screen, each followed by
/// its holes, which run the other way. Rings that rounding leaves without an area are left out.
pub(super) fn drawn_polygons(polygons: &MultiPolygon) -> Vec<Vec<[i32; 2]>> {
    let (low, high) = (-BUFFER, EXTENT + BUFFER);
    let tile = Rect::new((low, low), (high, high)).to_polygon();
    let within = match polygons.bounding_rect() {
        Some(around)
            if around.min().x >= low && around.min().y >= low && around.max().x <= high && around.max().y <= high =>
        {
            polygons.clone()
        }
        _ => polygons.intersection(&tile),
    };
    let ring = |ring: &LineString, clockwise: bool| {
        let points: Vec<Point> = ring.coords().map(|c| [c.x, c.y]).collect();
        let mut ring = rounded(&points);
        if ring.first() == ring.last() {
            ring.pop();
        }
        let doubled = doubled_area(&ring);
        // The y axis points down, so rings with a positive area run clockwise.
        if (doubled > 0) != clockwise {
            ring.reverse();
        }
        (doubled != 0).then_some(ring)
    };
    let of = |polygon: &Polygon| {
        let outer = ring(polygon.exterior(), true)?;
        Some(
            std::iter::once(outer)
                .chain(polygon.interiors().iter().filter_map(|hole| ring(hole, false)))
                .collect::<Vec<_>>(),
        )
    };
    within.iter().filter_map(of).flatten().collect()
}

fn doubled_area(ring: &[[i32; 2]]) -> i64 {
    let cross = |a: [i32; 2], b: [i32; 2]| i64::from(a[0]) * i64::from(b[1]) - i64::from(b[0]) * i64::from(a[1]);
    ring.iter().zip(ring.iter().cycle().skip(1)).map(|(&a, &b)| cross(a, b)).sum()
}

/// The parts of a line within the tile and its buffer.
pub(super) fn clipped(line: &[Point]) -> Vec<Vec<Point>> {
    let mut parts: Vec<Vec<Point>> = Vec::new();
    let mut open = false;
    for pair in line.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        let Some((from, to)) = inside(a, b) else {
            open = false;
            continue;
        };
        let start = between(a, b, from);
        match parts.last_mut().filter(|_| open && from == 0.0) {
            Some(part) => part.push(between(a, b, to)),
            None => parts.push(vec![start, between(a, b, to)]),
        }
        open = to == 1.0;
    }
    parts
}

fn between(a: Point, b: Point, share: f64) -> Point {
    if share == 1.0 { b } else { [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])] }
}

/// The shares of a segment's length at which it enters and leaves the tile and its buffer (Liang and Barsky, 1984). `None` if
/// the segment is outside.
fn inside(a: Point, b: Point) -> Option<(f64, f64)> {
    let (low, high) = (-BUFFER, EXTENT + BUFFER);
    let (mut from, mut to) = (0.0_f64, 1.0_f64);
    for axis in 0..2 {
        let d = b[axis] - a[axis];
        for (p, q) in [(-d, a[axis] - low), (d, high - a[axis])] {
            if p == 0.0 && q < 0.0 {
                return None;
            }
            if p < 0.0 {
                from = from.max(q / p);
            } else if p > 0.0 {
                to = to.min(q / p);
            }
        }
    }
    (from <= to).then_some((from, to))
}

/// Simplifies a line by the algorithm of Douglas and Peucker, with the distance to the segment. The ends stay.
pub(super) fn simplified(line: &[Point], tolerance: f64) -> Vec<Point> {
    let Some(last) = line.len().checked_sub(1) else { return Vec::new() };
    let mut keep = vec![false; line.len()];
    keep[0] = true;
    keep[last] = true;
    // The time for a span grows with its square at worst, so long lines are simplified part by part.
    let mut spans: Vec<(usize, usize)> =
        (0..last).step_by(TOGETHER).map(|from| (from, last.min(from + TOGETHER))).collect();
    spans.iter().for_each(|span| keep[span.1] = true);
    while let Some((from, to)) = spans.pop() {
        let far = (from + 1..to)
            .map(|i| (i, squared(line[i], line[from], line[to])))
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .filter(|far| far.1 > tolerance * tolerance);
        if let Some((middle, _)) = far {
            keep[middle] = true;
            spans.extend([(from, middle), (middle, to)]);
        }
    }
    line.iter().zip(keep).filter(|(_, keep)| *keep).map(|(&point, _)| point).collect()
}

/// The squared distance of a point from a segment.
fn squared(p: Point, a: Point, b: Point) -> f64 {
    let (u, v) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let squared = u[0] * u[0] + u[1] * u[1];
    let along = if squared > 0.0 { ((u[0] * v[0] + u[1] * v[1]) / squared).clamp(0.0, 1.0) } else { 0.0 };
    (v[0] - along * u[0]).powi(2) + (v[1] - along * u[1]).powi(2)
}

fn rounded(line: &[Point]) -> Vec<[i32; 2]> {
    // The line is clipped, so its coordinates fit into 16 bits.
    let mut points: Vec<[i32; 2]> = line.iter().map(|p| p.map(|c| c.round() as i32)).collect();
    points.dedup();
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn distance(p: Point, a: Point, b: Point) -> f64 {
        squared(p, a, b).sqrt()
    }

    #[test]
    fn a_line_that_leaves_and_comes_back_is_two() {
        let (inner, outer) = (100.0, 9000.0);
        let parts = drawn(&[[inner, inner], [outer, inner], [outer, 2000.0], [inner, 2000.0]], TOLERANCE);
        let edge = (EXTENT + BUFFER) as i32;
        assert_eq!(parts, [vec![[100, 100], [edge, 100]], vec![[edge, 2000], [100, 2000]]]);
        assert!(drawn(&[[-500.0, 0.0], [-500.0, 4000.0]], TOLERANCE).is_empty());
        let across = drawn(&[[-5000.0, 50.0], [9000.0, 50.0]], TOLERANCE);
        assert_eq!(across, [vec![[-64, 50], [edge, 50]]]);
    }

    #[test]
    fn a_polygon_across_the_edge_is_cut_and_runs_clockwise_with_its_hole_the_other_way() {
        let square =
            |from: f64, to: f64| LineString::from(vec![(from, from), (from, to), (to, to), (to, from), (from, from)]);
        let polygon = Polygon::new(square(4000.0, 5000.0), vec![square(4050.0, 4100.0)]);
        let rings = drawn_polygons(&polygon.into());
        let edge = (EXTENT + BUFFER) as i32;
        let areas: Vec<i64> = rings.iter().map(|ring| doubled_area(ring)).collect();
        assert_eq!(areas, [2 * i64::from(edge - 4000).pow(2), -2 * 50 * 50]);
        let inside = Polygon::new(square(10.0, 20.0), vec![square(12.0, 12.3)]);
        assert_eq!(drawn_polygons(&inside.into()).len(), 1, "the hole is less than a unit");
        assert!(drawn_polygons(&Polygon::new(square(5000.0, 6000.0), vec![]).into()).is_empty());
    }

    proptest! {
        #[test]
        fn what_is_drawn_is_inside_and_near_the_line(
            line in prop::collection::vec((-6000.0..10_000.0_f64, -6000.0..10_000.0_f64), 2..30), fine: bool
        ) {
            let line: Vec<Point> = line.into_iter().map(|(x, y)| [x, y]).collect();
            let tolerance = if fine { FINE_TOLERANCE } else { TOLERANCE };
            let most = tolerance + 0.71;
            for part in drawn(&line, tolerance) {
                prop_assert!(part.len() > 1);
                for p in part {
                    prop_assert!(p.iter().all(|&c| (-64..=4160).contains(&c)));
                    let p = p.map(f64::from);
                    let near = line.windows(2).map(|s| distance(p, s[0], s[1])).fold(f64::INFINITY, f64::min);
                    prop_assert!(near <= most, "{near}");
                }
            }
        }

        #[test]
        fn no_vertex_within_the_tile_is_further_from_what_is_drawn_than_the_tolerance(
            line in prop::collection::vec((0.0..4000.0_f64, 0.0..4000.0_f64), 2..30)
        ) {
            let line: Vec<Point> = line.into_iter().map(|(x, y)| [x, y]).collect();
            let parts = drawn(&line, TOLERANCE);
            for &vertex in &line {
                let near = parts.iter().flat_map(|part| part.windows(2))
                    .map(|s| distance(vertex, s[0].map(f64::from), s[1].map(f64::from))).fold(f64::INFINITY, f64::min);
                prop_assert!(near <= TOLERANCE + 0.71 || parts.is_empty(), "{near}");
            }
        }
    }
}
