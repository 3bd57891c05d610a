//! The room that an area leaves: distances to its boundary, found through a grid of cells.

use netcert_base::corridor::PlaneArea;
use netcert_base::watch;
use netcert_base::work_count::{WorkKind, count};

/// Leeway where nothing is bounded. It is above the mark for a missing bound, which the hinges set.
pub(in crate::stet) const FAR_OUTSIDE_M: f64 = -300.0;
/// A place in the plane, metres.
pub(in crate::stet) type PlanePoint = [f64; 2];

/// Side of a cell, metres.
const CELL_M: f64 = 3.0;
/// No place of a cell is farther from its middle, metres: half of its diagonal and an allowance for rounding.
const HALF_CELL_M: f64 = 0.5 * CELL_M * std::f64::consts::SQRT_2 + 1e-6;
/// The grid begins this much before the boundary and [`FAR_M`]. These are no round numbers, so a cell's corner hardly ever lies on a
/// boundary drawn in round numbers.
const ORIGIN_M: PlanePoint = [0.137_421, 0.211_973];
/// Distances up to this are exact, metres. Beyond it a place just has at least this much room.
const FAR_M: f64 = 4.0;
/// Most cells of a grid. An area of a square kilometre has a ninth of it.
const MOST_CELLS: usize = 1 << 20;
/// Distances below this have no direction, metres; and their square.
const TOUCHING_M: f64 = 1e-9;
const TOUCHING_M2: f64 = 1e-18;
/// A rough room is enough if it leaves this much more than what is enough, metres: the piece soon needs a better one otherwise.
const SPARE_M: f64 = 0.2;
/// Segments that share a box.
const BUNDLE: usize = 8;
/// How much deeper outside than it is a piece may be taken to be: metres, and as a share of its depth.
const ROUNDED_M: f64 = 0.1;
const ROUNDED: f64 = 0.1;

/// A cell of the grid.
#[derive(Clone, Copy)]
struct Cell {
    column: usize,
    row: usize,
}

/// A piece of a side over a step.
pub(in crate::stet) struct SweptPiece<'a> {
    /// Its ends at both stations.
    pub(in crate::stet) before: [PlanePoint; 2],
    pub(in crate::stet) after: [PlanePoint; 2],
    /// Most that its places may move in any direction, and both ends in a given one, metres. Between the ends it is convex.
    pub(in crate::stet) most: f64,
    pub(in crate::stet) stray: &'a dyn Fn(PlanePoint) -> [f64; 2],
    /// A leeway of at least this much need not be exact.
    pub(in crate::stet) enough: f64,
    /// Whether it is known to be inside at the first station.
    pub(in crate::stet) inside: bool,
}

impl SweptPiece<'_> {
    /// The piece at both stations, prolonged by what it slides along itself: what is left is its way across, and the difference
    /// of its two directions, metres.
    fn unslid(&self) -> ([PlanePoint; 2], [PlanePoint; 2], f64) {
        let (mut before, mut after) = (self.before, self.after);
        let unit = |piece: [PlanePoint; 2]| {
            let length = apart(piece[0], piece[1]).max(TOUCHING_M);
            [0, 1].map(|k| (piece[0][k] - piece[1][k]) / length)
        };
        let (u, v) = (unit(before), unit(after));
        let slid: f64 = [0, 1].map(|k| u[k] * (after[1][k] - before[1][k])).iter().sum();
        let (ahead, behind) = if slid > 0.0 { (0, 1) } else { (1, 0) };
        for k in 0..2 {
            before[ahead][k] += slid * u[k];
            after[behind][k] -= slid * v[k];
        }
        let turned = [0, 1].map(|k| before[0][k] - before[1][k] - after[0][k] + after[1][k]);
        (before, after, apart(turned, [0.0; 2]))
    }

    /// Most that the piece may come closer to what is `gap` away from it, in metres and direction. An end that is farther back may
    /// move more.
    fn stray_towards(&self, gap: PlanePoint, far: f64) -> f64 {
        if far < TOUCHING_M {
            return self.most;
        }
        let towards = [gap[0] / far, gap[1] / far];
        let reached = |p: PlanePoint| towards[0] * p[0] + towards[1] * p[1];
        let ends = [0, 1].map(|end| reached(self.before[end]).max(reached(self.after[end])));
        let stray = (self.stray)(towards);
        let most = ends[0].max(ends[1]);
        (stray[0] + ends[0] - most).max(stray[1] + ends[1] - most)
    }
}

