//! Joins the stations of strokes and turns into one corridor for a whole route, in one metric frame.
//!
//! The centreline is the cubic spline through the stations of the pieces, and the corridor is nowhere wider than its piece.
//! The vehicle enters straight where the route begins. A route that begins within a turn's reach begins with the turn. Two
//! turns that share a short stretch of road are blended there, within the width of both. If pieces cannot be joined, the error
//! names the place.

use std::ops::Range;

use super::blend::{self, BlendPoint};
use super::drive::{Drive, Join};
use super::grounds::TurnArea;
use super::pieces::{Menu, Strokes, TurnPiece};
use crate::corridor::{CentrelineError, Corridor, Frame, FrameError, open_ends};
use crate::network::{EdgeNo, Movement, MovementKind, Movements, Network, PassageKind};
use crate::osm::LonLat;
use crate::osm::facts::Policy;
use crate::stop::{Stop, Stopped};
use crate::turns::{Joint, LengthClass, Opening, StrokeLine, cut_out_of_route};
use crate::verdict::UnknownReason;

/// The greatest spacing of the route's stations, metres, as on strokes. A route with a sharp turn has the turn's spacing.
const SPACING_M: f64 = 1.0;
/// The least spacing of the route's stations, metres.
const LEAST_SPACING_M: f64 = 0.25;
/// Points that are closer than this are merged, metres.
const LEAST_STEP_M: f64 = 0.3;
/// The least number of stations. A shorter route begins earlier or ends later on its edge.
const LEAST_STATIONS: usize = 12;

/// The kind of a part of a route.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum PartKind {
    /// Along an edge.
    Edge(EdgeNo),
    /// From one edge into another at a junction, or over several nodes ([`passes_over`]).
    Turn {
        /// The edge that the vehicle comes from.
        from: EdgeNo,
        /// The edge that the vehicle goes into.
        to: EdgeNo,
    },
}

impl PartKind {
    /// Whether it is a turn or a passage.
    #[must_use]
    pub fn is_turn(self) -> bool {
        matches!(self, Self::Turn { .. })
    }
}

/// A stretch of a route.
#[derive(Debug, Clone, PartialEq)]
pub struct RoutePart {
    /// The kind of the part.
    pub kind: PartKind,
    /// The part's stations in the route's corridor. Neighbouring parts share their end stations.
    pub stations: Range<usize>,
}

/// A route as one corridor.
#[derive(Debug, Clone, PartialEq)]
pub struct RoutePath {
    /// The corridor, in metres of `frame`.
    pub corridor: Corridor,
    /// The metric frame of the corridor.
    pub frame: Frame,
    /// The parts in driving order.
    pub parts: Vec<RoutePart>,
}

/// Why a route's pieces give no corridor.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AssemblyError {
    /// A piece has no corridor.
    #[error("a piece of the route has no corridor")]
    Unknown {
        /// The piece.
        at: PartKind,
        /// The reason.
        reason: UnknownReason,
    },
    /// Two turns cannot be driven one after the other on the road between them.
    #[error("two turns follow each other so closely that no path leads from one into the other")]
    Overlap {
        /// The earlier one.
        before: PartKind,
        /// The later one.
        at: PartKind,
    },
    /// The route does not fit into one metric frame.
    #[error("the route spans more than one metric frame: {0}; plan it as several shorter routes and certify each")]
    Frame(#[from] FrameError),
    /// The caller cancelled the work.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// No centreline leads through the stations.
    #[error("the route's pieces make no smooth line: {error}")]
    Centreline {
        /// The turn nearest to the place where the line bends most.
        at: PartKind,
        /// What is wrong with the line.
        error: CentrelineError,
    },
}

/// The kind of the passage that a part is. `None` if the edge that the vehicle goes into starts where the other edge ends.
#[must_use]
pub fn passes_over(network: &Network, at: PartKind) -> Option<PassageKind> {
    let PartKind::Turn { from, to } = at else { return None };
    let edge = |edge: EdgeNo| network.edges.get(edge.index());
    let (from, to) = (edge(from)?, edge(to)?);
    if from.to_node == to.from_node {
        return None;
    }
    let at_node = network.crossings.at(from.to_node).iter().filter_map(|&other| edge(other));
    let on_ring = at_node.into_iter().any(|other| network.road(other).roundabout);
    Some(if on_ring { PassageKind::Roundabout } else { PassageKind::Complex })
}

