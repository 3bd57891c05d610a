//! Junctions of drawn lines at the same level: crossings, and ends that lie on another line.
//!
//! A meeting becomes a vertex that all its lines share. Lines on different layers (a bridge and the road below) cross
//! without meeting.

use super::alignment::{Point, distance};

/// Ends closer than this to a line are taken to lie on it. Meetings closer than this are one junction.
const REACH_M: f64 = 2.5;
/// A meeting this close to a vertex replaces the vertex.
const SNAP_M: f64 = 1.0;

/// A vertex of a drawn line.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Vertex {
    /// Metres along the road's axis.
    pub(crate) station_m: f64,
    /// Position.
    pub(crate) at: Point,
    /// The vertex's junction.
    pub(crate) junction: Option<usize>,
}

/// A drawn line before it is cut into ways.
#[derive(Debug, Clone)]
pub(crate) struct Line {
    /// At least two vertices. A closed line repeats its first vertex at the end.
    pub(crate) vertices: Vec<Vertex>,
    /// The layer of each segment (one fewer than vertices).
    pub(crate) layers: Vec<i32>,
}

impl Line {
    fn closed(&self) -> bool {
        matches!(self.vertices.as_slice(), [first, .., last] if distance(first.at, last.at) < 1e-9)
    }

    fn segments(&self) -> impl Iterator<Item = (Point, Point, i32)> {
        self.vertices.windows(2).zip(&self.layers).map(|(pair, &layer)| (pair[0].at, pair[1].at, layer))
    }
}

/// Place of a meeting on a line: segment index plus fraction.
#[derive(Clone, Copy)]
struct Spot {
    line: usize,
    position: f64,
}

/// Gives every line a shared vertex wherever it meets another line. Returns the number of junctions.
pub(crate) fn join(lines: &mut [Line]) -> usize {
    let mut meetings: Vec<(Point, Vec<Spot>)> = Vec::new();
    let mut meet = |at: Point, spots: [Spot; 2]| {
        match meetings.iter_mut().find(|(place, _)| distance(*place, at) < REACH_M) {
            Some((_, known)) => known.extend(spots),
            None => meetings.push((at, spots.to_vec())),
        };
    };
    for line in 0..lines.len() {
        end_meetings(lines, line, &mut meet);
    }
    for a in 0..lines.len() {
        for b in a + 1..lines.len() {
            crossings(lines, a, b, &mut meet);
        }
    }
    for (line, drawn) in lines.iter_mut().enumerate() {
        let mut mine: Vec<(f64, usize, Point)> = Vec::new();
        for (junction, (at, spots)) in meetings.iter().enumerate() {
            mine.extend(spots.iter().filter(|s| s.line == line).map(|s| (s.position, junction, *at)));
        }
        let closed = drawn.closed();
        mine.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        for (position, junction, at) in mine {
            insert(drawn, position, junction, at);
        }
        if closed && let [first, .., last] = drawn.vertices.as_mut_slice() {
            let shared = if first.junction.is_some() { *first } else { *last };
            (first.junction, first.at) = (shared.junction, shared.at);
            (last.junction, last.at) = (shared.junction, shared.at);
        }
    }
    meetings.len()
}

/// Ends of `line` that lie on another line: its nearest place within reach, on the end's layer.
fn end_meetings(lines: &[Line], line: usize, meet: &mut impl FnMut(Point, [Spot; 2])) {
    let this = &lines[line];
    let last = this.vertices.len() - 1;
    if this.closed() {
        return;
    }
    for (vertex, segment, position) in [(0, 0, 0.0), (last, last - 1, last as f64)] {
        let (end, layer) = (this.vertices[vertex].at, this.layers[segment]);
        let mut best: Option<(f64, Point, Spot)> = None;
        for (other, drawn) in lines.iter().enumerate().filter(|&(other, _)| other != line) {
            for (index, (a, b, _)) in drawn.segments().enumerate().filter(|(_, s)| s.2 == layer) {
                let t = foot(a, b, end);
                let at = [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])];
                let away = distance(at, end);
                if away < REACH_M && best.as_ref().is_none_or(|(least, ..)| away < *least) {
                    best = Some((away, at, Spot { line: other, position: index as f64 + t }));
                }
            }
        }
        if let Some((_, at, spot)) = best {
            meet(at, [Spot { line, position }, spot]);
        }
    }
}

fn crossings(lines: &[Line], a: usize, b: usize, meet: &mut impl FnMut(Point, [Spot; 2])) {
    for (i, (p, q, layer)) in lines[a].segments().enumerate() {
        for (j, (r, s, other)) in lines[b].segments().enumerate() {
            if layer == other
                && let Some((t, w)) = crossing(p, q, r, s)
            {
                let at = [p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])];
                meet(at, [Spot { line: a, position: i as f64 + t }, Spot { line: b, position: j as f64 + w }]);
            }
        }
    }
}

/// Fractions along p–q and r–s at which the segments cross.
fn crossing(p: Point, q: Point, r: Point, s: Point) -> Option<(f64, f64)> {
    let apart = |i: usize| p[i].min(q[i]) > r[i].max(s[i]) || p[i].max(q[i]) < r[i].min(s[i]);
    if apart(0) || apart(1) {
        return None;
    }
    let (d, e, f) = ([q[0] - p[0], q[1] - p[1]], [s[0] - r[0], s[1] - r[1]], [r[0] - p[0], r[1] - p[1]]);
    let cross = d[0] * e[1] - d[1] * e[0];
    let (t, w) = ((f[0] * e[1] - f[1] * e[0]) / cross, (f[0] * d[1] - f[1] * d[0]) / cross);
    ((0.0..=1.0).contains(&t) && (0.0..=1.0).contains(&w)).then_some((t, w))
}

/// Fraction along a–b nearest to `to`.
fn foot(a: Point, b: Point, to: Point) -> f64 {
    let (d, e) = ([b[0] - a[0], b[1] - a[1]], [to[0] - a[0], to[1] - a[1]]);
    ((d[0] * e[0] + d[1] * e[1]) / (d[0] * d[0] + d[1] * d[1])).clamp(0.0, 1.0)
}

/// Puts a junction's vertex at `position`. Vertices are inserted back to front, so earlier positions stay valid.
fn insert(line: &mut Line, position: f64, junction: usize, at: Point) {
    let segment = (position.floor() as usize).min(line.vertices.len() - 2);
    let fraction = position - segment as f64;
    let near = |i: usize| distance(line.vertices[i].at, at) < SNAP_M;
    let ends = [0, line.vertices.len() - 1];
    let at_end = |i: usize| ends.contains(&i) && distance(line.vertices[i].at, at) < REACH_M;
    let taken = [segment, segment + 1].into_iter().find(|&i| at_end(i) || near(i));
    if let Some(i) = taken {
        line.vertices[i].at = at;
        line.vertices[i].junction = Some(junction);
        return;
    }
    let (before, after) = (line.vertices[segment].station_m, line.vertices[segment + 1].station_m);
    let station_m = before + fraction * (after - before);
    line.vertices.insert(segment + 1, Vertex { station_m, at, junction: Some(junction) });
    line.layers.insert(segment, line.layers[segment]);
}
