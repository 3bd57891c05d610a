//! Finds the place, the unit and the corner where a vehicle comes closest to an edge, and the hinge that comes closest to its
//! limit.

use std::ops::Range;

use super::ride::NominalRide;
use crate::corridor::{Corridor, PlaneArea};
use crate::stet::motion::Pose;
use crate::stet::{Side, SpanResult};
use crate::vehicle::{Unit, Vehicle};

/// A bend of a greater radius is called straight, metres.
const STRAIGHT_M: f64 = 2000.0;

/// Distance between the places looked at along a side that an area limits, metres.
const SIDE_STEP_M: f64 = 0.25;
/// How far from the limiting station the steer axle may be at that moment, in vehicle lengths.
const FAR_LENGTHS: f64 = 1.6;

/// A part of a unit's side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum BodyPart {
    /// The front corner.
    FrontCorner,
    /// The rear corner.
    RearCorner,
    /// The side at the axle.
    Axle,
    /// The side at this distance ahead of the axle, metres. Negative values are behind it.
    Side(f64),
}

/// A bend of the corridor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bend {
    /// The centreline's least radius under the vehicle, metres.
    pub radius_m: f64,
    /// The side that the bend turns to.
    pub to: Side,
}

/// The place of the least leeway, with the vehicle's nominal poses at that moment.
#[derive(Debug, Clone)]
pub struct LimitingPlace {
    /// The station on whose normal the corner is.
    pub station: f64,
    /// Index of the unit.
    pub unit: usize,
    /// The edge of the corridor.
    pub side: Side,
    /// The part of the unit.
    pub part: BodyPart,
    /// The station of the steer axle at that moment. It is beyond the last station if the vehicle is leaving the corridor.
    pub head: f64,
    /// The poses of all units, front to rear.
    pub poses: Vec<Pose>,
    /// The nominal position of the corner.
    pub corner: [f64; 2],
    /// The point of the edge on the same normal.
    pub edge: [f64; 2],
    /// The unit vector from the centreline across that edge.
    pub outward: [f64; 2],
    /// The nominal distance from the corner to the edge, metres. Negative if the corner is beyond the edge.
    pub nominal_m: f64,
    /// What error bounds and allowances deduct from `nominal_m`, metres. `None` if no bound holds for the vehicle.
    pub bounds_m: Option<f64>,
    /// The width of the corridor at the station, metres. `None` where an area limits.
    pub width_m: Option<f64>,
    /// The bend that the vehicle is in. `None` on a straight.
    pub bend: Option<Bend>,
}

/// The place of the least hinge margin.
#[derive(Debug, Clone, PartialEq)]
pub struct HingePlace {
    /// Index of the unit behind the hinge. 0 stands for the steering.
    pub unit: usize,
    /// The station of that unit's front coupling at that moment.
    pub station: f64,
    /// The station of the steer axle at that moment.
    pub head: f64,
    /// The poses of all units, front to rear.
    pub poses: Vec<Pose>,
    /// The nominal angle, radians, positive to the left.
    pub angle_rad: f64,
    /// The greatest angle that the hinge allows, radians.
    pub limit_rad: f64,
}

impl LimitingPlace {
    pub(super) fn of(corridor: &Corridor, ride: &NominalRide, vehicle: &Vehicle, result: &SpanResult) -> Option<Self> {
        let limiting = &result.limiting;
        if limiting.in_area {
            return Self::in_area(corridor, ride, vehicle, result);
        }
        let unit = vehicle.units.get(limiting.unit)?;
        let (behind_m, to_rear_m) = (along_chain(vehicle, limiting.unit), vehicle.length_m);
        let wanted = limiting.station as f64;
        let axis = |head: f64| {
            let pose = ride.at(head).get(limiting.unit).copied()?;
            let guess = head - (behind_m - limiting.point_m) / corridor.spacing_m;
            Some(foot(corridor, pose.place(limiting.point_m, 0.0), guess))
        };
        let head = head_at(ride, wanted, (behind_m - limiting.point_m) / corridor.spacing_m, &axis)?;
        let poses = ride.at(head);
        let across = if limiting.side == Side::Left { 0.5 } else { -0.5 } * unit.width_m;
        let corner = poses.get(limiting.unit)?.place(limiting.point_m, across);
        let station = foot(corridor, corner, wanted);
        let at = Cross::at(corridor, station);
        let (half_m, outward) = match limiting.side {
            Side::Left => (at.left_m, at.normal),
            Side::Right => (at.right_m, at.normal.map(|c| -c)),
        };
        let edge = [0, 1].map(|i| at.centre[i] + half_m * outward[i]);
        let nominal_m = (0..2).map(|i| (edge[i] - corner[i]) * outward[i]).sum::<f64>();
        let rear = (head - to_rear_m / corridor.spacing_m).max(0.0) as usize;
        Some(Self {
            station,
            unit: limiting.unit,
            side: limiting.side,
            part: BodyPart::of(unit, limiting.point_m),
            head,
            poses,
            corner,
            edge,
            outward,
            nominal_m,
            bounds_m: result.rsc_m.map(|rsc_m| (nominal_m - rsc_m).max(0.0)),
            width_m: Some(at.left_m + at.right_m),
            bend: Bend::sharpest(corridor, rear..head.ceil().max(station) as usize + 1),
        })
    }
}