/// The edges of a route, with its beginning and end on the first and last edge.
#[derive(Debug, Clone, PartialEq)]
pub struct DrivenWay<'w> {
    /// The edges.
    pub drive: &'w Drive,
    /// The share of the first edge before the route's beginning, 0..=1.
    pub start: f64,
    /// The share of the last edge up to the route's end, 0..=1.
    pub end: f64,
}

/// Joins the pieces of a way into one corridor. `stop` is checked before each turn and each leg.
///
/// # Errors
/// See [`AssemblyError`].
pub fn assemble(
    network: &Network,
    movements: &Movements,
    strokes: &mut Strokes,
    menu: &mut Menu,
    way: &DrivenWay<'_>,
    stop: &Stop,
) -> Result<RoutePath, AssemblyError> {
    let edges = &way.drive.edges;
    let positions: Vec<LonLat> =
        edges.iter().flat_map(|&edge| network.positions(&network.edges[edge.index()])).collect();
    let frame = Frame::around(&positions)?;
    frame.forward(&positions)?;
    let mut between = Vec::new();
    let mut legs = Vec::new();
    let mut first = 0;
    for Join { from, arcs, to, at: next } in way.drive.joins() {
        let at = PartKind::Turn { from, to };
        let movement = movement(movements, from, arcs, to)
            .ok_or(AssemblyError::Unknown { at, reason: UnknownReason::Geometry })?;
        if movement.kind == MovementKind::StraightOn {
            continue;
        }
        stop.check()?;
        legs.push(first..next - arcs.len());
        first = next;
        let piece = menu.chosen(strokes, &movement, arcs).map_err(|reason| AssemblyError::Unknown { at, reason })?;
        between.push(Between {
            at,
            spacing_m: piece.corridor.spacing_m,
            samples: in_frame(&piece, frame)?,
            ground: TurnArea::of(&piece, frame)?,
            approach: piece.approach,
            departure: piece.departure,
            reach: piece.reach,
            strip: piece.strip,
        });
    }
    legs.push(first..edges.len());
    let mut string = Strung::default();
    for (i, leg) in legs.iter().enumerate() {
        let before = i.checked_sub(1).and_then(|i| between.get(i));
        let after = between.get(i);
        stop.check()?;
        let leg = Leg::new(strokes, way, leg.clone(), frame, before, after)?;
        leg.add(&mut string, before, after)?;
    }
    let finest_m = between.iter().map(|turn| turn.spacing_m).fold(SPACING_M, f64::min);
    stop.check()?;
    let mut path = string.finish(frame, finest_m.max(LEAST_SPACING_M), &between)?;
    cut_out_of_route(network, frame, &mut path.corridor.areas)?;
    Ok(path)
}

/// The movement from one edge into the next, or over the arcs between them. A way may lead over arcs that are no passage of the
/// network, if its steps are lawful one by one.
pub(super) fn movement(movements: &Movements, from: EdgeNo, arcs: &[EdgeNo], to: EdgeNo) -> Option<Movement> {
    if arcs.is_empty() {
        return movements.between(from, to).copied();
    }
    let passage = movements.passage(from, to).and_then(|place| movements.passages().get(place));
    let forbidden = passage.filter(|passage| passage.through == arcs).and_then(|passage| passage.forbidden);
    Some(Movement { from, to, kind: MovementKind::Turn, forbidden })
}

/// A turn of the route, in the route's frame.
struct Between {
    at: PartKind,
    spacing_m: f64,
    samples: Vec<BlendPoint>,
    ground: Option<TurnArea>,
    approach: Joint,
    departure: Joint,
    reach: LengthClass,
    strip: Policy,
}

fn in_frame(piece: &TurnPiece, frame: Frame) -> Result<Vec<BlendPoint>, FrameError> {
    samples(&piece.corridor, piece.turn.clone(), piece.frame, frame)
}

