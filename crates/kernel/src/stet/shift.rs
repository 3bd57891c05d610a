//! The planned shift of the steer axle off the centreline: a uniform cubic B-spline over the corridor's stations. Its
//! coefficients are integers, so a file or a database can hold exactly what was certified.
//!
//! Let c_j be the coefficient at knot j (the first is c_{−1}), j = ⌊k/4⌋ and u = k/4 − j. The shift at station k is `q
//! = ((1−u)³ c_{j−1} + (3u³ − 6u² + 4) c_j + (−3u³ + 3u² + 3u + 1) c_{j+1} + u³ c_{j+2}) / 6`. It is C² and never
//! outside the range of its coefficients. It is level at both ends, so the vehicle enters and leaves along the
//! corridor.

/// Stations between two knots.
pub const KNOT_STATIONS: usize = 4;
/// Value of one coefficient step, metres: 2⁻¹² (a quarter of a millimetre).
pub const STEP_M: f64 = 1.0 / 4096.0;

/// A planned shift, positive to the left.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Plan {
    /// c_{−1}, c_0, … in steps of [`STEP_M`]. There are ⌊(stations − 1)/4⌋ + 4 of them.
    pub coefficients: Vec<i32>,
}

/// Weights of four coefficients at u = 0, 1/4, 1/2, 3/4.
const WEIGHTS: [[f64; 4]; KNOT_STATIONS] = {
    let mut out = [[0.0; 4]; KNOT_STATIONS];
    let mut i = 0;
    while i < KNOT_STATIONS {
        let u = i as f64 / KNOT_STATIONS as f64;
        let (v, u2, u3) = (1.0 - u, u * u, u * u * u);
        out[i] =
            [v * v * v / 6.0, (3.0 * u3 - 6.0 * u2 + 4.0) / 6.0, (3.0 * (u2 - u3) + 3.0 * u + 1.0) / 6.0, u3 / 6.0];
        i += 1;
    }
    out
};

impl Plan {
    /// The plan without shift over `stations` stations.
    pub(super) fn centred(stations: usize) -> Self {
        Self { coefficients: vec![0; count(stations)] }
    }

    /// The plan nearest to `wanted` (metres by knot index), made level at both ends.
    pub(super) fn through(stations: usize, wanted: impl Fn(usize) -> f64) -> Self {
        let knots = stations.saturating_sub(1) / KNOT_STATIONS;
        let step = |knot: usize| (wanted(knot) / STEP_M).round() as i32;
        let mut coefficients: Vec<i32> = (0..count(stations)).map(|i| step(i.saturating_sub(1).min(knots))).collect();
        let last = coefficients.len() - 1;
        let (entry, exit) = (coefficients[1], coefficients[last]);
        level(&mut coefficients, entry, exit);
        Self { coefficients }
    }

    /// The shift at a station, metres. Beyond the last station it is the last station's.
    #[must_use]
    pub fn at_m(&self, station: usize) -> f64 {
        let Some(last) = self.coefficients.len().checked_sub(4) else { return 0.0 };
        let (knot, phase) = (station / KNOT_STATIONS, station % KNOT_STATIONS);
        let (knot, phase) = if knot > last { (last, 0) } else { (knot, phase) };
        let sum = |w: &[f64; 4]| -> f64 {
            w.iter().zip(&self.coefficients[knot..]).map(|(w, &c)| w * (f64::from(c) * STEP_M)).sum()
        };
        WEIGHTS.get(phase).map_or(0.0, sum)
    }

    /// The shift `s` stations from the first, metres; `s` need not be whole. Beyond both ends it is the end's.
    #[must_use]
    pub fn between_m(&self, s: f64) -> f64 {
        let Some(last) = self.coefficients.len().checked_sub(4) else { return 0.0 };
        let x = s.max(0.0) / KNOT_STATIONS as f64;
        let knot = (x as usize).min(last);
        let u = (x - knot as f64).min(1.0);
        let (v, u2, u3) = (1.0 - u, u * u, u * u * u);
        let weights = [v * v * v, 3.0 * u3 - 6.0 * u2 + 4.0, 3.0 * (u2 - u3) + 3.0 * u + 1.0, u3];
        weights.iter().zip(&self.coefficients[knot..]).map(|(w, &c)| w * f64::from(c)).sum::<f64>() * STEP_M / 6.0
    }

