//! Distances to the boundary of an area, positive inside, for scores only: from a raster that is filled where it is
//! asked, and linear between its nodes. Nothing rests on it.

use crate::corridor::Area;

/// Distance between nodes, metres.
const CELL_M: f64 = 0.25;
/// Nodes along a block. The boundary's segments that may be nearest are found once a block.
const BLOCK: usize = 16;
/// Greatest distance that is told, metres.
const FARTHEST_M: f64 = 6.0;
/// Added to distances in the raster, where 0 stands for a node that was not asked for yet.
const OFFSET_M: f32 = 100.0;

type Segment = [[f64; 2]; 2];

/// The distances in a rectangle.
pub(super) struct Field {
    low: [f64; 2],
    size: [usize; 2],
    nodes: Vec<f32>,
    segments: Vec<Segment>,
    /// By block: the segments that may be nearest to its nodes.
    blocks: Vec<Option<Vec<Segment>>>,
    /// By row of nodes: where the boundary crosses it.
    rows: Vec<Option<Vec<f64>>>,
}

impl Field {
    /// The field of an area within `around_m` of a place, in both directions of both axes.
    pub(super) fn new(area: &Area, centre: [f64; 2], around_m: f64) -> Self {
        let low = centre.map(|c| c - around_m);
        let near = |s: &Segment| {
            (0..2).all(|i| s[0][i].min(s[1][i]) <= centre[i] + around_m && s[0][i].max(s[1][i]) >= low[i])
        };
        let blocks = (2.0 * around_m / (CELL_M * BLOCK as f64)).ceil() as usize + 1;
        let size = [blocks * BLOCK; 2];
        // Segments beyond the rectangle count for the inside, too.
        let segments: Vec<Segment> = area.segments().collect();
        let (mut segments, far): (Vec<Segment>, Vec<Segment>) = segments.into_iter().partition(near);
        let beside = |s: &Segment| s[0][0].max(s[1][0]) > low[0];
        segments.extend(far.into_iter().filter(beside));
        Self {
            low,
            size,
            nodes: vec![0.0; size[0] * size[1]],
            segments,
            blocks: vec![None; blocks * blocks],
            rows: vec![None; size[1]],
        }
    }

    /// Distance of a place from the boundary, metres, positive inside. Places outside the rectangle are far outside.
    pub(super) fn distance_m(&mut self, [x, y]: [f64; 2]) -> f64 {
        let (u, v) = ((x - self.low[0]) / CELL_M, (y - self.low[1]) / CELL_M);
        let most = (self.size[0] - 1) as f64;
        if !(u >= 0.0 && v >= 0.0 && u < most && v < most) {
            return -FARTHEST_M;
        }
        let (i, j) = (u as usize, v as usize);
        let (s, t) = (u - i as f64, v - j as f64);
        let [a, b, c, d] = [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)].map(|(i, j)| self.node(i, j));
        (a + s * (b - a)) * (1.0 - t) + (c + s * (d - c)) * t
    }

    fn node(&mut self, i: usize, j: usize) -> f64 {
        let at = j * self.size[0] + i;
        if self.nodes[at] == 0.0 {
            self.nodes[at] = self.exact(i, j) as f32 + OFFSET_M;
        }
        f64::from(self.nodes[at] - OFFSET_M)
    }

    fn exact(&mut self, i: usize, j: usize) -> f64 {
        let p = [self.low[0] + i as f64 * CELL_M, self.low[1] + j as f64 * CELL_M];
        let squared = self.block(i / BLOCK, j / BLOCK).iter().map(|s| squared(*s, p)).fold(f64::INFINITY, f64::min);
        let distance_m = squared.sqrt().min(FARTHEST_M);
        let beyond = self.row(j).iter().filter(|x| **x > p[0]).count();
        if beyond % 2 == 1 { distance_m } else { -distance_m }
    }

    fn block(&mut self, i: usize, j: usize) -> &[Segment] {
        let side_m = BLOCK as f64 * CELL_M;
        let (low, segments) = (self.low, &self.segments);
        let blocks = self.size[0] / BLOCK;
        self.blocks[j * blocks + i].get_or_insert_with(|| {
            let centre = [low[0] + (i as f64 + 0.5) * side_m, low[1] + (j as f64 + 0.5) * side_m];
            let far: Vec<f64> = segments.iter().map(|s| squared(*s, centre).sqrt()).collect();
            let half = side_m * std::f64::consts::FRAC_1_SQRT_2;
            let most = far.iter().copied().fold(FARTHEST_M + half, f64::min) + 2.0 * half;
            segments.iter().zip(&far).filter(|(_, far)| **far <= most).map(|(s, _)| *s).collect()
        })
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
        let area = Area { rings: vec![square(5.0), square(1.0), vec![[30.0, -9.0], [31.0, -9.0], [31.0, 9.0]]] };
        let mut field = Field::new(&area, [0.3, -0.2], 9.0);
        for (p, m) in
            [([4.1, 0.2], 0.9), ([0.5, 0.2], -0.5), ([0.0, 2.2], 1.2), ([7.0, 1.0], -2.0), ([50.0, 0.0], -6.0)]
        {
            assert!((field.distance_m(p) - m).abs() < 1e-4, "{p:?} {}", field.distance_m(p));
        }
    }
}
