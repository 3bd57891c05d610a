//! Leeway in the plane (docs/proof.md, section 11): where a corridor has areas, bodies are held against their boundary instead
//! of the corridor's edges.
//!
//! At the foot of its axle a unit deviates across its heading and in its heading, and not along. The leeway of a piece of its side is
//! the distance of the piece from a segment of the boundary, less what the piece may move in the direction of that segment.

mod ground;

use std::cell::RefCell;
use std::sync::Arc;

use netcert_base::corridor::{Area, AreaSpan, Corridor};

use super::block::{BARELY_CLOSED_RAD, BLOCK, Minima, row};
use super::body::{Body, FRESH, Point as BodyPoint, least};
use super::lanes::{LANES, tagged};
use super::model::MAX_POINTS;
use super::track::Track;
use ground::{Ground, Point, Swept};

/// Sides are covered in pieces no longer than this, metres. The hull of a piece over a step is little larger than what the piece
/// sweeps.
const PIECE_M: f64 = 1.4;
/// Share by which the motion's second derivative, taken at the stations, may be greater between them.
const BETWEEN: f64 = 1.25;
/// Leeway where nothing is bounded. It is above the mark for a missing bound, which the hinges set.
const FAR_OUTSIDE_M: f64 = -300.0;
/// Leeways that differ by less are measured where only the least one counts, metres: rounding decides between them.
const SAME_M: f64 = 1e-9;
/// Directions at a smaller sine to the heading meet the axis too far away.
const OBLIQUE: f64 = 0.05;
/// A function lies above its chord over a step, less this share of its second derivative times the square of the step.
const CHORD: f64 = 0.125;
/// Stands for a gap of zero in a denominator, metres.
const NO_GAP_M: f64 = 1e-9;
/// A foot goes on to the next station when its point is farther than this share of the spacing: the middle, and a little more, so that
/// rounding does not send it to and fro.
const PAST_MIDDLE: f64 = 0.55;
/// Most stations walked to find the foot of a body point.
const MOST_STEPS: usize = 16;

/// A span of stations of the steer axle, with its area.
#[derive(Clone)]
struct Window {
    /// First and last extended station.
    first: usize,
    last: usize,
    /// `None` where the area cannot be used: nothing is inside.
    ground: Option<Arc<Ground>>,
}

/// Areas whose boundaries have been prepared. Paths of one junction share its area.
#[derive(Default)]
pub struct Grounds(RefCell<Vec<Prepared>>);

type Prepared = (Arc<Area>, Option<Arc<Ground>>);

impl Grounds {
    fn of(&self, area: &Arc<Area>) -> Option<Arc<Ground>> {
        if let Some((_, ground)) = self.0.borrow().iter().find(|(known, _)| Arc::ptr_eq(known, area)) {
            return ground.clone();
        }
        let ground = Ground::new(area).map(Arc::new);
        self.0.borrow_mut().push((Arc::clone(area), ground.clone()));
        ground
    }
}

/// The areas of a corridor, prepared for its extended stations.
pub(super) struct Areas(Vec<Window>);

impl Areas {
    pub(super) fn new(corridor: &Corridor, lead: usize, grounds: &Grounds) -> Self {
        let last = corridor.len().saturating_sub(1);
        let window = |span: &AreaSpan| Window {
            first: lead + span.heads.start.min(last),
            last: lead + span.heads.end.saturating_sub(1).min(last),
            ground: grounds.of(&span.area),
        };
        Self(corridor.areas.iter().map(window).collect())
    }

    /// The areas for every second station.
    pub(super) fn coarse(&self, first: usize) -> Self {
        let half = |w: &Window| Window {
            first: w.first.saturating_sub(first).div_ceil(2),
            last: w.last.saturating_sub(first) / 2,
            ground: w.ground.clone(),
        };
        Self(self.0.iter().map(half).collect())
    }

    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The areas that count at all of the given stations of the steer axle.
    fn count(&self, from: usize, to: usize) -> impl Iterator<Item = Option<&Ground>> {
        self.0.iter().filter(move |w| w.first <= from && to <= w.last).map(|w| w.ground.as_deref())
    }

