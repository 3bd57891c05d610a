//! Bodies that would overlap when the vehicle is straight, or as a hinge turns to its limit.
//!
//! The view is from above, without heights. Two overlaps are normal and left out: a semi-trailer over the unit that
//! carries its fifth wheel, and a dolly's low frame under the unit that draws it. Other bodies may not overlap.
//!
//! Bodies are rectangles here, but real bodies have rounded or chamfered corners. So there are two results. Bodies that
//! overlap even with their ends rounded to half circles cannot be built. Bodies of which only the corners overlap get a
//! warning.

use super::Unit;

/// Step between the angles that are tried, degrees.
const STEP_DEG: f64 = 0.25;
/// Overlap that counts as touching, metres: published dimensions are rounded.
pub(crate) const TOUCH_M: f64 = 0.05;

/// Largest distance of a fifth wheel behind the axle, as a share of L. A greater share would lift the front of the unit
/// that carries it. The lead trailer of a Canadian B-train has 0.21 (CA-BTRAIN25). Lorries have their drawbar eyes at
/// 0.3 or more.
const FIFTH_WHEEL_MOST: f64 = 0.28;

/// The ends of bodies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum BodyEnds {
    /// Half circles. Bodies that overlap even so cannot be built.
    Round,
    /// With corners, which alone overlap.
    Square,
}

/// Two bodies that overlap at some angle of a hinge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Clash {
    /// Index of the unit behind the hinge that turns.
    pub(crate) hinge: usize,
    /// Indices of both units, front one first.
    pub(crate) units: (usize, usize),
    /// Hinge angle of the overlap, degrees; not above the hinge's limit.
    pub(crate) angle_deg: f64,
    /// With what ends the bodies overlap.
    pub(crate) ends: BodyEnds,
}

/// Whether `unit` is a dolly or turntable axle: a drawbar draws it, and the next unit's body lies over it.
#[must_use]
pub(crate) fn is_dolly(units: &[Unit], unit: usize) -> bool {
    let own = units.get(unit).is_some_and(|u| u.front_overhang_m <= 0.0);
    own && unit > 0 && carries(units, unit)
}

/// Whether `unit` carries the next unit's body on a fifth wheel. The body then reaches ahead of the coupling, and the
/// coupling is no farther behind the axle than [`FIFTH_WHEEL_MOST`] allows.
#[must_use]
pub(crate) fn carries(units: &[Unit], unit: usize) -> bool {
    units.get(unit).zip(units.get(unit + 1)).is_some_and(|(carrier, carried)| {
        let most = carrier.rear_overhang_m.min(FIFTH_WHEEL_MOST * carrier.coupling_to_axle_m);
        carried.front_overhang_m > 0.0 && carrier.hitch_offset_m < most
    })
}

/// The first overlap at each hinge: with rounded ends if there is one, otherwise of the corners alone. Overlaps of the
/// straight vehicle (`angle_deg` 0) are included.
pub(crate) fn clashes(units: &[Unit]) -> Vec<Clash> {
    (1..units.len())
        .filter_map(|hinge| first(units, hinge, BodyEnds::Round).or_else(|| first(units, hinge, BodyEnds::Square)))
        .collect()
}

fn first(units: &[Unit], hinge: usize, ends: BodyEnds) -> Option<Clash> {
    let limit_deg = units.get(hinge)?.max_articulation_rad.to_degrees();
    let steps = (limit_deg / STEP_DEG).floor() as u32;
    let angles = (0..=steps).map(|i| f64::from(i) * STEP_DEG).chain([limit_deg]);
    for angle_deg in angles {
        let bodies = turned(units, hinge, angle_deg.to_radians());
        for behind in hinge..units.len() {
            for ahead in 0..hinge {
                let (Some(a), Some(b)) = (bodies.get(ahead), bodies.get(behind)) else { continue };
                let meet = match ends {
                    BodyEnds::Round => a.rounded_meets(b),
                    BodyEnds::Square => a.meets(b),
                };
                if meet && may_not_meet(units, ahead, behind) {
                    return Some(Clash { hinge, units: (ahead, behind), angle_deg, ends });
                }
            }
        }
    }
    None
}

