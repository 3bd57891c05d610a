//! The adversary against a route: one corridor with areas at its turns and half-widths elsewhere, one vehicle, and
//! claims about all of it or about a part.
//!
//! In areas it attacks as an attack on areas does. Elsewhere it pushes the body points with the least clearance over their nearer
//! edge.

use std::ops::{Range, RangeInclusive};

use netcert_base::corridor::Corridor;
use netcert_base::vehicle::Vehicle;

use crate::adversary::{AdversaryBounds, PushTarget, kernel};
use crate::area_attack::{AreaAttack, AreaAttackOutcome, Scope};
use crate::attack::{Course, STEPS_PER_M};
use crate::claim::Claim;
use crate::draw::Draw;
use crate::least_room::Stretch;
use crate::path::{Path, V2, along, left_of};
use crate::simulator::{Near, SearchGrid, SimulatedRun, sweep};

/// The steps and body points that are searched for places to attack.
const COARSE: SearchGrid = SearchGrid { stride: 5, pitch_m: 0.5 };
/// Of a unit's side one place is looked at in so many steps.
const APART_STEPS: usize = 30 * STEPS_PER_M;
/// Places at half-widths whose reach is computed, as a multiple of those that are attacked.
const LOOKED_AT: usize = 6;

/// A claim about a part of a route: metres from the route's beginning, and what is promised there.
#[derive(Debug, Clone, Copy)]
pub struct PartClaim {
    pub from_m: f64,
    pub to_m: f64,
    pub rsc_m: f64,
    /// γ of the part's claim.
    pub shrink: f64,
}

/// A vehicle on its whole route.
pub struct Journey<'a> {
    areas: AreaAttack<'a>,
}

impl<'a> Journey<'a> {
    /// Prepares a journey: drives the path undisturbed. The path has one vertex for each station.
    pub fn new(corridor: &'a Corridor, vehicle: &'a Vehicle, path: &'a Path) -> Self {
        Self { areas: AreaAttack::new(corridor, vehicle, path, 1.0) }
    }

    /// Keeps places of all bodies on the runs of the attacks that follow.
    pub fn watch(&mut self) {
        self.areas.seen = Some(Vec::new());
    }

    /// The places that were kept, metres in the corridor's frame.
    pub fn seen(&mut self) -> Vec<V2> {
        self.areas.seen.take().unwrap_or_default()
    }

    /// Attacks the claim about the whole route: at the `places` worst places of every area and of every stretch between
    /// areas, then its hinges and with noise.
    pub fn attack_whole(&mut self, claim: &Claim, draw: &mut Draw, places: usize) -> AreaAttackOutcome {
        self.begin(claim.shrink, Scope::whole());
        self.attack(self.areas.attack.on_road(), places);
        let areas = &mut self.areas;
        areas.attack.attack_hinges(draw);
        let noise = areas.attack.noise(draw);
        let run = areas.attack.drive.whole(&noise);
        areas.measure(&run, areas.attack.on_road(), "noise");
        areas.found.hinge = areas.attack.outcome.hinge;
        areas.found.clone()
    }

    /// Attacks the claim about a part. Where half-widths count it is about body points whose feet are on the part. In
    /// areas it is about all bodies while some body is on the part.
    pub fn attack_part(&mut self, part: &PartClaim, places: usize) -> AreaAttackOutcome {
        let vehicle = self.areas.attack.drive.vehicle;
        let front_m = vehicle.units[0].front_overhang_m;
        let heads_m = (part.from_m - front_m, part.to_m + vehicle.length_m - front_m);
        let steps = self.step_at(heads_m.0)..self.step_at(heads_m.1);
        self.begin(part.shrink, Scope { steps: steps.clone(), feet_m: part.from_m..=part.to_m });
        self.attack(steps, places);
        self.areas.found.clone()
    }

    /// Pushes bodies to one side (+1: left) where they are farthest on that side of the corridor's line, while their feet are on a stretch. Of
    /// each unit one place is pushed.
    pub fn push_aside(&mut self, feet_m: RangeInclusive<f64>, side: f64, shrink: f64) {
        let AreaAttack { attack, .. } = &self.areas;
        let vehicle = attack.drive.vehicle;
        let front_m = vehicle.units[0].front_overhang_m;
        let steps = self.step_at(feet_m.start() - 2.0 * front_m)..self.step_at(feet_m.end() + vehicle.length_m);
        let mut farthest: Vec<Option<(f64, Near)>> = vec![None; vehicle.units.len()];
        sweep(&attack.drive, &attack.nominal, &attack.road, steps.clone(), COARSE, |near| {
            let (guide, headings) = attack.nominal.at(near.step);
            let aside_m = near.side * 0.5 * vehicle.units[near.unit].width_m;
            let place = attack.drive.body_point(guide, headings, near.unit, near.ahead_m, aside_m);
            let left_m = attack.road.locate(place, near.foot_m).lateral_m;
            let known = &mut farthest[near.unit];
            if feet_m.contains(&near.foot_m) && known.is_none_or(|(most_m, _)| side * left_m > most_m) {
                *known = Some((side * left_m, near));
            }
        });
        let target = |(_, near): (f64, Near)| {
            let (_, tangent) = attack.road.centre(near.foot_m);
            let aside_m = near.side * 0.5 * vehicle.units[near.unit].width_m;
            let push = along([0.0; 2], side, left_of(tangent));
            PushTarget { step: near.step, unit: near.unit, ahead_m: near.ahead_m, aside_m, push }
        };
        let targets: Vec<PushTarget> = farthest.into_iter().flatten().map(target).collect();
        self.begin(shrink, Scope { steps, feet_m });
        for target in &targets {
            self.push(target, Course::Exceeded);
            self.push(target, Course::Kept);
        }
    }