/// A segment near a cell.
#[derive(Clone, Copy)]
struct Near {
    segment: u32,
    /// Distance from the cell's middle, metres.
    middle_m: f64,
}

/// An area's boundary, with the segments near each cell of a grid.
pub(crate) struct AreaGrid {
    origin: PlanePoint,
    columns: usize,
    rows: usize,
    segments: Vec<Segment>,
    /// Corners of boxes around every [`BUNDLE`] segments.
    bundles: Vec<[PlanePoint; 2]>,
    /// Segments within [`FAR_M`] of each cell, the nearest to its middle first: `near[starts[cell]..starts[cell + 1]]`.
    starts: Vec<u32>,
    near: Vec<Near>,
    /// Whether each cell's own corner lies inside.
    inside: Vec<bool>,
}

impl AreaGrid {
    /// `None` if the boundary has no segment, is not finite, or is too large for a grid. Nothing is inside then.
    pub(in crate::stet) fn new(area: &PlaneArea) -> Option<Self> {
        let segments: Vec<Segment> = area.segments().map(Segment::new).collect();
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for p in segments.iter().map(|segment| segment.a) {
            for k in 0..2 {
                if !p[k].is_finite() {
                    return None;
                }
                (low[k], high[k]) = (low[k].min(p[k]), high[k].max(p[k]));
            }
        }
        let origin = [low[0] - FAR_M - ORIGIN_M[0], low[1] - FAR_M - ORIGIN_M[1]];
        let cells = |k: usize| ((high[k] + FAR_M - origin[k]) / CELL_M).ceil() + 1.0;
        if segments.is_empty() || cells(0) * cells(1) > MOST_CELLS as f64 {
            return None;
        }
        let (columns, rows) = (cells(0) as usize, cells(1) as usize);
        let mut ground = Self {
            origin,
            columns,
            rows,
            bundles: segments.chunks(BUNDLE).map(around).collect(),
            segments,
            starts: Vec::new(),
            near: Vec::new(),
            inside: Vec::new(),
        };
        ground.sort_segments();
        ground.mark_inside();
        Some(ground)
    }

    /// Lists the segments near each cell.
    fn sort_segments(&mut self) {
        let mut pairs: Vec<(u32, Near)> = Vec::new();
        let half = 0.5 * CELL_M;
        let reach = FAR_M + HALF_CELL_M;
        for (number, segment) in (0..).zip(&self.segments) {
            let (a, b) = (segment.a, segment.b);
            let range = |k: usize, count: usize| {
                let from = (a[k].min(b[k]) - FAR_M - self.origin[k]) / CELL_M;
                let to = (a[k].max(b[k]) + FAR_M - self.origin[k]) / CELL_M;
                from.floor().max(0.0) as usize..=(to.floor().max(0.0) as usize).min(count - 1)
            };
            for row in range(1, self.rows) {
                for column in range(0, self.columns) {
                    let corner = self.corner(column, row);
                    let squared = segment.squared([corner[0] + half, corner[1] + half]);
                    if squared <= reach * reach {
                        let near = Near { segment: number, middle_m: squared.sqrt() };
                        pairs.push(((row * self.columns + column) as u32, near));
                    }
                }
            }
        }
        // By cell first, which needs no comparisons.
        self.starts = vec![0; self.columns * self.rows + 1];
        for (cell, _) in &pairs {
            self.starts[*cell as usize + 1] += 1;
        }
        for cell in 1..self.starts.len() {
            self.starts[cell] += self.starts[cell - 1];
        }
        let mut next = self.starts.clone();
        self.near = vec![Near { segment: 0, middle_m: 0.0 }; pairs.len()];
        for (cell, near) in pairs {
            let next = &mut next[cell as usize];
            self.near[*next as usize] = near;
            *next += 1;
        }
        for cell in self.starts.windows(2) {
            let near = &mut self.near[cell[0] as usize..cell[1] as usize];
            near.sort_unstable_by(|a, b| a.middle_m.total_cmp(&b.middle_m).then(a.segment.cmp(&b.segment)));
        }
    }

