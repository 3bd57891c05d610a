//! The room that a place or a body has in an area: its distance from all that lies outside.
//!
//! Room is positive inside and negative outside, where it says how far away the area is.

use netcert_base::corridor::PlaneArea;

use crate::path::{V2, along, direction, dot, left_of};

/// Distance between the places of an edge that are tried where an edge is not all inside, metres.
const TRIED_M: f64 = 0.1;

/// An area's boundary, prepared for measuring.
#[derive(Debug, Clone)]
pub struct AreaBoundary {
    segments: Vec<[V2; 2]>,
}

/// A rectangular body: its axle, its heading, and how far it reaches from there.
#[derive(Debug, Clone, Copy)]
pub struct Body {
    pub axle: V2,
    pub ahead: V2,
    pub front_m: f64,
    pub rear_m: f64,
    pub half_m: f64,
}

/// An edge of a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BodyEdge {
    Left,
    Right,
    Front,
    Rear,
}

/// All edges of a body.
pub const EDGES: [BodyEdge; 4] = [BodyEdge::Left, BodyEdge::Right, BodyEdge::Front, BodyEdge::Rear];

/// A place of a body's outline, and the place of the boundary that is nearest to it.
#[derive(Debug, Clone, Copy)]
pub struct Touch {
    pub room_m: f64,
    pub edge: BodyEdge,
    /// Ahead of the body's axle, and to its left, metres.
    pub ahead_m: f64,
    pub aside_m: f64,
    /// In the frame of the area.
    pub at: V2,
    pub nearest: V2,
}

impl AreaBoundary {
    pub fn new(area: &PlaneArea) -> Self {
        let mut segments = Vec::new();
        for ring in &area.rings {
            let mut before = ring.last();
            for vertex in ring {
                segments.extend(before.filter(|before| *before != vertex).map(|before| [*before, *vertex]));
                before = Some(vertex);
            }
        }
        Self { segments }
    }

    /// Whether a place is inside: a ray northwards from there crosses the boundary an odd number of times.
    pub fn holds(&self, [x, y]: V2) -> bool {
        let mut inside = false;
        for [a, b] in &self.segments {
            let (west, east) = if a[0] < b[0] { (a, b) } else { (b, a) };
            if west[0] <= x && x < east[0] {
                let cross = (east[0] - west[0]) * (y - west[1]) - (east[1] - west[1]) * (x - west[0]);
                inside ^= cross < 0.0;
            }
        }
        inside
    }

    /// The distance to the boundary, metres, and its nearest place.
    pub fn nearest(&self, point: V2) -> (f64, V2) {
        let mut best = (f64::INFINITY, point);
        for segment in &self.segments {
            let at = on_segment(segment, point);
            let off = along(point, -1.0, at);
            let squared = dot(off, off);
            if squared < best.0 {
                best = (squared, at);
            }
        }
        (best.0.sqrt(), best.1)
    }

    /// The room of a place, metres, and the nearest place of the boundary.
    pub fn room(&self, point: V2) -> (f64, V2) {
        let (distance, nearest) = self.nearest(point);
        (if self.holds(point) { distance } else { -distance }, nearest)
    }

    /// The place of one edge that has the least room. It is exact where all of the edge is inside. Elsewhere it is the
    /// deepest of places 0.1 m apart.
    pub fn edge(&self, body: &Body, edge: BodyEdge) -> Touch {
        let [from, to] = body.edge(edge);
        let wall = [body.at(from), body.at(to)];
        let mut best: Option<(f64, V2, V2)> = None;
        let mut crossed = false;
        for segment in &self.segments {
            if best.is_some_and(|best| apart(&wall, segment) > best.0) {
                continue;
            }
            crossed |= cross(&wall, segment);
            let (squared, at, nearest) = closest(&wall, segment);
            if best.is_none_or(|best| squared < best.0) {
                best = Some((squared, at, nearest));
            }
        }
        if crossed || !self.holds(wall[0]) {
            return tried(&[self], body, edge, f64::INFINITY).expect("an edge has places");
        }
        let (squared, at, nearest) = best.unwrap_or((f64::INFINITY, wall[0], wall[0]));
        let [ahead_m, aside_m] = body.seen(at);
        Touch { room_m: squared.sqrt(), edge, ahead_m, aside_m, at, nearest }
    }

