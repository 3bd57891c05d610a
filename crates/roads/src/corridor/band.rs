//! Symmetric positive definite systems of half-bandwidth three, factored as L·D·Lᵀ and solved in O(n).

/// The lower band of a symmetric matrix: `rows[i][j]` is the entry (i, i − j).
#[derive(Debug, Clone, Default)]
pub(crate) struct Band {
    pub(crate) rows: Vec<[f64; 4]>,
}

impl Band {
    pub(crate) fn zero(n: usize) -> Self {
        Self { rows: vec![[0.0; 4]; n] }
    }

    /// Adds `weight · v vᵀ`. `entries` are the entries of v from index `first` on.
    pub(crate) fn add_outer(&mut self, first: usize, entries: &[f64; 4], weight: f64) {
        for (i, row) in self.rows[first..first + 4].iter_mut().enumerate() {
            for j in 0..=i {
                row[j] += weight * entries[i] * entries[i - j];
            }
        }
    }

    /// Replaces the matrix by its factors and `b` by the solution, for two right-hand sides at once.
    pub(crate) fn solve_in_place(&mut self, b: &mut [[f64; 2]]) {
        self.factor_forward(b);
        let n = b.len();
        for i in (0..n).rev() {
            let mut x = b[i].map(|v| v * self.rows[i][0]);
            for (j, after) in (i + 1..n.min(i + 4)).enumerate() {
                let l = self.rows[after][j + 1];
                x[0] -= l * b[after][0];
                x[1] -= l * b[after][1];
            }
            b[i] = x;
        }
    }

    /// `rows[i]` becomes [1/d_i, l_(i,i−1), l_(i,i−2), l_(i,i−3)] and `b` becomes L⁻¹ b. The previous three rows stay
    /// in registers, because latency bounds the recursion.
    fn factor_forward(&mut self, b: &mut [[f64; 2]]) {
        let (mut f1, mut f2, mut f3) = ([0.0; 4], [0.0; 4], [0.0; 4]);
        let (mut y1, mut y2, mut y3) = ([0.0; 2], [0.0; 2], [0.0; 2]);
        for (row, b) in self.rows.iter_mut().zip(b) {
            let [a0, a1, a2, a3] = *row;
            let v3 = a3;
            let v2 = a2 - v3 * f2[1];
            let v1 = a1 - v3 * f1[2] - v2 * f1[1];
            let (l1, l2, l3) = (v1 * f1[0], v2 * f2[0], v3 * f3[0]);
            *row = [1.0 / (a0 - v3 * l3 - v2 * l2 - v1 * l1), l1, l2, l3];
            *b = [0, 1].map(|k| b[k] - l3 * y3[k] - l2 * y2[k] - l1 * y1[k]);
            (f3, f2, f1) = (f2, f1, *row);
            (y3, y2, y1) = (y2, y1, *b);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_solution_put_back_in_gives_the_right_hand_side() {
        let n = 40;
        let mut band = Band::zero(n);
        let mut seed = 1u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / 2f64.powi(53) - 0.5
        };
        for first in 0..n - 3 {
            band.add_outer(first, &[random(), random(), random(), random()], 3.0);
        }
        band.rows.iter_mut().for_each(|row| row[0] += 0.1);
        let b: Vec<[f64; 2]> = (0..n).map(|_| [random(), random()]).collect();
        let (full, mut x) = (band.clone(), b.clone());
        band.solve_in_place(&mut x);
        for i in 0..n {
            for k in 0..2 {
                let below: f64 = (0..4.min(i + 1)).map(|j| full.rows[i][j] * x[i - j][k]).sum();
                let above: f64 = (i + 1..n.min(i + 4)).map(|r| full.rows[r][r - i] * x[r][k]).sum();
                assert!((below + above - b[i][k]).abs() < 1e-10);
            }
        }
    }
}
