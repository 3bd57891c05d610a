//! Distances to the boundary of an area, positive inside, for scores only: from a raster that is filled where it is
//! asked, and linear between its nodes. Nothing rests on it.

use crate::corridor::PlaneArea;
use crate::watch;

/// Distance between nodes, metres.
const CELL_M: f64 = 0.25;
/// Cells along a block. Blocks share the nodes between them.
const BLOCK: usize = 8;
const NODES: usize = BLOCK + 1;
/// Blocks along a tile.
const TILE: usize = 8;
/// Greatest distance that is told, metres.
const FARTHEST_M: f64 = 6.0;

/// Segments that are compared together.
const LANES: usize = 8;

type Segment = [[f64; 2]; 2];

/// Eight segments: starts, directions, and one over the squared lengths. Coordinates are from the middle of a block, so that single
/// precision is enough.
#[derive(Clone)]
struct Eight {
    start: [[f32; LANES]; 2],
    way: [[f32; LANES]; 2],
    per_squared: [f32; LANES],
}

/// The distances in a square.
pub(super) struct Field {
    low: [f64; 2],
    /// Blocks along each side.
    side: usize,
    segments: Vec<Segment>,
    /// By tile: the segments that may be nearest to its nodes.
    tiles: Vec<Option<Vec<Segment>>>,
    blocks: Vec<Option<Box<Block>>>,
    /// By row of nodes: where the boundary crosses it.
    rows: Vec<Option<Vec<f64>>>,
}

/// A few nodes, and the segments that may be nearest to them. Nodes that nobody has asked for are NaN.
struct Block {
    nodes: [f32; NODES * NODES],
    middle: [f64; 2],
    segments: Vec<Eight>,
}

impl Field {
    /// The field of an area within `around_m` of a place, in both directions of both axes.
    pub(super) fn new(area: &PlaneArea, centre: [f64; 2], around_m: f64) -> Self {
        let low = centre.map(|c| c - around_m);
        let tiles = (2.0 * around_m / (CELL_M * (BLOCK * TILE) as f64)).ceil() as usize;
        let side = tiles * TILE;
        Self {
            low,
            side,
            segments: area.segments().collect(),
            tiles: vec![None; tiles * tiles],
            blocks: (0..side * side).map(|_| None).collect(),
            rows: vec![None; side * BLOCK + 1],
        }
    }

    /// Distance of a place from the boundary, metres, positive inside. Places outside the square are far outside.
    pub(super) fn distance_m(&mut self, [x, y]: [f64; 2]) -> f64 {
        let (u, v) = ((x - self.low[0]) / CELL_M, (y - self.low[1]) / CELL_M);
        let most = (self.side * BLOCK) as f64;
        if !(u >= 0.0 && v >= 0.0 && u < most && v < most) {
            return -FARTHEST_M;
        }
        let (i, j) = (u as i32 as usize, v as i32 as usize);
        let (s, t) = ((u - i as f64) as f32, (v - j as f64) as f32);
        let at = j / BLOCK * self.side + i / BLOCK;
        let first = (j % BLOCK) * NODES + i % BLOCK;
        let between = |[a, b, c, d]: [f32; 4]| f64::from((a + s * (b - a)) * (1.0 - t) + (c + s * (d - c)) * t);
        if let Some(Block { nodes, .. }) = self.blocks[at].as_deref() {
            let m = between([nodes[first], nodes[first + 1], nodes[first + NODES], nodes[first + NODES + 1]]);
            if !m.is_nan() {
                return m;
            }
        }
        between(self.corners(at, first, [i, j]))
    }

    /// The four nodes around a place, computed where they are not known.
    #[cold]
    fn corners(&mut self, at: usize, first: usize, [i, j]: [usize; 2]) -> [f32; 4] {
        if self.blocks[at].is_none() {
            self.blocks[at] = Some(Box::new(self.block(i / BLOCK, j / BLOCK)));
        }
        [(first, i, j), (first + 1, i + 1, j), (first + NODES, i, j + 1), (first + NODES + 1, i + 1, j + 1)]
            .map(|(node, i, j)| self.fill(at, node, i, j))
    }

    /// A node of a block, computed when it is first asked for.
    fn fill(&mut self, at: usize, node: usize, i: usize, j: usize) -> f32 {
        let known = self.blocks[at].as_ref().map_or(f32::NAN, |block| block.nodes[node]);
        if !known.is_nan() {
            return known;
        }
        watch::poll();
        let p = [self.low[0] + i as f64 * CELL_M, self.low[1] + j as f64 * CELL_M];
        let beyond = self.row(j).iter().filter(|x| **x > p[0]).count();
        let Some(block) = &mut self.blocks[at] else { return f32::NAN };
        let distance_m = block.distance_m(p);
        let distance_m = if beyond % 2 == 1 { distance_m } else { -distance_m };
        block.nodes[node] = distance_m;
        distance_m
    }

