//! Places where two one-way carriageways become one road, or one road parts. The map's line jogs there, but the lane
//! goes straight on.
//!
//! A two-way road's line is the middle of both directions, and a carriageway's line is the middle of one direction. At
//! their node the line changes from one middle to the other within a few metres, and the cross section jumps as far the
//! other way. The road does neither: the half of the road in the direction of travel continues as the carriageway.
//!
//! In the model the carriageway lies at the node where its half of the road lies. At the end of the jog it lies where
//! the map has it. Its edges are straight in between, so a corridor uses only the hull of two mapped sections. Two
//! conditions must hold: both carriageways meet at the node (`network::Splits`), and the line bends less without the
//! jog than with it. A road that bends the other way, or continues along its middle, keeps its line as drawn.

use super::polyline::Polyline;
use super::stretch::Across;
use super::taper::{Ramp, share};

/// Shortest jog, metres. A jog begins at the node.
const LEAST_REACH_M: f64 = 5.0;
/// Longest jog, metres.
const MOST_REACH_M: f64 = 100.0;
/// Range of lateral distances between a carriageway and its half of the road, metres. A smaller distance needs no
/// correction, and a larger one is no jog.
const SHIFT_M: std::ops::RangeInclusive<f64> = 0.3..=8.0;
/// Length examined on both sides of a jog for bends of the line, metres.
const AROUND_M: f64 = 40.0;
/// Length beyond a jog over which the smoothed line returns to the map's line, metres. Smoothing keeps waves of this
/// length.
const FADE_M: f64 = 200.0;
/// Distance between vertices added where the line returns, metres. A parabola deviates by 1 cm from its chord there.
const STEP_M: f64 = 10.0;
/// A piece of line that shrinks below this share of its length has folded.
const LEAST_SHARE: f64 = 0.3;

/// A node where a two-way road meets one of its carriageways.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Split {
    /// Arc length along the line.
    pub(crate) at: f64,
    /// Whether the carriageway comes after the node.
    pub(crate) ahead: bool,
    /// All lanes of the direction of travel, across the line of the two-way road, and across the line of the
    /// carriageway.
    pub(crate) two_way: Across,
    pub(crate) one_way: Across,
    /// Length over which the road stays one-way, metres.
    pub(crate) one_way_m: f64,
    /// Metres of taper along the road per metre across.
    pub(crate) ratio: f64,
}

/// A jog of the map's line that the road does not have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Jog {
    /// Arc length of the node.
    pub(crate) at: f64,
    /// Whether the jog lies after the node.
    pub(crate) ahead: bool,
    pub(crate) reach_m: f64,
    /// Place of the carriageway's middle at the node, across the line, metres to the left.
    pub(crate) shift_m: f64,
}

impl Jog {
    /// Distance beyond the node, on the side of the carriageway.
    fn beyond(&self, u: f64) -> f64 {
        if self.ahead { u - self.at } else { self.at - u }
    }

    /// Lateral distance of the line without the jog from the map's line.
    fn aside(&self, u: f64) -> f64 {
        let beyond_m = self.beyond(u);
        -self.shift_m * ((beyond_m / self.reach_m).clamp(0.0, 1.0) - share((beyond_m - self.reach_m) / FADE_M))
    }

    /// Arc lengths at which the line needs vertices.
    fn cuts(&self) -> impl Iterator<Item = f64> + '_ {
        let sign = if self.ahead { 1.0 } else { -1.0 };
        let steps = (FADE_M / STEP_M) as usize;
        (0..=steps).map(move |i| self.at + sign * (self.reach_m + i as f64 * STEP_M))
    }
}

/// Vertices around a split, from the two-way road outwards: distance beyond the node, and position.
type Outward = Vec<(f64, [f64; 2])>;

impl Split {
    /// The jog at a split, if the line has one. The carriageway's place at the node and the end of the jog are those
    /// with which the line bends least.
    pub(crate) fn jog(&self, line: &Polyline) -> Option<Jog> {
        let (left_m, right_m) =
            (self.two_way.left_m - self.one_way.left_m, self.two_way.right_m - self.one_way.right_m);
        let outward = self.outward(line);
        let drawn = bending(&outward);
        let mut best: Option<(f64, Jog)> = None;
        for shift_m in [0.5 * (left_m + right_m), left_m, right_m] {
            if !SHIFT_M.contains(&shift_m.abs()) {
                continue;
            }
            for reach_m in self.reaches(&outward, shift_m) {
                let jog = Jog { at: self.at, ahead: self.ahead, reach_m, shift_m };
                let bends = bending(&self.without(&jog, &outward));
                // Improvements below 1e-6 are ignored, so the first of similar jogs counts.
                if bends < drawn - 1e-4 && best.as_ref().is_none_or(|(least, _)| bends < least - 1e-6) {
                    best = Some((bends, jog));
                }
            }
        }
        best.map(|(_, jog)| jog)
    }

