//! Cubic splines: uniform B-splines for smoothing, and an interpolant for exact points.
//!
//! Both are C² with a third derivative that is constant between knots. A B-spline's value is a convex mean of four
//! coefficients, so a bound on the coefficients over a cell bounds the curve there.

/// Knot spacing of the width profile, metres. A narrow place affects four knots to each side.
pub(crate) const KNOT_M: f64 = 2.5;

/// Value and first three derivatives, `[derivative][component]`.
pub(crate) type Jet<const N: usize> = [[f64; N]; 4];

/// A uniform cubic B-spline over `0..=knot_m · cells`; `cells + 3` coefficients.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Spline<const N: usize> {
    /// Distance between knots, metres.
    pub(crate) knot_m: f64,
    /// At least four coefficients.
    pub(crate) coefficients: Vec<[f64; N]>,
}

impl<const N: usize> Spline<N> {
    /// The cubic of each cell.
    pub(crate) fn cubics(&self) -> Cubics<N> {
        let h = self.knot_m;
        let cubic = |c: &[[f64; N]]| {
            // Differences from one coefficient keep a constant exactly constant.
            let from = |i: usize| -> [f64; N] { std::array::from_fn(|k| c[i][k] - c[1][k]) };
            let (before, after, last) = (from(0), from(2), from(3));
            let of = |value: &dyn Fn(usize) -> f64| std::array::from_fn(value);
            [
                of(&|k| c[1][k] + (before[k] + after[k]) / 6.0),
                of(&|k| (after[k] - before[k]) * (0.5 / h)),
                of(&|k| (before[k] + after[k]) * (0.5 / (h * h))),
                of(&|k| (last[k] - 3.0 * after[k] - before[k]) / (6.0 * h * h * h)),
            ]
        };
        Cubics { knot_m: h, per_m: 1.0 / h, cells: self.coefficients.windows(4).map(cubic).collect() }
    }
}

/// A spline as the cubics of its cells, to be evaluated at many places.
#[derive(Debug)]
pub(crate) struct Cubics<const N: usize> {
    knot_m: f64,
    per_m: f64,
    /// By cell, the coefficients of 1, t, t² and t³, with t in metres from the cell's start. Not empty.
    cells: Vec<[[f64; N]; 4]>,
}

impl<const N: usize> Cubics<N> {
    /// Distance between knots, metres.
    pub(crate) fn knot_m(&self) -> f64 {
        self.knot_m
    }

    /// The ends and middles of all cells.
    pub(crate) fn half_cells(&self) -> impl Iterator<Item = f64> {
        (0..=2 * self.cells.len()).map(|i| 0.5 * i as f64 * self.knot_m)
    }

    /// The cubic at `u`, and the distance from its start. Outside the range the first or last cell's cubic continues.
    #[inline]
    fn cell(&self, u: f64) -> (&[[f64; N]; 4], f64) {
        let cell = ((u * self.per_m).max(0.0) as usize).min(self.cells.len() - 1);
        (&self.cells[cell], u - cell as f64 * self.knot_m)
    }

    /// Value and derivatives at `u`.
    #[inline]
    pub(crate) fn at(&self, u: f64) -> Jet<N> {
        let ([a, b, c, d], t) = self.cell(u);
        [
            std::array::from_fn(|k| a[k] + t * (b[k] + t * (c[k] + t * d[k]))),
            std::array::from_fn(|k| b[k] + t * (2.0 * c[k] + t * (3.0 * d[k]))),
            std::array::from_fn(|k| 2.0 * c[k] + t * (6.0 * d[k])),
            std::array::from_fn(|k| 6.0 * d[k]),
        ]
    }

    /// First and second derivative at `u`.
    #[inline]
    pub(crate) fn bend(&self, u: f64) -> [[f64; N]; 2] {
        let ([_, b, c, d], t) = self.cell(u);
        [
            std::array::from_fn(|k| b[k] + t * (2.0 * c[k] + t * (3.0 * d[k]))),
            std::array::from_fn(|k| 2.0 * c[k] + t * (6.0 * d[k])),
        ]
    }

    /// One component and its first derivative at `u`.
    #[inline]
    pub(crate) fn component(&self, k: usize, u: f64) -> [f64; 2] {
        let ([a, b, c, d], t) = self.cell(u);
        [a[k] + t * (b[k] + t * (c[k] + t * d[k])), b[k] + t * (2.0 * c[k] + t * (3.0 * d[k]))]
    }
}

/// `basis(t)[d][k]` is the d-th derivative (in units of the knot spacing) of the basis function of the k-th of a cell's
/// four active coefficients, at fraction `t` of the cell.
pub(crate) fn basis(t: f64) -> [[f64; 4]; 2] {
    let u = 1.0 - t;
    let (t2, u2) = (t * t, u * u);
    [
        [u2 * u / 6.0, (3.0 * t2 * t - 6.0 * t2 + 4.0) / 6.0, (3.0 * u2 * u - 6.0 * u2 + 4.0) / 6.0, t2 * t / 6.0],
        [-0.5 * u2, 1.5 * t2 - 2.0 * t, 2.0 * u - 1.5 * u2, 0.5 * t2],
    ]
}

/// The cell of `u` on a grid of `cells` cells, and the fraction of the cell. The last cell includes its end.
pub(crate) fn locate(u: f64, knot_m: f64, cells: usize) -> (usize, f64) {
    let scaled = u / knot_m;
    let cell = (scaled.max(0.0) as usize).min(cells.saturating_sub(1));
    (cell, scaled - cell as f64)
}

