//! The drivable area of a turn as a set of polygons: approach and departure strips, the part that both roads share at
//! the junction, and the kerb return between them.
//!
//! No part is invented, except that two parts of one road join without a gap. Beyond the node a road counts only where
//! traffic really drives on it (its stroke continues), or where the other road crosses it. A turn to the near side (right, for right-hand traffic) gets what the lanes of the
//! two *directions* share. A turn across the oncoming traffic gets what the carriageways share. If the junction's
//! surface is mapped, the corner is the mapped surface outside both roads, and no kerb return is assumed. What the other
//! roads of the junction add inside the crossing is made in `crossing`.

use geo::orient::{Direction, Orient};
use geo::{Area as _, BooleanOps, Euclidean, Length, LineString, MultiPolygon, Polygon, Simplify, unary_union};

use super::LengthClass;
use super::arm::{Arm, RoadEdges};
use super::vector::{add, along, unit};
use crate::corridor::{PlaneArea, outline};
use crate::osm::facts::Policy;

/// Distance from the node within which the roads' shared part is searched, metres.
pub(super) const CROSSING_M: f64 = 30.0;
/// Vertices of the whole area this close to the line between their neighbours are removed, metres.
const STRAIGHT_M: f64 = 1e-5;
/// Straight road beyond a road's end that planned paths may use, and its overlap with the road, metres.
const BEYOND_M: f64 = 70.0;
const OVERLAP_ROAD_M: f64 = 12.0;
/// How far the parts of a road that changes its width are prolonged over their joint, metres; and the greatest angle between them,
/// radians. Within it they would be one stroke if they were equally wide.
const JOINT_M: f64 = 2.0;
const JOINT_RAD: f64 = 0.79;
/// Overlap of the kerb return with the roads, metres, so that rounding leaves no gap between them.
const OVERLAP_M: f64 = 0.3;
/// Smallest and largest angle of a corner with a kerb return, radians.
pub(super) const CORNERS_RAD: std::ops::RangeInclusive<f64> = 0.17..=2.62;
/// Largest extent of a kerb return along its roads, metres.
const MOST_RETURN_M: f64 = 15.0;
/// Tolerance with which a kerb return's circle touches both edges, metres. The edges are drawn in chords of a metre.
const TOUCHING_M: f64 = 0.03;
/// Largest extent of a mapped corner along its roads, metres.
const MOST_CORNER_M: f64 = 20.0;
/// Angle of a chord of the kerb return's arc, radians. The arc is cut off outside, on the side with less room.
pub(super) const ARC_STEP_RAD: f64 = 0.1;

/// The data from which the area is made.
pub(super) struct TurnGround<'a> {
    pub(super) from: &'a Arm,
    pub(super) to: &'a Arm,
    pub(super) policy: Policy,
    pub(super) left_hand_traffic: bool,
    /// Turn of the vehicle, radians, positive left.
    pub(super) turn_rad: f64,
    pub(super) kerb_radius_m: f64,
    /// The junction's surface, if mapped.
    pub(super) surface: Option<&'a MultiPolygon>,
    /// What the crossing has beside the two roads' strips.
    pub(super) crossing: &'a [Polygon],
    pub(super) length_class: LengthClass,
}