    /// Marks the cells whose corner lies inside, row by row: the boundary changes sides where it crosses the row.
    fn mark_inside(&mut self) {
        for row in 0..self.rows {
            let y = self.corner(0, row)[1];
            let mut crossings: Vec<f64> =
                self.segments.iter().filter(|s| (s.a[1] > y) != (s.b[1] > y)).map(|s| crossing(s.a, s.b, y)).collect();
            crossings.sort_unstable_by(f64::total_cmp);
            for column in 0..self.columns {
                let x = self.corner(column, row)[0];
                self.inside.push(crossings.partition_point(|&at| at <= x) % 2 == 1);
            }
        }
    }

    fn corner(&self, column: usize, row: usize) -> PlanePoint {
        [self.origin[0] + column as f64 * CELL_M, self.origin[1] + row as f64 * CELL_M]
    }

    /// The cell of a place. `None` outside the grid, which is outside the area.
    fn cell(&self, p: PlanePoint) -> Option<Cell> {
        let [x, y] = [0, 1].map(|k| (p[k] - self.origin[k]) / CELL_M);
        let on = x >= 0.0 && y >= 0.0 && x < self.columns as f64 && y < self.rows as f64;
        on.then_some(Cell { column: x as usize, row: y as usize })
    }

    fn near(&self, cell: Cell) -> &[Near] {
        let cell = cell.row * self.columns + cell.column;
        &self.near[self.starts[cell] as usize..self.starts[cell + 1] as usize]
    }

    /// Square of the distance of a place from the boundary, at most the square of [`FAR_M`]; and the nearest segment, if it is so near.
    fn nearest(&self, near: &[Near], p: PlanePoint) -> (f64, Option<u32>) {
        let mut nearest = (FAR_M * FAR_M, None);
        let mut nearest_m = FAR_M;
        for &Near { segment, middle_m } in near {
            // All that follow are farther.
            if middle_m - HALF_CELL_M >= nearest_m {
                break;
            }
            let squared = self.segments[segment as usize].squared(p);
            if squared < nearest.0 {
                nearest = (squared, Some(segment));
                nearest_m = squared.sqrt();
            }
        }
        nearest
    }

    /// Whether a place lies inside: as its cell's corner, unless the boundary is crossed an odd number of times on the way
    /// there, along the row and then along the column.
    fn contains(&self, p: PlanePoint) -> bool {
        let Some(cell) = self.cell(p) else { return false };
        let corner = self.corner(cell.column, cell.row);
        let mut inside = self.inside[cell.row * self.columns + cell.column];
        // The way from the corner does not leave the cell.
        for &Near { segment, .. } in self.near(cell).iter().take_while(|near| near.middle_m <= HALF_CELL_M) {
            let Segment { a, b, .. } = self.segments[segment as usize];
            if (a[1] > p[1]) != (b[1] > p[1]) {
                let at = crossing(a, b, p[1]);
                inside ^= at > corner[0] && at <= p[0];
            }
            if (a[0] > corner[0]) != (b[0] > corner[0]) {
                let at = crossing([a[1], a[0]], [b[1], b[0]], corner[0]);
                inside ^= at > corner[1] && at <= p[1];
            }
        }
        inside
    }

    /// Room of a place: its distance to the boundary, negative outside, at most [`FAR_M`]. `inside`: whether the place is inside, where
    /// that is known.
    pub(in crate::stet) fn room(&self, p: PlanePoint, inside: Option<bool>) -> f64 {
        self.room_and_nearest(p, inside).0
    }

    /// Room of a place, and the nearest segment: `None` for a place inside that is farther than [`FAR_M`] from all of them.
    fn room_and_nearest(&self, p: PlanePoint, inside: Option<bool>) -> (f64, Option<u32>) {
        count(WorkKind::Distance, 1);
        let near = self.nearest(self.cell(p).map_or(&[][..], |cell| self.near(cell)), p);
        let far = near.0.sqrt();
        match inside.unwrap_or_else(|| self.contains(p)) {
            true => (far, near.1),
            false if near.1.is_some() => (-far, near.1),
            false => {
                let (squared, segment) = self.nearest_of_all(p);
                (-squared.sqrt(), segment)
            }
        }
    }