    /// The place of a body's outline that has the least room.
    pub fn body(&self, body: &Body) -> Touch {
        let touches = EDGES.map(|edge| self.edge(body, edge));
        touches.into_iter().min_by(|a, b| a.room_m.total_cmp(&b.room_m)).expect("a body has four edges")
    }

    /// Vertices of the boundary inside a body: of an island under it, or a corner that it cuts.
    pub fn under(&self, body: &Body) -> impl Iterator<Item = V2> {
        let covered =
            |[ahead_m, aside_m]: V2| -body.rear_m < ahead_m && ahead_m < body.front_m && aside_m.abs() < body.half_m;
        self.segments.iter().map(|segment| segment[0]).filter(move |vertex| covered(body.seen(*vertex)))
    }
}

/// One place of a body's outline where a place may be in any of several areas. `None` without areas.
pub fn place_in_any(grounds: &[&AreaBoundary], body: &Body, edge: BodyEdge, [ahead_m, aside_m]: V2) -> Option<Touch> {
    let at = body.at([ahead_m, aside_m]);
    let (room_m, nearest) = grounds.iter().map(|ground| ground.room(at)).max_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(Touch { room_m, edge, ahead_m, aside_m, at, nearest })
}

/// The place of an edge that has the least room, if that is less than `enough`, where a place may be in any of several
/// areas. With one area it is exact; otherwise it is the least of places 0.1 m apart.
pub fn in_any(grounds: &[&AreaBoundary], body: &Body, edge: BodyEdge, enough: f64) -> Option<Touch> {
    if let [only] = grounds {
        return Some(only.edge(body, edge)).filter(|touch| touch.room_m < enough);
    }
    tried(grounds, body, edge, enough)
}

/// The least of places 0.1 m apart. Room changes by a metre per metre at most, so places are left out whose neighbours
/// have too much of it.
fn tried(grounds: &[&AreaBoundary], body: &Body, edge: BodyEdge, enough: f64) -> Option<Touch> {
    let [from, to] = body.edge(edge);
    let way = along(to, -1.0, from);
    let length = dot(way, way).sqrt();
    let pieces = (length / TRIED_M).ceil().max(1.0);
    let place = |k: usize| place_in_any(grounds, body, edge, along(from, k as f64 / pieces, way));
    let last = pieces as usize;
    let [first, end] = [place(0)?, place(last)?];
    let mut best = if first.room_m < end.room_m { first } else { end };
    // Ranges between two places with the rooms of both.
    let mut open = vec![((0, first.room_m), (last, end.room_m))];
    while let Some((low, high)) = open.pop() {
        let apart = (high.0 - low.0) as f64 / pieces * length;
        let least = 0.5 * (low.1 + high.1 - apart);
        if high.0 - low.0 < 2 || least >= best.room_m.min(enough) {
            continue;
        }
        let middle = (low.0 + high.0) / 2;
        let touch = place(middle)?;
        if touch.room_m < best.room_m {
            best = touch;
        }
        open.extend([(low, (middle, touch.room_m)), ((middle, touch.room_m), high)]);
    }
    Some(best).filter(|best| best.room_m < enough)
}

impl Body {
    /// A place of the body (metres ahead of its axle and to the left) in the frame of the area.
    pub fn at(&self, [ahead_m, aside_m]: V2) -> V2 {
        along(along(self.axle, ahead_m, self.ahead), aside_m, left_of(self.ahead))
    }

    /// A place of the area's frame, seen from the body.
    pub fn seen(&self, point: V2) -> V2 {
        let off = along(point, -1.0, self.axle);
        [dot(off, self.ahead), dot(off, left_of(self.ahead))]
    }

    /// Both ends of an edge, seen from the body.
    pub fn edge(&self, edge: BodyEdge) -> [V2; 2] {
        let (front, rear, half) = (self.front_m, -self.rear_m, self.half_m);
        match edge {
            BodyEdge::Left => [[rear, half], [front, half]],
            BodyEdge::Right => [[rear, -half], [front, -half]],
            BodyEdge::Front => [[front, -half], [front, half]],
            BodyEdge::Rear => [[rear, -half], [rear, half]],
        }
    }

    /// The direction out of the body across an edge.
    pub fn outwards(&self, edge: BodyEdge) -> V2 {
        let back = |v: V2| [-v[0], -v[1]];
        match edge {
            BodyEdge::Left => left_of(self.ahead),
            BodyEdge::Right => back(left_of(self.ahead)),
            BodyEdge::Front => self.ahead,
            BodyEdge::Rear => back(self.ahead),
        }
    }

