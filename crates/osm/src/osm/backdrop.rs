//! Things behind the roads as shapes. The ways of multipolygons are joined into rings, and vertices that nobody would see are left out.

use geo::{BoundingRect as _, Contains as _, Coord, LineString, Point, Polygon, SimplifyIdx as _};
use rstar::RTree;
use rstar::primitives::{GeomWithData, Rectangle};
use rustc_hash::FxHashMap;
use serde::{Deserialize, Serialize};

use super::changes::ObjectKind;
use super::facts::BackdropKind;
use crate::osm::{LonLat, NodeId};

/// A thing behind the roads.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Backdrop {
    /// What it is.
    pub kind: BackdropKind,
    /// The object in OpenStreetMap.
    pub object: (ObjectKind, i64),
    /// Its name, if it has one.
    pub name: Option<Box<str>>,
    /// Where it is.
    pub shape: BackdropShape,
}

/// The shape of a thing behind the roads, within two metres of the map.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum BackdropShape {
    /// Polygons, each with its outer ring first. Rings are closed.
    Areas(Vec<Vec<Vec<LonLat>>>),
    /// Lines of at least two positions.
    Lines(Vec<Vec<LonLat>>),
    /// A position.
    Place(LonLat),
}

/// The greatest distance of a shape from the map's, metres.
const TOLERANCE_M: f64 = 2.0;
/// Areas that are smaller in both directions are left out, metres: four pixels at the deepest zoom that shows them.
const LEAST_SIDE_M: f64 = 10.0;
/// The greatest number of a hole's vertices that are tried, to find the outline around the hole.
const MOST_VERTICES: usize = 16;
/// The greatest number of outlines around a vertex that are tried. Outlines do not overlap, and few boxes around them do.
const MOST_OUTLINES: usize = 64;
/// Vertices that are simplified together. The time for so many grows with their square.
const TOGETHER: usize = 500;
const METRES_PER_E7: f64 = 0.011_131_949;

/// The rings that ways form, end to end; `None` if some do not close. Ways are node ids.
pub(super) fn rings(ways: &[&[NodeId]]) -> Option<Vec<Vec<NodeId>>> {
    let mut at_end: FxHashMap<NodeId, Vec<usize>> = FxHashMap::default();
    for (number, way) in ways.iter().enumerate().filter(|(_, way)| way.first() != way.last()) {
        for end in [way.first(), way.last()].into_iter().flatten() {
            at_end.entry(*end).or_default().push(number);
        }
    }
    let mut rings = Vec::new();
    let mut used = vec![false; ways.len()];
    for (number, way) in ways.iter().enumerate() {
        if way.is_empty() || std::mem::replace(&mut used[number], true) {
            continue;
        }
        let mut chain = way.to_vec();
        while let (Some(first), Some(last)) = (chain.first(), chain.last())
            && first != last
        {
            let ends = at_end.get_mut(last)?;
            // Each end is looked at once, however many ways meet there.
            let next = loop {
                let next = ends.pop()?;
                if !std::mem::replace(&mut used[next], true) {
                    break next;
                }
            };
            let next = ways[next];
            if next.first() == Some(last) {
                chain.extend_from_slice(&next[1..]);
            } else {
                chain.extend(next.iter().rev().skip(1));
            }
        }
        if chain.len() < 4 || chain.first() != chain.last() {
            return None;
        }
        rings.push(chain);
    }
    Some(rings)
}

/// Polygons of outer rings and the holes within them. A hole in no outer ring is left out, and so is a polygon that is too small to be
/// seen.
pub(super) fn polygons(outer: Vec<Vec<LonLat>>, inner: &[Vec<LonLat>]) -> Vec<Vec<Vec<LonLat>>> {
    let plane = |ring: &Vec<LonLat>| Polygon::new(line_of(ring), Vec::new());
    let outlines: Vec<Polygon> = outer.iter().map(plane).collect();
    let around = |(at, outline): (usize, &Polygon)| {
        let around = outline.bounding_rect()?;
        Some(GeomWithData::new(Rectangle::from_corners(around.min().x_y(), around.max().x_y()), at))
    };
    let boxes = RTree::bulk_load(outlines.iter().enumerate().filter_map(around).collect());
    let mut polygons: Vec<Vec<Vec<LonLat>>> = outer.into_iter().map(|ring| vec![ring]).collect();
    for hole in inner {
        let inside = |&vertex: &LonLat| {
            let point = Point(coord(vertex));
            let near = boxes.locate_all_at_point(&point.x_y()).take(MOST_OUTLINES).map(|found| found.data);
            near.filter(|&at| outlines.get(at).is_some_and(|outline| outline.contains(&point))).min()
        };
        // A vertex on the outline tells nothing, so some are tried. Their number is bounded, and so is the time.
        let at = if outlines.len() == 1 { Some(0) } else { hole.iter().take(MOST_VERTICES).find_map(inside) };
        if let Some(polygon) = at.and_then(|at| polygons.get_mut(at)) {
            polygon.push(hole.clone());
        }
    }
    for polygon in &mut polygons {
        let mut first = true;
        polygon.iter_mut().for_each(|ring| *ring = simplified(ring));
        polygon.retain(|ring| std::mem::take(&mut first) || is_seen(ring));
    }
    polygons.retain(|polygon| polygon.first().is_some_and(|outer| is_seen(outer)));
    polygons
}

