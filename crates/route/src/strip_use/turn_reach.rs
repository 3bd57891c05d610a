//! How far to the left and right of its line a vehicle comes beside its turns.
//!
//! Beside a turn bodies are held against the junction's area, which has all of the strip that the turn may use. How much of it they need is
//! found by certifying the route's own plan once more in areas from which the rest is cut away. What is then still safe is proved to be left
//! out, by the same certificate. The first cut leaves the nominal bodies a little room. A cut that takes too much gives back what is missing.

use std::ops::Range;
use std::sync::Arc;

use geo::{BooleanOps as _, LineString, MultiPolygon, Polygon};
use rayon::prelude::*;

use super::strips::{PartStrips, StationStrips};
use super::windows::{AreaWindow, BodyReach};
use crate::corridor::{AreaSpan, Corridor, PlaneArea};
use crate::stet::motion::{Pose, sweep_path};
use crate::stet::{Certificate, Model, SpanResult, certify_plan_spans};
use crate::stop::{Stop, Stopped};
use crate::vehicle::Unit;

/// The room that a first cut leaves beside nominal bodies, metres.
const ROOM_M: f64 = 0.2;
/// What a cut gives back beyond what is missing, metres.
const MORE_M: f64 = 0.02;
/// A cut begins at least so far inside the strip's outer edge, metres; else nothing is cut.
const LEAST_CUT_M: f64 = 0.05;
/// A cut ends so far beyond the strip's outer edge, metres. An area has nothing there, but for roundings.
const OUT_M: f64 = 0.5;
/// How often an area is cut anew.
const MOST_CUTS: usize = 6;
/// Distance of places along bodies, metres.
const PITCH_M: f64 = 1.0;

/// How far bodies come to the left and right of a route's line at a station, metres. `None` on a side where the strip's edge is the bound.
pub(super) type TurnReach = [Option<f64>; 2];

/// The reach beside turns, by station of the route.
///
/// # Errors
/// `stop` was told.
pub(super) fn turn_reach(
    corridor: &Corridor,
    certificate: &Certificate,
    model: &Model,
    strips: &[&PartStrips],
    windows: &[AreaWindow],
    stop: &Stop,
) -> Result<Vec<TurnReach>, Stopped> {
    let mut cuts = Cuts::new(corridor, strips, windows);
    if !cuts.any() {
        return Ok(cuts.kept);
    }
    let reach = BodyReach::of(&model.vehicle, corridor.spacing_m);
    let nominal = cuts.nominal(corridor, certificate, model, reach, windows);
    let mut rooms_m = vec![ROOM_M; windows.len()];
    let spans: Vec<Range<usize>> = windows.iter().map(|window| window.stations.clone()).collect();
    for cut in 0..=MOST_CUTS {
        cuts.keep(&nominal, &rooms_m, windows);
        let cut_corridor = cuts.corridor(corridor, reach);
        let results = certify_plan_spans(&cut_corridor, model, &certificate.shift, &spans, stop);
        stop.check()?;
        // The plan fits the corridor: it comes from its certificate.
        let Ok(results) = results else { break };
        let holds = |result: &SpanResult| result.safe() && result.shrink >= certificate.result.shrink;
        if results.iter().all(holds) {
            return Ok(cuts.kept);
        }
        for (room_m, result) in rooms_m.iter_mut().zip(&results).filter(|(_, result)| !holds(result)) {
            let missing_m = result.rsc_m.map_or(f64::INFINITY, |rsc_m| (-rsc_m).max(0.0));
            // The last time a turn that is still without enough room keeps all of its strip.
            *room_m = if cut + 1 >= MOST_CUTS { f64::INFINITY } else { *room_m + missing_m + MORE_M };
        }
    }
    Ok(vec![[None; 2]; corridor.len()])
}

/// What is cut away, by station of the route.
struct Cuts {
    /// The strips at stations beside turns. `None` elsewhere, and where nothing may be cut.
    strips: Vec<Option<StationStrips>>,
    /// Whether nothing may be cut on the road at a station or beside it.
    whole: Vec<bool>,
    /// What is kept on each side, metres from the line. `None`: nothing is cut.
    kept: Vec<TurnReach>,
}