    /// Whether any area counts over the step from station `k` to the next.
    fn over(&self, k: usize) -> bool {
        self.count(k, k + 1).next().is_some()
    }

    /// Whether any area counts near the given stations of the steer axle.
    #[inline(always)]
    pub(super) fn touch(&self, from: usize, to: usize) -> bool {
        self.0.iter().any(|w| w.first <= to && from <= w.last)
    }

    /// Whether areas count from the step before station `from` to the step behind station `to`. The corridor's edges then
    /// do not matter.
    #[inline(always)]
    pub(super) fn replace(&self, from: usize, to: usize) -> bool {
        (from.saturating_sub(1)..=to).all(|k| self.over(k))
    }

    /// Whether an area begins to count at station `k`.
    fn begins(&self, k: usize) -> bool {
        self.0.iter().any(|w| w.first == k)
    }

    /// Whether other areas count over the step from station `k` to the next than over the step before.
    fn changes(&self, k: usize) -> bool {
        self.begins(k) || self.0.iter().any(|w| w.last == k)
    }
}

/// A unit at a head station.
pub(super) struct Stand {
    head: usize,
    axle: Point,
    along: Point,
    /// Way of the axle to the next station, metres, and change of its curvature per metre, 1/m².
    way: f64,
    jerk: f64,
    /// Bounds of how far each body point is off across the nominal heading, to first order, metres; and of the heading, radians.
    across: [f64; MAX_POINTS],
    turned: f64,
}

impl Stand {
    fn place(&self, ahead: f64, aside: f64) -> Point {
        let [x, y] = self.along;
        [self.axle[0] + ahead * x - aside * y, self.axle[1] + ahead * y + aside * x]
    }

    /// The unit at station `k` of the block that begins at station `head`.
    fn read<const REFINED: bool>(body: &Body, block: &[f64], refined: &[f64], head: usize, k: usize) -> Self {
        let at = |field: usize| block[field * BLOCK + k];
        let (extra_axle, extra_coupling, remainder) =
            (at(row::EXTRA_AXLE), at(row::EXTRA_COUPLING), at(row::REMAINDER));
        let a = (extra_axle + extra_coupling) * body.inverse_length + body.heading + remainder;
        let mut across = [0.0; MAX_POINTS];
        for (index, point) in body.points.iter().enumerate() {
            let spot = &point.spot;
            let first_order = if REFINED {
                refined[index * BLOCK + k]
            } else {
                spot.gain + extra_axle * spot.from_axle + extra_coupling * spot.from_coupling
            };
            across[index] = first_order + spot.ahead.abs() * remainder;
        }
        Self {
            head: head + k,
            axle: [at(row::X), at(row::Y)],
            along: [at(row::UX), at(row::UY)],
            way: at(row::WAY2).sqrt(),
            jerk: at(row::JERK),
            across,
            turned: a,
        }
    }
}

/// The least leeway of one unit over a step, by side.
#[derive(Clone, Copy)]
struct Lowest {
    leeway: f64,
    /// The body point near it. `None` while another unit has less leeway.
    point: Option<usize>,
}

impl Lowest {
    fn lower(&mut self, leeway: f64, point: usize) {
        // A NaN, which no input should cause, counts as no room.
        if leeway < self.leeway || leeway.is_nan() {
            *self = Self {
                leeway: if leeway.is_nan() { FAR_OUTSIDE_M } else { leeway.max(FAR_OUTSIDE_M) },
                point: Some(point),
            };
        }
    }
}

