//! Bodies, their points, and the stations under them. Each point's foot is followed from station to station. Each point
//! records which stations it has passed (proof, section 7, Feet).

mod rooms;
mod stand;

use super::block::{BLOCK, Feet, LOST_M, Minima};
use super::group::gamma;
use super::lanes::{LANES, Vector, tagged};
use super::model::Model;
use super::tag::tag;
use super::track::{Fields, Track};

pub(super) use rooms::{PIECE_M, Rooms};
pub(super) use stand::Stand;

/// A foot farther along than this (metres) is searched again.
pub(super) const NEAR_M: f64 = 1.0;
/// Most stations walked to find a foot.
const MOST_STEPS: usize = 128;
/// Most stations by which a foot is corrected at once.
const MOST_MOVED: usize = 64;
/// A foot goes on to the next station when it has passed the middle between both by this factor. It is a little more than one, so that
/// rounding does not send it to and fro.
const PAST_MIDDLE: f64 = 1.04;
/// Least factor by which normals crowd on the inside of a bend. Half-widths end before that.
const NARROWEST: f64 = 0.1;
/// Most stations between two successive feet of a point. If there are more, the point jumped over them and nothing is
/// certified there.
const JUMPED: usize = 4;
/// A foot is lost if it is farther from its place on a straight than this share of the distance to the steer axle plus
/// these metres. It then lies on a leg of the corridor that the vehicle has left or has yet to reach.
const ASTRAY_PART: f64 = 0.5;
const ASTRAY_M: f64 = 10.0;
/// `BodyPoint::covered` of a point that comes from an area: no station counts as jumped over until its next foot.
pub(super) const FRESH: usize = usize::MAX;
/// Added to a head's station so that differences stay positive for points ahead of the head.
const AHEAD: usize = 1 << 20;

/// The body points of one unit of one vehicle.
pub(super) struct Body {
    pub(super) half_width: f64,
    pub(super) inverse_length: f64,
    /// A and g at the axle, at the sweep's γ.
    pub(super) heading: f64,
    pub(super) axle: f64,
    pub(super) points: Vec<BodyPoint>,
    /// The unit at the last station, where areas count.
    pub(super) stood: Option<Stand>,
    pub(super) rooms: Rooms,
    /// Last unit only: its axle, whose offset the published certificate needs.
    pub(super) last_axle: Option<LastAxle>,
}

pub(super) struct LastAxle {
    pub(super) foot: usize,
    pub(super) way: FootRange,
}

/// Where a foot is on a straight, in stations behind the head, and how far it may be from there.
pub(super) struct FootRange {
    pub(super) behind: usize,
    pub(super) astray: usize,
}

pub(super) struct BodyPoint {
    pub(super) on_axis: AxisPoint,
    pub(super) tag: u64,
    /// Distance to the previous point, metres; 0 for the first.
    pub(super) gap: f64,
    pub(super) foot: usize,
    pub(super) way: FootRange,
    /// Every station up to this one has been under the point or is lost.
    pub(super) covered: usize,
}

/// A place on a body's axis, metres ahead of its axle, and its bounds on the straight.
#[derive(Clone, Copy)]
pub(super) struct AxisPoint {
    pub(super) ahead: f64,
    /// g there, and the slopes of g towards half a width ahead and half a width behind.
    pub(super) gain: f64,
    pub(super) slope_ahead: f64,
    pub(super) slope_behind: f64,
    /// |1 − a/L| and |a/L|
    pub(super) from_axle: f64,
    pub(super) from_coupling: f64,
}

impl AxisPoint {
    /// The place at share `part` of the way from this point to the next one behind it. g is convex: it lies below its
    /// chord, and beyond either end it is no steeper towards that end than at the end.
    pub(super) fn between(self, behind: Self, part: f64) -> Self {
        let mix = |a: f64, b: f64| a + (b - a) * part;
        // The weights of axle and coupling are linear in the place except at sign changes, so they are convex too.
        Self {
            ahead: mix(self.ahead, behind.ahead),
            gain: mix(self.gain, behind.gain),
            slope_ahead: self.slope_ahead,
            slope_behind: behind.slope_behind,
            from_axle: mix(self.from_axle, behind.from_axle),
            from_coupling: mix(self.from_coupling, behind.from_coupling),
        }
    }
}

impl Body {
    /// Removes the straight gains, so that nothing is deducted for them.
    pub(super) fn forget_gains(&mut self) {
        for point in &mut self.points {
            point.on_axis = AxisPoint { gain: 0.0, slope_ahead: 0.0, slope_behind: 0.0, ..point.on_axis };
        }
    }
}

