//! The search for the place of a piece that has the least room. Pieces are halved until each one is decided.

use super::deductions::{Deductions, ROUNDING_M};
use super::piece::BodyPiece;
use crate::TOLERANCE_M;
use crate::areas::Boundary;
use crate::hull::{Segment, hull, way};
use crate::swept_vehicle::SweptVehicle;
use crate::vector::{Point, length};
use netcert_base::watch;

/// Once a claim has failed, only places that are worse by this are looked for, metres.
pub(super) const WORSE_M: f64 = 0.01;
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
/// The part of a bow that goes when the time is halved: what is left is a quarter.
const HALVING_SAVES: f64 = 0.75;

/// A piece that is not decided yet, and for each area the segments that may be too close to it.
struct Node {
    piece: BodyPiece,
    near: Vec<Vec<u32>>,
}

/// What a node of the search turns out to be.
enum Fate {
    /// All of the piece has the room that is asked for.
    Kept,
    /// The adjoint may improve its bounds at these stretches of the axis. Then it is judged again.
    Dull(Node, Vec<[f64; 2]>),
    /// The same, but the claim has failed already. The search ends, and the adjoint is spared.
    Spared,
    /// It fails: a place of it, and the bound of the room there.
    Lacking(Point, f64),
    /// Only its parts can be decided.
    Halved([Node; 2]),
}

/// What is known of a claim while its pieces are searched.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Claim {
    /// No place refutes it so far.
    Open,
    Refuted,
}

/// The state of a search.
struct Search<'a> {
    /// Boundaries of the areas that count.
    boundaries: Vec<&'a Boundary>,
    /// Room that is asked for, metres. It falls as places with less room are found.
    target: f64,
    /// Whether a place outside all areas fails. A claim below zero concedes that a place is so far outside.
    strict: bool,
    claim: Claim,
    /// Comparisons so far.
    work: usize,
    /// The place whose bound is least so far.
    least: Option<(Point, f64)>,
}

impl Search<'_> {
    /// How far outside a place may be, metres.
    fn conceded(&self) -> f64 {
        if self.strict { 0.0 } else { -self.target }
    }

    /// The distance that decides without a direction, metres.
    fn needed(&self, taken: &Deductions) -> f64 {
        taken.needed(self.target, self.strict)
    }

    /// Whether another comparison may be made.
    fn goes_on(&self) -> bool {
        self.work <= MOST_WORK
    }

    /// From now on only places that are worse than this one are looked for.
    fn fail_at(&mut self, at: Point, bound: f64) {
        self.least = Some((at, bound));
        (self.target, self.strict, self.claim) = (bound - WORSE_M, false, Claim::Refuted);
    }

    /// The segments of each area that are closer than `reach` to a piece, with the ways to them.
    fn ways(&self, near: &[Vec<u32>], seen: &Seen, reach: f64) -> Vec<Vec<(u32, Point)>> {
        let ways = |(b, near): (&&Boundary, &Vec<u32>)| -> Vec<(u32, Point)> {
            let ways = near.iter().map(|&k| (k, way(&seen.points, b.segments[k as usize])));
            ways.filter(|(_, way)| length(*way) < reach).collect()
        };
        self.boundaries.iter().zip(near).map(ways).collect()
    }
}

/// A piece as the boundaries see it.
struct Seen {
    piece: BodyPiece,
    taken: Deductions,
    /// The hull of its nominal places.
    points: Vec<Point>,
    /// Whether turned directions are worth their while.
    careful: bool,
}

