//! Coarse bounds of leeway, for the many places that lie far above their claim (proof, section 7).
//!
//! A body point is read in the frame of the station next to its foot: two products instead of the foot itself. What
//! the curve, the half-width and the tube may do between the station and the foot is deducted. What a coarse bound does
//! not decide is cut into the cells of `leeway`.

use std::ops::Range;

use crate::UP;
use crate::allowance::{BEND_ROUNDING, BETWEEN, JUMPS_PART, SIN_SPARE};
use crate::feet::point;
use crate::road::{DIP_PART, Section};
use crate::swept_vehicle::{ABOUT, SweptVehicle};
use crate::tubes::Tube;

/// A body point is at most this share of a stretch ahead of its station or behind it.
const NEAR: f64 = 0.6;
/// Most moves from one station to the next in search of a foot.
const MOST_MOVES: usize = 4;
/// Where the bounds hold: the greatest sine of the angle between body and road, and the greatest product of curvature and
/// lateral place.
const MOST: f64 = 0.5;
/// Greatest heading difference at a station, and greatest sum of the angles at which chords meet, radians.
const MOST_JUMP_RAD: f64 = 0.05;
const MOST_KINKS_RAD: f64 = 0.5;
/// Between the ends of a body of length G the lateral place is greater by κG²/4 at most (proof, section 7).
const SAGITTA: f64 = 0.25;
/// Factors for what is not exact: the sum of gains, and chords that meet at an arc's angle.
const RISE_SPARE: f64 = 1.001;
const KINK_SPARE: f64 = 1.05;
/// A foot this many stations before the corridor is before it for all of a slab.
const BEFORE: f64 = 1.5;
/// Greatest tangent of half the angle between a unit and its coupling's path.
const MOST_HALF: f64 = 0.25;

/// One side of a part of a body, during some steps.
#[derive(Debug, Clone)]
pub(crate) struct Slab {
    pub(crate) unit: usize,
    pub(crate) side: usize,
    pub(crate) steps: Range<usize>,
    /// Metres ahead of the axle, rear end first.
    pub(crate) a: [f64; 2],
    /// How often the body was halved.
    pub(crate) halvings: u32,
}

/// A body point in the frame of a station.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LocalPoint {
    /// Station of the road.
    pub(crate) station: usize,
    /// Metres ahead of the station, and to its left.
    off: f64,
    lateral: f64,
    /// Sine of the body's heading against the station's.
    sin: f64,
    /// Metres ahead of the axle, and the largest deviation on a straight.
    a: f64,
    gain: f64,
}

impl LocalPoint {
    /// The foot in stations of the road, roughly.
    pub(crate) fn rough(&self, spacing: f64) -> f64 {
        self.station as f64 + self.off / spacing
    }
}

/// A lower bound of a slab's leeway.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Coarse {
    pub(crate) bound: f64,
    /// The part of the deductions that lessens as the body is halved.
    pub(crate) body: f64,
    /// The stations between which all feet lie.
    pub(crate) stations: [f64; 2],
}

