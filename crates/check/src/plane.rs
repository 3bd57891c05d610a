//! Room in areas: over some stations a body is held against a part of the plane, not against the corridor's half-widths.
//!
//! A step is in an area if both its ends are between the first and the last station of an `AreaSpan`. In such steps each
//! place of a body's outline must keep the claimed distance from the area's complement, all deviations deducted. Feet,
//! normals and half-widths play no part there.
//!
//! **Deviations.** When its axle is at its foot, a unit is off by y across and α in heading, and by nothing along. The
//! point a ahead of the axle and c to its left is then off by
//!
//! ```text
//! across   y + a sin α − c (1 − cos α)        along   −a (1 − cos α) − c sin α
//! ```
//!
//! y + aα is the corridor's first-order bound plus a R/L (proof, section 3). R has the term L(α − sin α), so y + a sin α
//! is bounded by the same R1. Call this bound q(a), and let A bound α. Both displacements are affine in (a, c), so their
//! length is convex, and on a piece of a body it is greatest at a corner (`Swept::stray`).
//!
//! **Deviations in a direction.** Let m be a unit vector with the parts m_u along the nominal heading and m_n to its left.
//! Towards m, the point is off by
//!
//! ```text
//! m_n (y + a' sin α) − (1 − cos α) (m_n c + m_u a),     a' = a − c m_u/m_n
//! ```
//!
//! So across and along do not both count in full. a' is where the line through the point in the direction m meets the
//! body's axis. The first term is at most |m_n| q(a'), and at most |m_n| q(a) + |m_u c| A. The lesser counts. Beyond the
//! last knots q grows by A per metre. The second term is at most −(m_n c + m_u a) A²/2 if that is positive, else 0. For one
//! motion at one moment, all this is affine in (a, c). So the greatest of the corners' bounds holds for the piece
//! (`Swept::toward`).
//!
//! In a part of a step the heading turns by some φ. Seen from the unit, m turns as much. In between it is a sum of its
//! directions at both ends. The factors are not below zero, and they add up to 1/cos(φ/2) at most. So the greater of the
//! bounds at both ends, times this, holds in between.
//!
//! **Room.** The nominal places of a piece in a part of a step are in the hull of its corners at both ends, but for a bow
//! (`Swept::bow`). The hull is convex, and so is a segment of the boundary. In the direction m of their closest places they
//! are as far apart as these. So the piece keeps from the segment at least this distance, less the bow, less the greatest
//! deviation towards m. A part of a deviation is within the same bound, so no place gets across the segment. The least over
//! all segments is the cell's bound. A segment is done with at once if it is far enough for `Swept::stray`. A segment that
//! touches the hull has no direction, and `Swept::stray` counts.
//!
//! A cell whose bound is too low is halved, or the adjoint's bounds replace its tubes, until each cell ends with a bound not
//! below the claim, or holds a place where the bound is below it. The adjoint runs about a and about a'.
//!
//! **What lies under a body.** Nothing can come under a body but across its outline. Where a check begins, and where
//! the areas that count change, all of the body is examined; elsewhere its outline is.
//!
//! A place outside all areas has no room. It fails every claim of zero or more. A negative claim promises nothing; it
//! holds there if the deviation is no greater than what it concedes, or the distance from a segment beside it and the
//! deviation across that segment together.

use std::ops::Range;

use crate::areas::Boundary;
use crate::feet::point;
use crate::hull::{Segment, hull, way};
use crate::swept::Swept;
use crate::vector::{Point, framed, length};
use crate::{TOLERANCE_M, UP};
use netcert_base::watch;

