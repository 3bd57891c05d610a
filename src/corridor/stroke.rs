//! A stroke of the network becomes a corridor, and its edges spans of stations.
//!
//! Certified is only what lies between a stroke's first and last edge; approach, lead-in and tail are driven. An edge that the
//! extract cuts is entered straight, like any first edge. Left out: turns off the stroke, which have corridors of their own.

use super::frame::Frame;
use super::polyline::Polyline;
use super::profile::{Across, Gap, Stretch, limit_offset, profile};
use super::resample::{ArcLength, LEAST_OFFSET_FACTOR, Track};
use super::smooth::{Smoothed, Smoothing, smooth};
use super::{Corridor, EdgeSpan, Params, StrokeCorridor};
use crate::network::{Edge, Network, Stroke};
use crate::osm::LonLat;
use crate::osm::facts::{Direction, Policy, Strip};
use crate::verdict::UnknownReason;

/// Nothing shorter has a direction worth the name, metres.
const LEAST_LENGTH_M: f64 = 2.0;
/// Shorter edges carry no station of their own, metres.
const LEAST_EDGE_M: f64 = 0.01;
/// Driven after the turn that counts: longer than any catalogued vehicle, so that its last unit leaves the turn too, metres.
const TAIL_M: f64 = 60.0;
/// Smoothed with a closed stroke beyond its tail, so that the free end is far from what counts, metres.
const BEYOND_M: f64 = 150.0;
/// Turns round a closed stroke at most, before and after.
const MOST_TURNS: usize = 12;
/// |c′| is 1 but for smoothing; below this the line folds back on itself.
const LEAST_SPEED: f64 = 0.3;
/// |κ|·half-width from which normals as good as cross inside the corridor.
const MOST_CROSSING: f64 = 0.98;

/// An edge of the chain: where it is in the frame, what it offers.
struct Link<'n> {
    index: u32,
    edge: &'n Edge,
    points: Vec<[f64; 2]>,
    /// Strip, and what it may shift across.
    room: Option<(Across, Across)>,
}

/// A link on the line that is smoothed, at arc lengths `from..to`; the same link may come several times.
struct Piece {
    link: usize,
    counted: bool,
    from: f64,
    to: f64,
}

/// The line of the chain, as driven.
struct Course {
    line: Polyline,
    pieces: Vec<Piece>,
    /// The corridor ends here; what follows is for smoothing only.
    end: f64,
}

/// The corridor of a stroke, in a metric frame of its own.
///
/// Fails only where nothing can be said of any of its edges: shorter than two metres, folded, wider than a metric frame
/// (`Geometry`), or without any width (`Width`). One bad edge among good ones is `unknown` in its span.
pub fn stroke_corridor(
    network: &Network,
    stroke: &Stroke,
    policy: Policy,
    params: &Params,
) -> Result<StrokeCorridor, UnknownReason> {
    let (mut links, approach) = links(network, stroke, policy, params)?;
    if stroke.closed {
        // A loop is its own approach.
        links.drain(..approach);
    }
    let course = if stroke.closed { closed_course(&links, params) } else { open_course(&links, approach) };
    if course.line.length() < LEAST_LENGTH_M {
        return Err(UnknownReason::Geometry);
    }
    let asked = Smoothing { tolerance_m: params.tolerance_m, cutoff_m: params.cutoff_m };
    let smoothed = smooth(&course.line, asked);
    let stretches = stretches(&links, &course.pieces).ok_or(UnknownReason::Width)?;
    let mut profile = profile(&stretches, &gaps(network, &links, &course, &smoothed));
    let folded = limit_offset(&mut profile, &smoothed.curve, 1.0 - LEAST_OFFSET_FACTOR, LEAST_SPEED);

    let track = Track { curve: &|u| smoothed.curve.at(u), profile: &profile };
    let (corridor, arc) = track.resample(0.0, course.end, params.spacing_m);
    if !(arc.total() >= 0.5 * LEAST_LENGTH_M && all_finite(&corridor)) {
        return Err(UnknownReason::Geometry);
    }
    let cut =
        Cut { corridor: &corridor, arc: &arc, smoothed: &smoothed, folded: &folded, torn: &corridor.torn(), params };
    let spans = course.pieces.iter().filter(|p| p.counted).map(|p| cut.span(p, &links[p.link])).collect();
    Ok(StrokeCorridor { corridor, spans })
}