/// The bodies of a vehicle that stands straight behind the steer axle's first station, at γ = `shrink`. Planning uses
/// three points per unit.
pub(super) fn bodies<const CERTIFY: bool>(model: &Model, track: &Track, shrink: f64) -> Vec<Body> {
    let tolerance = model.vehicle.tracking_tolerance_m * gamma(model, shrink);
    let last = model.units.len() - 1;
    let mut coupling = 0.0;
    model
        .units
        .iter()
        .enumerate()
        .map(|(index, unit)| {
            let axle = coupling - unit.length;
            coupling = axle - unit.hitch;
            let foot = |ahead: f64| (track.first_head as f64 + (axle + ahead) / track.spacing).round() as usize;
            let n = unit.points.len();
            let way = |ahead: f64| FootRange {
                behind: track.first_head + AHEAD - foot(ahead),
                astray: ((ASTRAY_PART * (axle + ahead).abs() + ASTRAY_M) / track.spacing).ceil() as usize,
            };
            // The innermost point on a steady circle.
            let middle = (0..n).min_by(|&a, &b| unit.points[a].abs().total_cmp(&unit.points[b].abs()));
            let chosen = (0..n).filter(|&p| CERTIFY || p == 0 || Some(p) == middle || p == n - 1);
            let points = chosen.map(|p| {
                let gain = unit.at[p].at(tolerance);
                let start = foot(unit.points[p]);
                let on_axis = AxisPoint {
                    ahead: unit.points[p],
                    gain,
                    slope_ahead: (unit.ahead[p].at(tolerance) - gain) / unit.half_width,
                    slope_behind: (unit.behind[p].at(tolerance) - gain) / unit.half_width,
                    from_axle: (1.0 - unit.points[p] / unit.length).abs(),
                    from_coupling: (unit.points[p] / unit.length).abs(),
                };
                BodyPoint {
                    on_axis,
                    tag: tag(index, p),
                    gap: if p == 0 { 0.0 } else { unit.points[p - 1] - unit.points[p] },
                    foot: start,
                    way: way(unit.points[p]),
                    covered: start.saturating_sub(1),
                }
            });
            Body {
                half_width: unit.half_width,
                inverse_length: 1.0 / unit.length,
                heading: unit.heading.at(tolerance),
                axle: unit.axle.at(tolerance),
                points: points.collect(),
                stood: None,
                rooms: Rooms::new(&unit.points),
                last_axle: (CERTIFY && index == last).then(|| LastAxle { foot: foot(0.0), way: way(0.0) }),
            }
        })
        .collect()
}

/// Eight points relative to their foot stations.
pub(super) struct Seen<V> {
    pub(super) at: Fields<V>,
    pub(super) along: V,
    pub(super) lateral: V,
}

/// Moves on over a block whose leeways are not wanted.
pub(super) fn skip(track: &Track, body: &mut Body, head: usize) {
    for point in &mut body.points {
        point.foot = point.way.expected(track, head + BLOCK);
        point.covered = point.foot.saturating_sub(1);
    }
    if let Some(axle) = &mut body.last_axle {
        axle.foot = axle.way.expected(track, head + BLOCK);
    }
}

/// Ends the sweep: stations that a point has not passed are lost.
pub(super) fn finish(track: &Track, body: &Body, minima: &mut Minima) {
    for point in &body.points {
        point.lose(track.lead + track.count, minima);
    }
}

impl FootRange {
    /// The foot on a straight when the head is at station `head`.
    pub(super) fn expected(&self, track: &Track, head: usize) -> usize {
        (head + AHEAD).saturating_sub(self.behind).min(track.len() - LANES)
    }

    /// `foot`, or the foot on a straight if `foot` is too far from it.
    pub(super) fn kept(&self, track: &Track, head: usize, foot: usize) -> usize {
        let expected = self.expected(track, head);
        if foot.abs_diff(expected) > self.astray { expected } else { foot }
    }
}

impl LastAxle {
    /// Raises the offsets to the axle's distance from the planned path, at its own feet.
    #[inline(always)]
    pub(super) fn follow<V: Vector>(&mut self, track: &Track, [x, y]: [V; 2], shift: &[f64], minima: &mut Minima) {
        let feet = follow(track, self.foot, x, y);
        let seen = place(track.fields.gather(&feet), x, y);
        let spread = V::splat(1.0) / narrow(&seen.at, seen.lateral);
        let (on, lateral) = foot(&seen.at, seen.along, seen.lateral, spread);
        for (i, &k) in feet.iter().enumerate() {
            let other = if on.lane(i) < 0.0 { k.saturating_sub(1) } else { (k + 1).min(track.len() - 1) };
            let [own, next] = [k, other].map(|k| shift[k]);
            let planned = own + (next - own) * (on.lane(i).abs() / track.spacing).min(1.0);
            minima.offset[k] = minima.offset[k].max((lateral.lane(i) - planned).abs());
        }
        self.foot = next_foot(track, feet[LANES - 1], seen.along.lane(LANES - 1));
    }
}