    /// Square of the distance of a place from the boundary, and the nearest segment.
    fn nearest_of_all(&self, p: PlanePoint) -> (f64, Option<u32>) {
        let mut nearest = (f64::INFINITY, None);
        for (first, (segments, [low, high])) in
            (0..).step_by(BUNDLE).zip(self.segments.chunks(BUNDLE).zip(&self.bundles))
        {
            let [x, y] = [0, 1].map(|k| (low[k] - p[k]).max(p[k] - high[k]).max(0.0));
            if x * x + y * y >= nearest.0 {
                continue;
            }
            for (number, segment) in (first..).zip(segments) {
                let squared = segment.squared(p);
                if squared < nearest.0 {
                    nearest = (squared, Some(number));
                }
            }
        }
        nearest
    }

    /// Room and leeway of a piece of a side over a step. The room is the distance from the boundary of the hull of the piece at both
    /// stations; the leeway is less by what the piece may move towards each segment. Neither is too great. Both are negative where
    /// the hull is not inside.
    pub(in crate::stet) fn swept(&self, piece: &SweptPiece<'_>) -> (f64, f64) {
        count(WorkKind::Distance, 1);
        let corners = [piece.before[0], piece.before[1], piece.after[1], piece.after[0]];
        let outside = || {
            let depth = self.depth(piece);
            (-depth, -depth - piece.most)
        };
        let middle = [0, 1].map(|k| 0.25 * corners.iter().map(|p| p[k]).sum::<f64>());
        let reach = corners.iter().map(|p| apart(*p, middle)).fold(0.0, f64::max);
        let Some(cell) = self.cell(middle).filter(|_| reach < FAR_M) else { return outside() };
        let near = self.near(cell);
        let nearest = self.nearest(near, middle);
        if !piece.inside && !self.contains(middle) {
            return outside();
        }
        let rough = nearest.0.sqrt() - reach;
        let Some(first) = nearest.1.filter(|_| rough - piece.most < piece.enough + SPARE_M) else {
            return (rough, rough - piece.most);
        };
        let (mut room, mut leeway) = (FAR_M - reach, FAR_M - reach - piece.most);
        let pairs = pairs(&corners);
        let nearest = Near { segment: first, middle_m: 0.0 };
        for near in std::iter::once(&nearest).chain(near.iter().filter(|near| near.segment != first)) {
            let segment = &self.segments[near.segment as usize];
            let within = (leeway + piece.most).max(room) + reach;
            if near.middle_m - HALF_CELL_M >= within {
                break;
            }
            let way = segment.towards(middle);
            let squared = way[0] * way[0] + way[1] * way[1];
            if squared >= within * within {
                continue;
            }
            let beyond = beyond_line(&corners, middle, way, squared.sqrt());
            if beyond > TOUCHING_M && beyond - piece.most >= leeway.min(piece.enough) {
                room = room.min(beyond);
                leeway = leeway.min(beyond - piece.most);
                continue;
            }
            let Some(gap) = segment.gap(&corners, &pairs) else { return outside() };
            let far = apart(gap, [0.0; 2]);
            room = room.min(far);
            leeway = leeway.min(far - piece.stray_towards(gap, far));
        }
        (room, leeway)
    }

