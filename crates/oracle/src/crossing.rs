//! Drawn crossings of two straight roads, and turns through them: the area of the crossing, and corridors whose
//! half-widths say nothing where the area counts.
//!
//! A crossing is drawn as a turn to the left: the first road comes along the x axis, and both roads meet at the origin.
//! A pose then turns, moves and perhaps mirrors it.

use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::Arc;

use netcert_base::corridor::{AreaSpan, Corridor, PlaneArea};
use netcert_base::vehicle::Vehicle;

use crate::draw::Draw;
use crate::path::{V2, along, direction, dot, left_of};
use crate::road;

/// Distance between the stations of a turn, metres.
pub const SPACING_M: f64 = 0.5;
/// How far both roads reach from the origin, metres: farther than the longest vehicle gets while the area counts.
const ARMS_M: [f64; 2] = [150.0, 180.0];
/// How far the first road goes on behind the second, metres.
const BEYOND_M: f64 = 40.0;
/// How much of both roads is in both areas of a split crossing, metres.
const SHARED_M: f64 = 14.0;
/// The corridor before the area counts, the area before the bend begins and after the vehicle has left it, and the
/// corridor after the area counts, metres.
const LEAD_M: f64 = 15.0;
const CLEAR_M: f64 = 10.0;
const TAIL_M: f64 = 30.0;
/// Half-width where it counts for nothing, metres.
const NARROW_M: f64 = 0.5;
/// Sharpest curvature of a move aside on a straight, 1/m, and its least length, metres.
const ASIDE: f64 = 1.0 / 25.0;
const ASIDE_LEAST_M: f64 = 12.0;
/// Less than this beside a lane is no island, metres.
const LEAST_BESIDE_M: f64 = 0.01;

/// A crossing of two straight roads, and the turn to the left from the first into the second.
#[derive(Debug, Clone)]
pub struct Crossing {
    /// Right and left edge of each road as it is driven, metres to the left of the line through the origin.
    pub strips: [[f64; 2]; 2],
    /// The part of each that a vehicle may use away from the crossing: all of it, or one side of an island.
    pub lanes: [[f64; 2]; 2],
    /// Angle of the turn, radians.
    pub angle: f64,
    /// Radius of the kerb on the inside, metres.
    pub kerb_m: f64,
    /// Whether the first road goes on behind the second.
    pub beyond: bool,
    /// Whether two areas cover it that overlap.
    pub split: bool,
    /// Rings inside the area that are no part of it.
    pub islands: Vec<Vec<V2>>,
    pub pose: CrossingPose,
}

/// Where a crossing is: mirrored or not, then turned, then moved.
#[derive(Debug, Clone, Copy)]
pub struct CrossingPose {
    pub mirrored: bool,
    pub heading: f64,
    pub at: V2,
}

/// A turn through a crossing. Places aside are metres to the left of the lines through the origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Manoeuvre {
    /// Place aside on the first road, and how far the path moves aside before the bend begins, metres to the left.
    pub before_m: f64,
    pub swing_m: f64,
    /// Radius of the bend, and the lengths over which its curvature rises and falls, metres.
    pub radius_m: f64,
    pub rise_m: f64,
    pub fall_m: f64,
    /// How far the path moves aside after the bend, metres to the left, and the place aside on the second road then.
    /// Together they decide where the bend begins.
    pub drift_m: f64,
    pub after_m: f64,
}

impl Crossing {
    /// A crossing with widths, angle, kerb and lane use at random.
    pub fn drawn(draw: &mut Draw) -> Self {
        let left_hand = draw.one_in(2);
        let mut strip = || {
            let half_m = 0.5 * draw.between(6.0, 14.0);
            // Halves of narrower roads hold no lorry.
            match (half_m > 3.5 && draw.one_in(2), left_hand) {
                (false, _) => [-half_m, half_m],
                (true, false) => [-half_m, 0.0],
                (true, true) => [0.0, half_m],
            }
        };
        let strips = [strip(), strip()];
        Self {
            strips,
            lanes: strips,
            angle: draw.between(60.0, 105.0).to_radians(),
            kerb_m: draw.between(4.0, 14.0),
            beyond: draw.one_in(3),
            split: draw.one_in(4),
            islands: Vec::new(),
            pose: CrossingPose {
                mirrored: draw.one_in(2),
                heading: draw.between(-3.0, 3.0),
                at: [draw.between(-900.0, 900.0), draw.between(-900.0, 900.0)],
            },
        }
    }