/// What a span is cut from.
struct Cut<'c> {
    corridor: &'c Corridor,
    arc: &'c ArcLength,
    smoothed: &'c Smoothed,
    folded: &'c [f64],
    torn: &'c [usize],
    params: &'c Params,
}

impl Cut<'_> {
    fn span(&self, piece: &Piece, link: &Link<'_>) -> EdgeSpan {
        let c = self.corridor;
        let last = c.len() - 1;
        let first = ((self.arc.at(piece.from) / c.spacing_m).floor() as usize).min(last);
        let end = ((self.arc.at(piece.to) / c.spacing_m).ceil() as usize).clamp(first, last);
        let centreline_deviation_m = self.smoothed.deviation_m(piece.from, piece.to);
        let sharpest = c.curvature[first..=end].iter().fold(0.0_f64, |k, c| k.max(c.abs()));
        let broken = piece.to - piece.from < LEAST_EDGE_M
            || centreline_deviation_m > self.params.tolerance_m
            || (first..=end).any(|i| c.curvature[i].abs() * c.left_m[i].max(c.right_m[i]) > MOST_CROSSING)
            || self.torn.iter().any(|k| (first..=end).contains(k))
            || self.folded.iter().any(|&u| u >= piece.from && u <= piece.to);
        EdgeSpan {
            edge: link.index,
            stations: first..end + 1,
            min_radius_m: 1.0 / sharpest,
            centreline_deviation_m,
            unknown: match (broken, link.room) {
                (true, _) => Some(UnknownReason::Geometry),
                (false, None) => Some(UnknownReason::Width),
                (false, Some(_)) => None,
            },
        }
    }
}

fn all_finite(c: &Corridor) -> bool {
    [&c.x, &c.y, &c.heading, &c.curvature, &c.left_m, &c.right_m].iter().all(|v| v.iter().all(|x| x.is_finite()))
}

/// Approach and edges of the stroke in the frame, and how many are approach.
fn links<'n>(
    network: &'n Network,
    stroke: &Stroke,
    policy: Policy,
    params: &Params,
) -> Result<(Vec<Link<'n>>, usize), UnknownReason> {
    let range = |r: &std::ops::Range<u32>| network.stroke_edges.get(r.start as usize..r.end as usize);
    let (Some(approach), Some(edges)) = (range(&stroke.approach), range(&stroke.edges)) else {
        return Err(UnknownReason::Geometry);
    };
    if edges.is_empty() {
        return Err(UnknownReason::Geometry);
    }
    let chain: Vec<u32> = approach.iter().chain(edges).copied().collect();
    let mut positions: Vec<LonLat> = Vec::new();
    let mut ends = Vec::with_capacity(chain.len());
    for &index in &chain {
        positions.extend(network.positions(&network.edges[index as usize]));
        ends.push(positions.len());
    }
    let metric = Frame::around(&positions).and_then(|frame| frame.forward(&positions));
    let metric = metric.map_err(|_| UnknownReason::Geometry)?;
    let mut start = 0;
    let links = chain
        .iter()
        .zip(ends)
        .map(|(&index, end)| {
            let edge = &network.edges[index as usize];
            let points = metric[start..end].to_vec();
            start = end;
            Link { index, edge, points, room: room(network, edge, policy, params.map_tolerance_m) }
        })
        .collect();
    Ok((links, approach.len()))
}

/// The strip of an edge under a policy, and what it may shift across: a lane, within the lanes of its direction.
fn room(network: &Network, edge: &Edge, policy: Policy, map_tolerance_m: f64) -> Option<(Across, Across)> {
    let section = network.road(edge).sections[usize::from(edge.direction == Direction::Backward)];
    let across = |strip: Strip| {
        let (left_m, right_m) = (f64::from(strip.left_m), f64::from(strip.right_m));
        let usable = (left_m - right_m).is_finite() && left_m > right_m;
        usable.then_some(Across { left_m: left_m - map_tolerance_m, right_m: right_m + map_tolerance_m })
    };
    let strip = section.strip(policy).and_then(across)?;
    let wider = (policy == Policy::Lane).then_some(section.direction).flatten().and_then(across);
    Some((strip, wider.filter(|w| strip.within(*w)).unwrap_or(strip)))
}

