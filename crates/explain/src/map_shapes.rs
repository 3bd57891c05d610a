//! What a map shows of an explanation, in the metric frame: the room, the planned path, the ground that the bodies sweep, and the
//! vehicle at the moment that decides.

use std::ops::Range;

use geo::{
    Area as _, BooleanOps as _, Buffer as _, ConvexHull as _, LineString, MultiPolygon, Polygon, Simplify as _,
    unary_union,
};

use super::swept_ground::swept;
use super::{Explanation, Geometry, TurnExplanation};
use crate::corridor::{Corridor, Frame, outline};
use crate::stet::motion::Pose;
use crate::stop::{Stop, Stopped};
use crate::turns::TurnPath;

/// Longest way over which swept ground is drawn, metres. Of a longer edge the part around the tightest place is drawn.
const MOST_SWEPT_M: f64 = 1000.0;
/// Smaller and thinner pieces of a strip beside an area are left out: square metres, half a width in metres. Two outlines of one road
/// differ by a few centimetres, and what lies between them would be slivers and spikes.
const SLIVER_M2: f64 = 1.0;
const SLIVER_M: f64 = 0.05;
/// Vertices this close to the line between their neighbours are left out, metres.
const STRAIGHT_M: f64 = 0.01;
/// Road that is drawn after the last station, so that the front overhang stands on it, metres.
const AHEAD_M: f64 = 3.0;

/// The shapes of an explanation, metres in `frame`.
#[derive(Debug, Clone)]
pub(super) struct MapShapes {
    pub(super) frame: Frame,
    /// The surface that a turn may use at its junction. Empty for an edge.
    pub(super) area: MultiPolygon,
    /// The strip of the road that the vehicle may use besides.
    pub(super) strip: MultiPolygon,
    /// Straight road that the certificate assumes where a road ends, as far as the vehicle drives.
    pub(super) beyond: MultiPolygon,
    /// `None` if the turn has no path.
    pub(super) motion: Option<DrawnMotion>,
}

/// What the vehicle does.
#[derive(Debug, Clone)]
pub(super) struct DrawnMotion {
    /// The planned path of the steer axle.
    pub(super) path: Vec<[f64; 2]>,
    /// For each unit, the ground that it sweeps.
    pub(super) swept: Vec<MultiPolygon>,
    /// For each unit, its pose at the moment that decides.
    pub(super) poses: Vec<Pose>,
}

impl MapShapes {
    /// The shapes of an edge. `None` without a corridor.
    pub(super) fn of_edge(e: &Explanation, stop: &Stop) -> Result<Option<Self>, Stopped> {
        let Some((g, frame)) = e.geometry.as_ref().and_then(|g| Some((g, g.frame?))) else { return Ok(None) };
        let behind = stations(&g.corridor, e.vehicle.length_m);
        let all = g.span.start..(g.span.end + behind).min(g.ride.len());
        let motion = DrawnMotion::of(e, g, &near_the_tightest(g, all), stop)?;
        let strip = unary_union(&strip(&g.corridor, g.span.clone(), [0.0; 2]));
        let none = MultiPolygon::new(Vec::new());
        Ok(Some(Self { frame, area: none.clone(), strip, beyond: none, motion: Some(motion) }))
    }

    /// The shapes of a turn. `None` without an area.
    pub(super) fn of_turn(t: &TurnExplanation, stop: &Stop) -> Result<Option<Self>, Stopped> {
        let Some(made) = &t.corridors else { return Ok(None) };
        let e = &t.explanation;
        let none = MultiPolygon::new(Vec::new());
        let mut drawn =
            Self { frame: made.frame, area: made.area.clone(), strip: none.clone(), beyond: none, motion: None };
        if let (Some(path), Some(g)) = (&t.path, &e.geometry) {
            drawn.strip = beside(&unary_union(&strips(path, e.vehicle.length_m)), &drawn.area);
            let first = path.counted.start + stations(&path.corridor, e.vehicle.length_m);
            let heads = first.min(path.turn.start)..path.counted.end;
            let motion = DrawnMotion::of(e, g, &heads, stop)?;
            let driven = MultiPolygon(motion.swept.iter().flatten().cloned().collect()).convex_hull();
            drawn.beyond = beside(&beside(&beyond(path).intersection(&driven), &drawn.area), &drawn.strip);
            drawn.motion = Some(motion);
        }
        Ok(Some(drawn))
    }
}

impl DrawnMotion {
    fn of(e: &Explanation, g: &Geometry, heads: &Range<usize>, stop: &Stop) -> Result<Self, Stopped> {
        let path = LineString::from(g.certificate.plan.get(g.span.clone()).unwrap_or_default().to_vec());
        let path = path.simplify(STRAIGHT_M).coords().map(|c| [c.x, c.y]).collect();
        let poses = if e.hinge_decides() { &g.hinge.poses } else { &g.place.poses };
        Ok(Self { path, swept: swept(&e.vehicle, &g.ride, heads, stop)?, poses: poses.clone() })
    }
}

/// The part of `all` around the tightest place, if `all` is too long.
fn near_the_tightest(g: &Geometry, all: Range<usize>) -> Range<usize> {
    let most = stations(&g.corridor, MOST_SWEPT_M);
    if all.len() <= most {
        return all;
    }
    let middle = (g.place.head.max(0.0) as usize).clamp(all.start + most / 2, all.end - most / 2);
    middle - most / 2..middle + most / 2
}

fn stations(corridor: &Corridor, metres: f64) -> usize {
    (metres / corridor.spacing_m).ceil() as usize
}

/// The strip between the corridor's edges over some stations.
fn strip(c: &Corridor, stations: Range<usize>, prolonged_m: [f64; 2]) -> Option<Polygon> {
    let ring = outline(c, stations, &|k| [c.left_m[k], -c.right_m[k]], prolonged_m)?;
    Some(polygon(&ring))
}

fn polygon(ring: &[[f64; 2]]) -> Polygon {
    Polygon::new(LineString::from(ring.to_vec()), Vec::new())
}

/// The road before the stations at which a turn's area counts, and the road that counts as soon as the vehicle has left the area.
fn strips(path: &TurnPath, length_m: f64) -> Vec<Polygon> {
    let (c, counted) = (&path.corridor, path.counted.clone());
    let Some(area) = &path.area else { return strip(c, counted, [0.0, AHEAD_M]).into_iter().collect() };
    let before = counted.start..(area.heads.start + stations(c, AHEAD_M)).min(counted.end);
    let after = area.heads.end.saturating_sub(stations(c, length_m)).max(counted.start)..counted.end;
    [strip(c, before, [0.0; 2]), strip(c, after, [0.0, AHEAD_M])].into_iter().flatten().collect()
}

/// The straight road that counts beyond the ends of a turn's corridor.
fn beyond(path: &TurnPath) -> MultiPolygon {
    let own = path.area.as_ref();
    let others = path.corridor.areas.iter().filter(|span| Some(*span) != own);
    let rings: Vec<Polygon> = others.flat_map(|span| span.area.rings.iter().map(|ring| polygon(ring))).collect();
    unary_union(&rings)
}

/// The parts of a shape outside another one.
fn beside(shape: &MultiPolygon, other: &MultiPolygon) -> MultiPolygon {
    let whole = shape.difference(other).buffer(-SLIVER_M).buffer(SLIVER_M).simplify(STRAIGHT_M);
    MultiPolygon(whole.into_iter().filter(|piece| piece.unsigned_area() >= SLIVER_M2).collect())
}