/// Lowers `minima` by one unit over eight head stations from `first` on, of the block that begins at `head`. With `alone`, the
/// corridor's edges do not count at these stations, and the feet of the body points are followed here.
#[allow(clippy::too_many_arguments)] // One call per unit and eight stations.
pub(super) fn pass<const CERTIFY: bool, const REFINED: bool>(
    track: &Track,
    body: &mut Body,
    block: &[f64],
    refined: &[f64],
    head: usize,
    first: usize,
    alone: bool,
    minima: &mut Minima,
) {
    let mut feet = [0; MAX_POINTS];
    for (foot, point) in feet.iter_mut().zip(&body.points) {
        *foot = point.foot;
    }
    for station in first..first + LANES {
        let k = station - head;
        let stand = Stand::read::<REFINED>(body, block, refined, head, k);
        for (foot, point) in feet.iter_mut().zip(&body.points) {
            *foot = walked(track, *foot + usize::from(station > first), stand.place(point.spot.ahead, 0.0));
        }
        if CERTIFY {
            if alone {
                let hinge = tagged(block[row::HINGE * BLOCK + k], body.points[0].tag);
                minima.hinge[station] = least(minima.hinge[station], hinge);
                let [from, to] = &mut minima.under[station];
                for &foot in &feet[..body.points.len()] {
                    (*from, *to) = ((*from).min(foot as u32), (*to).max(foot as u32));
                }
            }
            let closes = block[row::HINGE * BLOCK + k] > BARELY_CLOSED_RAD;
            if let Some(before) = body.stood.take().filter(|before| before.head + 1 == station)
                && track.areas.over(before.head)
                && !minima.bare
            {
                let known = (minima.floor + SAME_M).max(minima.keep);
                let known = [0, 1].map(|side| minima.area[side][before.head].min(known));
                let lowest = if closes {
                    let passage = Passage::new(track, (&body.points, body.half_width), &before, &stand);
                    passage.lowest(&mut body.rooms, known)
                } else {
                    [Lowest { leeway: FAR_OUTSIDE_M, point: Some(0) }; 2]
                };
                for (side, lowest) in lowest.into_iter().enumerate() {
                    let Some(point) = lowest.point else { continue };
                    minima.area[side][before.head] = tagged(lowest.leeway, body.points[point].tag);
                    minima.area_foot[side][before.head] = feet[point] as u32;
                    if minima.counted.contains(&before.head) {
                        minima.floor = minima.floor.min(lowest.leeway);
                    }
                }
            }
            body.stood = Some(stand);
        } else {
            plan(track, body, &stand, &feet, minima);
        }
    }
    if alone {
        for (point, foot) in body.points.iter_mut().zip(feet) {
            point.foot = (foot + 1).min(track.len() - LANES);
            point.covered = FRESH;
        }
    }
}

/// A piece of a side between two body points.
struct Piece {
    /// The body point behind it, and the one near it.
    index: usize,
    point: usize,
    /// Its ends, metres ahead of the axle.
    ends: [f64; 2],
    /// 0 left, 1 right.
    side: usize,
}

/// Rooms of a unit's pieces, carried from step to step. A piece that moves by a metre loses at most a metre of room. A piece that slides
/// along its side goes where it was itself and the piece ahead of it, and loses what it moves aside. So most pieces need not be
/// measured in most steps.
pub(super) struct Rooms {
    pieces: Vec<Piece>,
    rooms: Vec<f64>,
    /// The rooms in the step before.
    before: Vec<f64>,
    /// By side: room of its half of the front edge.
    front: [f64; 2],
    /// By side: the piece with the least leeway in the last step. It is measured first.
    critical: [usize; 2],
    /// The station after the last step.
    head: usize,
    /// Without disturbances: the places that were measured last, with their rooms.
    places: Vec<(Point, f64)>,
}

impl Rooms {
    /// The pieces of a side whose body points are at these places, metres ahead of the axle.
    pub(super) fn new(points: &[f64]) -> Self {
        let mut pieces = Vec::new();
        for index in 1..points.len() {
            let (ahead, behind) = (points[index - 1], points[index]);
            let parts = ((ahead - behind) / PIECE_M).ceil().max(1.0);
            for part in 0..parts as usize {
                let [from, to] = [part as f64 / parts, (part + 1) as f64 / parts];
                let ends = [from, to].map(|share| ahead + (behind - ahead) * share);
                let point = if from + to < 1.0 { index - 1 } else { index };
                pieces.extend([0, 1].map(|side| Piece { index, point, ends, side }));
            }
        }
        Self {
            rooms: vec![f64::NEG_INFINITY; pieces.len()],
            before: vec![f64::NEG_INFINITY; pieces.len()],
            pieces,
            front: [f64::NEG_INFINITY; 2],
            critical: [0, 1],
            head: 0,
            places: Vec::new(),
        }
    }