fn open_course(links: &[Link<'_>], approach: usize) -> Course {
    let mut course = Course { line: Polyline::default(), pieces: Vec::with_capacity(links.len()), end: 0.0 };
    for link in 0..links.len() {
        course.drive(links, link, link >= approach);
    }
    course.end = course.line.length();
    course
}

/// Unrolls a loop: enough of its edges before the turn that counts that a vehicle enters it in full articulation, and
/// enough after it that its last unit leaves it.
fn closed_course(links: &[Link<'_>], params: &Params) -> Course {
    let n = links.len();
    let length = |link: usize| -> f64 {
        links[link].points.windows(2).map(|w| (w[1][0] - w[0][0]).hypot(w[1][1] - w[0][1])).sum()
    };
    let count = |asked_m: f64, nth: &dyn Fn(usize) -> usize| {
        let mut sum = 0.0;
        (0..MOST_TURNS * n)
            .take_while(|&i| {
                let more = sum < asked_m;
                sum += length(nth(i));
                more
            })
            .count()
    };
    let before = count(params.lead_in_m, &|i| n - 1 - i % n);
    let tail = count(TAIL_M, &|i| i % n);
    let beyond = count(TAIL_M + BEYOND_M, &|i| i % n);
    let mut course = Course { line: Polyline::default(), pieces: Vec::with_capacity(before + n + beyond), end: 0.0 };
    for i in 0..before {
        course.drive(links, n - 1 - (before - 1 - i) % n, false);
    }
    for link in 0..n {
        course.drive(links, link, true);
    }
    for i in 0..beyond {
        if i == tail {
            course.end = course.line.length();
        }
        course.drive(links, i % n, false);
    }
    if course.end <= 0.0 {
        course.end = course.line.length();
    }
    course
}

impl Course {
    fn drive(&mut self, links: &[Link<'_>], link: usize, counted: bool) {
        let mut points = links[link].points.iter();
        let from = points.next().map_or(0.0, |&p| self.line.push(p));
        let to = points.fold(from, |_, &p| self.line.push(p));
        self.pieces.push(Piece { link, counted, from, to });
    }
}

/// One stretch a piece; a piece without width goes on with the one before it, else with the next: it is `unknown` itself, but
/// its neighbours' vehicles drive over it. `None` without any width.
fn stretches(links: &[Link<'_>], pieces: &[Piece]) -> Option<Vec<Stretch>> {
    let mut known = pieces.iter().find_map(|p| links[p.link].room)?;
    let stretches = pieces.iter().map(|piece| {
        known = links[piece.link].room.unwrap_or(known);
        Stretch { from: piece.from, to: piece.to, strip: known.0, shift: known.1 }
    });
    Some(stretches.collect())
}

/// Narrow places of all pieces: passages centred on the map's vertex, which the smoothed line passes a little to one side.
fn gaps(network: &Network, links: &[Link<'_>], course: &Course, smoothed: &Smoothed) -> Vec<Gap> {
    let mut gaps = Vec::new();
    for piece in &course.pieces {
        let link = &links[piece.link];
        let range = link.edge.narrowings.start as usize..link.edge.narrowings.end as usize;
        for narrowing in network.narrowings.get(range).unwrap_or_default() {
            let last = link.points.len() - 1;
            let vertex = (narrowing.vertex as usize).min(last);
            let vertex = if link.edge.direction == Direction::Forward { vertex } else { last - vertex };
            let mut way = Polyline::default();
            let along = link.points[..=vertex].iter().fold(0.0, |_, &p| way.push(p));
            let at = piece.from + along;
            let [c, d, ..] = smoothed.curve.at(at);
            let off = [link.points[vertex][0] - c[0], link.points[vertex][1] - c[1]];
            let lateral = (d[0] * off[1] - d[1] * off[0]) / d[0].hypot(d[1]).max(LEAST_SPEED);
            let half = 0.5 * f64::from(narrowing.passage_m).max(0.0);
            gaps.push(Gap { at, room: Across { left_m: lateral + half, right_m: lateral - half } });
        }
    }
    gaps
}