    /// A crossing of two whole carriageways with an island in the mouth of one or both.
    pub fn with_islands(draw: &mut Draw) -> Self {
        let mut crossing = Self { split: false, ..Self::drawn(draw) };
        let which = draw.below(3);
        for road in 0..2 {
            if which != 2 && which != road {
                continue;
            }
            let half_m = draw.between(5.0, 7.0);
            let (middle, thin_m) = (draw.between(-0.4, 0.4), draw.between(0.3, 0.7));
            crossing.strips[road] = [-half_m, half_m];
            crossing.lanes[road] = if draw.one_in(2) { [-half_m, middle - thin_m] } else { [middle + thin_m, half_m] };
            let from_m = draw.between(1.0, 6.0);
            let length_m = draw.between(4.0, 15.0);
            crossing.islands.push(crossing.island(road, middle, thin_m, [from_m, from_m + length_m]));
        }
        // The other road is used as a whole, if it has no island.
        for road in (0..2).filter(|road| which != 2 && which != *road) {
            crossing.lanes[road] = crossing.strips[road];
        }
        crossing
    }

    /// An island on a road, pointed at both ends, between two distances from the crossing.
    fn island(&self, road: usize, middle: f64, thin_m: f64, [from_m, to_m]: [f64; 2]) -> Vec<V2> {
        let place = self.past_mouth(road);
        vec![
            place(from_m, middle),
            place(from_m + thin_m, middle + thin_m),
            place(to_m - thin_m, middle + thin_m),
            place(to_m, middle),
            place(to_m - thin_m, middle - thin_m),
            place(from_m + thin_m, middle - thin_m),
        ]
    }

    /// Places on a road by their distance from where the other road's edge crosses it, and metres to the left of its line.
    fn past_mouth(&self, road: usize) -> impl Fn(f64, f64) -> V2 + use<> {
        let corners = [0, 1].map(|side| self.meet(self.strips[0][side], self.strips[1][side]));
        let u = if road == 0 { [-1.0, 0.0] } else { direction(self.angle) };
        let left = if road == 0 { [0.0, 1.0] } else { left_of(u) };
        let mouth_m = corners.iter().map(|corner| dot(*corner, u)).fold(0.0, f64::max);
        move |ahead, aside| along(along([0.0; 2], mouth_m + ahead, u), aside, left)
    }

    /// What the strips have beside the lanes, from where the other road's edge crosses them to where the roads end: islands for a
    /// vehicle that keeps to the lanes away from the crossing.
    pub fn beside_lanes(&self) -> Vec<Vec<V2>> {
        let beside = |road: usize| {
            let ([right, left], [lane_right, lane_left]) = (self.strips[road], self.lanes[road]);
            let place = self.past_mouth(road);
            let far_m = ARMS_M[road] - BEYOND_M;
            [[right, lane_right], [lane_left, left]]
                .into_iter()
                .filter(|[a, b]| b - a > LEAST_BESIDE_M)
                .map(move |[a, b]| vec![place(0.0, a), place(0.0, b), place(far_m, b), place(far_m, a)])
        };
        [0, 1].into_iter().flat_map(beside).collect()
    }

    /// Where a line aside on the first road meets a line aside on the second.
    fn meet(&self, first: f64, second: f64) -> V2 {
        [(self.angle.cos() * first - second) / self.angle.sin(), first]
    }

    /// The crossing as one ring, before its pose. Both roads end at the given distances from the origin.
    fn ring(&self, arms_m: [f64; 2]) -> Vec<V2> {
        let [[first_right, first_left], [second_right, second_left]] = self.strips;
        let u = direction(self.angle);
        let second = |ahead: f64, aside: f64| along(along([0.0; 2], ahead, u), aside, left_of(u));
        let mut ring = vec![[-arms_m[0], first_right]];
        if self.beyond {
            let corner = self.meet(first_left, second_right);
            let far = corner[0].max(self.meet(first_right, second_right)[0]) + BEYOND_M;
            ring.extend([[far, first_right], [far, first_left], corner]);
        } else {
            ring.push(self.meet(first_right, second_right));
        }
        ring.extend([second(arms_m[1], second_right), second(arms_m[1], second_left)]);
        let from = along(self.meet(first_left, second_left), -self.kerb_m * (0.5 * self.angle).tan(), [1.0, 0.0]);
        let centre = along(from, self.kerb_m, [0.0, 1.0]);
        let pieces = (self.kerb_m * self.angle).ceil();
        let kerb = (0..=pieces as usize).rev().map(|k| k as f64 / pieces * self.angle - FRAC_PI_2);
        ring.extend(kerb.map(|angle| along(centre, self.kerb_m, direction(angle))));
        ring.push([-arms_m[0], first_left]);
        ring
    }