    /// Forgets the rooms unless they are those of the step before station `head`.
    fn enter(&mut self, head: usize, anew: bool) {
        if self.head != head || anew {
            self.rooms.fill(f64::NEG_INFINITY);
            self.front = [f64::NEG_INFINITY; 2];
        }
        self.before.copy_from_slice(&self.rooms);
        self.head = head + 1;
    }

    /// The room of a place without disturbances, unless it is known to be at least `enough`: it falls by no more than the place has moved
    /// since it was measured. Places are numbered.
    fn nominal(&mut self, areas: &Areas, head: usize, (number, p): (usize, Point), enough: f64) -> Option<f64> {
        let known = self.places.get(number);
        if known.is_some_and(|(q, room)| room - ground::apart(*q, p) >= enough) {
            return None;
        }
        let rooms = areas.count(head, head).map(|ground| ground.map_or(FAR_OUTSIDE_M, |ground| ground.room(p)));
        let room = rooms.fold(FAR_OUTSIDE_M, f64::max);
        match self.places.get_mut(number) {
            Some(known) => *known = (p, room),
            None => self.places.push((p, room)),
        }
        Some(room)
    }

    /// The room in the step before of the piece and of the one ahead of it on its side, if the latter is at least this long.
    fn slid(&self, number: usize, slide: f64) -> Option<f64> {
        let (own, ahead) = (self.before.get(number)?, number.checked_sub(2)?);
        (self.pieces[ahead].length() >= slide).then(|| own.min(self.before[ahead]))
    }
}

impl Piece {
    fn length(&self) -> f64 {
        self.ends[0] - self.ends[1]
    }
}

/// One unit over the step between two stations.
struct Passage<'a> {
    areas: &'a Areas,
    points: &'a [BodyPoint],
    half_width: f64,
    before: &'a Stand,
    after: &'a Stand,
    /// Turn of the nominal heading, radians, and way of the axle, metres.
    turn: f64,
    way: f64,
    /// The greater ones of both stations' bounds.
    across: [f64; MAX_POINTS],
    heading: f64,
    /// Most that any place of the body may move in any direction, what it leaves its straight line by included.
    most: f64,
    /// How far both sides slide along themselves at most, and by side how far they move aside. `None` if they do not slide forward, or if
    /// several areas count.
    slide: Option<(f64, [f64; 2])>,
}