    /// How far a swept piece is outside at most, metres: at least as deep as any place of its hull, and little deeper unless the leeway
    /// is enough. What is enough changes no depth that is not enough.
    ///
    /// A part of the piece over a part of the step is bounded in two ways. Rooms change no faster than places, so its middle speaks for all of it.
    /// And no place is deeper than its distance from the segment that is nearest to the middle, which is greatest at a corner of the part.
    fn depth(&self, swept: &SweptPiece<'_>) -> f64 {
        let between = |a: PlanePoint, b: PlanePoint, part: f64| [0, 1].map(|k| a[k] + part * (b[k] - a[k]));
        let (before, after, turned) = swept.unslid();
        let at = |part: f64, moment: f64| {
            let [front, rear] = [0, 1].map(|i| between(before[i], after[i], moment));
            between(front, rear, part)
        };
        // A place of the hull between two of the piece's own is off the piece by at most that much.
        let off = 0.25 * turned;
        let length = apart(before[0], before[1]).max(apart(after[0], after[1]));
        let way = apart(before[0], after[0]).max(apart(before[1], after[1]));
        let mut most = 0.0_f64;
        // The parts of the piece and of the step, by their middle and half of their share, and how deep they may be.
        let mut open = vec![([0.5; 2], [0.5; 2], f64::INFINITY)];
        while let Some(([part, moment], [half_part, half_moment], within)) = open.pop() {
            watch::poll();
            if within <= most {
                continue;
            }
            let (half_length, half_way) = (half_part * length, half_moment * way);
            let (room, nearest) = self.room_and_nearest(at(part, moment), None);
            let depth = -room;
            let around = depth + half_length + half_way;
            if around.is_nan() {
                return f64::INFINITY;
            }
            let bound = nearest.map_or(around, |segment| {
                let segment = &self.segments[segment as usize];
                let corner = |s: f64, t: f64| segment.squared(at(part + s * half_part, moment + t * half_moment));
                let corners = [corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, -1.0), corner(1.0, 1.0)];
                around.min(corners.into_iter().fold(0.0, f64::max).sqrt())
            });
            if bound - depth <= ROUNDED_M.max(ROUNDED * depth) || -bound - off - swept.most >= swept.enough {
                most = most.max(bound);
            } else if half_length >= half_way {
                let by = 0.5 * half_part;
                open.extend([part - by, part + by].map(|part| ([part, moment], [by, half_moment], bound)));
            } else {
                let by = 0.5 * half_moment;
                open.extend([moment - by, moment + by].map(|moment| ([part, moment], [half_part, by], bound)));
            }
        }
        most + off
    }

    /// Whether any vertex of the boundary lies within a rectangle: an island may be so small that no side of it is near.
    pub(in crate::stet) fn under(&self, corners: [PlanePoint; 4]) -> bool {
        let within = |p: PlanePoint| {
            (0..4).all(|i| {
                let (a, b) = (corners[i], corners[(i + 1) % 4]);
                (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) >= 0.0
            })
        };
        self.segments.iter().any(|segment| within(segment.a))
    }
}

/// How far four corners lie at least from a segment, of which `way` leads from `middle` to the nearest place, `far` metres. All of the
/// segment lies beyond the line across the way's end. A middle on the segment has no such line.
#[inline(always)]
fn beyond_line(corners: &[PlanePoint; 4], middle: PlanePoint, way: PlanePoint, far: f64) -> f64 {
    if far < TOUCHING_M {
        return f64::NEG_INFINITY;
    }
    let along = |p: &PlanePoint| ((p[0] - middle[0]) * way[0] + (p[1] - middle[1]) * way[1]) / far;
    far - corners.iter().map(along).fold(f64::NEG_INFINITY, f64::max)
}

/// The corners of a box around segments.
fn around(segments: &[Segment]) -> [PlanePoint; 2] {
    let ends = segments.iter().flat_map(|s| [s.a, s.b]);
    ends.fold([[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]], |[low, high], p| {
        [[0, 1].map(|k| p[k].min(low[k])), [0, 1].map(|k| p[k].max(high[k]))]
    })
}

/// Where the line from `a` to `b` reaches the second coordinate `y`.
fn crossing(a: PlanePoint, b: PlanePoint, y: f64) -> f64 {
    a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
}

#[inline]
pub(in crate::stet) fn apart(a: PlanePoint, b: PlanePoint) -> f64 {
    ((a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2)).sqrt()
}

/// A segment of the boundary.
struct Segment {
    a: PlanePoint,
    b: PlanePoint,
    along: PlanePoint,
    /// 1 over the square of its length.
    inverse: f64,
}

impl Segment {
    fn new([a, b]: [PlanePoint; 2]) -> Self {
        let along = [b[0] - a[0], b[1] - a[1]];
        Self { a, b, along, inverse: 1.0 / (along[0] * along[0] + along[1] * along[1]).max(TOUCHING_M2) }
    }

