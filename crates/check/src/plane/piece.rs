//! A piece of a body in a part of a step, and its halves.

use crate::feet::point;
use crate::swept_vehicle::SweptVehicle;
use crate::vector::{Point, length};

/// A piece of a body, from `a[0]` to `a[1]` ahead of its axle and from `c[0]` to `c[1]` to its left, in a part of a step.
#[derive(Debug, Clone, Copy)]
pub(super) struct BodyPiece {
    pub(super) unit: usize,
    pub(super) step: usize,
    pub(super) a: [f64; 2],
    pub(super) c: [f64; 2],
    /// Shares of the step.
    pub(super) t: [f64; 2],
}

impl BodyPiece {
    pub(super) fn middle(&self) -> Self {
        let middle = |[from, to]: [f64; 2]| [f64::midpoint(from, to); 2];
        Self { a: middle(self.a), c: middle(self.c), t: middle(self.t), ..*self }
    }

    pub(super) fn halves(&self, cut: fn(&mut Self) -> &mut [f64; 2]) -> [Self; 2] {
        let mut halves = [*self; 2];
        let [from, to] = *cut(&mut halves[0]);
        cut(&mut halves[0])[1] = f64::midpoint(from, to);
        cut(&mut halves[1])[0] = f64::midpoint(from, to);
        halves
    }

    /// How far the piece extends ahead and aside, and how far it moves, metres.
    fn extent(&self, corners: &[Point; 8]) -> [f64; 3] {
        let moved = |i: usize| length([corners[i + 4][0] - corners[i][0], corners[i + 4][1] - corners[i][1]]);
        [(self.a[1] - self.a[0]).abs(), (self.c[1] - self.c[0]).abs(), (0..4).map(moved).fold(0.0, f64::max)]
    }

    pub(super) fn size(&self, corners: &[Point; 8]) -> f64 {
        self.extent(corners).into_iter().fold(0.0, f64::max)
    }

    pub(super) fn halves_of_longest(&self, corners: &[Point; 8]) -> [Self; 2] {
        let [a, c, moved] = self.extent(corners);
        if a >= c && a >= moved {
            self.halves(|piece| &mut piece.a)
        } else if c >= moved {
            self.halves(|piece| &mut piece.c)
        } else {
            self.halves(|piece| &mut piece.t)
        }
    }
}

impl SweptVehicle<'_> {
    /// The corners of a piece at the start of its time, then at its end.
    pub(super) fn corners(&self, piece: &BodyPiece) -> [Point; 8] {
        let mut corners = [[0.0; 2]; 8];
        for (i, corner) in corners.iter_mut().enumerate() {
            let pose = self.pose(piece.step, piece.unit, piece.t[i / 4]);
            *corner = point(pose, piece.a[i / 2 % 2], piece.c[i % 2]);
        }
        corners
    }
}