/// Deducted for rounding, metres. Coordinates of 1e8 m are exact to 3e-8.
const ROUNDING_M: f64 = 1e-6;
/// Cells that extend and move less than this are not halved, metres.
const FINEST_M: f64 = 1e-4;
/// For cells that extend and move less than this the adjoint may run, even if their middle does by the filter, metres.
const SMALL_M: f64 = 0.03;
/// The adjoint runs only for pieces of a body no longer than this, metres.
const SHARP_M: f64 = 1.0;
/// Most comparisons of cells with segments, for one piece in one step. Some thousand decide an honest claim.
const MOST_WORK: usize = 10_000_000;
/// A comparison in a direction counts as so many.
const DIRECTED_WORK: usize = 8;
/// Turned directions are tried where the shortest way falls short of a claim by no more than this, metres.
const ASLANT_M: f64 = 0.05;
/// Small cells are also held apart from a segment in directions that are turned by these tangents from the shortest way, then by these
/// steps from the best one of them.
const TURNS: [f64; 7] = [0.0, -0.6, -0.3, -0.1, 0.1, 0.3, 0.6];
const TURN_STEPS: [f64; 6] = [0.1, 0.05, 0.025, 0.012, 0.006, 0.003];
/// Once a claim has failed, only places that are worse by this are looked for, metres.
const WORSE_M: f64 = 0.01;

/// The place where a claim fails by most in an area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Cramped {
    pub(crate) step: usize,
    pub(crate) unit: usize,
    /// The body point: metres ahead of the axle, and to its left.
    pub(crate) at: Point,
    /// How far the bound is below the claim, metres. Infinite where nothing is bounded.
    pub(crate) short_m: f64,
}

/// A piece of a body, from `a[0]` to `a[1]` ahead of its axle and from `c[0]` to `c[1]` to its left, in a part of a step.
#[derive(Debug, Clone, Copy)]
struct Piece {
    unit: usize,
    step: usize,
    a: [f64; 2],
    c: [f64; 2],
    /// Shares of the step.
    t: [f64; 2],
}

impl Piece {
    fn middle(&self) -> Self {
        let middle = |[from, to]: [f64; 2]| [f64::midpoint(from, to); 2];
        Self { a: middle(self.a), c: middle(self.c), t: middle(self.t), ..*self }
    }

