//! The room of the pieces of a unit's sides, carried from step to step.

use crate::stet::areas::{FAR_OUTSIDE_M, PlanePoint, PreparedAreas, apart};

/// Sides are covered in pieces no longer than this, metres. The hull of a piece over a step is little larger than what the piece
/// sweeps.
pub(in crate::stet) const PIECE_M: f64 = 1.4;

/// A piece of a side between two body points.
pub(in crate::stet) struct SidePiece {
    /// The body point behind it, and the one near it.
    pub(in crate::stet) index: usize,
    pub(in crate::stet) point: usize,
    /// Its ends, metres ahead of the axle.
    pub(in crate::stet) ends: [f64; 2],
    /// 0 left, 1 right.
    pub(in crate::stet) side: usize,
}

/// Rooms of a unit's pieces, carried from step to step. A piece that moves by a metre loses at most a metre of room. A piece that slides
/// along its side goes where it was itself and the piece ahead of it, and loses what it moves aside. So most pieces need not be
/// measured in most steps.
pub(in crate::stet) struct Rooms {
    pub(in crate::stet) pieces: Vec<SidePiece>,
    pub(in crate::stet) rooms: Vec<f64>,
    /// The rooms in the step before.
    pub(in crate::stet) before: Vec<f64>,
    /// By side: room of its half of the front edge.
    pub(in crate::stet) front: [f64; 2],
    /// By side: the piece with the least leeway in the last step. It is measured first.
    pub(in crate::stet) critical: [usize; 2],
    /// The station after the last step.
    head: usize,
    /// Without disturbances: the places that were measured last, with their rooms.
    places: Vec<(PlanePoint, f64)>,
    /// The station at which they were measured last.
    places_head: usize,
}

impl Rooms {
    /// The pieces of a side whose body points are at these places, metres ahead of the axle.
    pub(in crate::stet) fn new(points: &[f64]) -> Self {
        let mut pieces = Vec::new();
        for index in 1..points.len() {
            let (ahead, behind) = (points[index - 1], points[index]);
            let parts = ((ahead - behind) / PIECE_M).ceil().max(1.0);
            for part in 0..parts as usize {
                let [from, to] = [part as f64 / parts, (part + 1) as f64 / parts];
                let ends = [from, to].map(|share| ahead + (behind - ahead) * share);
                let point = if from + to < 1.0 { index - 1 } else { index };
                pieces.extend([0, 1].map(|side| SidePiece { index, point, ends, side }));
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
            places_head: 0,
        }
    }

    /// Forgets the rooms unless they are those of the step before station `head`.
    pub(in crate::stet) fn enter(&mut self, head: usize, anew: bool) {
        if self.head != head || anew {
            self.rooms.fill(f64::NEG_INFINITY);
            self.front = [f64::NEG_INFINITY; 2];
        }
        self.before.copy_from_slice(&self.rooms);
        self.head = head + 1;
    }

    /// Forgets the rooms of places unless they are those of the station before `head`.
    pub(in crate::stet) fn enter_nominal(&mut self, head: usize, anew: bool) {
        if self.places_head + 1 != head || anew {
            self.places.clear();
        }
        self.places_head = head;
    }

    /// The room of a place without disturbances, unless it is known to be at least `enough`: it falls by no more than the place has moved
    /// since it was measured. Places are numbered.
    pub(in crate::stet) fn nominal(
        &mut self,
        areas: &PreparedAreas,
        head: usize,
        number: usize,
        p: PlanePoint,
        enough: f64,
    ) -> Option<f64> {
        let known = self.places.get(number).map(|(q, room)| (apart(*q, p), *room));
        if known.is_some_and(|(moved, room)| room - moved >= enough) {
            return None;
        }
        // A place that has moved by less than its room has not crossed the boundary.
        let alone = areas.count(head, head).nth(1).is_none();
        let inside = known.filter(|(moved, room)| alone && *moved < room.abs()).map(|(_, room)| room > 0.0);
        let rooms = areas.count(head, head).map(|ground| ground.map_or(FAR_OUTSIDE_M, |ground| ground.room(p, inside)));
        let room = rooms.fold(FAR_OUTSIDE_M, f64::max);
        match self.places.get_mut(number) {
            Some(known) => *known = (p, room),
            None => self.places.push((p, room)),
        }
        Some(room)
    }

    /// The room in the step before of the piece and of the one ahead of it on its side, if the latter is at least this long.
    pub(in crate::stet) fn slid(&self, number: usize, slide: f64) -> Option<f64> {
        let (own, ahead) = (self.before.get(number)?, number.checked_sub(2)?);
        (self.pieces[ahead].length() >= slide).then(|| own.min(self.before[ahead]))
    }
}

impl SidePiece {
    fn length(&self) -> f64 {
        self.ends[0] - self.ends[1]
    }
}