impl SweptVehicle<'_> {
    /// The place of a piece whose bound is least, with the bound, if that is below `target`. Once a claim is refuted, the
    /// adjoint is spared: the search ends at a place whose bound it may still improve.
    pub(super) fn least(
        &mut self,
        piece: BodyPiece,
        target: f64,
        active: &[usize],
        claim: Claim,
    ) -> Option<(Point, f64)> {
        let spans = &self.road.areas.spans;
        let boundaries = active.iter().map(|&k| &spans[k].boundary).collect();
        let mut search = Search { boundaries, target, strict: target >= -TOLERANCE_M, claim, work: 0, least: None };
        let mut open = vec![self.first_node(piece, &search)];
        while let Some(node) = open.pop() {
            watch::poll();
            match self.judge(node, &mut search) {
                Fate::Kept => {}
                Fate::Dull(node, stretches) => {
                    for a in stretches {
                        self.sharpen_about(piece.step, piece.unit, a);
                    }
                    open.push(node);
                }
                Fate::Spared => break,
                Fate::Lacking(at, bound) => search.fail_at(at, bound),
                Fate::Halved(halves) => open.extend(halves),
            }
        }
        search.least
    }

    /// A whole piece with all segments that may be too close.
    fn first_node(&self, piece: BodyPiece, search: &Search<'_>) -> Node {
        let reach = search.needed(&self.taken(&piece)).max(search.conceded());
        let corners = self.corners(&piece);
        Node { piece, near: search.boundaries.iter().map(|boundary| boundary.near(&corners, reach)).collect() }
    }

    /// Decides a node, or says what decides it.
    fn judge(&self, Node { piece, near }: Node, search: &mut Search<'_>) -> Fate {
        let taken = self.taken(&piece);
        let needed = search.needed(&taken);
        if needed <= 0.0 {
            return Fate::Kept;
        }
        let corners = self.corners(&piece);
        let points = hull(&corners);
        search.work += 1 + near.iter().map(Vec::len).sum::<usize>();
        // A place by itself fails the claim, so it is judged with care however large its piece is.
        let careful = piece.size(&corners) <= SMALL_M || points.len() == 1;
        let seen = Seen { piece, taken, points, careful };
        if !search.strict && self.beyond_all(&near, &seen, search) >= search.target {
            return Fate::Kept;
        }
        let ways = search.ways(&near, &seen, needed.max(search.conceded()));
        // What is far enough from the whole piece is far enough from its parts.
        let close = self.close(&ways, &seen, needed, search);
        if close.iter().zip(&search.boundaries).any(|(close, b)| close.is_empty() && b.contains(corners[0])) {
            return Fate::Kept;
        }
        search.work += DIRECTED_WORK * close.iter().map(Vec::len).sum::<usize>();
        // Parts of a piece that is partly outside may be conceded by segments that are far enough from the piece.
        let near = if search.strict { numbers(&close) } else { numbers(&ways) };
        self.judge_middle(&seen, &corners, &close, near, search)
    }

    /// Of the segments closer than `needed`, those from which a piece may not keep what is asked for, with what it keeps.
    fn close(&self, ways: &[Vec<(u32, Point)>], seen: &Seen, needed: f64, search: &Search<'_>) -> Vec<Vec<(u32, f64)>> {
        let close = |(b, ways): (&&Boundary, &Vec<(u32, Point)>)| -> Vec<(u32, f64)> {
            let within = ways.iter().filter(|(_, way)| length(*way) < needed);
            let kept = within.map(|&(k, way)| (k, way, self.keeps(seen, b.segments[k as usize], way, search.target)));
            let close =
                kept.filter(|(_, way, kept)| *kept < search.target || search.strict && length(*way) < ROUNDING_M);
            close.map(|(k, _, kept)| (k, kept)).collect()
        };
        search.boundaries.iter().zip(ways).map(close).collect()
    }

    /// Decides a node that may lack room by its middle: whether that lacks room, whether the adjoint may help, and what is
    /// halved otherwise.
    fn judge_middle(
        &self,
        seen: &Seen,
        corners: &[Point; 8],
        close: &[Vec<(u32, f64)>],
        near: Vec<Vec<u32>>,
        search: &Search<'_>,
    ) -> Fate {
        let (piece, target) = (seen.piece, search.target);
        let middle = self.middle(&piece);
        let there = self.room(&near, &middle, search);
        let bound = there.map_or_else(|| self.beyond_all(&near, &middle, search), |(bound, _)| bound);
        let failed = bound < target || search.strict && there.is_none();
        let size = piece.size(corners);
        let levers = there.map_or(piece.a, |(_, way)| self.levers(&piece, way));
        let duller = |a: [f64; 2]| self.dull(piece.step, piece.unit, a);
        // A small piece whose middle does by a hair may fail all the same.
        let dull = (failed || size <= SMALL_M) && search.goes_on() && (duller(piece.a) || duller(levers));
        if dull && search.claim == Claim::Refuted {
            return Fate::Spared;
        }
        let [long, spread] = [piece.a, levers].map(|a| (a[1] - a[0]).abs());
        // Across a body the levers spread too.
        let (long, wide) = (long > SHARP_M, spread > long + SHARP_M);
        if dull && !long && !wide {
            return Fate::Dull(Node { piece, near }, vec![piece.a, levers]);
        }
        if dull {
            let halves = if long { piece.halves(|piece| &mut piece.a) } else { piece.halves(|piece| &mut piece.c) };
            return halved(halves, &near);
        }
        // A direction that is tried has a lever of its own. It proves nothing while only the filter bounds that place.
        let aslant = there
            .filter(|(bound, _)| {
                failed && *bound >= target - ASLANT_M && search.claim == Claim::Open && search.goes_on()
            })
            .map(|(_, way)| self.levers_aslant(&piece, way))
            .filter(|levers| duller(*levers));
        if let Some(levers) = aslant {
            return Fate::Dull(Node { piece, near }, vec![levers]);
        }
        if failed || size <= FINEST_M || !search.goes_on() {
            // A place outside all areas may fail with a bound that would do.
            let bound = if failed { bound } else { self.bound(&near, seen, search) }.min(target - ROUNDING_M);
            return Fate::Lacking([middle.piece.a[0], middle.piece.c[0]], bound);
        }
        let kept = |close: &Vec<(u32, f64)>| close.iter().map(|(_, kept)| *kept).reduce(f64::min);
        let lacking = target - close.iter().filter_map(kept).fold(seen.taken.no_room(), f64::max);
        // Halving the time divides the bow by four.
        let in_time = HALVING_SAVES * seen.taken.bow[0] >= lacking;
        let halves = if in_time { piece.halves(|piece| &mut piece.t) } else { piece.halves_of_longest(corners) };
        halved(halves, &near)
    }

    /// The place in the middle of a piece.
    fn middle(&self, piece: &BodyPiece) -> Seen {
        let piece = piece.middle();
        let points = self.corners(&piece)[..1].to_vec();
        Seen { piece, taken: self.taken(&piece).still(), points, careful: true }
    }

    /// Bound of the distance that a piece keeps from a segment, metres, in turned directions too where they may decide.
    fn keeps(&self, seen: &Seen, segment: Segment, way: Point, target: f64) -> f64 {
        let Seen { piece, taken, points, careful } = seen;
        let straight = self.kept(piece, taken, points, segment, way);
        if *careful && (target - ASLANT_M..target).contains(&straight) {
            self.kept_aslant(piece, taken, points, segment, way)
        } else {
            straight
        }
    }

    /// The room of a piece in the area that leaves it most, and the way to the segment that leaves it no more. `None` outside
    /// all areas.
    fn room(&self, near: &[Vec<u32>], seen: &Seen, search: &Search<'_>) -> Option<(f64, Point)> {
        let room = |(b, near): (&&Boundary, &Vec<u32>)| {
            let to = |&k: &u32| {
                let (segment, way) = (b.segments[k as usize], way(&seen.points, b.segments[k as usize]));
                (self.keeps(seen, segment, way, search.target), way)
            };
            let least = |x: (f64, Point), y: (f64, Point)| if y.0 < x.0 { y } else { x };
            b.contains(seen.points[0]).then(|| near.iter().map(to).fold((f64::INFINITY, [0.0; 2]), least))
        };
        search.boundaries.iter().zip(near).filter_map(room).reduce(|x, y| if y.0 > x.0 { y } else { x })
    }

    /// The least that is said of places outside, by the area that says most.
    fn beyond_all(&self, near: &[Vec<u32>], seen: &Seen, search: &Search<'_>) -> f64 {
        let all = search.boundaries.iter().zip(near);
        let segments = all.flat_map(|(b, near)| near.iter().map(|&k| b.segments[k as usize]));
        let beyond = segments.map(|segment| self.beyond(&seen.piece, &seen.taken, &seen.points, segment));
        beyond.fold(seen.taken.no_room(), f64::max)
    }

    /// The room of a piece, or what is said of it outside.
    fn bound(&self, near: &[Vec<u32>], seen: &Seen, search: &Search<'_>) -> f64 {
        self.room(near, seen, search).map_or_else(|| self.beyond_all(near, seen, search), |(bound, _)| bound)
    }
}

/// Both halves, each with the segments of the whole.
fn halved(halves: [BodyPiece; 2], near: &[Vec<u32>]) -> Fate {
    Fate::Halved(halves.map(|piece| Node { piece, near: near.to_vec() }))
}

/// The numbers of segments, without what is known of each.
fn numbers<T>(near: &[Vec<(u32, T)>]) -> Vec<Vec<u32>> {
    near.iter().map(|near| near.iter().map(|(k, _)| *k).collect()).collect()
}