    fn halves(&self, cut: fn(&mut Self) -> &mut [f64; 2]) -> [Self; 2] {
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

    fn size(&self, corners: &[Point; 8]) -> f64 {
        self.extent(corners).into_iter().fold(0.0, f64::max)
    }

    fn halves_of_longest(&self, corners: &[Point; 8]) -> [Self; 2] {
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

impl Swept<'_> {
    /// Checks claims about steps: that all of every body has at least so much room, metres, in those steps that are in
    /// areas. Returns for each claim the place where it fails by most. `only` looks at one unit, and at its front, its
    /// rear and one side (0 left, 1 right).
    pub(crate) fn cramped(
        &mut self,
        claims: &[(Range<usize>, f64)],
        only: Option<(usize, usize)>,
    ) -> Vec<Option<Cramped>> {
        if self.road.areas.spans.is_empty() {
            return vec![None; claims.len()];
        }
        // Claims of neighbouring spans share steps.
        let mut proved = vec![f64::NEG_INFINITY; self.motion.steps()];
        claims.iter().map(|(steps, claimed)| self.cramped_in(steps.clone(), *claimed, only, &mut proved)).collect()
    }

    fn cramped_in(
        &mut self,
        steps: Range<usize>,
        claimed: f64,
        only: Option<(usize, usize)>,
        proved: &mut [f64],
    ) -> Option<Cramped> {
        let mut worst: Option<Cramped> = None;
        let mut before = Vec::new();
        for step in steps {
            let active = self.road.areas.active(step);
            let whole = active != before;
            before.clone_from(&active);
            if active.is_empty() || !whole && proved[step] >= claimed {
                continue;
            }
            for unit in only.map_or(0..self.chain.links.len(), |(unit, _)| unit..unit + 1) {
                if self.tubes.get(step, unit).is_none() {
                    return Some(Cramped { step, unit, at: [0.0; 2], short_m: f64::INFINITY });
                }
                for piece in self.pieces(step, unit, whole, only.map(|(_, side)| side)) {
                    // Only what is worse than the worst so far is of interest.
                    let target = claimed - worst.map_or(0.0, |worst| worst.short_m + WORSE_M);
                    if let Some((at, bound)) = self.least(piece, target, &active, worst.is_some()) {
                        worst = Some(Cramped { step, unit, at, short_m: claimed - bound });
                    }
                }
            }
            if worst.is_none() {
                proved[step] = proved[step].max(claimed);
            }
        }
        worst
    }

    /// A body's outline in a step, or all of the body.
    fn pieces(&self, step: usize, unit: usize, whole: bool, side: Option<usize>) -> Vec<Piece> {
        let link = &self.chain.links[unit];
        let (sides, b) = ([link.rear, link.front], link.half_width);
        let piece = |a: [f64; 2], c: [f64; 2]| Piece { unit, step, a, c, t: [0.0, 1.0] };
        if whole && side.is_none() {
            // The outline is a part of it, but it is sooner decided by itself.
            return [
                piece(sides, [b; 2]),
                piece(sides, [-b; 2]),
                piece([link.front; 2], [-b, b]),
                piece([link.rear; 2], [-b, b]),
                piece(sides, [-b, b]),
            ]
            .to_vec();
        }
        let ends = sides.map(|a| piece([a; 2], [-b, b]));
        let own = [b, -b].into_iter().enumerate().filter(|(own, _)| side.is_none_or(|side| side == *own));
        ends.into_iter().chain(own.map(|(_, c)| piece(sides, [c; 2]))).collect()
    }

    /// The place of a piece whose bound is least, with the bound, if that is below `target`. Once a claim is `refuted`, the
    /// adjoint is spared: the search ends at a place whose bound it may still improve.
    fn least(&mut self, piece: Piece, mut target: f64, active: &[usize], mut refuted: bool) -> Option<(Point, f64)> {
        let spans = &self.road.areas.spans;
        let boundaries: Vec<&Boundary> = active.iter().map(|&k| &spans[k].boundary).collect();
        let mut strict = target >= -TOLERANCE_M;
        // A claim below zero concedes that a place is so far outside.
        let conceded = |target: f64, strict: bool| if strict { 0.0 } else { -target };
        let reach = self.taken(&piece).needed(target, strict).max(conceded(target, strict));
        let corners = self.corners(&piece);
        let near = boundaries.iter().map(|boundary| boundary.near(&corners, reach)).collect();
        let mut open: Vec<(Piece, Vec<Vec<u32>>)> = vec![(piece, near)];
        let (mut least, mut work) = (None, 0);
        while let Some((piece, near)) = open.pop() {
            watch::poll();
            let taken = self.taken(&piece);
            let needed = taken.needed(target, strict);
            if needed <= 0.0 {
                continue;
            }
            let corners = self.corners(&piece);
            let hull = hull(&corners);
            work += 1 + near.iter().map(Vec::len).sum::<usize>();
            let small = piece.size(&corners) <= SMALL_M;
            let kept = |piece: &Piece, taken: &Taken, hull: &[Point], segment, way, target| {
                let straight = self.kept(piece, taken, hull, segment, way);
                // A place by itself fails the claim, so it is judged with care however large its piece is.
                let careful = small || hull.len() == 1;
                if careful && (target - ASLANT_M..target).contains(&straight) {
                    self.kept_aslant(piece, taken, hull, segment, way)
                } else {
                    straight
                }
            };
            // The least that is said of places outside, by the area that says most.
            let beyond = |near: &[Vec<u32>], piece: &Piece, taken: &Taken, points: &[Point]| {
                let all =
                    boundaries.iter().zip(near).flat_map(|(b, near)| near.iter().map(|&k| b.segments[k as usize]));
                all.map(|segment| self.beyond(piece, taken, points, segment)).fold(taken.no_room(), f64::max)
            };
            if !strict && beyond(&near, &piece, &taken, &hull) >= target {
                continue;
            }
            let ways = |(b, near): (&&Boundary, &Vec<u32>)| -> Vec<(u32, Point)> {
                let ways = near.iter().map(|&k| (k, way(&hull, b.segments[k as usize])));
                ways.filter(|(_, way)| length(*way) < needed.max(conceded(target, strict))).collect()
            };
            let ways: Vec<Vec<(u32, Point)>> = boundaries.iter().zip(&near).map(ways).collect();
            // What is far enough from the whole piece is far enough from its parts.
            let close = |(b, ways): (&&Boundary, &Vec<(u32, Point)>)| -> Vec<(u32, f64)> {
                let within = ways.iter().filter(|(_, way)| length(*way) < needed);
                let kept =
                    within.map(|&(k, way)| (k, way, kept(&piece, &taken, &hull, b.segments[k as usize], way, target)));
                let close = kept.filter(|(_, way, kept)| *kept < target || strict && length(*way) < ROUNDING_M);
                close.map(|(k, _, kept)| (k, kept)).collect()
            };
            let near: Vec<Vec<(u32, f64)>> = boundaries.iter().zip(&ways).map(close).collect();
            if near.iter().zip(&boundaries).any(|(near, b)| near.is_empty() && b.contains(corners[0])) {
                continue;
            }
            work += DIRECTED_WORK * near.iter().map(Vec::len).sum::<usize>();
            // Parts of a piece that is partly outside may be conceded by segments that are far enough from the piece.
            let known: Vec<Vec<u32>> = if strict {
                near.iter().map(|near| near.iter().map(|(k, _)| *k).collect()).collect()
            } else {
                ways.iter().map(|ways| ways.iter().map(|(k, _)| *k).collect()).collect()
            };
            // The room of a piece, and the way to the segment that leaves it no more.
            let room = |piece: &Piece, taken: &Taken, points: &[Point]| {
                let room = |(b, near): (&&Boundary, &Vec<u32>)| {
                    let to = |&k: &u32| {
                        let (segment, way) = (b.segments[k as usize], way(points, b.segments[k as usize]));
                        (kept(piece, taken, points, segment, way, target), way)
                    };
                    let least = |x: (f64, Point), y: (f64, Point)| if y.0 < x.0 { y } else { x };
                    b.contains(points[0]).then(|| near.iter().map(to).fold((f64::INFINITY, [0.0; 2]), least))
                };
                boundaries.iter().zip(&known).filter_map(room).reduce(|x, y| if y.0 > x.0 { y } else { x })
            };
            let middle = piece.middle();
            let still = self.taken(&middle).still();
            let there = room(&middle, &still, &self.corners(&middle)[..1]);
            let outside = || beyond(&known, &middle, &still, &self.corners(&middle)[..1]);
            let bound = there.map_or_else(outside, |(bound, _)| bound);
            let failed = bound < target || strict && there.is_none();
            let size = piece.size(&corners);
            let levers = there.map_or(piece.a, |(_, way)| self.levers(&piece, way));
            // A direction that is tried has a lever of its own. It proves nothing while only the filter bounds that place.
            let aslant = there
                .filter(|(bound, _)| failed && *bound >= target - ASLANT_M)
                .map(|(_, way)| self.levers_aslant(&piece, way))
                .filter(|levers| self.dull(piece.step, piece.unit, *levers));
            // A small piece whose middle does by a hair may fail all the same.
            let dull = (failed || size <= SMALL_M)
                && work <= MOST_WORK
                && [piece.a, levers].into_iter().any(|a| self.dull(piece.step, piece.unit, a));
            let [long, spread] = [piece.a, levers].map(|a| (a[1] - a[0]).abs());
            // Across a body the levers spread too.
            let (long, wide) = (long > SHARP_M, spread > long + SHARP_M);
            if dull && refuted {
                break;
            }
            if dull && !long && !wide {
                self.sharpen_about(piece.step, piece.unit, piece.a);
                self.sharpen_about(piece.step, piece.unit, levers);
                open.push((piece, known));
            } else if let Some(levers) = aslant.filter(|_| !dull && !refuted && work <= MOST_WORK) {
                self.sharpen_about(piece.step, piece.unit, levers);
                open.push((piece, known));
            } else if !dull && (failed || size <= FINEST_M || work > MOST_WORK) {
                let whole = || {
                    room(&piece, &taken, &hull)
                        .map_or_else(|| beyond(&known, &piece, &taken, &hull), |(bound, _)| bound)
                };
                // A place outside all areas may fail with a bound that would do.
                let bound = if failed { bound } else { whole() }.min(target - ROUNDING_M);
                least = Some(([middle.a[0], middle.c[0]], bound));
                (target, strict, refuted) = (bound - WORSE_M, false, true);
            } else {
                // Halving the time divides the bow by four.
                let kept = |near: &Vec<(u32, f64)>| near.iter().map(|(_, kept)| *kept).reduce(f64::min);
                let lacking = target - near.iter().filter_map(kept).fold(taken.no_room(), f64::max);
                let halves = if dull && long {
                    piece.halves(|piece| &mut piece.a)
                } else if dull {
                    piece.halves(|piece| &mut piece.c)
                } else if 0.75 * taken.bow[0] >= lacking {
                    piece.halves(|piece| &mut piece.t)
                } else {
                    piece.halves_of_longest(&corners)
                };
                open.extend(halves.map(|half| (half, known.clone())));
            }
        }
        least
    }

    /// What is deducted for a piece, whatever the direction.
    fn taken(&self, piece: &Piece) -> Taken {
        let headings = piece.t.map(|t| self.pose(piece.step, piece.unit, t).u);
        let [x, y] = [headings[0][0] + headings[1][0], headings[0][1] + headings[1][1]];
        let (swing, l) = (self.motion.swing(piece.step, piece.unit), self.chain.links[piece.unit].l);
        Taken {
            stray: self.stray(piece),
            bow: self.bow(piece),
            headings,
            // Twice the cosine of half the turn is the length of the sum.
            between: 2.0 / length([x, y]) * UP,
            led: swing.curvature * swing.len / 12.0 * (swing.len / l).powi(2),
        }
    }

    /// Bound of the distance that a piece keeps from a segment, metres. `way` is the shortest from its hull.
    fn kept(&self, piece: &Piece, taken: &Taken, hull: &[Point], segment: Segment, way: Point) -> f64 {
        let apart = length(way);
        if apart < ROUNDING_M {
            return self.beyond(piece, taken, hull, segment);
        }
        let m = way.map(|x| x / apart);
        // Any direction would do, so rounding of this one does no harm.
        let beyond = |s: Point| hull.iter().map(move |x| m[0] * (s[0] - x[0]) + m[1] * (s[1] - x[1]));
        let apart = segment.into_iter().flat_map(beyond).fold(f64::INFINITY, f64::min);
        apart - self.toward(piece, taken, m) - taken.bow[0] - taken.bow[1] - ROUNDING_M
    }

    /// Bound of the room of a piece that is on the boundary or outside, metres, below zero. Beside a segment no place is farther outside than
    /// it is from the segment, and it gets no farther than by its deviation across, to the worse side.
    fn beyond(&self, piece: &Piece, taken: &Taken, points: &[Point], segment: Segment) -> f64 {
        let [s, e] = segment;
        let size = length([e[0] - s[0], e[1] - s[1]]);
        let u = [(e[0] - s[0]) / size, (e[1] - s[1]) / size];
        let placed = |x: &Point| framed([x[0] - s[0], x[1] - s[1]], u);
        let margin = -taken.no_room();
        let beside = |[along, _]: [f64; 2]| along >= margin && along <= size - margin;
        if !points.iter().map(placed).all(beside) {
            return taken.no_room();
        }
        let depth = points.iter().map(|x| placed(x)[1].abs()).fold(0.0, f64::max);
        let across =
            [[-u[1], u[0]], [u[1], -u[0]]].map(|m| self.toward(piece, taken, m)).into_iter().fold(0.0, f64::max);
        (-(depth + across + taken.bow[0] + taken.bow[1] + ROUNDING_M)).max(taken.no_room())
    }

    /// As [`Self::kept`], in the best of several directions. Before a corner of the boundary, a longer way may be one in which the body
    /// moves less.
    fn kept_aslant(&self, piece: &Piece, taken: &Taken, hull: &[Point], segment: Segment, way: Point) -> f64 {
        let at = |tangent: f64| (self.kept(piece, taken, hull, segment, turned(way, tangent)), tangent);
        let better = |x: (f64, f64), y: (f64, f64)| if y.0 > x.0 { y } else { x };
        if length(way) < ROUNDING_M {
            return self.kept(piece, taken, hull, segment, way);
        }
        let coarse = TURNS.into_iter().map(at).fold((f64::NEG_INFINITY, 0.0), better);
        let refined = |best: (f64, f64), step: f64| better(better(best, at(best.1 - step)), at(best.1 + step));
        TURN_STEPS.into_iter().fold(coarse, refined).0
    }

    /// Bound of how far a piece's places are off towards a unit vector, metres.
    fn toward(&self, piece: &Piece, taken: &Taken, m: Point) -> f64 {
        let (step, unit) = (piece.step, piece.unit);
        let Some(tube) = self.tubes.get(step, unit) else { return f64::INFINITY };
        let across = |a: f64| self.off(step, unit, a, tube) + a.abs() * tube.r1 / self.chain.links[unit].l;
        let own = piece.a.map(across);
        let at = |[along, aside]: [f64; 2], k: usize, c: f64| {
            let a = piece.a[k];
            let apart = aside.abs() * own[k] + (along * c).abs() * tube.a;
            let lever = a - c * along / aside;
            let joint = if lever.is_finite() { aside.abs() * across(lever) } else { f64::INFINITY };
            apart.min(joint) + 0.5 * tube.a * tube.a * (-aside * c - along * a).max(0.0)
        };
        let frames = taken.headings.map(|u| framed(m, u));
        let corners = frames.into_iter().flat_map(|m| [0, 1].into_iter().flat_map(move |k| piece.c.map(|c| (m, k, c))));
        let most = corners.map(|(m, k, c)| at(m, k, c)).fold(0.0, f64::max);
        // At the end of a step the heading may turn a little farther.
        ((most * taken.between + taken.led * taken.stray) * UP).min(taken.stray)
    }

    /// The places on the axis where the bounds of a piece's deviations along `way` are taken, as far as knots reach.
    fn levers(&self, piece: &Piece, way: Point) -> [f64; 2] {
        let link = &self.chain.links[piece.unit];
        let middle = piece.middle();
        let [along, aside] = framed(way, self.pose(piece.step, piece.unit, middle.t[0]).u);
        if aside.abs() <= 1e-9 * length(way) {
            return piece.a;
        }
        let [rear, front] = [link.rear - link.half_width, link.front + link.half_width];
        let levers = piece.a.into_iter().flat_map(|a| piece.c.map(|c| a - c * along / aside));
        let levers = levers.map(|a| a.clamp(rear, front));
        levers.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], a| [low.min(a), high.max(a)])
    }