impl BodyPoint {
    /// Records the stations that have been under the point.
    #[inline(always)]
    pub(super) fn cover(&mut self, feet: Feet, minima: &mut Minima) {
        if self.covered == FRESH {
            self.covered = feet.range().0;
        }
        match feet {
            Feet::Run(first) if first <= self.covered + JUMPED => self.covered = self.covered.max(first + LANES - 1),
            Feet::Run(first) => {
                self.lose(first, minima);
                self.covered = first + LANES - 1;
            }
            Feet::Each(feet) => {
                for foot in feet {
                    if foot > self.covered + JUMPED {
                        self.lose(foot, minima);
                    }
                    self.covered = self.covered.max(foot);
                }
            }
        }
    }

    /// Called after a block. A foot that is lost goes back to its place on a straight, and the stations in between are
    /// lost.
    #[inline(always)]
    pub(super) fn keep_on_the_way(&mut self, track: &Track, head: usize, minima: &mut Minima) {
        let expected = self.way.expected(track, head);
        if self.covered.saturating_add(self.way.astray) < expected || self.foot.abs_diff(expected) > self.way.astray {
            self.lose(expected, minima);
            self.foot = expected;
            self.covered = expected.saturating_sub(1);
        }
    }

    /// Marks the stations after `covered` up to `end` as lost: nothing is certified there.
    #[cold]
    fn lose(&self, end: usize, minima: &mut Minima) {
        if self.covered == FRESH {
            return;
        }
        let lost = tagged(LOST_M, self.tag);
        for k in self.covered + 1..end.min(minima.left.len()) {
            minima.left[k] = least(minima.left[k], lost);
            minima.right[k] = least(minima.right[k], lost);
        }
    }
}

#[inline(always)]
pub(super) fn place<V: Vector>(at: Fields<V>, x: V, y: V) -> Seen<V> {
    let (dx, dy) = (x - at.x, y - at.y);
    let along = dx * at.tangent_x + dy * at.tangent_y;
    let lateral = dy * at.tangent_x - dx * at.tangent_y;
    Seen { at, along, lateral }
}

#[inline(always)]
pub(super) fn near<V: Vector>(along: V) -> bool {
    along.abs().all_below(NEAR_M.next_up())
}

/// The nearest station of each point, found by walking from `first`. The walk goes step by step because neighbouring
/// points have neighbouring feet.
pub(super) fn follow<V: Vector>(track: &Track, first: usize, x: V, y: V) -> [usize; LANES] {
    let f = &track.fields;
    let last = track.len() - 1;
    let mut feet = [first; LANES];
    let mut k = first.min(last);
    for (i, foot) in feet.iter_mut().enumerate() {
        for _ in 0..MOST_STEPS {
            let (dx, dy) = (x.lane(i) - f.x[k], y.lane(i) - f.y[k]);
            let along = dx * f.tangent_x[k] + dy * f.tangent_y[k];
            let lateral = dy * f.tangent_x[k] - dx * f.tangent_y[k];
            // On the outside of a curve stations are farther apart at the point than on the line.
            let half = 0.5 * track.spacing * (1.0 - f.curvature[k] * lateral).max(NARROWEST);
            if along > PAST_MIDDLE * half && k < last {
                k += 1;
            } else if along < -PAST_MIDDLE * half && k > 0 {
                k -= 1;
            } else {
                break;
            }
        }
        *foot = k;
    }
    feet
}

/// The station to start the next eight feet from: one after the last of these, corrected by its offset `along`.
#[inline(always)]
pub(super) fn next_foot(track: &Track, foot: usize, along: f64) -> usize {
    moved(foot + 1, along / track.spacing).min(track.len() - LANES)
}

/// The station `by` stations from `foot`, at most [`MOST_MOVED`] to either side and not before the first.
#[inline(always)]
pub(super) fn moved(foot: usize, by: f64) -> usize {
    // Truncating a positive number rounds without a call on machines that lack the instruction. NaN gives 0.
    let off = (by + (MOST_MOVED as f64 + 0.5)).clamp(0.0, (2 * MOST_MOVED) as f64) as usize;
    (foot + off).saturating_sub(MOST_MOVED)
}

/// Metres a point moves along the corridor while its foot moves a metre, 1 − κb. It is below 1 on the inside of a bend.
#[inline(always)]
pub(super) fn narrow<V: Vector>(at: &Fields<V>, lateral: V) -> V {
    (V::splat(1.0) - at.curvature * lateral).max(V::splat(NARROWEST))
}

/// Arc length from the station to the foot of a point at (`along`, `lateral`), and the lateral place at that foot.
/// `spread` is 1/(1 − κb): σ = a/(1 − κb), lat = b − (κ/2 + κ'σ/6)·a·σ.
#[inline(always)]
pub(super) fn foot<V: Vector>(at: &Fields<V>, along: V, lateral: V, spread: V) -> (V, V) {
    let sigma = along * spread;
    (sigma, lateral - (at.curvature * 0.5 + at.curvature_slope * sigma * (1.0 / 6.0)) * along * sigma)
}

/// The lesser of two numbers, neither of which is NaN: positions are finite, and a point without a foot has [`LOST_M`].
#[inline(always)]
pub(super) fn least(minimum: f64, value: f64) -> f64 {
    if minimum < value { minimum } else { value }
}