impl<'a> Passage<'a> {
    fn new(
        track: &'a Track,
        (points, half_width): (&'a [BodyPoint], f64),
        before: &'a Stand,
        after: &'a Stand,
    ) -> Self {
        let (u, v) = (before.along, after.along);
        let turn = (u[0] * v[1] - u[1] * v[0]).atan2(u[0] * v[0] + u[1] * v[1]).abs();
        let across = std::array::from_fn(|index| before.across[index].max(after.across[index]));
        let way = before.way.max(track.spacing);
        let heading = before.turned.max(after.turned);
        let areas = &track.areas;
        let mut passage =
            Self { areas, points, half_width, before, after, turn, way, across, heading, most: 0.0, slide: None };
        let [front, rear] = [0, points.len() - 1].map(|index| points[index].spot.ahead);
        // Between two points what a place may move is convex.
        let most = points.iter().zip(&passage.across).map(|(point, across)| passage.most(*across, point.spot.ahead));
        passage.most = most.fold(0.0, f64::max) + passage.sag(front).max(passage.sag(rear));
        passage.slide =
            passage.slide([front, rear]).filter(|_| areas.count(before.head, before.head + 1).nth(1).is_none());
        passage
    }

    /// [`Self::slide`] of sides with these ends. What a place moves is linear along its side.
    fn slide(&self, ends: [f64; 2]) -> Option<(f64, [f64; 2])> {
        let [x, y] = self.before.along;
        let moves = |half: f64| {
            ends.map(|ahead| {
                let (p, q) = (self.before.place(ahead, half), self.after.place(ahead, half));
                let d = [q[0] - p[0], q[1] - p[1]];
                [d[0] * x + d[1] * y, d[1] * x - d[0] * y]
            })
        };
        let (left, right) = (moves(self.half_width), moves(-self.half_width));
        let all = || left.iter().chain(&right).map(|[along, _]| *along);
        let aside = [left, right].map(|[front, rear]| front[1].abs().max(rear[1].abs()));
        all().all(|along| along >= 0.0).then(|| (all().fold(0.0, f64::max), aside))
    }

    /// Bound of the first order across the heading, `ahead` metres ahead of the axle. It is convex: chords between body points are
    /// never below it, and it is nowhere steeper than the heading's bound.
    fn across_at(&self, ahead: f64) -> f64 {
        let points = self.points;
        let last = points.len() - 1;
        let (front, rear) = (points[0].spot.ahead, points[last].spot.ahead);
        if ahead >= front {
            return self.across[0] + (ahead - front) * self.heading;
        }
        if ahead <= rear {
            return self.across[last] + (rear - ahead) * self.heading;
        }
        let index = (1..last).find(|&index| points[index].spot.ahead <= ahead).unwrap_or(last);
        let behind = &points[index];
        let share = (ahead - behind.spot.ahead) / behind.gap.max(NO_GAP_M);
        self.across[index] + (self.across[index - 1] - self.across[index]) * share
    }

    /// Most that a place of the body may move in the direction `towards`, a unit vector. In that direction the place moves as the
    /// place of the axis does on which the direction's normal through it meets the axis.
    fn stray(&self, towards: Point, ahead: f64, aside: f64) -> f64 {
        let a = self.heading;
        let in_frame = |u: Point| {
            let (along, across) = (towards[0] * u[0] + towards[1] * u[1], u[0] * towards[1] - u[1] * towards[0]);
            let first = if across.abs() > OBLIQUE {
                across.abs() * self.across_at(ahead - aside * along / across)
            } else {
                across.abs() * self.across_at(ahead) + along.abs() * aside.abs() * a
            };
            // Turning by α draws the place by 1 − cos α towards the axle, along and across.
            let drawn = (-across * aside).max(0.0) + (-along * ahead).max(0.0);
            first + 0.5 * a * a * drawn
        };
        let most = in_frame(self.before.along).max(in_frame(self.after.along));
        // Between both headings.
        most + 0.125 * self.turn * self.turn * (self.across_at(ahead) + aside.abs() * a)
    }

    /// Most that a place may move in any direction.
    fn most(&self, across: f64, ahead: f64) -> f64 {
        let (a, half) = (self.heading, self.half_width);
        let (across, along) = (across + 0.5 * half * a * a, half * a + 0.5 * ahead.abs() * a * a);
        (across * across + along * along).sqrt() * (1.0 + 0.125 * self.turn * self.turn)
    }

    /// How far a point leaves the straight line between its places at both stations: the arc of the axle, the arc of the point around
    /// the axle, and an uneven turn.
    fn sag(&self, ahead: f64) -> f64 {
        let lever = ahead.abs() + self.half_width;
        let uneven = self.before.jerk.max(self.after.jerk) * self.way * self.way;
        CHORD * BETWEEN * (self.way * self.turn + lever * (self.turn * self.turn + uneven))
    }

    /// Room and leeway of a piece that has these ends at both stations: the greatest over the areas.
    fn room(&self, piece: &Swept<'_>, inside: bool) -> (f64, f64) {
        let inside = inside && self.areas.count(self.before.head, self.before.head + 1).nth(1).is_none();
        let rooms = self.areas.count(self.before.head, self.before.head + 1).map(|ground| match ground {
            Some(ground) => ground.swept(piece, inside),
            None => (FAR_OUTSIDE_M, FAR_OUTSIDE_M),
        });
        rooms.fold((FAR_OUTSIDE_M, FAR_OUTSIDE_M), |most, room| (most.0.max(room.0), most.1.max(room.1)))
    }

    /// Room and leeway of the left or right half (0 or 1) of the front edge or the rear edge, at body point `index`, which had this room
    /// in the step before. A leeway of at least `enough` need not be exact.
    fn edge(&self, index: usize, side: usize, known: f64, enough: f64) -> (f64, f64) {
        let half = if side == 0 { self.half_width } else { -self.half_width };
        let ahead = self.points[index].spot.ahead;
        let ends = |stand: &Stand| [half, 0.0].map(|aside| stand.place(ahead, aside));
        let sag = self.sag(ahead);
        let most = self.most(self.across[index], ahead) + sag;
        let (before, after) = (ends(self.before), ends(self.after));
        let left = known - moved(before, after);
        if left - most >= enough {
            return (left, left - most);
        }
        let stray = |towards: Point| [half, 0.0].map(|aside| self.stray(towards, ahead, aside) + sag);
        self.room(&Swept { before, after, most, enough, stray: &stray }, known > 0.0)
    }

    /// Whether something may already be under the body when the first step of an area begins.
    fn blocked(&self) -> bool {
        let (half, last) = (self.half_width, self.points.len() - 1);
        let (front, rear) = (self.points[0].spot.ahead, self.points[last].spot.ahead);
        let corners = [(rear, -half), (front, -half), (front, half), (rear, half)];
        let outline = corners.map(|(ahead, aside)| self.before.place(ahead, aside));
        self.areas
            .count(self.before.head, self.before.head + 1)
            .all(|ground| ground.is_none_or(|ground| ground.under(outline)))
    }

    /// The least leeways, left and right, or those in `known` where they are less.
    fn lowest(&self, rooms: &mut Rooms, known: [f64; 2]) -> [Lowest; 2] {
        let mut lowest = known.map(|leeway| Lowest { leeway, point: None });
        rooms.enter(self.before.head, self.areas.changes(self.before.head));
        if self.areas.begins(self.before.head) {
            let (blocked, last) = (self.blocked(), self.points.len() - 1);
            for (side, lowest) in lowest.iter_mut().enumerate() {
                let edge = || self.edge(last, side, f64::NEG_INFINITY, f64::INFINITY).1;
                let leeway = if blocked { -self.half_width } else { edge() };
                lowest.lower(leeway, last);
            }
        }
        let first = rooms.critical;
        for number in first {
            self.measure(rooms, number, &mut lowest);
        }
        for (side, lowest) in lowest.iter_mut().enumerate() {
            let (room, leeway) = self.edge(0, side, rooms.front[side], lowest.leeway);
            rooms.front[side] = room;
            lowest.lower(leeway, 0);
        }
        for number in (0..rooms.pieces.len()).filter(|number| !first.contains(number)) {
            self.measure(rooms, number, &mut lowest);
        }
        lowest
    }

    /// Lowers the least leeway of a piece's side.
    fn measure(&self, rooms: &mut Rooms, number: usize, lowest: &mut [Lowest; 2]) {
        let Some(piece) = rooms.pieces.get(number) else { return };
        let carried = self.slide.and_then(|(slide, aside)| Some(rooms.slid(number, slide)? - aside[piece.side]));
        let carried = carried.unwrap_or(f64::NEG_INFINITY);
        if carried - self.most >= lowest[piece.side].leeway {
            rooms.rooms[number] = carried;
            return;
        }
        let (index, aside) = (piece.index, if piece.side == 0 { self.half_width } else { -self.half_width });
        let lowest = &mut lowest[piece.side];
        let [ahead, behind] = [index - 1, index].map(|point| self.points[point].spot.ahead);
        let sag = self.sag(ahead).max(self.sag(behind));
        let most = piece.ends.map(|ahead| self.most(self.across_at(ahead), ahead));
        let most = most[0].max(most[1]) + sag;
        let ends = |stand: &Stand| piece.ends.map(|ahead| stand.place(ahead, aside));
        let (before, after) = (ends(self.before), ends(self.after));
        let left = carried.max(rooms.before[number] - moved(before, after));
        rooms.rooms[number] = if left - most >= lowest.leeway {
            left
        } else {
            let stray = |towards: Point| piece.ends.map(|ahead| self.stray(towards, ahead, aside) + sag);
            let swept = Swept { before, after, most, enough: lowest.leeway, stray: &stray };
            let (room, leeway) = self.room(&swept, rooms.before[number] > 0.0);
            if leeway < lowest.leeway {
                rooms.critical[piece.side] = number;
            }
            lowest.lower(leeway, piece.point);
            room
        };
    }
}

/// Most that the room of a piece falls over a step, metres: the hulls of two steps share the piece at the station between them.
fn moved(before: [Point; 2], after: [Point; 2]) -> f64 {
    ground::apart(before[0], after[0]).max(ground::apart(before[1], after[1]))
}

/// Lowers the planning leeways at the feet of a unit's points: the nominal room of the sides between them, less the straight gains.
fn plan(track: &Track, body: &mut Body, stand: &Stand, feet: &[usize; MAX_POINTS], minima: &mut Minima) {
    if track.areas.count(stand.head, stand.head).next().is_none() {
        return;
    }
    let only = !minima.counted.is_empty();
    if track.areas.changes(stand.head) || track.areas.changes(stand.head.saturating_sub(1)) {
        body.rooms.places.clear();
    }
    let mut number = 0;
    for index in 0..body.points.len() {
        let before = index.saturating_sub(1);
        let (ahead, behind) = (&body.points[before], &body.points[index]);
        let (from, to) = (ahead.spot.ahead, behind.spot.ahead);
        let parts = ((from - to) / PIECE_M).ceil().max(1.0);
        for (side, aside) in [body.half_width, -body.half_width].into_iter().enumerate() {
            // The first part begins where the one ahead ends. The first point is a place by itself.
            let places = if index == 0 { 0..=0 } else { 1..=parts as usize };
            for part in places {
                let share = part as f64 / parts;
                let p = stand.place(from + (to - from) * share, aside);
                // Only what is negative or the least is asked for.
                let enough = if only { minima.floor.max(0.0) } else { f64::INFINITY };
                number += 1;
                let room = body.rooms.nominal(&track.areas, stand.head, (number - 1, p), enough);
                let Some(room) = room else { continue };
                let near = if share < 0.5 { before } else { index };
                let point = &body.points[near];
                let leeway = room - point.spot.gain;
                if minima.counted.contains(&stand.head) {
                    minima.floor = minima.floor.min(leeway);
                }
                let tagged = tagged(leeway, point.tag);
                let column = if side == 0 { &mut minima.left } else { &mut minima.right };
                column[feet[near]] = least(column[feet[near]], tagged);
            }
        }
    }
}

/// The station nearest to a place, found by walking from `foot`.
fn walked(track: &Track, foot: usize, [x, y]: Point) -> usize {
    let f = &track.fields;
    let last = track.len() - 1;
    let mut k = foot.min(last);
    let along = |k: usize| (x - f.x[k]) * f.tangent_x[k] + (y - f.y[k]) * f.tangent_y[k];
    for _ in 0..MOST_STEPS {
        let away = along(k);
        if away > PAST_MIDDLE * track.spacing && k < last {
            k += 1;
        } else if away < -PAST_MIDDLE * track.spacing && k > 0 {
            k -= 1;
        } else {
            break;
        }
    }
    k
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
pub(super) mod tests {
    use std::sync::Arc;

    use netcert_base::corridor::{Area, AreaSpan, Corridor, CurvatureProfile};
    use netcert_base::stop::Stop;
    use netcert_base::vehicle::Catalogue;

    use crate::stet::{Certificate, Model, Options, certify, certify_planned, certify_spans};

    const VEHICLES: [&str; 4] = ["EU-SEMI16.5", "US-WB67", "AU-BDOUBLE26", "AU-ATRIPLE53"];

    fn certified(corridor: &Corridor, vehicle: &str) -> Certificate {
        let model = Model::new(Catalogue::builtin().unwrap().get(vehicle).unwrap()).unwrap();
        let fixed = Options { max_shift_m: 0.0, correction_sweeps: 0 };
        certify(corridor, &model, &fixed, &Stop::never()).unwrap().unwrap()
    }

    /// The corridor with its own edges as an area, prolonged straight by `beyond_m`.
    pub(in crate::stet) fn as_area(corridor: &Corridor, beyond_m: f64, heads: std::ops::Range<usize>) -> Corridor {
        let last = corridor.len() - 1;
        let edge = |k: usize, along: f64, aside: f64| {
            let (sin, cos) = corridor.heading[k].sin_cos();
            [corridor.x[k] + along * cos - aside * sin, corridor.y[k] + along * sin + aside * cos]
        };
        let mut ring = vec![edge(0, -beyond_m, -corridor.right_m[0])];
        ring.extend((0..=last).map(|k| edge(k, 0.0, -corridor.right_m[k])));
        ring.push(edge(last, beyond_m, -corridor.right_m[last]));
        ring.push(edge(last, beyond_m, corridor.left_m[last]));
        ring.extend((0..=last).rev().map(|k| edge(k, 0.0, corridor.left_m[k])));
        ring.push(edge(0, -beyond_m, corridor.left_m[0]));
        let area = Arc::new(Area { rings: vec![ring] });
        Corridor { areas: vec![AreaSpan { heads, area }], ..corridor.clone() }
    }

    #[test]
    fn on_a_straight_the_plane_and_the_corridor_agree() {
        let corridor = Corridor::straight(260.0, 2.0, 1.9);
        for vehicle in VEHICLES {
            let by_edges = certified(&corridor, vehicle).result.rsc_m.unwrap();
            let in_area = as_area(&corridor, 90.0, 0..corridor.len());
            let by_area = certified(&in_area, vehicle).result.rsc_m.unwrap();
            assert!((by_edges - by_area).abs() < 0.002, "{vehicle}: {by_edges} {by_area}");
        }
    }

    #[test]
    fn one_span_has_the_numbers_that_a_whole_certificate_has_for_it() {
        let profile = CurvatureProfile::new(0.5)
            .straight(90.0)
            .clothoid(0.07, 8.0)
            .arc(0.07, 10.0)
            .clothoid(0.0, 8.0)
            .straight(90.0);
        let fixed = Options { max_shift_m: 0.0, correction_sweeps: 0 };
        let mut seen = [false; 3];
        for half_m in (0..40).map(|step| 1.0 + 0.05 * f64::from(step)) {
            let corridor = Corridor::from_curvature(0.5, [3.0, 4.0], 6.0, &profile.curvature, 7.0, half_m);
            let in_area = as_area(&corridor, 90.0, 100..corridor.len() - 60);
            let span = 120..corridor.len() - 20;
            for vehicle in VEHICLES {
                let model = Model::new(Catalogue::builtin().unwrap().get(vehicle).unwrap()).unwrap();
                let spans = std::slice::from_ref(&span);
                let quick = certify_spans(&in_area, &[&model], spans, &fixed).remove(0).spans.remove(0);
                let (_, mut whole) = certify_planned(&in_area, &model, spans, &fixed, &Stop::never()).unwrap().unwrap();
                let whole = whole.remove(0);
                let near = |a: Option<f64>, b: Option<f64>| a.zip(b).map_or(a == b, |(a, b)| (a - b).abs() < 1e-6);
                assert!(near(quick.rsc_m, whole.rsc_m), "{vehicle} {half_m}: {quick:?} {whole:?}");
                assert!(near(quick.hinge_margin_rad, whole.hinge_margin_rad), "{vehicle} {half_m}");
                assert_eq!((quick.shrink, quick.verdict()), (whole.shrink, whole.verdict()), "{vehicle} {half_m}");
                seen[usize::from(quick.safe()) + usize::from(quick.safe() && quick.shrink < 1.0)] = true;
            }
        }
        assert_eq!(seen, [true; 3], "unsafe, safe, safe with less tolerance");
    }

    #[test]
    fn in_a_bend_the_plane_is_no_worse_than_the_corridor() {
        for (radius_m, angle) in [(60.0, 0.8), (25.0, 1.2), (14.0, 1.57)] {
            let profile = CurvatureProfile::new(0.5)
                .straight(90.0)
                .clothoid(1.0 / radius_m, 8.0)
                .arc(1.0 / radius_m, radius_m * angle - 8.0)
                .clothoid(0.0, 8.0)
                .straight(90.0);
            let corridor = Corridor::from_curvature(0.5, [3.0, 4.0], 6.0, &profile.curvature, 7.0, 4.0);
            for vehicle in VEHICLES {
                let by_edges = certified(&corridor, vehicle).result.rsc_m;
                let in_area = as_area(&corridor, 90.0, 0..corridor.len());
                let by_area = certified(&in_area, vehicle).result.rsc_m;
                if let (Some(by_edges), Some(by_area)) = (by_edges, by_area) {
                    assert!(by_area > by_edges - 0.06, "{vehicle} R {radius_m}: {by_edges} {by_area}");
                }
            }
        }
    }
}