impl Cuts {
    fn new(corridor: &Corridor, parts: &[&PartStrips], windows: &[AreaWindow]) -> Self {
        let mut strips = vec![None; corridor.len()];
        let mut whole = vec![false; corridor.len()];
        for part in parts {
            for window in windows {
                let (own, near) = (&part.stations, &window.stations);
                for k in own.start.max(near.start)..own.end.min(near.end) {
                    strips[k] = part.at(k).filter(|strips| !strips.has_surface);
                    if strips[k].is_none() {
                        whole[k.saturating_sub(1)..(k + 2).min(corridor.len())].fill(true);
                    }
                }
            }
        }
        Self { strips, whole, kept: vec![[None; 2]; corridor.len()] }
    }

    /// Whether some turn may use more than the lane.
    fn any(&self) -> bool {
        self.strips
            .iter()
            .flatten()
            .any(|strips| (0..2).any(|side| strips.turn[side] - strips.lane[side] > LEAST_CUT_M))
    }

    /// How far nominal bodies come to each side of the line at each station, metres, while all of them are within the strips.
    fn nominal(
        &self,
        corridor: &Corridor,
        certificate: &Certificate,
        model: &Model,
        reach: BodyReach,
        windows: &[AreaWindow],
    ) -> Vec<[f64; 2]> {
        let units = &model.vehicle.units;
        let poses = sweep_path(&path(corridor, &certificate.plan, model.vehicle.length_m), &model.vehicle);
        let mut heads: Vec<bool> = vec![false; poses.len().saturating_sub(1)];
        for window in windows {
            let end = (window.stations.end + reach.behind).min(heads.len());
            heads[window.stations.start.min(end)..end].fill(true);
        }
        let mut out = vec![[f64::MIN; 2]; corridor.len()];
        // The path has one vertex before the first station.
        for (head, poses) in poses.iter().skip(1).enumerate().filter(|(head, _)| heads[*head]) {
            let near = reach.around(&(head..head + 1), corridor.len());
            let near: Vec<usize> = near.filter(|&k| self.strips[k].is_some()).collect();
            if near.is_empty() {
                continue;
            }
            let places = poses.iter().zip(units).flat_map(|(pose, unit)| sides(pose, unit));
            for [x, y] in places {
                for &k in &near {
                    let Some(strips) = &self.strips[k] else { continue };
                    let (sin, cos) = corridor.heading[k].sin_cos();
                    let [dx, dy] = [x - corridor.x[k], y - corridor.y[k]];
                    let (along_m, left_m) = (dx * cos + dy * sin, dy * cos - dx * sin);
                    if along_m.abs() > corridor.spacing_m {
                        continue;
                    }
                    for (side, aside_m) in [(0, left_m), (1, -left_m)] {
                        if aside_m < strips.turn[side] + OUT_M {
                            out[k][side] = out[k][side].max(aside_m);
                        }
                    }
                }
            }
        }
        out
    }

    /// Keeps this much room beside nominal bodies, by window, and all of the lane.
    fn keep(&mut self, nominal: &[[f64; 2]], rooms_m: &[f64], windows: &[AreaWindow]) {
        for (k, strips) in self.strips.iter().enumerate() {
            let Some(strips) = strips else { continue };
            let near = windows.iter().zip(rooms_m).filter(|(window, _)| window.stations.contains(&k));
            let room_m = near.map(|(_, room_m)| *room_m).fold(0.0, f64::max);
            self.kept[k] = [0, 1].map(|side| {
                let needed_m = (nominal[k][side] + room_m).max(strips.lane[side]);
                let cut = !self.whole[k] && needed_m < strips.turn[side] - LEAST_CUT_M;
                cut.then_some(needed_m)
            });
        }
    }