    /// Square of the distance of a place.
    #[inline(always)]
    fn squared(&self, p: PlanePoint) -> f64 {
        let e = [p[0] - self.a[0], p[1] - self.a[1]];
        let share = ((self.along[0] * e[0] + self.along[1] * e[1]) * self.inverse).clamp(0.0, 1.0);
        let off = [e[0] - share * self.along[0], e[1] - share * self.along[1]];
        off[0] * off[0] + off[1] * off[1]
    }

    /// The place of the segment that is nearest to `p`, from `p`.
    #[inline(always)]
    fn towards(&self, p: PlanePoint) -> PlanePoint {
        let e = [p[0] - self.a[0], p[1] - self.a[1]];
        let share = ((self.along[0] * e[0] + self.along[1] * e[1]) * self.inverse).clamp(0.0, 1.0);
        [share * self.along[0] - e[0], share * self.along[1] - e[1]]
    }

    /// The shortest way from the hull of four points to the segment. `None` if they touch. `pairs`: those of the points ([`pairs`]).
    fn gap(&self, corners: &[PlanePoint; 4], pairs: &[Self; 6]) -> Option<PlanePoint> {
        let (a, b) = (self.a, self.b);
        let mut least = (f64::INFINITY, [0.0; 2]);
        let mut shorter = |gap: PlanePoint| {
            let squared = gap[0] * gap[0] + gap[1] * gap[1];
            if squared < least.0 {
                least = (squared, gap);
            }
        };
        corners.iter().for_each(|p| shorter(self.towards(*p)));
        for pair in pairs {
            if cross(pair.a, pair.b, a, b) {
                return None;
            }
            [a, b].into_iter().for_each(|end| shorter(pair.towards(end).map(|x| -x)));
        }
        let within = (0..4).any(|left_out| {
            let [p, q, r] = [1, 2, 3].map(|k| corners[(left_out + k) % 4]);
            let turn = |p: PlanePoint, q: PlanePoint| (q[0] - p[0]) * (a[1] - p[1]) - (q[1] - p[1]) * (a[0] - p[0]);
            let turns = [turn(p, q), turn(q, r), turn(r, p)];
            turns.iter().all(|&t| t > 0.0) || turns.iter().all(|&t| t < 0.0)
        });
        (!within).then_some(least.1)
    }
}

/// The segments between all pairs of four points: the order of the points around their hull does not matter.
fn pairs(points: &[PlanePoint; 4]) -> [Segment; 6] {
    [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]].map(|pair| Segment::new(pair.map(|k| points[k])))
}