fn may_not_meet(units: &[Unit], ahead: usize, behind: usize) -> bool {
    let next = behind == ahead + 1;
    !(next && (carries(units, ahead) || is_dolly(units, behind)))
}

/// A body in the plane: centre, direction, half length and half width.
struct Body {
    middle: [f64; 2],
    along: [f64; 2],
    half_length: f64,
    half_width: f64,
}

/// All bodies with the hinge ahead of unit `hinge` turned by `angle` and the other hinges straight.
fn turned(units: &[Unit], hinge: usize, angle: f64) -> Vec<Body> {
    let (mut coupling, mut along) = ([0.0, 0.0], [1.0, 0.0]);
    let mut bodies = Vec::with_capacity(units.len());
    for (i, u) in units.iter().enumerate() {
        if i == hinge {
            along = [angle.cos(), angle.sin()];
        }
        let place = |ahead_m: f64| [0, 1].map(|k| coupling[k] + ahead_m * along[k]);
        let (front, rear) = (u.front_overhang_m, -u.coupling_to_axle_m - u.rear_overhang_m);
        bodies.push(Body {
            middle: place(0.5 * (front + rear)),
            along,
            half_length: 0.5 * (front - rear),
            half_width: 0.5 * u.width_m,
        });
        coupling = place(-u.coupling_to_axle_m - u.hitch_offset_m);
    }
    bodies
}

impl Body {
    /// Whether the rectangles overlap by more than [`TOUCH_M`] (separating axis test).
    fn meets(&self, other: &Self) -> bool {
        let gap = [0, 1].map(|k| other.middle[k] - self.middle[k]);
        let across = |u: [f64; 2]| [-u[1], u[0]];
        [self.along, across(self.along), other.along, across(other.along)].into_iter().all(|axis| {
            let reach = |body: &Self| {
                body.half_length * dot(axis, body.along).abs() + body.half_width * dot(axis, across(body.along)).abs()
            };
            dot(axis, gap).abs() < reach(self) + reach(other) - TOUCH_M
        })
    }

    /// As [`Self::meets`], with ends rounded to half circles. A body shorter than wide becomes a disc of its length.
    fn rounded_meets(&self, other: &Self) -> bool {
        let radius = |body: &Self| body.half_width.min(body.half_length);
        let core = |body: &Self| {
            let half = body.half_length - radius(body);
            [half, -half].map(|by| [0, 1].map(|k| body.middle[k] + by * body.along[k]))
        };
        apart(core(self), core(other)) < radius(self) + radius(other) - TOUCH_M
    }
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// Distance between two segments.
fn apart(a: [[f64; 2]; 2], b: [[f64; 2]; 2]) -> f64 {
    let side =
        |p: [f64; 2], s: [[f64; 2]; 2]| (s[1][0] - s[0][0]) * (p[1] - s[0][1]) - (s[1][1] - s[0][1]) * (p[0] - s[0][0]);
    if side(a[0], b) * side(a[1], b) < 0.0 && side(b[0], a) * side(b[1], a) < 0.0 {
        return 0.0;
    }
    [(a[0], b), (a[1], b), (b[0], a), (b[1], a)]
        .into_iter()
        .map(|(p, s)| point_apart(p, s))
        .fold(f64::INFINITY, f64::min)
}

fn point_apart(p: [f64; 2], [from, to]: [[f64; 2]; 2]) -> f64 {
    let (d, off) = ([to[0] - from[0], to[1] - from[1]], [p[0] - from[0], p[1] - from[1]]);
    let share = (dot(d, off) / dot(d, d).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    (off[0] - share * d[0]).hypot(off[1] - share * d[1])
}