    /// A body with its axle at a place.
    pub fn new(unit: &netcert_base::vehicle::Unit, axle: V2, heading: f64) -> Self {
        Self {
            axle,
            ahead: direction(heading),
            front_m: unit.coupling_to_axle_m + unit.front_overhang_m,
            rear_m: unit.rear_overhang_m,
            half_m: 0.5 * unit.width_m,
        }
    }
}

/// The place of a segment that is nearest to a point.
fn on_segment([a, b]: &[V2; 2], point: V2) -> V2 {
    let way = along(*b, -1.0, *a);
    let share = dot(along(point, -1.0, *a), way) / dot(way, way);
    along(*a, share.clamp(0.0, 1.0), way)
}

/// A lower bound of the squared distance of two segments: that of their bounding boxes.
fn apart(a: &[V2; 2], b: &[V2; 2]) -> f64 {
    let gap = |x: usize| {
        let after = a[0][x].min(a[1][x]) - b[0][x].max(b[1][x]);
        let before = b[0][x].min(b[1][x]) - a[0][x].max(a[1][x]);
        after.max(before).max(0.0)
    };
    gap(0).powi(2) + gap(1).powi(2)
}

/// Twice the signed area of a triangle.
fn turn(a: V2, b: V2, c: V2) -> f64 {
    dot(left_of(along(b, -1.0, a)), along(c, -1.0, a))
}

/// Whether two segments cross.
fn cross(a: &[V2; 2], b: &[V2; 2]) -> bool {
    let split =
        |line: &[V2; 2], by: &[V2; 2]| (turn(line[0], line[1], by[0]) > 0.0) != (turn(line[0], line[1], by[1]) > 0.0);
    split(a, b) && split(b, a)
}