impl TurnGround<'_> {
    /// The drivable area, and whether it has a kerb return of the assumed radius.
    pub(super) fn area(&self) -> (MultiPolygon, bool) {
        let strip = |arm: &Arm| strip(arm, 0..arm.len(), &|k| arm.near_node(k, self.length_class), [0.0; 2]);
        let mut parts: Vec<Polygon> = [self.from, self.to].into_iter().filter_map(strip).collect();
        parts.extend(self.common());
        parts.extend(self.joint());
        parts.extend_from_slice(self.crossing);
        let corner = match self.surface {
            Some(surface) => self.mapped_corner(surface),
            None => self.kerb_return().into_iter().collect(),
        };
        let rounded = self.surface.is_none() && !corner.is_empty();
        parts.extend(corner);
        (unary_union(&parts), rounded)
    }

    /// Edges of the road as far as this turn may use it inside the junction.
    fn edges<'a>(&self, arm: &'a Arm) -> &'a [RoadEdges] {
        let near_side = (self.turn_rad < 0.0) != self.left_hand_traffic;
        if near_side && self.policy != Policy::Carriageway { &arm.direction } else { &arm.carriageway }
    }

    /// The part that both roads cover near the node. A road that ends (or begins) there is extended straight across the
    /// other road. The roads are never both extended by so much: where neither road is real, nothing is.
    fn common(&self) -> Vec<Polygon> {
        let piece = |arm: &Arm, prolonged: [f64; 2]| {
            let near = (CROSSING_M / arm.line.spacing_m) as usize;
            let first = arm.node.saturating_sub(near).max(arm.own.start);
            let end = (arm.node + near + 1).min(arm.own.end);
            let edges = self.edges(arm);
            strip(arm, first..end, &|k| edges[k], prolonged)
        };
        let ends = if self.from.node + 2 >= self.from.own.end { CROSSING_M } else { 0.0 };
        let begins = if self.to.node <= self.to.own.start + 1 { CROSSING_M } else { 0.0 };
        let (from, to) = (piece(self.from, [0.0; 2]), piece(self.to, [0.0; 2]));
        let (from_on, to_back) = (piece(self.from, [0.0, ends]), piece(self.to, [begins, 0.0]));
        let both = |a: &Option<Polygon>, b: &Option<Polygon>| match (a, b) {
            (Some(a), Some(b)) => a.intersection(b).0,
            _ => Vec::new(),
        };
        let mut common = both(&from, &to_back);
        if ends > 0.0 || begins > 0.0 {
            common.extend(both(&from_on, &to));
        }
        common
    }

    /// The joint of a road that only changes its width: each part is as the map has it up to the node, but smoothing leaves a gap of
    /// centimetres there. What both parts have in common, prolonged over it, closes the gap.
    fn joint(&self) -> Vec<Polygon> {
        let meets = self.from.node + 2 >= self.from.own.end && self.to.node <= self.to.own.start + 1;
        if !meets || self.turn_rad.abs() > JOINT_RAD {
            return Vec::new();
        }
        let near = |arm: &Arm| (2.0 * JOINT_M / arm.line.spacing_m).ceil() as usize;
        let piece = |arm: &Arm, prolonged: [f64; 2]| {
            let range =
                arm.node.saturating_sub(near(arm)).max(arm.own.start)..(arm.node + near(arm) + 1).min(arm.own.end);
            strip(arm, range, &|k| arm.near_node(k, self.length_class), prolonged)
        };
        match (piece(self.from, [0.0, JOINT_M]), piece(self.to, [JOINT_M, 0.0])) {
            (Some(from), Some(to)) => from.intersection(&to).0,
            _ => Vec::new(),
        }
    }

    /// The junction's surface between the roads' edges on the inside of the turn.
    fn mapped_corner(&self, surface: &MultiPolygon) -> Vec<Polygon> {
        let edges = [self.kerb(self.from, 0.0), self.kerb(self.to, 0.0)];
        Corner::between(edges.each_ref().map(Vec::as_slice), self.turn_rad)
            .map_or_else(Vec::new, |corner| corner.mapped(surface))
    }

    /// The corner between the roads' edges on the inside of the turn, rounded with the kerb radius.
    fn kerb_return(&self) -> Option<Polygon> {
        let kerb = |arm: usize, beyond_m: f64| self.kerb([self.from, self.to][arm], beyond_m);
        rounded(&kerb, self.turn_rad, self.kerb_radius_m, ARC_STEP_RAD)
    }

    /// The edge of a road near the node on the inside of the turn, or a line `beyond_m` outside it. It is extended
    /// where the turn's other road is.
    fn kerb(&self, arm: &Arm, beyond_m: f64) -> Vec<[f64; 2]> {
        let right = self.turn_rad < 0.0;
        let beyond_m = if right { -beyond_m } else { beyond_m };
        let [back_m, on_m] = if std::ptr::eq(arm, self.from) { [0.0, CROSSING_M] } else { [CROSSING_M, 0.0] };
        let near = (CROSSING_M / arm.line.spacing_m) as usize;
        let first = arm.node.saturating_sub(near).max(arm.own.start);
        let end = (arm.node + near + 1).min(arm.own.end);
        let place = |k: usize| arm.aside(k, arm.carriageway[k][usize::from(right)] + beyond_m);
        let mut line: Vec<[f64; 2]> = (first..end).map(place).collect();
        if let (Some(&a), Some(&b)) = (line.first(), line.last()) {
            line.insert(0, along(a, arm.forward(first), -back_m));
            line.push(along(b, arm.forward(end - 1), on_m));
        }
        line
    }
}