    /// [`Self::levers`] of all directions that [`Self::kept_aslant`] tries at first.
    fn levers_aslant(&self, piece: &Piece, way: Point) -> [f64; 2] {
        let all = TURNS.into_iter().flat_map(|tangent| self.levers(piece, turned(way, tangent)));
        all.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], a| [low.min(a), high.max(a)])
    }

    /// The corners of a piece at the start of its time, then at its end.
    fn corners(&self, piece: &Piece) -> [Point; 8] {
        let mut corners = [[0.0; 2]; 8];
        for (i, corner) in corners.iter_mut().enumerate() {
            let pose = self.pose(piece.step, piece.unit, piece.t[i / 4]);
            *corner = point(pose, piece.a[i / 2 % 2], piece.c[i % 2]);
        }
        corners
    }

    /// Bound of the distance of a piece's places from their nominal places, metres.
    fn stray(&self, piece: &Piece) -> f64 {
        let (step, unit) = (piece.step, piece.unit);
        let Some(tube) = self.tubes.get(step, unit) else { return f64::INFINITY };
        let c = piece.c[0].abs().max(piece.c[1].abs());
        let at = |a: f64| {
            let turned = 0.5 * tube.a * tube.a;
            let across = self.off(step, unit, a, tube) + a.abs() * tube.r1 / self.chain.links[unit].l + c * turned;
            let along = a.abs() * turned + c * tube.a;
            length([across, along]) * UP
        };
        at(piece.a[0]).max(at(piece.a[1]))
    }

    /// How far a piece's nominal places may be outside of the hull of its corners, metres.
    ///
    /// While its coupling moves along a chord, a unit turns by sin β/L per metre. A point ρ from the coupling is
    /// accelerated by at most ρ (|sin β cos β| + sin² β)/L² per square metre. It leaves the line between two of its places by
    /// an eighth of that times the square of the way. At the end of a step the unit turns by what chords leave out
    /// (`motion::led`), κℓ·x²/12. Returns both; the first is a quarter in half the time.
    fn bow(&self, piece: &Piece) -> [f64; 2] {
        let link = &self.chain.links[piece.unit];
        let swing = self.motion.swing(piece.step, piece.unit);
        let q = 1.0 + swing.before * swing.before;
        let sin = if swing.before.abs() < 1.0 { 2.0 * swing.before.abs() / q } else { 1.0 };
        let reach = |a: f64, c: f64| length([a - link.l, c]);
        let most = piece.a.iter().flat_map(|&a| piece.c.map(|c| reach(a, c))).fold(0.0, f64::max);
        let (x, share) = (swing.len / link.l, piece.t[1] - piece.t[0]);
        let led = swing.curvature * swing.len / 12.0;
        [sin * (1.0 + sin) * share * share / 8.0, led].map(|part| most * x * x * part * UP)
    }
}