impl LimitingPlace {
    /// The place of the limiting unit's side that comes closest to the boundary of the areas.
    fn in_area(corridor: &Corridor, ride: &NominalRide, vehicle: &Vehicle, result: &SpanResult) -> Option<Self> {
        let limiting = &result.limiting;
        let unit = vehicle.units.get(limiting.unit)?;
        let aside = if limiting.side == Side::Left { 0.5 } else { -0.5 } * unit.width_m;
        let (front, rear) = (unit.coupling_to_axle_m + unit.front_overhang_m, -unit.rear_overhang_m);
        let pieces = ((front - rear) / SIDE_STEP_M).ceil().max(1.0);
        let near_m = (limiting.station as f64 * corridor.spacing_m, FAR_LENGTHS * vehicle.length_m);
        let mut best: Option<(f64, usize, f64, [f64; 2])> = None;
        for head in 0..ride.len() {
            let areas: Vec<&PlaneArea> = counting(corridor, head);
            if areas.is_empty() || (head as f64 * corridor.spacing_m - near_m.0).abs() > near_m.1 {
                continue;
            }
            let poses = ride.at(head as f64);
            let pose = poses.get(limiting.unit)?;
            for i in 0..=pieces as usize {
                let ahead = front + (rear - front) * i as f64 / pieces;
                let Some((room_m, edge)) = room(&areas, pose.place(ahead, aside)) else { continue };
                if best.is_none_or(|(least_m, ..)| room_m < least_m) {
                    best = Some((room_m, head, ahead, edge));
                }
            }
        }
        let (nominal_m, head, ahead, edge) = best?;
        let poses = ride.at(head as f64);
        let corner = poses.get(limiting.unit)?.place(ahead, aside);
        let (off, sign) = ([edge[0] - corner[0], edge[1] - corner[1]], nominal_m.signum());
        let length = off[0].hypot(off[1]).max(1e-9);
        let station = foot(corridor, corner, limiting.station as f64);
        let behind = (head as f64 - vehicle.length_m / corridor.spacing_m).max(0.0) as usize;
        Some(Self {
            station,
            unit: limiting.unit,
            side: limiting.side,
            part: BodyPart::of(unit, ahead),
            head: head as f64,
            poses,
            corner,
            edge,
            outward: off.map(|c| sign * c / length),
            nominal_m,
            bounds_m: result.rsc_m.map(|rsc_m| (nominal_m - rsc_m).max(0.0)),
            width_m: None,
            bend: Bend::sharpest(corridor, behind..head + 1),
        })
    }
}

/// The areas that count while the steer axle is at a station.
fn counting(corridor: &Corridor, head: usize) -> Vec<&PlaneArea> {
    corridor.areas.iter().filter(|span| span.heads.contains(&head)).map(|span| span.area.as_ref()).collect()
}

/// The room of a place in the area that leaves it most, metres, negative outside, and the nearest place of that boundary.
fn room(areas: &[&PlaneArea], p: [f64; 2]) -> Option<(f64, [f64; 2])> {
    let of = |area: &&PlaneArea| {
        let edge = area.nearest(p)?;
        let far = (edge[0] - p[0]).hypot(edge[1] - p[1]);
        Some((if area.contains(p) { far } else { -far }, edge))
    };
    areas.iter().filter_map(of).max_by(|a, b| a.0.total_cmp(&b.0))
}

/// The station of the steer axle at which the foot of the body point passes the station `wanted`.
fn head_at(ride: &NominalRide, wanted: f64, behind: f64, foot_of: &dyn Fn(f64) -> Option<f64>) -> Option<f64> {
    // The lengths of plan and corridor differ by a few metres at most, and a trailer that cuts in adds some metres.
    let last = ride.len().checked_sub(1)? as f64;
    let (from, to) = ((wanted + behind - 25.0).clamp(0.0, last), (wanted + behind + 25.0).clamp(0.0, last));
    let (mut best, mut least, mut head) = (from, f64::INFINITY, from);
    while head <= to {
        let off = (foot_of(head)? - wanted).abs();
        if off < least {
            (best, least) = (head, off);
        }
        head += 0.125;
    }
    Some(best)
}

