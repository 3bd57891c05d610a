//! One unit over the step between two head stations: what each piece of its sides has left (docs/proof.md, section 11).

use crate::stet::areas::{FAR_OUTSIDE_M, PlanePoint, PreparedAreas, SweptPiece, apart};
use crate::stet::body::{BodyPoint, Rooms, Stand};
use crate::stet::model::MAX_POINTS;
use crate::stet::track::Track;

/// Share by which the motion's second derivative, taken at the stations, may be greater between them.
const BETWEEN: f64 = 1.25;
/// A function lies above its chord over a step, less this share of its second derivative times the square of the step.
const CHORD: f64 = 0.125;
/// Directions at a smaller sine to the heading meet the axis too far away.
const OBLIQUE: f64 = 0.05;
/// Stands for a gap of zero in a denominator, metres.
const NO_GAP_M: f64 = 1e-9;

/// The least leeway of one unit over a step, by side.
#[derive(Clone, Copy)]
pub(super) struct Lowest {
    pub(super) leeway: f64,
    /// The body point near it. `None` while another unit has less leeway.
    pub(super) point: Option<usize>,
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

/// One unit over the step between two stations.
pub(super) struct UnitPassage<'a> {
    areas: &'a PreparedAreas,
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

impl<'a> UnitPassage<'a> {
    pub(super) fn new(
        track: &'a Track,
        points: &'a [BodyPoint],
        half_width: f64,
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
        let [front, rear] = [0, points.len() - 1].map(|index| points[index].on_axis.ahead);
        // Between two points what a place may move is convex.
        let most = points.iter().zip(&passage.across).map(|(point, across)| passage.most(*across, point.on_axis.ahead));
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
        let (front, rear) = (points[0].on_axis.ahead, points[last].on_axis.ahead);
        if ahead >= front {
            return self.across[0] + (ahead - front) * self.heading;
        }
        if ahead <= rear {
            return self.across[last] + (rear - ahead) * self.heading;
        }
        let index = (1..last).find(|&index| points[index].on_axis.ahead <= ahead).unwrap_or(last);
        let behind = &points[index];
        let share = (ahead - behind.on_axis.ahead) / behind.gap.max(NO_GAP_M);
        self.across[index] + (self.across[index - 1] - self.across[index]) * share
    }

    /// Most that a place of the body may move in the direction `towards`, a unit vector. In that direction the place moves as the
    /// place of the axis does on which the direction's normal through it meets the axis.
    fn stray(&self, towards: PlanePoint, ahead: f64, aside: f64) -> f64 {
        let a = self.heading;
        let in_frame = |u: PlanePoint| {
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

    /// Whether a piece that had this room in the step before is inside at the first station. Where several areas count, it may have been
    /// in another one.
    fn was_inside(&self, room: f64) -> bool {
        room > 0.0 && self.areas.count(self.before.head, self.before.head + 1).nth(1).is_none()
    }

    /// Room and leeway of a piece that has these ends at both stations: the greatest over the areas.
    fn room(&self, piece: &SweptPiece<'_>) -> (f64, f64) {
        let rooms = self.areas.count(self.before.head, self.before.head + 1).map(|ground| match ground {
            Some(ground) => ground.swept(piece),
            None => (FAR_OUTSIDE_M, FAR_OUTSIDE_M),
        });
        rooms.fold((FAR_OUTSIDE_M, FAR_OUTSIDE_M), |most, room| (most.0.max(room.0), most.1.max(room.1)))
    }

    /// Room and leeway of the left or right half (0 or 1) of the front edge or the rear edge, at body point `index`, which had this room
    /// in the step before. A leeway of at least `enough` need not be exact.
    fn edge(&self, index: usize, side: usize, known: f64, enough: f64) -> (f64, f64) {
        let half = if side == 0 { self.half_width } else { -self.half_width };
        let ahead = self.points[index].on_axis.ahead;
        let ends = |stand: &Stand| [half, 0.0].map(|aside| stand.place(ahead, aside));
        let sag = self.sag(ahead);
        let most = self.most(self.across[index], ahead) + sag;
        let (before, after) = (ends(self.before), ends(self.after));
        let left = known - moved(before, after);
        if left - most >= enough {
            return (left, left - most);
        }
        let stray = |towards: PlanePoint| [half, 0.0].map(|aside| self.stray(towards, ahead, aside) + sag);
        let inside = self.was_inside(known);
        self.room(&SweptPiece { before, after, most, enough, stray: &stray, inside })
    }

    /// Whether something may already be under the body when the first step of an area begins.
    fn blocked(&self) -> bool {
        let (half, last) = (self.half_width, self.points.len() - 1);
        let (front, rear) = (self.points[0].on_axis.ahead, self.points[last].on_axis.ahead);
        let corners = [(rear, -half), (front, -half), (front, half), (rear, half)];
        let outline = corners.map(|(ahead, aside)| self.before.place(ahead, aside));
        self.areas
            .count(self.before.head, self.before.head + 1)
            .all(|ground| ground.is_none_or(|ground| ground.under(outline)))
    }

    /// The least leeways, left and right, or those in `known` where they are less.
    pub(super) fn lowest(&self, rooms: &mut Rooms, known: [f64; 2]) -> [Lowest; 2] {
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
        let [ahead, behind] = [index - 1, index].map(|point| self.points[point].on_axis.ahead);
        let sag = self.sag(ahead).max(self.sag(behind));
        let most = piece.ends.map(|ahead| self.most(self.across_at(ahead), ahead));
        let most = most[0].max(most[1]) + sag;
        let ends = |stand: &Stand| piece.ends.map(|ahead| stand.place(ahead, aside));
        let (before, after) = (ends(self.before), ends(self.after));
        let left = carried.max(rooms.before[number] - moved(before, after));
        rooms.rooms[number] = if left - most >= lowest.leeway {
            left
        } else {
            let stray = |towards: PlanePoint| piece.ends.map(|ahead| self.stray(towards, ahead, aside) + sag);
            let inside = self.was_inside(rooms.before[number]);
            let swept = SweptPiece { before, after, most, enough: lowest.leeway, stray: &stray, inside };
            let (room, leeway) = self.room(&swept);
            if leeway < lowest.leeway {
                rooms.critical[piece.side] = number;
            }
            lowest.lower(leeway, piece.point);
            room
        };
    }
}

/// Most that the room of a piece falls over a step, metres: the hulls of two steps share the piece at the station between them.
fn moved(before: [PlanePoint; 2], after: [PlanePoint; 2]) -> f64 {
    apart(before[0], after[0]).max(apart(before[1], after[1]))
}