    /// Candidate ends of the jog: the vertices, and once and twice the guideline's taper.
    fn reaches(&self, outward: &Outward, shift_m: f64) -> Vec<f64> {
        let most_m = MOST_REACH_M.min(self.one_way_m);
        let taper_m = self.ratio * shift_m.abs();
        let vertices = outward.iter().map(|(beyond_m, _)| *beyond_m);
        let within = |m: &f64| (LEAST_REACH_M..=most_m).contains(m);
        vertices.chain([taper_m, 2.0 * taper_m]).filter(within).collect()
    }

    fn outward(&self, line: &Polyline) -> Outward {
        let (before_m, after_m) = (AROUND_M, MOST_REACH_M + AROUND_M);
        let (from, to) =
            if self.ahead { (self.at - before_m, self.at + after_m) } else { (self.at - after_m, self.at + before_m) };
        let first = line.at.partition_point(|&u| u < from).saturating_sub(1);
        let end = (line.at.partition_point(|&u| u <= to) + 1).min(line.at.len());
        let beyond = |u: f64| if self.ahead { u - self.at } else { self.at - u };
        let mut outward: Outward = (first..end).map(|i| (beyond(line.at[i]), line.points[i])).collect();
        if !self.ahead {
            outward.reverse();
        }
        outward
    }

    /// The line with the jog removed.
    fn without(&self, jog: &Jog, outward: &Outward) -> Outward {
        let mut points = outward.clone();
        let end = points.partition_point(|(beyond_m, _)| *beyond_m < jog.reach_m - 1e-6);
        if let (Some(&(to_m, to)), Some(&(from_m, from))) = (points.get(end), points.get(end.wrapping_sub(1)))
            && to_m > jog.reach_m + 1e-6
        {
            let t = (jog.reach_m - from_m) / (to_m - from_m);
            points.insert(end, (jog.reach_m, [0, 1].map(|k| from[k] + t * (to[k] - from[k]))));
        }
        // Outwards from the node, left becomes right of travel if the carriageway lies behind.
        let shift_m = if self.ahead { jog.shift_m } else { -jog.shift_m };
        let places: Vec<[f64; 2]> = points.iter().map(|(_, place)| *place).collect();
        for (i, (beyond_m, place)) in points.iter_mut().enumerate() {
            let aside_m = -shift_m * (*beyond_m / jog.reach_m).clamp(0.0, 1.0);
            let normal = normal(&places, i);
            *place = [0, 1].map(|k| places[i][k] + aside_m * normal[k]);
        }
        points
    }
}

/// The sum of the squared angles at the vertices.
fn bending(points: &Outward) -> f64 {
    let direction = |a: [f64; 2], b: [f64; 2]| [b[0] - a[0], b[1] - a[1]];
    let turn = |w: &[(f64, [f64; 2])]| {
        let (a, b) = (direction(w[0].1, w[1].1), direction(w[1].1, w[2].1));
        (a[0] * b[1] - a[1] * b[0]).atan2(a[0] * b[0] + a[1] * b[1])
    };
    points.windows(3).map(|w| turn(w).powi(2)).sum()
}

/// The left normal at vertex `i`, scaled so that both adjacent segments move by one.
fn normal(points: &[[f64; 2]], i: usize) -> [f64; 2] {
    let of = |a: usize, b: usize| {
        let d = [points[b][0] - points[a][0], points[b][1] - points[a][1]];
        let length = d[0].hypot(d[1]).max(1e-9);
        [-d[1] / length, d[0] / length]
    };
    let last = points.len() - 1;
    let (before, after) = (of(i.max(1) - 1, i.max(1)), of(i.min(last - 1), i.min(last - 1) + 1));
    let sum = [before[0] + after[0], before[1] + after[1]];
    // Twice the cosine of half the turn, squared. A sharp corner is cut, not extended.
    let squared = (sum[0] * sum[0] + sum[1] * sum[1]).max(2.0);
    sum.map(|s| 2.0 * s / squared)
}