/// Stations of a corridor, converted from its own frame into the route's frame.
fn samples(c: &Corridor, stations: Range<usize>, own: Frame, frame: Frame) -> Result<Vec<BlendPoint>, FrameError> {
    let stations = stations.start.min(c.len())..stations.end.min(c.len());
    let mut at: Vec<[f64; 2]> = stations.clone().map(|k| [c.x[k], c.y[k]]).collect();
    if own != frame {
        let degrees = own.inverse(&at)?;
        at = frame.forward_degrees(degrees.into_iter().map(|[lon, lat]| (lon, lat)).collect())?;
    }
    Ok(stations.zip(at).map(|(k, at)| BlendPoint { at, left_m: c.left_m[k], right_m: c.right_m[k] }).collect())
}

/// The number of stations of one round of a loop, from the beginning of its first edge back to that place. The last edge ends
/// within a station of that place, and stations of successive rounds differ by at most half a station.
fn round(line: &StrokeLine) -> usize {
    let (c, spans) = (&line.made.corridor, &line.made.spans);
    let first = spans.first().map_or(0, |span| span.stations.start);
    let end = spans.last().map_or(0, |span| span.stations.end.saturating_sub(1));
    let off = |k: &usize| (c.x[*k] - c.x[first]).hypot(c.y[*k] - c.y[first]);
    let again = (end.saturating_sub(3)..(end + 4).min(c.len())).min_by(|a, b| off(a).total_cmp(&off(b)));
    again.map_or(0, |again| again.saturating_sub(first))
}

/// A run of edges straight on along one stroke: stations `from..=to` of an unrolled corridor.
struct Leg {
    /// All stations that may be needed, in the route's frame, from station `first` on.
    samples: Vec<BlendPoint>,
    first: usize,
    from: usize,
    to: usize,
    /// Each edge with its last station.
    edges: Vec<(EdgeNo, usize)>,
}

impl Leg {
    fn new(
        strokes: &mut Strokes,
        way: &DrivenWay<'_>,
        range: Range<usize>,
        frame: Frame,
        before: Option<&Between>,
        after: Option<&Between>,
    ) -> Result<Self, AssemblyError> {
        let edges = &way.drive.edges[range.clone()];
        let unknown = |edge: EdgeNo, reason| AssemblyError::Unknown { at: PartKind::Edge(edge), reason };
        let first_edge = edges.first().copied().unwrap_or(EdgeNo::new(0));
        let (stroke, _) = strokes.of(first_edge).ok_or_else(|| unknown(first_edge, UnknownReason::Geometry))?;
        let places: Vec<u32> = edges.iter().filter_map(|&edge| strokes.of(edge)).map(|place| place.1).collect();
        let line = strokes.line(stroke).map_err(|reason| unknown(first_edge, reason))?;
        let closed = strokes.closed(stroke);
        let (corridor, spans) = (&line.made.corridor, &line.made.spans);
        let last_station = corridor.len() - 1;
        // A loop is unrolled: the edges before the place where it closes are taken one round earlier, from its lead-in.
        let round = if closed { round(line.as_ref()) } else { 0 };
        let closes = |i: usize| places[i..].windows(2).filter(|pair| pair[1] <= pair[0]).count();
        let earlier = |i: usize| round * closes(i);
        let span = |i: usize| {
            let stations = spans.get(places[i] as usize).map(|span| span.stations.clone());
            let stations = stations.ok_or_else(|| unknown(edges[i], UnknownReason::Geometry))?;
            let back = earlier(i);
            // If a loop is longer than its lead-in, no leg can pass the loop's beginning.
            if stations.start < back {
                return Err(unknown(edges[i], UnknownReason::Geometry));
            }
            Ok(stations.start - back..stations.end - back)
        };
        for (i, &edge) in edges.iter().enumerate() {
            if let Some(reason) = spans.get(places[i] as usize).and_then(|span| span.unknown) {
                return Err(unknown(edge, reason));
            }
        }
        let within = |i: usize, share: f64| -> Result<usize, AssemblyError> {
            let span = span(i)?;
            Ok(span.start + ((span.len() - 1) as f64 * share).round() as usize)
        };
        let joined = |joint: &Joint, i: usize| joint.station.checked_sub(earlier(i));
        let last = edges.len() - 1;
        let mut from = match before {
            Some(turn) => joined(&turn.departure, 0).ok_or(AssemblyError::Overlap { before: turn.at, at: turn.at })?,
            None => within(0, way.start)?,
        };
        let mut to = match after {
            Some(turn) => {
                joined(&turn.approach, last).ok_or(AssemblyError::Overlap { before: turn.at, at: turn.at })?
            }
            None => within(last, way.end)?,
        };
        if before.is_none() {
            from = from.min(to.saturating_sub(if after.is_none() { LEAST_STATIONS } else { 0 }));
        }
        if after.is_none() {
            to = to.max((from + if before.is_none() { LEAST_STATIONS } else { 0 }).min(last_station));
        }
        let (low, high) = (from.min(to), from.max(to).min(last_station));
        let mut samples = samples(corridor, low..high + 1, line.made.frame, frame)?;
        // As in the turns' own certificates, their strip counts before and after them.
        let metres = |stations: usize| stations as f64 * corridor.spacing_m;
        for (station, sample) in (low..).zip(&mut samples) {
            let opening = |turn: Option<&Between>, of: &dyn Fn(LengthClass) -> Opening| {
                let (strip, opening) = turn.map_or((Policy::Lane, Opening::NONE), |turn| (turn.strip, of(turn.reach)));
                line.half_widths(strip, station, opening)
            };
            let after_turn = opening(before, &|reach| reach.opening_after(metres(station.saturating_sub(from))));
            let before_turn = opening(after, &|reach| reach.opening_before(metres(to.saturating_sub(station))));
            [sample.left_m, sample.right_m] = [0, 1].map(|side| after_turn[side].max(before_turn[side]));
        }
        let ends = (0..edges.len()).map(|i| Ok((edges[i], span(i)?.end - 1))).collect::<Result<_, AssemblyError>>()?;
        Ok(Self { samples, first: low, from, to: to.min(last_station), edges: ends })
    }