/// The corner between two roads, rounded with a kerb radius in chords of an angle. `kerb` is the edge of either road on the inside of the
/// turn from the one into the other, or a line the given distance outside it.
pub(super) fn rounded(
    kerb: &dyn Fn(usize, f64) -> Vec<[f64; 2]>,
    turn_rad: f64,
    kerb_radius_m: f64,
    chord_rad: f64,
) -> Option<Polygon> {
    if kerb_radius_m <= 0.0 {
        return None;
    }
    let (from_edge, to_edge) = (kerb(0, 0.0), kerb(1, 0.0));
    let corner = Corner::between([&from_edge, &to_edge], turn_rad)?;
    let turned = corner.turned_rad();
    let radius = kerb_radius_m.min(MOST_RETURN_M / (0.5 * turned.abs()).tan());
    // The circle touches both edges, however they bend: a ring's edge bends away from the tangent at the corner.
    let centre = crossing(&kerb(0, radius), &kerb(1, radius), turn_rad)?.at;
    let touching = |edge: &[[f64; 2]]| {
        let (at, m) = nearest(edge, centre)?;
        ((m - radius).abs() < TOUCHING_M).then_some(at)
    };
    let (start, end) = (touching(&from_edge)?, touching(&to_edge)?);
    let (u, v) = (unit(centre, start), unit(centre, end));
    let rounds = (u[0] * v[1] - u[1] * v[0]).atan2(u[0] * v[0] + u[1] * v[1]);
    if (rounds > 0.0) != (turned > 0.0) || rounds.abs() > *CORNERS_RAD.end() {
        return None;
    }
    let [a, b] = corner.inward();
    let mut ring = arc(centre, start, rounds, chord_rad);
    ring.push(end);
    ring.push(along(end, v, OVERLAP_M));
    ring.push(add(add(corner.at, a), b));
    ring.push(along(start, u, OVERLAP_M));
    Some(polygon(&ring))
}

/// The point on a line nearest to `p`, and its distance.
fn nearest(line: &[[f64; 2]], p: [f64; 2]) -> Option<([f64; 2], f64)> {
    let on_segment = |w: &[[f64; 2]]| {
        let d = [w[1][0] - w[0][0], w[1][1] - w[0][1]];
        let along = (p[0] - w[0][0]) * d[0] + (p[1] - w[0][1]) * d[1];
        let t = (along / (d[0] * d[0] + d[1] * d[1]).max(1e-12)).clamp(0.0, 1.0);
        let at = [w[0][0] + t * d[0], w[0][1] + t * d[1]];
        (at, (p[0] - at[0]).hypot(p[1] - at[1]))
    };
    line.windows(2).map(on_segment).min_by(|a, b| a.1.total_cmp(&b.1))
}

/// Points on the tangents of the arc, whose polygon lies on the road's side. The kerb bulges towards the vehicle, so
/// chords would cut it off; each point is moved outside onto the tangents.
fn arc(centre: [f64; 2], start: [f64; 2], turned: f64, chord_rad: f64) -> Vec<[f64; 2]> {
    let steps = (turned.abs() / chord_rad).ceil().max(1.0);
    let step = turned / steps;
    let out = 1.0 / (0.5 * step).cos();
    let from = [start[0] - centre[0], start[1] - centre[1]];
    let at = |angle: f64, by: f64| {
        let (sin, cos) = angle.sin_cos();
        add(centre, [by * (from[0] * cos - from[1] * sin), by * (from[0] * sin + from[1] * cos)])
    };
    let mut points = vec![start];
    points.extend((0..steps as usize).map(|i| at((i as f64 + 0.5) * step, out)));
    points
}

/// A stretch of road as wide as the turn's strip.
pub(super) fn stretch(arm: &Arm, range: std::ops::Range<usize>) -> MultiPolygon {
    unary_union(&strip(arm, range, &|k| arm.strip[k], [0.0; 2]).into_iter().collect::<Vec<Polygon>>())
}

/// The polygon between the edges of an arm's stations, extended straight by the given metres before and after.
fn strip(
    arm: &Arm,
    range: std::ops::Range<usize>,
    edges: &dyn Fn(usize) -> RoadEdges,
    prolonged_m: [f64; 2],
) -> Option<Polygon> {
    outline(&arm.line, range, edges, prolonged_m).map(|ring| polygon(&ring))
}