/// Jogs that may lie beside a place of the line. They are in the order of the line, and elsewhere they have no effect.
fn near(jogs: &[Jog], u: f64) -> &[Jog] {
    let reach_m = MOST_REACH_M + FADE_M + 1.0;
    let first = jogs.partition_point(|jog| jog.at < u - reach_m);
    let end = jogs.partition_point(|jog| jog.at <= u + reach_m);
    &jogs[first..end.max(first)]
}

/// A line without its jogs.
pub(crate) struct Relaid {
    pub(crate) line: Polyline,
    /// Arc lengths along the map's line and along this line.
    nodes: Vec<(f64, f64)>,
}

impl Relaid {
    /// Builds the line without the jogs. `None` if it would fold.
    pub(crate) fn new(line: &Polyline, jogs: &[Jog]) -> Option<Self> {
        let aside = |u: f64| near(jogs, u).iter().map(|jog| jog.aside(u)).sum::<f64>();
        let mut cuts: Vec<f64> = jogs.iter().flat_map(Jog::cuts).filter(|u| (0.0..line.length()).contains(u)).collect();
        cuts.sort_unstable_by(f64::total_cmp);
        let mut cuts = cuts.into_iter().peekable();
        let mut relaid = Self { line: Polyline::default(), nodes: Vec::with_capacity(line.at.len()) };
        for (i, &u) in line.at.iter().enumerate() {
            while let Some(cut) = cuts.next_if(|cut| *cut < u - 0.5) {
                if i > 0 && cut > line.at[i - 1] + 0.5 {
                    let [x, y] = line.direction(i - 1);
                    let [px, py] = line.on_segment(i - 1, cut);
                    relaid.push(cut, [px - aside(cut) * y, py + aside(cut) * x], [x, y])?;
                }
            }
            let normal = normal(&line.points, i);
            let along = line.direction(i.saturating_sub(1));
            relaid.push(u, [0, 1].map(|k| line.points[i][k] + aside(u) * normal[k]), along)?;
        }
        Some(relaid)
    }

    /// Adds a node. `along` is the direction of the map's line. `None` if the piece that ends there has folded.
    fn push(&mut self, u: f64, place: [f64; 2], along: [f64; 2]) -> Option<()> {
        let before = self.nodes.last().zip(self.line.points.last());
        let folded = before.is_some_and(|(&(from, _), last)| {
            (place[0] - last[0]) * along[0] + (place[1] - last[1]) * along[1] < LEAST_SHARE * (u - from)
        });
        let at = self.line.push(place);
        self.nodes.push((u, at));
        (!folded).then_some(())
    }

    /// Arc length on this line of a place on the map's line, extended beyond both ends.
    pub(crate) fn at(&self, u: f64) -> f64 {
        let last = self.nodes.len().saturating_sub(2);
        let i = self.nodes.partition_point(|&(from, _)| from <= u).saturating_sub(1).min(last);
        let (Some(a), Some(b)) = (self.nodes.get(i), self.nodes.get(i + 1)) else { return u };
        let inside = (a.0..=b.0).contains(&u);
        if inside {
            a.1 + (u - a.0) / (b.0 - a.0) * (b.1 - a.1)
        } else if u < a.0 {
            a.1 + u - a.0
        } else {
            b.1 + u - b.0
        }
    }

    /// Ramps by which the map's line lies beside this line beyond a jog, for a profile about this line.
    pub(crate) fn back(&self, jog: &Jog) -> Vec<Ramp> {
        if jog.ahead {
            let from = self.at(jog.at + jog.reach_m);
            return vec![Ramp { from, to: from + FADE_M, by_m: -jog.shift_m, node: usize::MAX }];
        }
        let to = self.at(jog.at - jog.reach_m);
        let always = Ramp { from: -2e3, to: -1e3, by_m: -jog.shift_m, node: usize::MAX };
        vec![always, Ramp { from: to - FADE_M, to, by_m: jog.shift_m, node: usize::MAX }]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_jog_has_no_effect_beyond_its_surroundings() {
        let jog = |k: u32| Jog {
            at: 37.0 * f64::from(k),
            ahead: k.is_multiple_of(3),
            reach_m: if k.is_multiple_of(2) { MOST_REACH_M } else { LEAST_REACH_M },
            shift_m: f64::from(k % 7) - 3.0,
        };
        let jogs: Vec<Jog> = (0..100).map(jog).collect();
        for k in 0..4_500 {
            let u = f64::from(k) - 300.0;
            let all: f64 = jogs.iter().map(|jog| jog.aside(u)).sum();
            assert_eq!(near(&jogs, u).iter().map(|jog| jog.aside(u)).sum::<f64>(), all, "{u}");
            assert!(near(&jogs, u).len() <= 17);
        }
    }
}