    /// Appends the leg's stations and the turn after it. The turn before it has been added already; if the two turns overlap,
    /// the shared stretch is blended.
    fn add(&self, string: &mut Strung, before: Option<&Between>, after: Option<&Between>) -> Result<(), AssemblyError> {
        if self.from <= self.to {
            // At a joint, the turn's own last station replaces the stroke's station.
            let from = self.from + usize::from(before.is_some());
            let to = (self.to + 1).saturating_sub(usize::from(after.is_some()));
            for station in from..to {
                string.push(PartKind::Edge(self.edge_at(station)), self.samples[station - self.first]);
            }
            if let Some(turn) = after {
                turn.samples.iter().for_each(|&sample| string.push(turn.at, sample));
            }
            return Ok(());
        }
        let (Some(before), Some(after)) = (before, after) else { return Ok(()) };
        let overlap = AssemblyError::Overlap { before: before.at, at: after.at };
        let blended = blend::blend(&before.samples, &after.samples, &self.samples).ok_or(overlap.clone())?;
        if !string.drop_last(before.at, blended.dropped_before) {
            return Err(overlap);
        }
        for (i, &sample) in blended.samples.iter().enumerate() {
            string.push(PartKind::Edge(self.edge_at(self.first + i)), sample);
        }
        after.samples.iter().skip(blended.dropped_after).for_each(|&sample| string.push(after.at, sample));
        Ok(())
    }

    fn edge_at(&self, station: usize) -> EdgeNo {
        let at = self.edges.iter().find(|(_, end)| station <= *end).or(self.edges.last());
        at.map_or(EdgeNo::new(0), |edge| edge.0)
    }
}

/// The points so far.
#[derive(Default)]
struct Strung {
    samples: Vec<BlendPoint>,
    kinds: Vec<PartKind>,
}

