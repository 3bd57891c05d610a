//! Random draws that are the same in every run (SplitMix64), and random corridors of straights, clothoids, arcs and
//! S-bends with changing widths.

use netcert_base::corridor::Corridor;

use crate::road;

/// SplitMix64 (Steele, Lea, Flood 2014).
#[derive(Debug, Clone)]
pub struct Draw(pub u64);

impl Draw {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in `low..high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.bits() >> 11) as f64 / (1u64 << 53) as f64)
    }

    /// Uniform in the logarithm, in `low..high`.
    pub fn log_between(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    pub fn one_in(&mut self, n: usize) -> bool {
        self.below(n) == 0
    }

    pub fn sign(&mut self) -> f64 {
        if self.one_in(2) { 1.0 } else { -1.0 }
    }
}

/// A curve as a list of (length, curvature at its end). Curvature runs linearly from each entry to the next.
pub type Bends = Vec<(f64, f64)>;

/// Curvature at stations 1 m apart along `bends`, starting straight.
pub fn curvature(bends: &Bends) -> Vec<f64> {
    let total: f64 = bends.iter().map(|b| b.0).sum();
    (0..=total.floor() as usize).map(|s| curvature_at(bends, s as f64)).collect()
}

/// Curvature `s` metres along `bends`.
pub fn curvature_at(bends: &Bends, s: f64) -> f64 {
    let (mut from, mut kappa) = (0.0, 0.0);
    for &(length, end) in bends {
        if s <= from + length {
            return kappa + (end - kappa) * ((s - from) / length.max(1e-9));
        }
        (from, kappa) = (from + length, end);
    }
    kappa
}

/// Straights, transitions, arcs of at least `radius_m` and S-bends, up to `length_m` in all.
pub fn bends(draw: &mut Draw, radius_m: f64, length_m: f64) -> Bends {
    let mut bends = vec![(draw.between(5.0, 40.0), 0.0)];
    let mut side = draw.sign();
    while bends.iter().map(|b| b.0).sum::<f64>() < length_m {
        let radius = if draw.one_in(2) { radius_m } else { radius_m * draw.between(1.0, 3.0) };
        let transition = if draw.one_in(6) { 1.0 } else { draw.between(0.08, 0.6) * radius.min(200.0) };
        let turn = draw.between(0.2, if radius < 60.0 { 3.5 } else { 1.2 });
        let arc = (turn * radius - transition).clamp(2.0, 150.0);
        bends.push((transition, side / radius));
        bends.push((arc, side / radius));
        if draw.one_in(3) {
            side = -side;
            bends.push((2.0 * transition, side / radius));
            bends.push((arc * draw.between(0.3, 1.0), side / radius));
        }
        bends.push((transition, 0.0));
        let longest = if draw.one_in(2) { 10.0 } else { 60.0 };
        bends.push((draw.between(1.0, longest), 0.0));
        side = if draw.one_in(3) { side } else { -side };
    }
    bends
}

/// Half-widths at `stations` stations: values in `low..high` over stretches of 30 to 150 m, joined by cosine tapers,
/// and constant over the first and last 20 m.
pub fn half_widths(draw: &mut Draw, stations: usize, low: f64, high: f64) -> Vec<f64> {
    let mut widths = Vec::with_capacity(stations);
    let mut now = draw.between(low, high);
    while widths.len() < stations {
        let next = if draw.one_in(2) { now } else { draw.between(low, high) };
        let taper = (draw.between(8.0, 30.0) * (next - now).abs()).ceil().max(1.0);
        for k in 0..taper as usize {
            let phase = std::f64::consts::PI * k as f64 / taper;
            widths.push(now + (next - now) * 0.5 * (1.0 - phase.cos()));
        }
        let steady = draw.between(30.0, 150.0) as usize;
        widths.extend(std::iter::repeat_n(next, steady));
        now = next;
    }
    widths.truncate(stations);
    let ends = 20.min(stations / 2);
    let (first, last) = (widths[ends], widths[stations - 1 - ends]);
    widths[..ends].fill(first);
    widths[stations - ends..].fill(last);
    widths
}

/// A corridor along `bends`, at a random place and heading.
pub fn corridor(draw: &mut Draw, bends: &Bends, low: f64, high: f64) -> Corridor {
    let curvature = curvature(bends);
    let left = half_widths(draw, curvature.len(), low, high);
    let right = half_widths(draw, curvature.len(), low, high);
    let start = [draw.between(-5e3, 5e3), draw.between(-5e3, 5e3)];
    road::corridor(1.0, start, draw.between(-3.0, 3.0), &curvature, &left, &right)
}