    /// How far along the two roads the kerb on the inside reaches, metres from the origin.
    fn kerb_ends(&self) -> [f64; 2] {
        let corner = self.meet(self.strips[0][1], self.strips[1][1]);
        let reach = self.kerb_m * (0.5 * self.angle).tan();
        [reach - corner[0], reach + dot(corner, direction(self.angle))]
    }

    /// The whole crossing as one area, before its pose.
    pub fn unposed(&self) -> PlaneArea {
        let rings = std::iter::once(self.ring(ARMS_M)).chain(self.islands.iter().cloned());
        PlaneArea { rings: rings.collect() }
    }

    /// The areas of the crossing: one, or two that overlap.
    pub fn areas(&self) -> Vec<PlaneArea> {
        let posed = |ring: Vec<V2>| ring.into_iter().map(|at| self.pose.place(at)).collect();
        let areas = if self.split {
            let short = self.kerb_ends().map(|end| end.max(8.0) + SHARED_M);
            let parts = [[ARMS_M[0], short[1]], [short[0], ARMS_M[1]]];
            parts.map(|arms_m| PlaneArea { rings: vec![self.ring(arms_m)] }).to_vec()
        } else {
            vec![self.unposed()]
        };
        areas.into_iter().map(|area| PlaneArea { rings: area.rings.into_iter().map(posed).collect() }).collect()
    }

    /// A middle place of the inside kerb, before the pose.
    pub fn inside(&self) -> V2 {
        self.meet(self.strips[0][1], self.strips[1][1])
    }

    /// Curvature and places at the stations of the bend, both moves aside included, before the pose. At the first one
    /// the path heads along the first road, and at the last one along the second.
    pub fn trace(&self, way: &Manoeuvre) -> (Vec<f64>, Vec<V2>) {
        let mut curvature = aside(way.swing_m);
        curvature.extend(bend(way, self.angle));
        curvature.extend(aside(way.drift_m));
        curvature.push(0.0);
        let none = vec![0.0; curvature.len()];
        let traced = road::corridor(SPACING_M, [0.0; 2], 0.0, &curvature, &none, &none);
        let last = curvature.len() - 1;
        let (sin, cos) = self.angle.sin_cos();
        let start = (cos * (way.before_m + traced.y[last]) - way.after_m) / sin - traced.x[last];
        let places = traced.x.iter().zip(&traced.y).map(|(x, y)| [start + x, way.before_m + y]);
        (curvature, places.collect())
    }

    /// The corridor of a turn for a vehicle, with the crossing's area while any of the vehicle is near the bend.
    pub fn corridor(&self, way: &Manoeuvre, vehicle: &Vehicle) -> Corridor {
        let stations = |metres: f64| (metres / SPACING_M).ceil() as usize;
        let (bent, places) = self.trace(way);
        let (first, heads) = (stations(LEAD_M + CLEAR_M), stations(LEAD_M));
        let last = first + bent.len() - 1;
        let heads_end = last + stations(vehicle.length_m + CLEAR_M) + 1;
        let mut curvature = vec![0.0; first];
        curvature.extend_from_slice(&bent);
        curvature.resize(heads_end + stations(TAIL_M), 0.0);
        let [from, into] = self.lanes;
        let half_width = |k: usize, left: bool| match k {
            _ if k < first => {
                if left {
                    from[1] - way.before_m
                } else {
                    way.before_m - from[0]
                }
            }
            _ if k <= last => NARROW_M,
            _ if left => into[1] - way.after_m,
            _ => way.after_m - into[0],
        };
        let [left, right] =
            [true, false].map(|left| (0..curvature.len()).map(|k| half_width(k, left)).collect::<Vec<f64>>());
        let at = self.pose.place(along(places[0], -(first as f64) * SPACING_M, [1.0, 0.0]));
        let mut corridor = if self.pose.mirrored {
            curvature.iter_mut().for_each(|curvature| *curvature = -*curvature);
            road::corridor(SPACING_M, at, self.pose.heading, &curvature, &right, &left)
        } else {
            road::corridor(SPACING_M, at, self.pose.heading, &curvature, &left, &right)
        };
        let span = |area| AreaSpan { heads: heads..heads_end, area: Arc::new(area) };
        corridor.areas = self.areas().into_iter().map(span).collect();
        corridor
    }
}

