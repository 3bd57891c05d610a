//! Joins edges of one name into lines that are long enough for a label. A single edge between two junctions is usually
//! too short.
//!
//! The two directions of a road give one line. The order of the lines depends on the rows alone. A line ends at a sharp
//! bend, because no label follows one.

use std::collections::BTreeMap;

use crate::osm::LonLat;
use crate::rows::MapEdge;

/// Names are shown from this zoom on.
pub(super) const FIRST_WITH_LABELS: u8 = 11;
/// The cosine of 60°, the sharpest bend between two edges of a line. MapLibre bends text by 45° at most.
const LEAST_COSINE: f64 = 0.5;

/// A line with the road whose name it shows.
pub(super) struct Label<'r> {
    /// The first edge of the line, which has the name.
    pub(super) edge: &'r MapEdge<'r>,
    pub(super) line: Vec<LonLat>,
}

type Name<'r> = (&'r str, Option<&'r str>, Option<&'r str>);
type Ends = BTreeMap<(i32, i32), Vec<usize>>;

/// The labels of the rows at zoom `z`. Rows of one class, name and ref are joined.
pub(super) fn labels<'r>(rows: &'r [MapEdge<'r>], z: u8) -> Vec<Label<'r>> {
    let mut roads: BTreeMap<Name<'r>, Vec<&'r MapEdge<'r>>> = BTreeMap::new();
    for row in rows.iter().filter(|row| row.line.len() > 1 && is_named(row, z)) {
        roads
            .entry((&row.road.highway, row.road.name.as_deref(), row.road.reference.as_deref()))
            .or_default()
            .push(row);
    }
    roads.into_values().flat_map(|mut edges| joined(&mut edges)).collect()
}

/// Whether the row's name is shown at zoom `z`. As on general maps, names of main roads appear first.
fn is_named(row: &MapEdge<'_>, z: u8) -> bool {
    let first = match row.road.highway.trim_end_matches("_link") {
        "motorway" | "trunk" | "primary" => FIRST_WITH_LABELS,
        "secondary" => 12,
        "tertiary" => 13,
        _ => 14,
    };
    z >= first && (row.road.name.is_some() || row.road.reference.is_some())
}

fn joined<'r>(edges: &mut Vec<&'r MapEdge<'r>>) -> Vec<Label<'r>> {
    // The two directions of a road are the same line, so one of them is dropped.
    let mut seen = std::collections::BTreeSet::new();
    edges.retain(|edge| {
        let (a, b) = (key(edge.line.first()), key(edge.line.last()));
        seen.insert((edge.edge.way_id, a.min(b), a.max(b), edge.line.len()))
    });
    let mut ends: Ends = BTreeMap::new();
    for (i, edge) in edges.iter().enumerate() {
        ends.entry(key(edge.line.first())).or_default().push(i);
        ends.entry(key(edge.line.last())).or_default().push(i);
    }
    let mut used = vec![false; edges.len()];
    let mut labels = Vec::new();
    for (i, &edge) in edges.iter().enumerate() {
        if std::mem::replace(&mut used[i], true) {
            continue;
        }
        let mut line = edge.line.clone();
        for _ in 0..2 {
            while let Some((next, more)) = onward(&line, edges, &mut ends, &used) {
                used[next] = true;
                line.extend(more.into_iter().skip(1));
            }
            line.reverse();
        }
        labels.push(Label { edge, line });
    }
    labels
}

/// The unused edge that continues the line most nearly straight, with its positions in the line's direction. Used ones are taken out of
/// `ends`, so that they are not looked at again.
fn onward(line: &[LonLat], edges: &[&MapEdge<'_>], ends: &mut Ends, used: &[bool]) -> Option<(usize, Vec<LonLat>)> {
    let [.., before, end] = line else { return None };
    let mut best: Option<(f64, usize)> = None;
    let free = ends.get_mut(&key(Some(end)))?;
    free.retain(|&i| !used[i]);
    for &i in free.iter() {
        let (start, then) = match edges[i].line.as_slice() {
            [start, then, ..] if start == end => (start, then),
            [.., then, start] => (start, then),
            _ => continue,
        };
        let cosine = cosine(direction(before, end), direction(start, then));
        if cosine >= best.map_or(LEAST_COSINE, |best| best.0) {
            best = Some((cosine, i));
        }
    }
    let (_, i) = best?;
    let mut more = edges[i].line.clone();
    if more.first() != Some(end) {
        more.reverse();
    }
    Some((i, more))
}

fn key(position: Option<&LonLat>) -> (i32, i32) {
    position.map_or((0, 0), |p| (p.lon_e7, p.lat_e7))
}

/// The vector between two positions, east and north, in the same scale.
fn direction(from: &LonLat, to: &LonLat) -> [f64; 2] {
    let ((lon, lat), (lon_to, lat_to)) = (from.degrees(), to.degrees());
    [(lon_to - lon) * lat.to_radians().cos(), lat_to - lat]
}

fn cosine([ax, ay]: [f64; 2], [bx, by]: [f64; 2]) -> f64 {
    let size = ax.hypot(ay) * bx.hypot(by);
    if size > 0.0 { (ax * bx + ay * by) / size } else { -1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::EdgeNo;
    use crate::osm::NodeId;
    use crate::osm::facts::{Direction, Oneway};
    use crate::rows::{EdgeKey, MapNumbers, RoadName};
    use crate::verdict::{UnknownReason, Verdict};

    fn edge_key(index: u32, way_id: i64) -> EdgeKey {
        let (from_node, to_node, direction) = (NodeId::new(0), NodeId::new(1), Direction::Forward);
        EdgeKey { index: EdgeNo::new(index), id: i64::from(index), way_id, from_node, to_node, direction }
    }

    fn edge(number: u32, name: &str, points: &[(i32, i32)]) -> MapEdge<'static> {
        MapEdge {
            edge: edge_key(number, 1),
            oneway: Oneway::No,
            road: RoadName { highway: "primary".into(), name: Some(name.to_owned().into()), reference: None },
            numbers: MapNumbers {
                length_m: 1.0,
                width_m: None,
                width_source: None,
                verdict: Verdict::Unknown(UnknownReason::Width),
                rsc_mm: None,
                need_width_m: None,
                shared: false,
                uses: None,
            },
            line: points.iter().map(|&(lon_e7, lat_e7)| LonLat { lon_e7, lat_e7 }).collect(),
        }
    }

    fn lines(rows: &[MapEdge<'_>]) -> Vec<Vec<i32>> {
        labels(rows, 14).into_iter().map(|label| label.line.iter().map(|p| p.lon_e7).collect()).collect()
    }

    #[test]
    fn both_directions_of_a_road_in_pieces_are_one_line() {
        let a = edge(0, "High Street", &[(0, 0), (100, 0)]);
        let b = edge(1, "High Street", &[(100, 0), (0, 0)]);
        let c = edge(2, "High Street", &[(200, 0), (100, 0)]);
        let d = edge(3, "High Street", &[(200, 0), (300, 10)]);
        assert_eq!(
            lines(&[a, b, c, d]),
            [vec![300, 200, 100, 0]].map(|mut line| {
                line.reverse();
                line
            })
        );
    }

    #[test]
    fn a_corner_or_another_name_ends_a_line() {
        let a = edge(0, "High Street", &[(0, 0), (100, 0)]);
        let corner = edge(1, "High Street", &[(100, 0), (100, 100)]);
        let other = edge(2, "Low Street", &[(100, 0), (200, 0)]);
        assert_eq!(lines(&[a, corner, other]), [vec![0, 100], vec![100, 100], vec![100, 200]]);
    }

    #[test]
    fn a_ring_ends() {
        let points = [(0, 0), (100, 0), (170, 70), (170, 170), (100, 240), (0, 240), (-70, 170), (-70, 70), (0, 0)];
        let ring: Vec<MapEdge<'_>> = (0..8_u32).map(|i| edge(i, "Ring", &points[i as usize..i as usize + 2])).collect();
        assert_eq!(lines(&ring).len(), 1);
        assert!(labels(&ring, 10).is_empty());
    }

    /// Copies of all lines at the node for each line would be 10^10 positions.
    #[test]
    fn many_long_roads_of_one_name_at_a_place_take_no_copies() {
        // All have other ends and other directions, and no two are straight.
        let spoke = |i: i32| -> Vec<(i32, i32)> {
            (0..2_000).map(|k| (k * (1 + i % 60) + k.min(1) * i, k * (1 + i / 60) + k.min(1) * i)).collect()
        };
        let rows: Vec<MapEdge<'_>> = (0..3_000_u32)
            .map(|i| MapEdge { edge: edge_key(i, i64::from(i)), ..edge(i, "High Street", &spoke(i as i32)) })
            .collect();
        let positions: usize = labels(&rows, 14).iter().map(|label| label.line.len()).sum();
        assert!(positions >= 3_000 * 1_999, "{positions}");
    }
}