/// Whether two segments cross.
fn cross(p: PlanePoint, q: PlanePoint, a: PlanePoint, b: PlanePoint) -> bool {
    let turn =
        |p: PlanePoint, q: PlanePoint, r: PlanePoint| (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
    let (c, d) = (turn(p, q, a), turn(p, q, b));
    let (e, f) = (turn(a, b, p), turn(a, b, q));
    (c > 0.0) != (d > 0.0) && (e > 0.0) != (f > 0.0)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn square(at: PlanePoint, half: f64) -> Vec<PlanePoint> {
        [[-half, -half], [half, -half], [half, half], [-half, half]].map(|p| [p[0] + at[0], p[1] + at[1]]).to_vec()
    }

    fn yard() -> AreaGrid {
        AreaGrid::new(&PlaneArea { rings: vec![square([0.0; 2], 20.0), square([5.0, 5.0], 1.0)] }).unwrap()
    }

    #[test]
    fn a_place_has_the_room_to_the_nearest_edge_or_island() {
        let ground = yard();
        for (p, room) in [
            ([0.0, 0.0], FAR_M),
            ([18.5, 3.0], 1.5),
            ([5.0, 7.0], 1.0),
            ([5.2, 5.0], -0.8),
            ([21.0, 0.0], -1.0),
            ([0.0, -30.0], -10.0),
        ] {
            assert!((ground.room(p, None) - room).abs() < 1e-12, "{p:?}: {}", ground.room(p, None));
        }
    }

    #[test]
    fn cells_know_inside_and_outside_as_the_area_does() {
        let area = PlaneArea { rings: vec![square([0.0; 2], 20.0), square([5.0, 5.0], 1.0), square([-9.0, 3.0], 4.0)] };
        let ground = AreaGrid::new(&area).unwrap();
        for i in 0..120 {
            for j in 0..120 {
                let p = [-30.0 + 0.5 * f64::from(i) + 0.013, -30.0 + 0.5 * f64::from(j) + 0.017];
                assert_eq!(ground.contains(p), area.contains(p), "{p:?}");
            }
        }
    }

    fn room(before: [PlanePoint; 2], after: [PlanePoint; 2]) -> f64 {
        yard().swept(&SweptPiece { before, after, most: 0.0, enough: FAR_M, stray: &|_| [0.0; 2], inside: false }).0
    }

    #[test]
    fn a_piece_that_passes_an_edge_between_two_moments_does_not_fit() {
        assert!(room([[3.5, 3.0], [4.5, 3.0]], [[3.5, 8.0], [4.6, 8.0]]) < 0.0);
        assert!((room([[17.0, 1.0], [17.0, 2.0]], [[18.0, 1.5], [18.5, 2.5]]) - 1.5).abs() < 1e-12);
    }

    #[test]
    fn a_piece_whose_middle_lies_on_an_edge_does_not_fit() {
        // All numbers are exact.
        let area = PlaneArea { rings: vec![square([0.0; 2], 16.0)] };
        let ground = AreaGrid::new(&area).unwrap();
        for (before, after) in [
            ([[-15.5, 1.0], [-15.5, 2.0]], [[-16.5, 1.0], [-16.5, 2.0]]),
            ([[15.5, 1.0], [15.5, 2.0]], [[16.5, 1.0], [16.5, 2.0]]),
            ([[16.0, 1.0], [16.0, 2.0]], [[16.0, 2.0], [16.0, 3.0]]),
        ] {
            for inside in [false, true] {
                let piece = SweptPiece { before, after, most: 0.0, enough: FAR_M, stray: &|_| [0.0; 2], inside };
                let (room, leeway) = ground.swept(&piece);
                assert!(room <= 0.0 && leeway <= 0.0, "{before:?} {inside}: {room} {leeway}");
            }
        }
    }

    #[test]
    fn what_is_outside_is_as_deep_as_its_deepest_place() {
        let ground = yard();
        let mut state = 7_u32;
        let mut draw = |least: f64, most: f64| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            least + (most - least) * f64::from(state >> 8) / f64::from(1_u32 << 24)
        };
        for _ in 0..300 {
            let (at, heading, turn) = ([draw(15.0, 24.0), draw(-6.0, 6.0)], draw(-3.2, 3.2), draw(-0.1, 0.1));
            let (length, slid, aside) = (draw(0.0, 1.5), draw(-1.0, 1.0), draw(-0.8, 0.8));
            let ends =
                |at: PlanePoint, heading: f64| [at, [at[0] - length * heading.cos(), at[1] - length * heading.sin()]];
            let moved = [
                at[0] + slid * heading.cos() - aside * heading.sin(),
                at[1] + slid * heading.sin() + aside * heading.cos(),
            ];
            let (before, after) = (ends(at, heading), ends(moved, heading + turn));
            let mut deepest = 0.0_f64;
            for i in 0..=40 {
                for j in 0..=40 {
                    let (part, moment) = (f64::from(i) / 40.0, f64::from(j) / 40.0);
                    let between = |a: PlanePoint, b: PlanePoint, t: f64| [0, 1].map(|k| a[k] + t * (b[k] - a[k]));
                    let piece = [0, 1].map(|end| between(before[end], after[end], moment));
                    deepest = deepest.max(-ground.room(between(piece[0], piece[1], part), None));
                }
            }
            let depth = |enough: f64| {
                let swept = SweptPiece { before, after, most: 0.0, enough, stray: &|_| [0.0; 2], inside: false };
                ground.depth(&swept)
            };
            // What slides is prolonged, and the prolonged piece goes aside and turns, too.
            let off = aside.abs() + turn.abs() * (length + slid.abs());
            let found = depth(f64::INFINITY);
            assert!(found >= deepest, "{found} {deepest}: {before:?} {after:?}");
            assert!(
                found <= deepest + ROUNDED_M.max(ROUNDED * deepest) + off + 0.02,
                "{found} {deepest}: {before:?} {after:?}"
            );
            assert!(depth(-1.0) >= deepest);
        }
    }

    #[test]
    fn what_moves_along_an_edge_costs_no_leeway() {
        let (before, after) = ([[17.0, 1.0], [17.0, 2.0]], [[18.0, 1.5], [18.5, 2.5]]);
        let stray = |towards: PlanePoint| [0.3 * towards[1].abs() + 0.1 * towards[0].abs(); 2];
        let piece = SweptPiece { before, after, most: 0.4, enough: FAR_M, stray: &stray, inside: false };
        let (room, leeway) = yard().swept(&piece);
        assert!((room - 1.5).abs() < 1e-12 && (leeway - 1.4).abs() < 1e-12, "{room} {leeway}");
    }

    /// A star of 90 corners with an island, and places around it.
    fn star() -> (PlaneArea, Vec<PlanePoint>) {
        let corner = |k: u32| {
            let angle = f64::from(k) / 90.0 * std::f64::consts::TAU;
            let radius = 14.0 + 5.0 * (7.0 * angle).sin() + 0.8 * (31.0 * angle).cos();
            [radius * angle.cos(), radius * angle.sin()]
        };
        let area = PlaneArea { rings: vec![(0..90).map(corner).collect(), square([2.3, -4.1], 0.7)] };
        let places = (0..6_400_u32).map(|i| [f64::from(i % 80), f64::from(i / 80)].map(|k| -21.0 + 0.531 * k));
        (area, places.collect())
    }

    #[test]
    fn the_nearest_segments_of_a_cell_are_those_of_the_whole_boundary() {
        let (area, places) = star();
        let ground = AreaGrid::new(&area).unwrap();
        for p in places {
            let far = apart(area.nearest(p).unwrap(), p);
            let room = if area.contains(p) { far.min(FAR_M) } else { -far };
            assert!((ground.room(p, None) - room).abs() < 1e-9, "{p:?}: {} {room}", ground.room(p, None));
        }
    }

    #[test]
    fn the_room_of_a_swept_piece_is_that_to_the_whole_boundary() {
        let (area, places) = star();
        let ground = AreaGrid::new(&area).unwrap();
        let mut near = 0;
        for (i, at) in places.into_iter().enumerate().filter(|(_, at)| area.contains(*at)) {
            let (sin, cos) = (0.7 * i as f64).sin_cos();
            let ends = |at: PlanePoint| [at, [at[0] - 1.2 * cos, at[1] - 1.2 * sin]];
            let (before, after) = (ends(at), ends([at[0] + 0.4 * cos - 0.1 * sin, at[1] + 0.4 * sin + 0.1 * cos]));
            let corners = [before[0], before[1], after[1], after[0]];
            let gaps: Option<Vec<PlanePoint>> =
                area.segments().map(|s| Segment::new(s).gap(&corners, &pairs(&corners))).collect();
            let swept = SweptPiece { before, after, most: 0.3, enough: FAR_M, stray: &|_| [0.3; 2], inside: false };
            let (room, leeway) = ground.swept(&swept);
            let Some(gaps) = gaps else {
                assert!(room <= 0.0 && leeway <= -0.3, "{at:?}: {room} {leeway}");
                continue;
            };
            let far = gaps.iter().map(|gap| apart(*gap, [0.0; 2])).fold(f64::INFINITY, f64::min);
            assert!(room <= far + 1e-9 && leeway <= far - 0.3 + 1e-9, "{at:?}: {room} {leeway} {far}");
            if far < FAR_M - 1.5 {
                near += 1;
                assert!((room - far).abs() < 1e-9 && (leeway - far + 0.3).abs() < 1e-9, "{at:?}: {room} {far}");
            }
        }
        assert!(near > 500, "{near}");
    }

    #[test]
    fn an_island_under_the_body_is_found() {
        let ground = yard();
        assert!(ground.under([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]]));
        assert!(!ground.under([[-10.0, 0.0], [0.0, 0.0], [0.0, 10.0], [-10.0, 10.0]]));
    }
}