impl CrossingPose {
    /// A place of the crossing as it was drawn, where it is.
    pub fn place(&self, [x, y]: V2) -> V2 {
        let u = direction(self.heading);
        along(along(self.at, x, u), if self.mirrored { -y } else { y }, left_of(u))
    }
}

impl Manoeuvre {
    /// A turn at random. Where lanes are wider than a lorry it need not stay in their middle.
    pub fn drawn(draw: &mut Draw, crossing: &Crossing) -> Self {
        let mut place = |[right, left]: [f64; 2]| {
            let spare = (0.5 * (left - right) - 1.7).max(0.0);
            0.5 * (left + right) + spare * draw.between(-1.0, 1.0)
        };
        let (before_m, after_m) = (place(crossing.lanes[0]), place(crossing.lanes[1]));
        Self {
            before_m,
            swing_m: if draw.one_in(2) { 0.0 } else { draw.between(-1.2, 0.4) },
            radius_m: draw.log_between(9.0, 25.0),
            rise_m: draw.between(3.0, 14.0),
            fall_m: draw.between(3.0, 14.0),
            drift_m: if draw.one_in(2) { 0.0 } else { draw.between(-0.6, 0.6) },
            after_m,
        }
    }
}

/// Curvature of a move aside on a straight, one wave of a sine. Its last station is that of what follows.
fn aside(aside_m: f64) -> Vec<f64> {
    if aside_m.abs() < 0.02 {
        return Vec::new();
    }
    let length_m = (TAU * aside_m.abs() / ASIDE).sqrt().max(ASIDE_LEAST_M);
    let pieces = (length_m / SPACING_M).ceil();
    let most = TAU * aside_m / (pieces * SPACING_M).powi(2);
    (0..pieces as usize).map(|k| most * (TAU * k as f64 / pieces).sin()).collect()
}