/// An area with the straight road beyond the ends of the two roads' corridors, for planning: a planned path is not held against the
/// cut end of a road (see [`crate::corridor::open_ends`]).
pub(super) fn opened(area: &MultiPolygon, [from, to]: [&Arm; 2], length_class: LengthClass) -> MultiPolygon {
    let overlap = |arm: &Arm| (OVERLAP_ROAD_M / arm.line.spacing_m) as usize;
    let edges = |arm: &Arm, k: usize| arm.near_node(k, length_class);
    let before = from.complete[0]
        .then(|| strip(from, 0..overlap(from).min(from.len()), &|k| edges(from, k), [BEYOND_M, 0.0]))
        .flatten();
    let after = to.complete[1]
        .then(|| strip(to, to.len().saturating_sub(overlap(to))..to.len(), &|k| edges(to, k), [0.0, BEYOND_M]))
        .flatten();
    [before, after].into_iter().flatten().fold(area.clone(), |area, strip| area.union(&strip))
}

/// The boundary of an area as rings without vertices that add nothing. Each vertex that is left out lies within [`STRAIGHT_M`] of the side
/// that replaces it. (Unions draw some corners twice, and neither vertex of such a corner may go because of the other.) A ring that would
/// enclose other ground without them keeps all its vertices.
pub(super) fn rings(area: &MultiPolygon) -> PlaneArea {
    let rings = area.iter().flat_map(|p| std::iter::once(p.exterior()).chain(p.interiors()));
    let open = |ring: &LineString| {
        let short = without_first(vertices(&ring.simplify(STRAIGHT_M)));
        let all = vertices(ring);
        if encloses_the_same(&short, &all) { short } else { all }
    };
    PlaneArea { rings: rings.map(open).filter(|ring| ring.len() > 2).collect() }
}

/// The vertices of a closed ring, each once.
fn vertices(ring: &LineString) -> Vec<[f64; 2]> {
    let mut ring: Vec<[f64; 2]> = ring.coords().map(|c| [c.x, c.y]).collect();
    ring.pop();
    ring
}

/// A ring begins anywhere, so its first vertex may add nothing, too.
fn without_first(mut ring: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    if let [first, second, .., last] = ring[..]
        && from_side_m(first, last, second) <= STRAIGHT_M
    {
        ring.remove(0);
    }
    ring
}

/// Whether the grounds of two rings differ by no more than vertices within [`STRAIGHT_M`] of the boundary can add or take.
fn encloses_the_same(short: &[[f64; 2]], all: &[[f64; 2]]) -> bool {
    let [short, all] = [short, all].map(polygon);
    (short.unsigned_area() - all.unsigned_area()).abs() <= STRAIGHT_M * Euclidean.length(all.exterior())
}

/// Distance of a place from a side, metres.
fn from_side_m(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    nearest(&[a, b], p).map_or(f64::INFINITY, |(_, m)| m)
}

/// The crossing of two edge lines, and their directions there.
pub(super) struct Corner {
    at: [f64; 2],
    from: [f64; 2],
    to: [f64; 2],
}

impl Corner {
    /// The corner where two edges on the inside of a turn meet, if there is one.
    pub(super) fn between(edges: [&[[f64; 2]]; 2], turn_rad: f64) -> Option<Self> {
        let corner = CORNERS_RAD.contains(&turn_rad.abs()).then(|| crossing(edges[0], edges[1], turn_rad))??;
        let turned = corner.turned_rad();
        (CORNERS_RAD.contains(&turned.abs()) && (turned > 0.0) == (turn_rad > 0.0)).then_some(corner)
    }

    /// A surface between the two edges.
    pub(super) fn mapped(&self, surface: &MultiPolygon) -> Vec<Polygon> {
        let [a, b] = self.inward();
        let between = polygon(&[
            add(along(self.at, self.from, -MOST_CORNER_M), a),
            add(add(self.at, a), b),
            add(along(self.at, self.to, MOST_CORNER_M), b),
        ]);
        surface.intersection(&between).0
    }

    /// Angle from one edge's direction to the other's, radians, positive left.
    fn turned_rad(&self) -> f64 {
        let (a, b) = (self.from, self.to);
        (a[0] * b[1] - a[1] * b[0]).atan2(a[0] * b[0] + a[1] * b[1])
    }

    /// Direction from either edge towards its road.
    fn inward(&self) -> [[f64; 2]; 2] {
        let sign = self.turned_rad().signum();
        [self.from, self.to].map(|d| [sign * d[1] * OVERLAP_M, -sign * d[0] * OVERLAP_M])
    }
}