impl HingePlace {
    /// The place where the hinge `result.hinge_unit` turns most while its coupling is over the span. If the bounds do not
    /// close, the place where the span bends most.
    pub(super) fn of(
        corridor: &Corridor,
        ride: &NominalRide,
        vehicle: &Vehicle,
        span: &Range<usize>,
        result: &SpanResult,
    ) -> Option<Self> {
        let unit = result.hinge_unit;
        let limit_rad = vehicle.units.get(unit)?.max_articulation_rad;
        let ahead_m = vehicle.units.get(unit)?.coupling_to_axle_m;
        let behind = (along_chain(vehicle, unit) - ahead_m).max(0.0) / corridor.spacing_m;
        let first = span.start as f64 + behind;
        let heads = first as usize..((span.end as f64 + behind) as usize + 1).min(ride.len());
        let measure = |head: usize| match result.closes() {
            true => ride.angle(head, unit).abs(),
            false => corridor.curvature.get((head as f64 - behind) as usize).map_or(0.0, |c| c.abs()),
        };
        let head = heads.max_by(|&a, &b| measure(a).total_cmp(&measure(b)))?;
        let poses = ride.at(head as f64);
        let angle_rad = ride.angle(head, unit);
        Some(Self { unit, station: head as f64 - behind, head: head as f64, poses, angle_rad, limit_rad })
    }
}

impl BodyPart {
    fn of(unit: &Unit, point_m: f64) -> Self {
        let near = |place_m: f64| (point_m - place_m).abs() < 1e-6;
        match () {
            () if near(unit.coupling_to_axle_m + unit.front_overhang_m) => Self::FrontCorner,
            () if near(-unit.rear_overhang_m) => Self::RearCorner,
            () if near(0.0) => Self::Axle,
            () => Self::Side(point_m),
        }
    }
}

impl Bend {
    fn sharpest(corridor: &Corridor, stations: Range<usize>) -> Option<Self> {
        let stations = stations.start.min(corridor.len())..stations.end.min(corridor.len());
        let curvature =
            corridor.curvature[stations].iter().fold(0.0_f64, |k, c| if c.abs() > k.abs() { *c } else { k });
        let to = if curvature > 0.0 { Side::Left } else { Side::Right };
        (curvature.abs() * STRAIGHT_M > 1.0).then(|| Self { radius_m: 1.0 / curvature.abs(), to })
    }
}

/// The cross section of a corridor at any place along it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cross {
    /// The point on the centreline.
    pub centre: [f64; 2],
    /// The unit vector to the left.
    pub normal: [f64; 2],
    /// Half-width to the left, metres.
    pub left_m: f64,
    /// Half-width to the right, metres.
    pub right_m: f64,
}

impl Cross {
    /// The cross section at a fractional station. Beyond its ends the corridor continues straight with the same width. The
    /// corridor must have stations.
    #[must_use]
    pub fn at(corridor: &Corridor, station: f64) -> Self {
        let last = corridor.len().saturating_sub(1);
        let low = (station.max(0.0).floor() as usize).min(last.saturating_sub(1));
        let high = (low + 1).min(last);
        let share = station - low as f64;
        let inside = share.clamp(0.0, 1.0);
        let mix = |v: &[f64]| v[low] + inside * (v[high] - v[low]);
        let heading = mix(&corridor.heading);
        let (sin, cos) = heading.sin_cos();
        let beyond = (share - inside) * corridor.spacing_m;
        Self {
            centre: [mix(&corridor.x) + beyond * cos, mix(&corridor.y) + beyond * sin],
            normal: [-sin, cos],
            left_m: mix(&corridor.left_m),
            right_m: mix(&corridor.right_m),
        }
    }

    /// The point at the distance `left_m` to the left of the centreline, metres.
    #[must_use]
    pub fn place(&self, left_m: f64) -> [f64; 2] {
        [0, 1].map(|i| self.centre[i] + left_m * self.normal[i])
    }
}

/// The fractional station on whose normal `point` is. The search starts at `guess`; the result may be beyond the ends.
pub(super) fn foot(corridor: &Corridor, point: [f64; 2], guess: f64) -> f64 {
    let mut station = guess;
    // Each step is a Newton step without the curvature term. A few steps give a millimetre.
    for _ in 0..50 {
        let at = Cross::at(corridor, station);
        let off = [point[0] - at.centre[0], point[1] - at.centre[1]];
        let along = (off[0] * at.normal[1] - off[1] * at.normal[0]) / corridor.spacing_m;
        station += along.clamp(-5.0, 5.0);
        if along.abs() < 1e-4 {
            break;
        }
    }
    station
}

/// The distance from the steer axle back to the axle of `unit` when the vehicle is straight, metres.
fn along_chain(vehicle: &Vehicle, unit: usize) -> f64 {
    let before = vehicle.units.iter().take(unit).map(|u| u.coupling_to_axle_m + u.hitch_offset_m).sum::<f64>();
    before + vehicle.units.get(unit).map_or(0.0, |u| u.coupling_to_axle_m)
}