/// The squared distance of two segments that do not cross, and the places of both. One of the four ends is nearest.
fn closest(a: &[V2; 2], b: &[V2; 2]) -> (f64, V2, V2) {
    let pairs = [
        (a[0], on_segment(b, a[0])),
        (a[1], on_segment(b, a[1])),
        (on_segment(a, b[0]), b[0]),
        (on_segment(a, b[1]), b[1]),
    ];
    let squared = |(p, q): &(V2, V2)| {
        let off = along(*p, -1.0, *q);
        dot(off, off)
    };
    let least = pairs.iter().min_by(|p, q| squared(p).total_cmp(&squared(q))).expect("there are four");
    (squared(least), least.0, least.1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::Draw;

    fn square(half: f64) -> Vec<V2> {
        vec![[-half, -half], [half, -half], [half, half], [-half, half]]
    }

    fn ground(rings: Vec<Vec<V2>>) -> AreaBoundary {
        AreaBoundary::new(&PlaneArea { rings })
    }

    fn body(axle: V2, heading: f64) -> Body {
        Body { axle, ahead: direction(heading), front_m: 3.0, rear_m: 1.0, half_m: 0.5 }
    }

    #[test]
    fn room_is_the_distance_to_the_boundary_and_negative_outside() {
        let ground = ground(vec![square(5.0), square(1.0)]);
        assert!((ground.room([3.5, 0.0]).0 - 1.5).abs() < 1e-12);
        assert!((ground.room([0.0, 0.25]).0 + 0.75).abs() < 1e-12);
        assert!((ground.room([8.0, 9.0]).0 + 5.0).abs() < 1e-12);
        assert_eq!(ground.nearest([8.0, 9.0]).1, [5.0, 5.0]);
    }

    #[test]
    fn whether_a_place_is_inside_agrees_with_the_area_itself() {
        let area =
            PlaneArea { rings: vec![vec![[0.0, 0.0], [9.0, 1.0], [4.0, 3.0], [8.0, 8.0], [-2.0, 6.0]], square(0.7)] };
        let ground = AreaBoundary::new(&area);
        let mut draw = Draw(5);
        for _ in 0..2_000 {
            let place = [draw.between(-4.0, 10.0), draw.between(-3.0, 9.0)];
            assert_eq!(ground.holds(place), area.contains(place), "{place:?}");
        }
    }

    #[test]
    fn a_body_inside_has_the_distance_of_its_nearest_edge() {
        let ground = ground(vec![square(5.0)]);
        let touch = ground.body(&body([1.0, 0.0], 0.0));
        assert!((touch.room_m - 1.0).abs() < 1e-12);
        assert_eq!(touch.ahead_m, 3.0);
        let touch = ground.body(&body([0.0, 3.0], std::f64::consts::PI));
        assert!((touch.room_m - 1.5).abs() < 1e-12);
        assert!(touch.aside_m < 0.0);
    }

    #[test]
    fn a_reentrant_corner_counts_where_it_meets_the_middle_of_a_side() {
        // The corner at the origin points at the middle of the left side, 0.2 m away.
        let ground = ground(vec![vec![[0.0, 0.0], [-9.0, 5.0], [-9.0, -9.0], [9.0, -9.0], [9.0, 5.0]]]);
        let touch = ground.body(&body([-1.0, -0.7], 0.0));
        assert!((touch.room_m - 0.2).abs() < 1e-12);
        assert!((touch.ahead_m - 1.0).abs() < 1e-12 && touch.edge == BodyEdge::Left);
        assert_eq!(touch.nearest, [0.0, 0.0]);
        // Now the corner is 0.3 m inside of the side, and no corner of the body is outside.
        let deep = body([-1.0, -0.2], 0.0);
        let touch = ground.body(&deep);
        assert!(touch.room_m < -0.2, "{touch:?}");
        assert_eq!(ground.under(&deep).next(), Some([0.0, 0.0]));
    }

    #[test]
    fn a_body_outside_has_its_deepest_place() {
        let ground = ground(vec![square(5.0)]);
        let touch = ground.body(&body([4.0, 0.0], 0.0));
        assert!((touch.room_m + 2.0).abs() < 1e-12 && touch.ahead_m == 3.0);
        assert!((ground.body(&body([9.0, 0.0], 0.0)).room_m + 7.0).abs() < 1e-12);
    }

    #[test]
    fn an_island_under_a_body_is_seen_though_the_outline_is_clear() {
        let ground = ground(vec![square(9.0), square(0.2)]);
        let above = body(direction(0.4).map(|x| -x), 0.4);
        assert!(ground.under(&above).next().is_some());
        assert!(ground.body(&above).room_m > 0.0);
        assert!(ground.under(&body([3.0, 3.0], 0.4)).next().is_none());
    }

    #[test]
    fn the_least_room_is_that_of_the_nearest_of_many_places() {
        let mut draw = Draw(11);
        let ground = ground(vec![
            vec![[-20.0, -8.0], [2.0, -9.0], [15.0, -20.0], [18.0, -4.0], [3.0, 2.0], [2.0, 12.0], [-6.0, 1.0]],
            vec![[0.0, -3.0], [0.5, -3.5], [1.0, -3.0]],
        ]);
        for _ in 0..500 {
            let body = body([draw.between(-15.0, 12.0), draw.between(-12.0, 6.0)], draw.between(-3.0, 3.0));
            let exact = ground.body(&body);
            // Where it leaves the area, places between those that were tried may be a little deeper.
            let slack = if exact.room_m > 0.0 { 1e-9 } else { 0.5 * TRIED_M };
            for edge in EDGES {
                let [from, to] = body.edge(edge);
                for k in 0..=60 {
                    let place = along(from, f64::from(k) / 60.0, along(to, -1.0, from));
                    assert!(ground.room(body.at(place)).0 >= exact.room_m - slack, "{exact:?}");
                }
            }
            assert!((ground.room(exact.at).0 - exact.room_m).abs() < 1e-9, "{exact:?}");
        }
    }

    #[test]
    fn where_areas_overlap_the_roomier_one_counts() {
        let shifted = |x: f64| vec![[x, -2.0], [x + 10.0, -2.0], [x + 10.0, 2.0], [x, 2.0]];
        let (a, b) = (ground(vec![shifted(0.0)]), ground(vec![shifted(6.0)]));
        let body = body([7.0, 0.0], 0.0);
        let room = |grounds: &[&AreaBoundary], edge| in_any(grounds, &body, edge, f64::INFINITY).unwrap().room_m;
        assert!((room(&[&a], BodyEdge::Front)).abs() < 1e-12);
        assert!((room(&[&a, &b], BodyEdge::Front) - 1.5).abs() < 1e-12);
        assert!((room(&[&a, &b], BodyEdge::Rear) - 1.5).abs() < 1e-12);
        assert!(in_any(&[], &body, BodyEdge::Rear, f64::INFINITY).is_none());
    }
}