/// The crossing of two edge lines in the turn's own sense: the one nearest to the end of the first line.
fn crossing(a: &[[f64; 2]], b: &[[f64; 2]], turn_rad: f64) -> Option<Corner> {
    let mut last = None;
    for p in a.windows(2) {
        let mut here = None;
        for q in b.windows(2) {
            let Some((at, ..)) = segments_cross(p[0], p[1], q[0], q[1]) else { continue };
            let (from, to) = (unit(p[0], p[1]), unit(q[0], q[1]));
            let sense = from[0] * to[1] - from[1] * to[0];
            if sense * turn_rad > 0.0 && here.is_none() {
                here = Some(Corner { at, from, to });
            }
        }
        last = here.or(last);
    }
    last
}

/// The crossing of two segments, and the share of each segment before it.
pub(super) fn segments_cross(a: [f64; 2], b: [f64; 2], c: [f64; 2], d: [f64; 2]) -> Option<([f64; 2], f64, f64)> {
    let (r, s) = ([b[0] - a[0], b[1] - a[1]], [d[0] - c[0], d[1] - c[1]]);
    let across = r[0] * s[1] - r[1] * s[0];
    if across.abs() < 1e-12 {
        return None;
    }
    let from = [c[0] - a[0], c[1] - a[1]];
    let t = (from[0] * s[1] - from[1] * s[0]) / across;
    let u = (from[0] * r[1] - from[1] * r[0]) / across;
    let inside = (0.0..=1.0).contains(&t) && (0.0..=1.0).contains(&u);
    inside.then(|| ([a[0] + t * r[0], a[1] + t * r[1]], t, u))
}

/// A ring as a polygon that runs counter-clockwise. A union treats rings of the other sense as holes.
pub(super) fn polygon(ring: &[[f64; 2]]) -> Polygon {
    Polygon::new(ring.iter().map(|p| (p[0], p[1])).collect::<LineString>(), Vec::new()).orient(Direction::Default)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn ground_m2(area: &PlaneArea) -> f64 {
        let rings = area.rings.iter().map(|ring| polygon(ring).unsigned_area());
        rings.enumerate().map(|(i, m2)| if i == 0 { m2 } else { -m2 }).sum()
    }

    /// A cross of two roads. At each of its corners the boundary has several vertices, so near each other as a union may draw them.
    fn cross(copies: &[(usize, f64)]) -> MultiPolygon {
        let inner = [(2.0, -2.0), (50.0, -2.0), (50.0, 2.0), (2.0, 2.0), (2.0, 50.0), (-2.0, 50.0)];
        let outer = [(-2.0, 2.0), (-50.0, 2.0), (-50.0, -2.0), (-2.0, -2.0), (-2.0, -50.0), (2.0, -50.0)];
        let corners = inner.into_iter().chain(outer);
        let ring = corners.zip(copies.iter().cycle()).flat_map(|((x, y), &(copies, apart_m))| {
            (0..=copies).map(move |k| (x + apart_m * k as f64, y - apart_m * (k % 2) as f64))
        });
        Polygon::new(ring.collect::<LineString>(), Vec::new()).into()
    }

    proptest! {
        /// A lost corner of this cross would add or take 1,152 m².
        #[test]
        fn a_corner_that_is_drawn_several_times_stays(
            copies in prop::collection::vec((0..4_usize, -12.0..-5.0_f64), 1..12),
        ) {
            let copies: Vec<(usize, f64)> = copies.into_iter().map(|(n, log)| (n, 10.0_f64.powf(log))).collect();
            let drawn = cross(&copies);
            let ring = rings(&drawn);
            prop_assert!((ground_m2(&ring) - drawn.unsigned_area()).abs() < 0.02, "{:?}", ring.rings);
        }
    }

    /// What was left out once: all vertices beside a side at once, and with them a corner that a union drew twice.
    #[test]
    fn a_ring_that_lost_a_corner_does_not_enclose_the_same() {
        let all = vertices(cross(&[(1, 1e-9)]).0[0].exterior());
        let without = |corner: usize| [&all[..2 * corner], &all[2 * corner + 2..]].concat();
        assert!(encloses_the_same(&rings(&cross(&[(1, 1e-9)])).rings[0], &all));
        for corner in 0..12 {
            assert!(!encloses_the_same(&without(corner), &all), "corner {corner}");
        }
    }

    #[test]
    fn vertices_on_a_side_go_wherever_the_ring_begins() {
        let square = [[0.0, 0.0], [5.0, 0.0], [10.0, 0.0], [10.0, 10.0], [5.0, 10.000_001], [0.0, 10.0]];
        for first in 0..square.len() {
            let ring: Vec<[f64; 2]> = square.iter().cycle().skip(first).take(square.len()).copied().collect();
            assert_eq!(rings(&polygon(&ring).into()).rings[0].len(), 4, "{first}");
        }
    }
}