/// The cubic spline through given points, parametrised by chord length. Its ends are not-a-knot, so a circle's ends are
/// as round as its middle.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Interpolant {
    at: Vec<f64>,
    points: Vec<[f64; 2]>,
    /// Second derivatives at the points.
    second: Vec<[f64; 2]>,
}

impl Interpolant {
    /// `at` must be strictly increasing and as long as `points`, with at least two entries.
    pub(crate) fn through(points: &[[f64; 2]], at: &[f64]) -> Self {
        Self { at: at.to_vec(), points: points.to_vec(), second: second_derivatives(points, at) }
    }

    /// Value and derivatives at `u`.
    pub(crate) fn at(&self, u: f64) -> Jet<2> {
        let last = self.at.len().saturating_sub(2);
        let i = self.at.partition_point(|&a| a <= u).saturating_sub(1).min(last);
        let (h, t) = (self.at[i + 1] - self.at[i], u - self.at[i]);
        let component = |k: usize| {
            let (m0, m1) = (self.second[i][k], self.second[i + 1][k]);
            let third = (m1 - m0) / h;
            let first = (self.points[i + 1][k] - self.points[i][k]) / h - h * (2.0 * m0 + m1) / 6.0;
            let value = self.points[i][k] + t * (first + t * (0.5 * m0 + t * third / 6.0));
            [value, first + t * (m0 + 0.5 * t * third), m0 + t * third, third]
        };
        let (x, y) = (component(0), component(1));
        [0, 1, 2, 3].map(|d| [x[d], y[d]])
    }
}

/// Second derivatives at the knots. Not-a-knot conditions are eliminated into the first and last inner equations. Two
/// points give a straight, three points the parabola through them.
fn second_derivatives(points: &[[f64; 2]], at: &[f64]) -> Vec<[f64; 2]> {
    let n = points.len();
    let mut second = vec![[0.0; 2]; n];
    if n < 3 {
        return second;
    }
    let h: Vec<f64> = at.windows(2).map(|w| w[1] - w[0]).collect();
    let slope = |i: usize, k: usize| (points[i + 1][k] - points[i][k]) / h[i];
    let rhs = |i: usize| [0, 1].map(|k| 6.0 * (slope(i, k) - slope(i - 1, k)));
    if n == 3 {
        return vec![rhs(1).map(|r| r / (3.0 * (h[0] + h[1]))); 3];
    }
    let (first, last) = (h[0] / h[1], h[n - 2] / h[n - 3]);
    // m_0 = (1 + first)·m_1 − first·m_2, and likewise at the end.
    let mut upper = vec![0.0; n];
    for i in 1..n - 1 {
        let (mut below, mut diagonal, mut above) = (h[i - 1], 2.0 * (h[i - 1] + h[i]), h[i]);
        if i == 1 {
            diagonal += below * (1.0 + first);
            above -= below * first;
            below = 0.0;
        }
        if i == n - 2 {
            diagonal += h[i] * (1.0 + last);
            below -= h[i] * last;
            above = 0.0;
        }
        let pivot = diagonal - below * upper[i - 1];
        upper[i] = above / pivot;
        let (r, before) = (rhs(i), second[i - 1]);
        second[i] = [0, 1].map(|k| (r[k] - below * before[k]) / pivot);
    }
    for i in (1..n - 2).rev() {
        second[i] = [0, 1].map(|k| second[i][k] - upper[i] * second[i + 1][k]);
    }
    second[0] = [0, 1].map(|k| (1.0 + first) * second[1][k] - first * second[2][k]);
    second[n - 1] = [0, 1].map(|k| (1.0 + last) * second[n - 2][k] - last * second[n - 3][k]);
    second
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_is_the_cubic(got: Jet<1>, u: f64) {
        for (got, want) in got.iter().zip([u * u * u, 3.0 * u * u, 6.0 * u, 6.0]) {
            assert!((got[0] - want).abs() < 1e-8 * (1.0 + want.abs()), "u {u}: {got:?} {want}");
        }
    }

    #[test]
    fn a_b_spline_reproduces_a_cubic_with_its_derivatives() {
        // The blossom of u³ at (k−1, k, k+1)·h gives the coefficients (k³ − k)·h³, with k from −1.
        let h = 2.5_f64;
        let coefficients = (-1..=13).map(f64::from).map(|k| [(k * k * k - k) * h * h * h]).collect();
        let spline = Spline { knot_m: h, coefficients }.cubics();
        for i in 0..=60 {
            assert_is_the_cubic(spline.at(f64::from(i) * 0.5), f64::from(i) * 0.5);
        }
    }

    #[test]
    fn an_interpolant_reproduces_a_cubic_with_its_derivatives() {
        let at = [0.0, 0.7, 2.0, 3.1, 4.9, 5.0, 7.5];
        let points = at.map(|u: f64| [u * u * u, 2.0 - u]);
        let spline = Interpolant::through(&points, &at);
        for i in 0..=75 {
            let u = f64::from(i) * 0.1;
            let jet = spline.at(u);
            assert_is_the_cubic(jet.map(|d| [d[0]]), u);
            assert!((jet[0][1] - 2.0 + u).abs() < 1e-12 && (jet[1][1] + 1.0).abs() < 1e-12);
        }
    }
}