    fn block(&mut self, i: usize, j: usize) -> Block {
        let side_m = BLOCK as f64 * CELL_M;
        let centre = |n: usize, side_m: f64, low: f64| low + (n as f64 + 0.5) * side_m;
        let low = self.low;
        let (tile_m, all) = (TILE as f64 * side_m, &self.segments);
        let (a, b) = (i / TILE, j / TILE);
        let tile = self.tiles[b * (self.side / TILE) + a]
            .get_or_insert_with(|| nearest(all, [centre(a, tile_m, low[0]), centre(b, tile_m, low[1])], tile_m));
        let middle = [centre(i, side_m, low[0]), centre(j, side_m, low[1])];
        let segments = nearest(tile, middle, side_m);
        Block { nodes: [f32::NAN; NODES * NODES], middle, segments: Eight::all(&segments, middle) }
    }

    fn row(&mut self, j: usize) -> &[f64] {
        let y = self.low[1] + j as f64 * CELL_M;
        let segments = &self.segments;
        self.rows[j].get_or_insert_with(|| {
            let crosses = |s: &&Segment| (s[0][1] > y) != (s[1][1] > y);
            let at = |[a, b]: &Segment| a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
            segments.iter().filter(crosses).map(at).collect()
        })
    }
}

impl Block {
    /// Distance of a place from the nearest segment, at most [`FARTHEST_M`].
    fn distance_m(&self, p: [f64; 2]) -> f32 {
        let p = [0, 1].map(|k| (p[k] - self.middle[k]) as f32);
        let mut least = [(FARTHEST_M * FARTHEST_M) as f32; LANES];
        for Eight { start: [x, y], way: [u, v], per_squared } in &self.segments {
            for i in 0..LANES {
                let (a, b) = (p[0] - x[i], p[1] - y[i]);
                let t = ((a * u[i] + b * v[i]) * per_squared[i]).clamp(0.0, 1.0);
                let (a, b) = (a - t * u[i], b - t * v[i]);
                let squared = a * a + b * b;
                least[i] = if squared < least[i] { squared } else { least[i] };
            }
        }
        least.into_iter().fold(f32::INFINITY, f32::min).sqrt()
    }
}

impl Eight {
    /// Segments by eights, seen from a place. The last segment fills the lanes that are left.
    fn all(segments: &[Segment], from: [f64; 2]) -> Vec<Self> {
        let of = |chunk: &[Segment]| {
            let at = |i: usize| chunk[i.min(chunk.len() - 1)];
            let lanes = |value: &dyn Fn(Segment) -> f64| std::array::from_fn(|i| value(at(i)) as f32);
            Self {
                start: [0, 1].map(|k| lanes(&|[a, _]| a[k] - from[k])),
                way: [0, 1].map(|k| lanes(&|[a, b]| b[k] - a[k])),
                per_squared: lanes(&|[a, b]| 1.0 / ((b[0] - a[0]).powi(2) + (b[1] - a[1]).powi(2)).max(1e-12)),
            }
        };
        segments.chunks(LANES).map(of).collect()
    }
}

/// The segments that may be the nearest one to a place in a square.
fn nearest(segments: &[Segment], centre: [f64; 2], side_m: f64) -> Vec<Segment> {
    let half_m = side_m * std::f64::consts::FRAC_1_SQRT_2;
    let far: Vec<f64> = segments.iter().map(|s| squared(*s, centre).sqrt()).collect();
    let most_m = far.iter().copied().fold(FARTHEST_M, f64::min) + 2.0 * half_m;
    segments.iter().zip(&far).filter(|(_, far)| **far <= most_m).map(|(s, _)| *s).collect()
}

/// Squared distance of a place from a segment.
fn squared([a, b]: Segment, p: [f64; 2]) -> f64 {
    let (d, e) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let t = ((e[0] * d[0] + e[1] * d[1]) / (d[0] * d[0] + d[1] * d[1]).max(1e-12)).clamp(0.0, 1.0);
    (e[0] - t * d[0]).powi(2) + (e[1] - t * d[1]).powi(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_those_to_the_nearest_side() {
        let square = |half: f64| vec![[-half, -half], [half, -half], [half, half], [-half, half]];
        let area = PlaneArea { rings: vec![square(5.0), square(1.0), vec![[30.0, -9.0], [31.0, -9.0], [31.0, 9.0]]] };
        let mut field = Field::new(&area, [0.3, -0.2], 9.0);
        for (p, m) in
            [([4.1, 0.2], 0.9), ([0.5, 0.2], -0.5), ([0.0, 2.2], 1.2), ([7.0, 1.0], -2.0), ([50.0, 0.0], -6.0)]
        {
            assert!((field.distance_m(p) - m).abs() < 1e-4, "{p:?} {}", field.distance_m(p));
        }
    }
}