/// What is deducted for a piece.
#[derive(Debug, Clone, Copy)]
struct Taken {
    /// For deviations to all sides, and for the bow, metres.
    stray: f64,
    bow: [f64; 2],
    /// The nominal headings at both ends of the piece's time.
    headings: [Point; 2],
    /// In between, a bound for both ends may be greater by this factor, and the heading off by this angle.
    between: f64,
    led: f64,
}

impl Taken {
    /// The distance that decides a claim without a direction, metres.
    fn needed(&self, target: f64, strict: bool) -> f64 {
        let needed = target - self.no_room();
        if strict { needed.max(ROUNDING_M) } else { needed }
    }

    /// The bound where the nominal place is on the boundary or outside, metres.
    fn no_room(&self) -> f64 {
        -(self.stray + self.bow[0] + self.bow[1] + ROUNDING_M)
    }

    /// For a nominal place, which has no bow.
    fn still(self) -> Self {
        Self { bow: [0.0; 2], ..self }
    }
}

/// A vector of the same length, turned by the angle of this tangent.
fn turned([x, y]: Point, tangent: f64) -> Point {
    let cosine = 1.0 / length([1.0, tangent]);
    [(x - y * tangent) * cosine, (y + x * tangent) * cosine]
}

#[cfg(test)]
mod tests;