impl SweptVehicle<'_> {
    /// A body point near station `from`. `None` if its foot is not found within a few stations, or belongs to another
    /// leg of the road.
    pub(crate) fn local_point(
        &self,
        node: usize,
        unit: usize,
        side: usize,
        a: f64,
        from: Option<usize>,
    ) -> Option<LocalPoint> {
        let link = &self.chain.links[unit];
        let pose = self.motion.pose(node, unit);
        let x = point(pose, a, if side == 0 { link.half_width } else { -link.half_width });
        let straight = self.rough_foot(node, unit, a);
        let (spacing, end) = (self.road.spacing, self.road.len() - 1);
        let mut station = from.unwrap_or(straight.max(0.0) as usize).min(end);
        for _ in 0..MOST_MOVES {
            let place = self.road.stations[station];
            let r = [x[0] - place.c[0], x[1] - place.c[1]];
            let off = r[0] * place.t[0] + r[1] * place.t[1];
            // Beyond both ends the road is straight.
            let beyond = station == 0 && off < 0.0 || station == end && off > 0.0;
            if beyond || off.abs() <= NEAR * spacing {
                let lateral = r[1] * place.t[0] - r[0] * place.t[1];
                let sin = pose.u[1] * place.t[0] - pose.u[0] * place.t[1];
                let gain = self.chain.gains.units[unit].point(a, self.tubes.tolerance_m);
                let local = LocalPoint { station, off, lateral, sin, a, gain };
                return (!self.astray(local.rough(spacing), straight)).then_some(local);
            }
            station = station.saturating_add_signed((off / spacing).round() as isize).min(end);
        }
        None
    }

    /// Whether a foot is before the corridor, where the road is straight. No claim reaches so far.
    pub(crate) fn outside(&self, local: &LocalPoint) -> bool {
        local.rough(self.road.spacing) + BEFORE < self.road.lead as f64
    }

    /// A lower bound of the leeway in a slab, from its corners. `locals` are those at its start and at its end in time,
    /// rear first. `None` where the road bends too much for it.
    pub(crate) fn coarse(&self, slab: &Slab, locals: &[[LocalPoint; 2]; 2]) -> Option<Coarse> {
        let all = locals.as_flattened();
        let first = all.iter().fold(usize::MAX, |least, local| least.min(local.station)).checked_sub(1)?;
        let last = all.iter().fold(0, |most, local| most.max(local.station)) + 1;
        let road = self.road.section(slab.side, first, last)?;
        let (tube, pace) = (self.greatest_tube(slab)?, self.pace(slab)?);
        let extent = self.extent(slab, all, &road, &tube, &pace)?;
        let least = self.lowest_corner(slab, all, &road, &tube, &extent);
        let feet = all.iter().map(|local| local.rough(self.road.spacing));
        let [from, to] = feet.fold([f64::INFINITY, 0.0], |[from, to], s| [s.min(from), s.max(to)]);
        let stray = extent.stray / self.road.spacing;
        let [from, to] = [from - stray, to + stray];
        let body = self.along_body(slab, &road, &tube, &extent, to - from);
        let time = self.in_time(slab, &road, &pace, &extent);
        Some(Coarse { bound: least - body - time, body, stations: [from - ABOUT, to + ABOUT] })
    }

    /// How far a slab reaches in the road's frame. `None` where the road bends too much, or a foot may be farther than a
    /// stretch from where its local point puts it.
    fn extent(&self, slab: &Slab, all: &[LocalPoint], road: &Section, tube: &Tube, pace: &Pace) -> Option<SlabExtent> {
        let most = |size: fn(&LocalPoint) -> f64| all.iter().map(size).fold(0.0, f64::max);
        let (spacing, link) = (self.road.spacing, &self.chain.links[slab.unit]);
        let front = all[0].a.abs().max(all[1].a.abs());
        let bent = road.bent[0].max(road.bent[1]);
        let off = most(|local| local.off.abs());
        // Within the slab a point is at most half of the way from a corner's time.
        let (arm, length) = (front + link.half_width, all[1].a - all[0].a);
        let turned = 0.5 * pace.travel * (pace.w + 2.0 * bent * (1.0 + arm * pace.w));
        // Within a body the angle is greater than at both ends only where the road bends to both sides.
        let between = road.bent[0].min(road.bent[1]) * length;
        let sin = most(|local| local.sin.abs()) + 2.0 * bent * off + road.jump + turned + between;
        let drift = 0.5 * pace.travel * (sin + arm * pace.w);
        // From the station to the foot the lateral place changes by at most off²·κ/2/(1 − κ·lateral). That is below off²·κ
        // while κ·lateral is below a half.
        // Within a body it is greater by the sagitta.
        let lateral = most(|local| local.lateral.abs()) + (off * off + SAGITTA * length * length) * bent + drift;
        // The square allows for the cosine between a foot and its station.
        let narrow = 1.0 - bent * lateral - (bent * spacing) * (bent * spacing);
        if !(narrow > 1.0 - MOST && sin < MOST && road.jump < MOST_JUMP_RAD) {
            return None;
        }
        let slide = link.half_width * tube.a + sin * (tube.y + front * tube.a);
        // Behind a station that the stretch before meets askew, a foot is farther along.
        let gap = road.jump * (lateral + 1.0) + road.slack;
        let stray = (off + gap) * (1.0 / narrow - 1.0) + gap + slide / narrow;
        if (off + gap + slide) / narrow > spacing {
            return None;
        }
        Some(SlabExtent { front, arm, length, bent, sin, lateral, narrow, slide, gap, stray })
    }

    /// The least leeway of a slab's corners, each with what may lie between its station and its foot.
    fn lowest_corner(&self, slab: &Slab, all: &[LocalPoint], road: &Section, tube: &Tube, extent: &SlabExtent) -> f64 {
        let (spacing, link) = (self.road.spacing, &self.chain.links[slab.unit]);
        let SlabExtent { front, bent, sin, narrow, slide, gap, stray, .. } = *extent;
        let tan = sin / (1.0 - sin * sin).sqrt();
        let heading = self.chain.gains.units[slab.unit].heading.at(self.tubes.tolerance_m);
        // How much the first-order bound grows per metre of body.
        let rise = (heading + (tube.extra + tube.extra_coupling) / link.l) * RISE_SPARE;
        let shared = front * tube.r1 / link.l
            + 0.5 * sin * front * tube.a * tube.a
            + 0.5 * bent / narrow * slide * slide
            + link.half_width * tan * rise;
        let sign = if slab.side == 0 { 1.0 } else { -1.0 };
        let mut least = f64::INFINITY;
        for local in all {
            let share = (local.a / link.l).abs();
            let dev = local.gain + (1.0 - local.a / link.l).abs() * tube.extra + share * tube.extra_coupling;
            let [w0, w1, w2] = self.road.widths_about(slab.side, local.station);
            let (before, after) = ((w1 - w0) / spacing, (w2 - w1) / spacing);
            let slope = before.abs().max(after.abs());
            let behind = local.off < 0.0;
            let width = w1 + local.off * if behind { before } else { after } - slope * stray;
            let way = local.off.abs() + gap;
            let aside = 0.5 * way * way * bent / narrow;
            // Behind its station a foot lies on the stretch before, which may meet the station askew.
            let askew = if behind { road.slack + road.jump * way } else { 0.0 };
            least = least.min(width - sign * local.lateral - (aside + road.slack + askew + (dev + shared) * UP));
        }
        least
    }

    /// What the body between its ends may lack, as `allowances` of exact corners. Its feet spread over so many stations.
    fn along_body(&self, slab: &Slab, road: &Section, tube: &Tube, extent: &SlabExtent, spread: f64) -> f64 {
        let SlabExtent { length, bent, sin, lateral, narrow, .. } = *extent;
        let crowded = narrow * narrow;
        let curve = road.bent[slab.side] / narrow
            + road.steepest * (3.0 * bent * sin + road.rate * lateral) / crowded
            + tube.a * self.chain.links[slab.unit].half_width * (2.0 * bent * bent * (sin + SIN_SPARE) + road.rate);
        let unfit = road.slacks + road.jumps * (JUMPS_PART * length + road.steepest * lateral);
        curve * BETWEEN * length * length / 8.0 + DIP_PART * road.growth * spread + unfit
    }

    /// What may be lacking between a slab's start and its end, as `corner` and `allowances`: |second derivative| per square
    /// metre of the coupling's path, and where chords meet, the jumps of the first derivative and of the place.
    fn in_time(&self, slab: &Slab, road: &Section, pace: &Pace, extent: &SlabExtent) -> f64 {
        let link = &self.chain.links[slab.unit];
        let SlabExtent { front, arm, bent, sin, lateral, narrow, .. } = *extent;
        let crowded = narrow * narrow;
        let (w, dw, b) = (pace.w, pace.w / link.l, link.half_width);
        let along_road = 1.0 + arm * w;
        let across = (w * w * (link.l + front) + b * dw) * sin + w + front * dw + b * w * w;
        let foot = (w * (1.0 + front * w) + 2.0 * bent * (sin + front * w) + road.rate * lateral) / crowded;
        let bend = across + bent * along_road * along_road / narrow + road.steepest * foot;
        let kink = pace.kinks * (link.l * w + arm / link.l) * (1.0 + road.steepest / narrow);
        (bend * BETWEEN + BEND_ROUNDING) * pace.travel * pace.travel / 8.0
            + JUMPS_PART * pace.travel * (kink + road.jumps)
            + pace.led * (arm + link.l)
    }

    /// The greatest bounds in a slab's steps. The bulge of the coupling's path counts as a part of `extra_coupling`.
    fn greatest_tube(&self, slab: &Slab) -> Option<Tube> {
        let mut most = Tube::default();
        for step in slab.steps.clone() {
            let tube = self.tubes.get(step, slab.unit)?;
            // Without a bound, nothing below would be a number.
            if !(tube.extra + tube.extra_coupling + tube.y + tube.a + tube.r1).is_finite() {
                return None;
            }
            let bulge = if slab.unit == 0 { 0.0 } else { self.motion.swing(step, slab.unit).bulge };
            most.extra = most.extra.max(tube.extra);
            most.extra_coupling = most.extra_coupling.max(tube.extra_coupling + bulge);
            most.y = most.y.max(tube.y);
            most.a = most.a.max(tube.a);
            most.r1 = most.r1.max(tube.r1);
        }
        Some(most)
    }

    /// How a unit moves in a slab's steps. `None` where it stands too far askew to its coupling's path.
    fn pace(&self, slab: &Slab) -> Option<Pace> {
        let (link, first) = (&self.chain.links[slab.unit], slab.steps.start);
        let mut half = 0.0_f64;
        let mut pace = Pace { travel: 0.0, w: 0.0, kinks: 0.0, led: 0.0 };
        for step in slab.steps.clone() {
            let swing = self.motion.swing(step, slab.unit);
            pace.travel += swing.len;
            half = half.max(swing.before.abs());
            let (kink, share) = (KINK_SPARE * swing.curvature * swing.len, swing.len / link.l);
            pace.led += kink * share * share / 12.0;
            if step > first {
                pace.kinks += kink;
            }
        }
        pace.w = 2.0 * half / (1.0 + half * half) / link.l;
        (half < MOST_HALF && pace.kinks < MOST_KINKS_RAD).then_some(pace)
    }
}

/// How far a slab reaches in the road's frame: the greatest values of all of its places, metres unless said otherwise.
struct SlabExtent {
    /// From the axle ahead or behind, and with half the width.
    front: f64,
    arm: f64,
    /// From the rear end to the front end.
    length: f64,
    /// Curvature of the road, 1/m.
    bent: f64,
    /// Sine of the angle to the road.
    sin: f64,
    lateral: f64,
    /// The least of 1 − κ·lateral.
    narrow: f64,
    /// How far a foot may slide as the body deviates, and what stations that meet askew add.
    slide: f64,
    gap: f64,
    /// The way along the road by which a foot may be from where its local point puts it.
    stray: f64,
}

/// How a unit moves in some steps.
struct Pace {
    /// The way of its coupling, metres.
    travel: f64,
    /// Its greatest turn per metre of that way, 1/m.
    w: f64,
    /// Sum of the angles at which the chords of the coupling meet, radians.
    kinks: f64,
    /// Sum of the unit's turns at such angles, the one before the first step included, radians.
    led: f64,
}

#[cfg(test)]
mod tests;