impl Strung {
    /// Appends a point. A point close to the last one is merged with it, with the lesser half-widths.
    fn push(&mut self, kind: PartKind, sample: BlendPoint) {
        if let Some(last) = self.samples.last_mut()
            && (sample.at[0] - last.at[0]).hypot(sample.at[1] - last.at[1]) < LEAST_STEP_M
        {
            last.left_m = last.left_m.min(sample.left_m);
            last.right_m = last.right_m.min(sample.right_m);
            return;
        }
        self.samples.push(sample);
        self.kinds.push(kind);
    }

    /// Removes the last `count` points of a turn. Returns false, and removes nothing, unless points of the turn remain.
    fn drop_last(&mut self, kind: PartKind, count: usize) -> bool {
        let own = self.kinds.iter().rev().take_while(|&&k| k == kind).count();
        if count >= own {
            return false;
        }
        let left = self.samples.len() - count;
        self.samples.truncate(left);
        self.kinds.truncate(left);
        true
    }

    /// The turn nearest to a point; without turns, the point's own edge.
    fn turn_at(&self, point: usize) -> PartKind {
        let turns = self.kinds.iter().enumerate().filter(|(_, kind)| matches!(kind, PartKind::Turn { .. }));
        let nearest = turns.min_by_key(|(i, _)| i.abs_diff(point)).map(|(_, kind)| *kind);
        nearest.or_else(|| self.kinds.get(point).copied()).unwrap_or(PartKind::Edge(EdgeNo::new(0)))
    }

    fn finish(self, frame: Frame, spacing_m: f64, turns: &[Between]) -> Result<RoutePath, AssemblyError> {
        let column = |of: fn(&BlendPoint) -> f64| self.samples.iter().map(of).collect::<Vec<f64>>();
        let points: Vec<[f64; 2]> = self.samples.iter().map(|sample| sample.at).collect();
        let (left_m, right_m) = (column(|s| s.left_m), column(|s| s.right_m));
        let mut corridor = crate::corridor::from_centreline(&points, &left_m, &right_m, 0.0, spacing_m)
            .map_err(|error| AssemblyError::Centreline { at: self.turn_at(sharpest(&points)), error })?;
        // Chords are shorter than arcs by some thousandths in the sharpest bends, which is exact enough to find the part.
        let mut along = Vec::with_capacity(points.len());
        let mut sum = 0.0;
        for (i, point) in points.iter().enumerate() {
            let before = points[i.saturating_sub(1)];
            sum += (point[0] - before[0]).hypot(point[1] - before[1]);
            along.push(sum);
        }
        let last = corridor.len() - 1;
        let station = |i: usize| (along[i] / sum * last as f64).round() as usize;
        let mut parts: Vec<RoutePart> = Vec::new();
        for (i, &kind) in self.kinds.iter().enumerate() {
            match parts.last_mut() {
                Some(part) if part.kind == kind => part.stations.end = station(i) + 1,
                Some(part) => {
                    let start = station(i);
                    part.stations.end = start + 1;
                    parts.push(RoutePart { kind, stations: start..start + 1 });
                }
                None => parts.push(RoutePart { kind, stations: 0..1 }),
            }
        }
        if let Some(part) = parts.last_mut() {
            part.stations.end = last + 1;
        }
        let mut turns = turns.iter();
        for part in parts.iter().filter(|part| matches!(part.kind, PartKind::Turn { .. })) {
            // Every turn of the way keeps a part, in the same order.
            let Some(turn) = turns.by_ref().find(|turn| turn.at == part.kind) else { break };
            let span = turn.ground.as_ref().map(|ground| ground.along(&corridor, &part.stations));
            corridor.areas.extend(span);
        }
        open_ends(&mut corridor, [true; 2]);
        Ok(RoutePath { corridor, frame, parts })
    }
}

/// The index of the point at which a line turns most.
fn sharpest(points: &[[f64; 2]]) -> usize {
    let turn = |w: &[[f64; 2]]| {
        let [u, v] = [[w[1][0] - w[0][0], w[1][1] - w[0][1]], [w[2][0] - w[1][0], w[2][1] - w[1][1]]];
        (u[0] * v[1] - u[1] * v[0]).atan2(u[0] * v[0] + u[1] * v[1]).abs()
    };
    let turns = points.windows(3).map(turn).enumerate();
    turns.max_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(before, _)| before + 1)
}