/// Curvature of a bend, which rises and falls linearly. Its last station is that of what follows.
fn bend(way: &Manoeuvre, angle: f64) -> Vec<f64> {
    // A bend that ends before its curvature has risen has shorter transitions.
    let fits = (2.0 * angle * way.radius_m / (way.rise_m + way.fall_m)).min(1.0);
    let (rise, fall) = (way.rise_m * fits, way.fall_m * fits);
    let length = angle * way.radius_m + 0.5 * (rise + fall);
    let pieces = (length / SPACING_M).ceil() as usize;
    let share = |s: f64| (s / rise).min((length - s) / fall).clamp(0.0, 1.0);
    let shape: Vec<f64> = (0..pieces).map(|k| share(k as f64 * SPACING_M)).collect();
    // Both ends are zero, so trapezoids are plain sums; the turn becomes exact.
    let turned: f64 = shape.iter().sum::<f64>() * SPACING_M;
    shape.into_iter().map(|share| share * angle / turned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::area::AreaBoundary;
    use crate::fleet;

    fn cases() -> impl Iterator<Item = (Crossing, Manoeuvre)> {
        (0..60).map(|index| {
            let mut draw = Draw(0xc055 + index * 7919);
            let crossing = if index % 3 == 0 { Crossing::with_islands(&mut draw) } else { Crossing::drawn(&mut draw) };
            let way = Manoeuvre::drawn(&mut draw, &crossing);
            (crossing, way)
        })
    }

    #[test]
    fn a_turn_leads_from_its_place_on_one_road_to_its_place_on_the_other() {
        for (crossing, way) in cases() {
            let vehicle = fleet::vehicle("US-WB67");
            let corridor = crossing.corridor(&way, &vehicle);
            assert!(corridor.torn().is_empty());
            let n = corridor.len() - 1;
            let turned = corridor.heading[n] - corridor.heading[0];
            assert!((turned.abs() - crossing.angle).abs() < 1e-9);
            assert_eq!(turned < 0.0, crossing.pose.mirrored);
            let u = direction(crossing.angle);
            let expected = |ahead: f64| along(along([0.0; 2], ahead, u), way.after_m, left_of(u));
            let end = [corridor.x[n], corridor.y[n]];
            let ahead = dot(along(end, -1.0, crossing.pose.place([0.0; 2])), {
                let [a, b] = [crossing.pose.place(u), crossing.pose.place([0.0; 2])];
                along(a, -1.0, b)
            });
            let expected = crossing.pose.place(expected(ahead));
            assert!((end[0] - expected[0]).hypot(end[1] - expected[1]) < 1e-6);
        }
    }

    #[test]
    fn the_area_holds_both_roads_and_no_island() {
        for (crossing, _) in cases() {
            let area = crossing.unposed();
            let ground = AreaBoundary::new(&area);
            let middle = |[right, left]: [f64; 2]| 0.5 * (right + left);
            let width = |[right, left]: [f64; 2]| left - right;
            let u = direction(crossing.angle);
            for ahead in [60.0, 100.0] {
                let first = [-ahead, middle(crossing.lanes[0])];
                let second = along(along([0.0; 2], ahead, u), middle(crossing.lanes[1]), left_of(u));
                for (road, place) in [(0, first), (1, second)] {
                    let room = ground.room(place).0;
                    let whole = crossing.lanes[road] == crossing.strips[road];
                    assert!(!whole || (room - 0.5 * width(crossing.strips[road])).abs() < 1e-6, "{crossing:?}");
                    assert!(room > 1.0);
                }
            }
            for island in &crossing.islands {
                let centre = island.iter().fold([0.0; 2], |sum, at| along(sum, 1.0 / island.len() as f64, *at));
                assert!(ground.room(centre).0 < -0.29, "{crossing:?}");
            }
        }
    }

    #[test]
    fn what_is_beside_the_lanes_is_closed_away_from_the_crossing_only() {
        let strips = [[-5.0, 5.0], [-4.0, 4.0]];
        let lanes = [[-5.0, 0.5], [-4.0, 4.0]];
        let pose = CrossingPose { mirrored: false, heading: 0.0, at: [0.0; 2] };
        let open = Crossing {
            strips,
            lanes,
            angle: FRAC_PI_2,
            kerb_m: 6.0,
            beyond: true,
            split: false,
            islands: Vec::new(),
            pose,
        };
        let closed = Crossing { islands: open.beside_lanes(), ..open.clone() };
        let room = |crossing: &Crossing, at: V2| AreaBoundary::new(&crossing.unposed()).room(at).0;
        assert_eq!(closed.islands.len(), 1, "the second road's lanes are all of it");
        for (at, before, after) in [([-30.0, -2.0], 3.0, 2.5), ([-30.0, 2.5], 2.5, -2.0), ([0.0, 40.0], 4.0, 4.0)] {
            assert!((room(&open, at) - before).abs() < 1e-6);
            assert!((room(&closed, at) - after).abs() < 1e-6, "{at:?}: {}", room(&closed, at));
        }
        assert!(room(&closed, [0.0, 3.0]) > 2.0, "the crossing itself is open");
    }

    #[test]
    fn the_two_areas_of_a_split_crossing_cover_it() {
        for (crossing, _) in cases().filter(|(crossing, _)| crossing.split) {
            let whole = AreaBoundary::new(&Crossing { split: false, ..crossing.clone() }.areas()[0]);
            let parts: Vec<AreaBoundary> = crossing.areas().iter().map(AreaBoundary::new).collect();
            let mut draw = Draw(3);
            for _ in 0..500 {
                let at = crossing.pose.place([draw.between(-60.0, 30.0), draw.between(-30.0, 60.0)]);
                if whole.room(at).0 > 0.01 {
                    let room = parts.iter().map(|part| part.room(at).0).fold(f64::NEG_INFINITY, f64::max);
                    assert!(room > 0.0 && room <= whole.room(at).0 + 1e-9);
                }
            }
        }
    }
}