    /// The corridor with areas from which the rest is cut away.
    fn corridor(&self, corridor: &Corridor, reach: BodyReach) -> Corridor {
        let cut = |span: &AreaSpan| {
            let near = reach.around(&span.heads, corridor.len());
            let cut = self.rest(corridor, near);
            let area = if cut.0.is_empty() { Arc::clone(&span.area) } else { Arc::new(without(&span.area, &cut)) };
            AreaSpan { heads: span.heads.clone(), area }
        };
        Corridor { areas: corridor.areas.par_iter().map(cut).collect(), ..corridor.clone() }
    }

    /// What is cut away along some stations.
    fn rest(&self, corridor: &Corridor, stations: Range<usize>) -> MultiPolygon {
        let mut pieces = Vec::new();
        for k in stations.start..stations.end.saturating_sub(1) {
            for (side, sign) in [(0, 1.0), (1, -1.0)] {
                let ends = [k, k + 1].map(|k| {
                    let strips = self.strips[k]?;
                    // Where nothing is cut at one of two stations, the cut narrows to the strip's edge between them.
                    let from_m = self.kept[k][side].unwrap_or(strips.turn[side]);
                    let (sin, cos) = corridor.heading[k].sin_cos();
                    let place =
                        |aside_m: f64| [corridor.x[k] - sign * aside_m * sin, corridor.y[k] + sign * aside_m * cos];
                    Some([place(from_m), place(strips.turn[side].max(from_m) + OUT_M)])
                });
                let cuts = self.kept[k][side].is_some() || self.kept[k + 1][side].is_some();
                if let ([Some(here), Some(there)], true) = (ends, cuts) {
                    let ring = LineString::from(vec![here[0], there[0], there[1], here[1]]);
                    pieces.push(Polygon::new(ring, Vec::new()));
                }
            }
        }
        geo::unary_union(&pieces)
    }
}

/// The plan with straight road before and after it.
fn path(corridor: &Corridor, plan: &[[f64; 2]], length_m: f64) -> Vec<[f64; 2]> {
    let (Some(&first), Some(&last)) = (plan.first(), plan.last()) else { return Vec::new() };
    let spacing_m = corridor.spacing_m;
    let ahead = |at: [f64; 2], k: usize, by_m: f64| {
        let (sin, cos) = corridor.heading[k].sin_cos();
        [at[0] + by_m * cos, at[1] + by_m * sin]
    };
    let beyond = (length_m / spacing_m).ceil() as usize + 2;
    let before = std::iter::once(ahead(first, 0, -spacing_m));
    let after = (1..=beyond).map(|i| ahead(last, plan.len() - 1, i as f64 * spacing_m));
    before.chain(plan.iter().copied()).chain(after).collect()
}

/// Places along both sides of a body, its corners included.
fn sides(pose: &Pose, unit: &Unit) -> impl Iterator<Item = [f64; 2]> {
    let (rear_m, front_m) = (-unit.rear_overhang_m, unit.coupling_to_axle_m + unit.front_overhang_m);
    let pieces = ((front_m - rear_m) / PITCH_M).ceil().max(1.0);
    let (pose, half_m) = (*pose, 0.5 * unit.width_m);
    (0..=pieces as usize).flat_map(move |i| {
        let ahead_m = rear_m + (front_m - rear_m) * i as f64 / pieces;
        [half_m, -half_m].map(|left_m| pose.place(ahead_m, left_m))
    })
}

/// An area without what is cut away.
fn without(area: &PlaneArea, cut: &MultiPolygon) -> PlaneArea {
    let ring = |ring: &Vec<[f64; 2]>| Polygon::new(LineString::from(ring.clone()), Vec::new());
    // As in an area, what lies inside an odd number of rings counts.
    let area = MultiPolygon(area.rings.iter().map(ring).collect());
    let left = area.difference(cut);
    let rings = left.iter().flat_map(|polygon| std::iter::once(polygon.exterior()).chain(polygon.interiors()));
    let open = |ring: &LineString| {
        let mut ring: Vec<[f64; 2]> = ring.coords().map(|c| [c.x, c.y]).collect();
        ring.pop();
        ring
    };
    PlaneArea { rings: rings.map(open).filter(|ring| ring.len() > 2).collect() }
}