    fn begin(&mut self, shrink: f64, scope: Scope) {
        let areas = &mut self.areas;
        areas.attack.bounds.steer_m = shrink * areas.attack.drive.vehicle.tracking_tolerance_m;
        areas.attack.outcome.hinge = (f64::INFINITY, 0);
        areas.scope = scope;
        areas.begin();
    }

    /// The step at which the steer axle is so far from the route's beginning.
    fn step_at(&self, from_m: f64) -> usize {
        let drive = &self.areas.attack.drive;
        let spans = drive.path.span_of_vertex(0) as f64 + from_m / drive.path.spacing_m;
        ((spans * drive.steps_per_span as f64).max(0.0) as usize).min(drive.steps())
    }

    fn attack(&mut self, steps: Range<usize>, places: usize) {
        let on_road = self.areas.attack.on_road();
        let steps = steps.start.max(on_road.start)..steps.end.min(on_road.end);
        for stretch in self.areas.grounds.stretches(steps) {
            match stretch {
                Stretch::Inside(steps) => self.areas.attack_in(steps, places),
                Stretch::Outside(steps) => {
                    for target in self.targets(steps, places) {
                        for course in [Course::Exceeded, Course::Kept] {
                            self.push(&target, course);
                        }
                    }
                }
                Stretch::Doubtful(_) => {}
            }
        }
    }

    /// The body points that the adversary gets farthest over an edge of the corridor at first order.
    fn targets(&mut self, steps: Range<usize>, places: usize) -> Vec<PushTarget> {
        let AreaAttack { attack, scope, found, .. } = &mut self.areas;
        let mut worst: Vec<Near> = Vec::new();
        for from in steps.clone().step_by(APART_STEPS) {
            let mut least: Vec<Near> = Vec::new();
            sweep(
                &attack.drive,
                &attack.nominal,
                &attack.road,
                from..(from + APART_STEPS).min(steps.end),
                COARSE,
                |near| {
                    if !scope.feet_m.contains(&near.foot_m) {
                        return;
                    }
                    match least.iter_mut().find(|other| (other.unit, other.side) == (near.unit, near.side)) {
                        Some(other) if near.clearance_m < other.clearance_m => *other = near,
                        Some(_) => {}
                        None => least.push(near),
                    }
                },
            );
            worst.append(&mut least);
        }
        worst.sort_by(|a, b| a.clearance_m.total_cmp(&b.clearance_m));
        worst.truncate(LOOKED_AT * places);
        let reached = |near: &Near| {
            let (_, tangent) = attack.road.centre(near.foot_m);
            let push = along([0.0; 2], near.edge, left_of(tangent));
            let aside_m = near.side * 0.5 * attack.drive.vehicle.units[near.unit].width_m;
            let target = PushTarget { step: near.step, unit: near.unit, ahead_m: near.ahead_m, aside_m, push };
            let kernel = kernel(&attack.drive, &attack.nominal, &attack.calm, &target, attack.memory());
            (near.clearance_m - kernel.reach_m(&attack.bounds), target)
        };
        let mut reached: Vec<(f64, PushTarget)> = worst.iter().map(reached).collect();
        reached.sort_by(|a, b| a.0.total_cmp(&b.0));
        reached.truncate(places);
        found.first_order_m = reached.first().map_or(found.first_order_m, |first| first.0.min(found.first_order_m));
        reached.into_iter().map(|(_, target)| target).collect()
    }

    /// Pushes a body point twice: linearised about the undisturbed run, then about the attacked run.
    fn push(&mut self, target: &PushTarget, course: Course) {
        let areas = &mut self.areas;
        let (attack, memory) = (&areas.attack, areas.attack.memory());
        let steps = attack.drive.steps();
        let per_step = attack.drive.path.spacing_m / attack.drive.steps_per_span as f64;
        let slope = course.slope(attack.bounds.steer_m, attack.drive.vehicle);
        let bounds = AdversaryBounds { change_m: slope * per_step, ..attack.bounds };
        let mut attacked: Option<(SimulatedRun, _)> = None;
        for _ in 0..2 {
            let attack = &areas.attack;
            let (run, before) = attacked.as_ref().map_or((&attack.nominal, &attack.calm), |(run, d)| (run, d));
            let kernel = kernel(&attack.drive, run, before, target, memory);
            let near = target.step.saturating_sub(15 * STEPS_PER_M).max(kernel.first)
                ..(target.step + 3 * STEPS_PER_M).min(steps);
            let disturbance = kernel.attack(&bounds, steps);
            let run = attack.from(kernel.first, near.end, &disturbance);
            areas.measure(&run, near.clone(), course.push());
            if course == Course::Kept {
                areas.attack.measure_hinges(&run, near);
            }
            attacked = Some((run, disturbance));
        }
    }
}