fn is_seen(ring: &[LonLat]) -> bool {
    let Some(first) = ring.first().filter(|_| ring.len() >= 4) else { return false };
    let scale = east_scale(*first);
    let span = |of: fn(&LonLat) -> i32| {
        let (low, high) = ring.iter().map(of).fold((i32::MAX, i32::MIN), |(low, high), at| (low.min(at), high.max(at)));
        (f64::from(high) - f64::from(low)) * METRES_PER_E7
    };
    (span(|p| p.lon_e7) * scale).max(span(|p| p.lat_e7)) >= LEAST_SIDE_M
}

/// The line without vertices that are closer than [`TOLERANCE_M`] to what is left.
pub(super) fn simplified(line: &[LonLat]) -> Vec<LonLat> {
    let Some(first) = line.first() else { return Vec::new() };
    let scale = east_scale(*first);
    let mut kept = vec![*first];
    let mut rest = line;
    while rest.len() > 1 {
        let (part, _) = rest.split_at(rest.len().min(TOGETHER));
        let plane: LineString =
            part.iter().map(|&p| Coord { x: f64::from(p.lon_e7) * scale, y: f64::from(p.lat_e7) }).collect();
        let seen = plane.simplify_idx(TOLERANCE_M / METRES_PER_E7);
        kept.extend(seen.into_iter().skip(1).filter_map(|at| part.get(at)));
        rest = rest.get(part.len() - 1..).unwrap_or_default();
    }
    kept
}

fn east_scale(at: LonLat) -> f64 {
    at.degrees().1.to_radians().cos()
}

fn coord(position: LonLat) -> Coord {
    Coord { x: f64::from(position.lon_e7), y: f64::from(position.lat_e7) }
}

fn line_of(ring: &[LonLat]) -> LineString {
    ring.iter().map(|&position| coord(position)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rings_of(ways: &[&[i64]]) -> Option<Vec<Vec<i64>>> {
        let ways: Vec<Vec<NodeId>> = ways.iter().map(|way| way.iter().copied().map(NodeId::new).collect()).collect();
        let found = rings(&ways.iter().map(Vec::as_slice).collect::<Vec<_>>())?;
        Some(found.iter().map(|ring| ring.iter().map(|node| node.get()).collect()).collect())
    }

    #[test]
    fn ways_form_rings_whatever_their_directions() {
        let found = rings_of(&[&[1, 2, 3], &[7, 8, 9, 7], &[1, 5, 4], &[3, 4]]);
        assert_eq!(found, Some(vec![vec![1, 2, 3, 4, 5, 1], vec![7, 8, 9, 7]]));
        assert_eq!(rings_of(&[&[7, 8, 9, 7], &[20, 21, 22]]), None);
        assert_eq!(rings_of(&[]), Some(vec![]));
    }

    #[test]
    fn a_hole_is_in_the_outline_around_it() {
        let square = |from: i32, to: i32| {
            [(from, from), (to, from), (to, to), (from, to), (from, from)]
                .map(|(lon_e7, lat_e7)| LonLat { lon_e7, lat_e7 })
                .to_vec()
        };
        let found = polygons(
            vec![square(0, 10_000), square(20_000, 40_000), square(50_000, 50_100)],
            &[square(25_000, 30_000), square(90_000, 99_000), square(26_000, 26_010)],
        );
        // The third outline is a metre wide, and so is the last hole; the second hole is nowhere.
        assert_eq!(found, [vec![square(0, 10_000)], vec![square(20_000, 40_000), square(25_000, 30_000)]]);
    }

    /// Each tooth is a little larger than the one before, so that every step of the algorithm finds its vertex at the end.
    #[test]
    fn so_many_teeth_and_so_many_ways_between_two_nodes_are_no_trap() {
        let saw = |k: i32| LonLat { lon_e7: 1000 * k, lat_e7: if k % 2 == 0 { 0 } else { 1000 + k } };
        let line: Vec<LonLat> = (0..200_000).map(saw).collect();
        assert_eq!(simplified(&line), line);
        let ways: Vec<[NodeId; 3]> = (0..200_000).map(|k| [1, 10 + k, 2].map(NodeId::new)).collect();
        let ways: Vec<&[NodeId]> = ways.iter().map(<[NodeId; 3]>::as_slice).collect();
        assert_eq!(rings(&ways).map(|rings| rings.len()), Some(100_000));
    }

    /// Outlines of which each one's box has each hole, and none the hole itself: 10^10 tests of sides.
    #[test]
    fn so_many_outlines_over_each_other_are_no_trap() {
        let ring = |corners: &[(i32, i32)]| -> Vec<LonLat> {
            corners.iter().map(|&(lon_e7, lat_e7)| LonLat { lon_e7, lat_e7 }).collect()
        };
        let corner = |k: i32| {
            let a = 1_000_000 + k;
            ring(&[(0, 0), (a, 0), (a, a), (a - 9, 9), (0, 0)])
        };
        let hole = |k: i32| {
            let (x, y) = (10_000 + k % 100, 900_000 - k);
            ring(&[(x, y), (x + 5_000, y), (x + 5_000, y + 5_000), (x, y + 5_000), (x, y)])
        };
        let outer: Vec<Vec<LonLat>> = (0..20_000).map(corner).collect();
        let inner: Vec<Vec<LonLat>> = (0..20_000).map(hole).collect();
        let found = polygons(outer, &inner);
        assert!(found.len() == 20_000 && found.iter().all(|polygon| polygon.len() == 1));
    }

    #[test]
    fn vertices_that_nobody_sees_are_left_out() {
        let line =
            [(0, 0), (10_000, 150), (20_000, 0), (30_000, 5_000)].map(|(lon_e7, lat_e7)| LonLat { lon_e7, lat_e7 });
        assert_eq!(simplified(&line), [line[0], line[2], line[3]]);
    }
}