    /// Whether the plan is the centreline itself.
    #[must_use]
    pub fn is_centred(&self) -> bool {
        self.coefficients.iter().all(|&c| c == 0)
    }
}

/// Number of coefficients of a plan over `stations` stations.
pub(super) fn count(stations: usize) -> usize {
    stations.saturating_sub(1) / KNOT_STATIONS + 4
}

/// The shift at a station from coefficients in metres.
pub(super) fn at(coefficients: &[f64], station: usize) -> f64 {
    let (knot, [a, b, c, d]) = (station / KNOT_STATIONS, WEIGHTS[station % KNOT_STATIONS]);
    coefficients[knot] * a + coefficients[knot + 1] * b + coefficients[knot + 2] * c + coefficients[knot + 3] * d
}

/// Makes the first three coefficients equal and the last four. If these overlap, all coefficients become `exit`.
pub(super) fn level<T: Copy>(coefficients: &mut [T], entry: T, exit: T) {
    let last = coefficients.len() - 1;
    coefficients[..3].fill(if last < 6 { exit } else { entry });
    coefficients[last - 3..].fill(exit);
}

/// Gives each coefficient of an end the sum of the end's gradients, because they must stay equal.
pub(super) fn tie(asked: &mut [f64]) {
    let last = asked.len() - 1;
    let sum = |part: &[f64]| part.iter().fold(0.0, |sum, v| sum + *v);
    let (entry, exit) = (sum(&asked[..3]), sum(&asked[last - 3..]));
    asked[..3].fill(entry);
    asked[last - 3..].fill(exit);
}

impl Plan {
    /// The shift at every station of a track. `lead` stations come before the corridor's first, which `stations` counts.
    pub(super) fn along(&self, lead: usize, total: usize, stations: usize) -> Vec<f64> {
        let mut out = Vec::with_capacity(total);
        out.resize(lead, self.at_m(0));
        out.extend((0..stations).map(|station| self.at_m(station)));
        out.resize(total, self.at_m(stations - 1));
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plan_is_level_at_its_ends_and_within_its_coefficients() {
        let wanted = |knot: usize| if knot.is_multiple_of(2) { 0.4 } else { -0.3 };
        for stations in 1..60 {
            let plan = Plan::through(stations, wanted);
            assert_eq!(plan.coefficients.len(), count(stations));
            let q: Vec<f64> = (0..stations).map(|k| plan.at_m(k)).collect();
            assert!(q.iter().all(|q| (-0.3001..=0.4001).contains(q)), "{q:?}");
            let slope = |a: f64, b: f64| (a - b).abs();
            if stations > 16 {
                // u³/6 of a step of 0.7 m, a quarter of a knot on; nothing from the far end.
                assert!(slope(q[1], q[0]) < 0.7 / 384.0 + 1e-9, "{q:?}");
                assert!(slope(q[stations - 1], q[stations - 2]) < 0.7 / 384.0 + 1e-9, "{q:?}");
            }
        }
    }

    #[test]
    fn a_track_holds_the_ends_of_a_plan() {
        let plan = Plan::through(40, |knot| 0.1 * knot as f64);
        let q = plan.along(10, 70, 40);
        assert_eq!(q.len(), 70);
        assert!(q[..10].iter().all(|q| *q == plan.at_m(0)));
        assert!(q[50..].iter().all(|q| *q == plan.at_m(39)));
        assert_eq!(q[10 + 17], plan.at_m(17));
    }

    #[test]
    fn between_stations_a_plan_is_what_it_is_at_stations() {
        for stations in [2, 17, 40] {
            let plan = Plan::through(stations, |knot| (0.7 * knot as f64).sin());
            for k in 0..stations {
                assert!((plan.between_m(k as f64) - plan.at_m(k)).abs() < 1e-12, "{k} of {stations}");
            }
            assert_eq!(plan.between_m(-3.0), plan.at_m(0));
            assert!((plan.between_m(stations as f64 + 9.0) - plan.at_m(stations - 1)).abs() < 1e-12);
        }
    }
}
