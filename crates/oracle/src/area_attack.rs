//! The adversary against areas: one corridor with areas, one vehicle, one claim.
//!
//! Where an area counts, disturbances push the places of bodies that have the least room at the boundary nearest to
//! them. Bounds, attacks on hinges and noise are those of an attack, which also measures half-widths where no area counts.

use std::ops::{Range, RangeInclusive};

use netcert_base::corridor::Corridor;
use netcert_base::vehicle::Vehicle;

use crate::adversary::{AdversaryBounds, PushTarget, kernel};
use crate::area::EDGES;
use crate::attack::{self, Attack, Course, STEPS_PER_M};
use crate::claim::Claim;
use crate::draw::Draw;
use crate::least_room::{PathAreas, Stretch, Worst, body};
use crate::path::{Path, V2, along, dot};
use crate::simulator::{Disturbance, Near, SearchGrid, SimulatedRun, sweep};

/// The steps and body points that are searched for places to attack.
const COARSE: SearchGrid = SearchGrid { stride: 5, pitch_m: 0.5 };
/// Two places of one unit are the same attack if they are this close: steps, and metres on the body.
const SAME_STEPS: usize = 10;
const SAME_M: f64 = 0.4;
/// Of the runs whose places are kept, so many steps make one.
const SEEN_STRIDE: usize = 4;
/// Most moments at which an edge of a unit is attacked.
const LOWS: usize = 2;
/// Errors of RK4 and of the plan's cubic, and what sampling leaves, metres.
pub const ALLOWANCE_M: f64 = 1e-3;
/// The same for hinges, radians.
pub const ALLOWANCE_RAD: f64 = 2e-4;

/// What an attack on areas found.
#[derive(Debug, Clone)]
pub struct AreaAttackOutcome {
    /// Least room in the areas, and its place. `None` if no area counts anywhere.
    pub least: Option<Worst>,
    /// The attack that found it.
    pub by: &'static str,
    /// Least room without any disturbance, metres.
    pub undisturbed_m: f64,
    /// The least of the attacked places' rooms less the linearised adversary's reach, metres.
    pub first_order_m: f64,
    /// A place of the boundary that got under a body, and the step.
    pub under: Option<(usize, V2)>,
    /// Least clearance to the half-widths where no area counts. Where a unit may be in an area or beside it, the greater of
    /// its room and its clearance.
    pub outside: Option<Near>,
    /// Least θ_i less articulation over the attacks within the course tolerance, radians, and its hinge.
    pub hinge: (f64, usize),
}

impl Default for AreaAttackOutcome {
    fn default() -> Self {
        Self {
            least: None,
            by: "nothing",
            undisturbed_m: f64::INFINITY,
            first_order_m: f64::INFINITY,
            under: None,
            outside: None,
            hinge: (f64::INFINITY, 0),
        }
    }
}

impl AreaAttackOutcome {
    /// The least of room and clearance, metres.
    pub fn least_m(&self) -> f64 {
        let room_m = self.least.map_or(f64::INFINITY, |worst| worst.room_m);
        room_m.min(self.outside.map_or(f64::INFINITY, |near| near.clearance_m))
    }

    /// What of the claim does not hold.
    pub fn refutes(&self, claim: &Claim) -> Option<String> {
        let mut words = Vec::new();
        if let Some(worst) = self.least.filter(|worst| worst.room_m < claim.rsc_m - ALLOWANCE_M) {
            words.push(format!("room {:.4} m by {} at {worst:?}", worst.room_m, self.by));
        }
        if let Some(near) = self.outside.filter(|near| near.clearance_m < claim.rsc_m - ALLOWANCE_M) {
            words.push(format!("clearance {:.4} m outside of areas at {near:?}", near.clearance_m));
        }
        // A body that never touches the boundary cannot have come over an island.
        if let Some((step, vertex)) = self.under.filter(|_| claim.rsc_m >= 0.0) {
            words.push(format!("the boundary's vertex {vertex:?} is under a body at step {step}"));
        }
        if self.hinge.0 < claim.hinge_margin_rad - ALLOWANCE_RAD {
            let [promised, met] = [claim.hinge_margin_rad, self.hinge.0].map(f64::to_degrees);
            words.push(format!("hinge {} has {met:.3}° and not {promised:.3}°", self.hinge.1));
        }
        (!words.is_empty()).then(|| format!("RSC {:.4} m, γ {:.2}: {}", claim.rsc_m, claim.shrink, words.join("; ")))
    }
}

/// Attacks a claim at the `places` worst places, then its hinges and with noise.
pub fn attack_areas(
    corridor: &Corridor,
    vehicle: &Vehicle,
    claim: &Claim,
    draw: &mut Draw,
    places: usize,
) -> AreaAttackOutcome {
    let path = attack::path(corridor, vehicle, claim);
    AreaAttack::new(corridor, vehicle, &path, claim.shrink).fight(draw, places)
}

/// What a claim is about: steps of the drive, and feet of body points along the corridor, metres.
#[derive(Debug, Clone)]
pub(crate) struct Scope {
    pub(crate) steps: Range<usize>,
    pub(crate) feet_m: RangeInclusive<f64>,
}

impl Scope {
    /// All of a drive.
    pub(crate) fn whole() -> Self {
        Self { steps: 0..usize::MAX, feet_m: f64::NEG_INFINITY..=f64::INFINITY }
    }
}

/// Vehicle, areas and plan of one claim.
pub struct AreaAttack<'a> {
    pub(crate) attack: Attack<'a>,
    pub(crate) grounds: PathAreas,
    pub(crate) found: AreaAttackOutcome,
    pub(crate) scope: Scope,
    /// Places of bodies on the runs that were measured, if they are kept.
    pub(crate) seen: Option<Vec<V2>>,
}

impl<'a> AreaAttack<'a> {
    /// Prepares an attack on areas: drives the path undisturbed. The path has one vertex for each station.
    pub fn new(corridor: &'a Corridor, vehicle: &'a Vehicle, path: &'a Path, shrink: f64) -> Self {
        let attack = Attack::new(corridor, vehicle, path, shrink);
        let grounds = PathAreas::new(corridor, &attack.drive);
        let mut areas =
            Self { attack, grounds, found: AreaAttackOutcome::default(), scope: Scope::whole(), seen: None };
        areas.begin();
        areas
    }

    /// Forgets what was found, and measures the undisturbed run.
    pub(crate) fn begin(&mut self) {
        self.found = AreaAttackOutcome::default();
        self.with_nominal(|areas, nominal| areas.measure(nominal, areas.attack.on_road(), "nothing"));
        self.found.undisturbed_m = self.found.least.map_or(f64::INFINITY, |worst| worst.room_m);
    }

    /// Runs every attack.
    pub fn fight(mut self, draw: &mut Draw, places: usize) -> AreaAttackOutcome {
        let steps = self.grounds.steps();
        self.attack_in(steps, places);
        self.attack.attack_hinges(draw);
        let noise = self.attack.noise(draw);
        let run = self.attack.drive.whole(&noise);
        self.measure(&run, self.attack.on_road(), "noise");
        self.found.hinge = self.attack.outcome.hinge;
        self.found
    }

    /// Attacks the worst places of the areas in some steps.
    pub(crate) fn attack_in(&mut self, steps: Range<usize>, places: usize) {
        for (k, worst) in self.targets(steps, places).into_iter().enumerate() {
            for course in [Course::Exceeded, Course::Kept] {
                self.attack(worst, course, 1.0, course.push());
            }
            // At a kink of the boundary the nearest place may not be the one that is reached.
            if k < 2 {
                self.attack(worst, Course::Exceeded, -1.0, "a push away");
            }
        }
    }

    /// Calls `act` with the undisturbed run, which it may not change.
    pub(crate) fn with_nominal(&mut self, act: impl FnOnce(&mut Self, &SimulatedRun)) {
        let empty = SimulatedRun { first: 0, guide: Vec::new(), headings: Vec::new() };
        let nominal = std::mem::replace(&mut self.attack.nominal, empty);
        act(self, &nominal);
        self.attack.nominal = nominal;
    }

    /// The places at which the adversary gets closest to the boundary at first order. Those of each edge are looked at
    /// whose room is less than a little before and after, and the edge's ends at the same moment.
    fn targets(&mut self, steps: Range<usize>, places: usize) -> Vec<Worst> {
        let (drive, nominal) = (&self.attack.drive, &self.attack.nominal);
        let steps: Vec<usize> = steps.step_by(COARSE.stride).collect();
        let mut kept: Vec<Worst> = Vec::new();
        for unit in 0..drive.vehicle.units.len() {
            for edge in EDGES {
                let room = |step: &usize| self.grounds.edge(drive, nominal, *step, unit, edge);
                let rooms: Vec<Worst> = steps.iter().filter_map(room).collect();
                let least = |k: usize| {
                    let around = k.saturating_sub(4)..(k + 5).min(rooms.len());
                    rooms[around].iter().all(|other| other.room_m >= rooms[k].room_m)
                };
                let mut lows: Vec<Worst> = (0..rooms.len()).filter(|k| least(*k)).map(|k| rooms[k]).collect();
                lows.sort_by(|a, b| a.room_m.total_cmp(&b.room_m));
                lows.truncate(LOWS);
                for low in lows {
                    let ends = self.grounds.ends(drive, nominal, low.step, unit, edge);
                    for one in std::iter::once(low).chain(ends) {
                        if !kept.iter().any(|other| same(other, &one)) {
                            kept.push(one);
                        }
                    }
                }
            }
        }
        let mut reached: Vec<(f64, Worst)> = kept.into_iter().map(|one| (self.first_order_m(&one), one)).collect();
        reached.sort_by(|a, b| a.0.total_cmp(&b.0));
        let first_order_m = reached.first().map_or(f64::INFINITY, |first| first.0);
        self.found.first_order_m = self.found.first_order_m.min(first_order_m);
        reached.truncate(places);
        reached.into_iter().map(|(_, one)| one).collect()
    }

    /// What the linearised adversary leaves of a place's room, metres.
    fn first_order_m(&self, worst: &Worst) -> f64 {
        let target = self.target(&self.attack.nominal, worst, 1.0);
        let kernel = kernel(&self.attack.drive, &self.attack.nominal, &self.attack.calm, &target, self.attack.memory());
        worst.room_m - kernel.reach_m(&self.attack.bounds)
    }

    /// A place and the way from there to the boundary: outwards if it is inside, further away if it is outside.
    fn target(&self, run: &SimulatedRun, worst: &Worst, sign: f64) -> PushTarget {
        let way = along(worst.nearest, -1.0, worst.at);
        let length = dot(way, way).sqrt();
        let push = if length > 1e-6 {
            let towards = sign * worst.room_m.signum() / length;
            [towards * way[0], towards * way[1]]
        } else {
            let out = body(&self.attack.drive, run, worst.step, worst.unit).outwards(worst.edge);
            [sign * out[0], sign * out[1]]
        };
        PushTarget { step: worst.step, unit: worst.unit, ahead_m: worst.ahead_m, aside_m: worst.aside_m, push }
    }

    /// Attacks a place: linearised about the undisturbed run, then twice about the attacked run, at the place of the
    /// same unit that is worst there.
    fn attack(&mut self, worst: Worst, course: Course, sign: f64, by: &'static str) {
        let drive_steps = self.attack.drive.steps();
        let per_step = self.attack.drive.path.spacing_m / self.attack.drive.steps_per_span as f64;
        let slope = course.slope(self.attack.bounds.steer_m, self.attack.drive.vehicle);
        let bounds = AdversaryBounds { change_m: slope * per_step, ..self.attack.bounds };
        let mut target = self.target(&self.attack.nominal, &worst, sign);
        let mut attacked: Option<(SimulatedRun, Disturbance)> = None;
        for round in 0..3 {
            let (run, before) =
                attacked.as_ref().map_or((&self.attack.nominal, &self.attack.calm), |(run, d)| (run, d));
            let kernel = kernel(&self.attack.drive, run, before, &target, self.attack.memory());
            let near = target.step.saturating_sub(15 * STEPS_PER_M).max(kernel.first)
                ..(target.step + 3 * STEPS_PER_M).min(drive_steps);
            let disturbance = kernel.attack(&bounds, drive_steps);
            let run = self.attack.from(kernel.first, near.end, &disturbance);
            self.measure(&run, near.clone(), by);
            if course == Course::Kept {
                self.attack.measure_hinges(&run, near);
            }
            // A run ends a little after its target, so the next round's place has to lie before its end.
            let around = target.step.saturating_sub(15)..(target.step + 15).min(run.steps().end);
            let again = self.grounds.least_of(&self.attack.drive, &run, around, worst.unit);
            let Some(again) = again.filter(|_| round < 2) else { break };
            target = self.target(&run, &again, sign);
            attacked = Some((run, disturbance));
        }
    }

    /// Records the least room of a run in some steps, and its clearance where no area counts.
    pub(crate) fn measure(&mut self, run: &SimulatedRun, range: Range<usize>, by: &'static str) {
        let drive = &self.attack.drive;
        let range = range.start.max(run.first).max(self.scope.steps.start)
            ..range.end.min(run.steps().end).min(self.scope.steps.end);
        if let Some(seen) = &mut self.seen {
            drive.body_sides(run, range.clone().step_by(SEEN_STRIDE), seen);
        }
        if let Some(worst) = self.grounds.least(drive, run, range.clone())
            && self.found.least.is_none_or(|least| worst.room_m < least.room_m)
        {
            (self.found.least, self.found.by) = (Some(worst), by);
        }
        self.found.under = self.found.under.or_else(|| self.grounds.under(drive, run, range.clone()));
        let least = &mut self.found.outside;
        let mut note = |near: Near| {
            if self.scope.feet_m.contains(&near.foot_m)
                && least.is_none_or(|least| near.clearance_m < least.clearance_m)
            {
                *least = Some(near);
            }
        };
        for stretch in self.grounds.stretches(range) {
            match stretch {
                Stretch::Outside(steps) => sweep(drive, run, &self.attack.road, steps, COARSE, &mut note),
                Stretch::Doubtful(steps) => {
                    let mut units: Vec<(usize, Near)> = Vec::new();
                    sweep(drive, run, &self.attack.road, steps, COARSE, |near| {
                        match units.last_mut().filter(|(unit, last)| (*unit, last.step) == (near.unit, near.step)) {
                            Some((_, last)) if near.clearance_m < last.clearance_m => *last = near,
                            Some(_) => {}
                            None => units.push((near.unit, near)),
                        }
                    });
                    for (unit, near) in units {
                        let room_m = self.grounds.room_m(drive, run, near.step, unit);
                        note(Near { clearance_m: near.clearance_m.max(room_m), ..near });
                    }
                }
                Stretch::Inside(_) => {}
            }
        }
    }
}

/// Whether two places of a run are one for an attack.
fn same(a: &Worst, b: &Worst) -> bool {
    a.unit == b.unit
        && a.step.abs_diff(b.step) < SAME_STEPS
        && (a.ahead_m - b.ahead_m).hypot(a.aside_m - b.aside_m) < SAME_M
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::claim::BodyPoint;
    use crate::crossing::Crossing;
    use crate::fleet;
    use crate::planner::drivable;
    use crate::road;
    use netcert_base::corridor::{AreaSpan, PlaneArea};

    /// A straight strip as an area: 5 m wide, with half-widths that forbid everything.
    fn strip() -> Corridor {
        let stations = 201;
        let none = vec![0.0; stations];
        let mut corridor = road::corridor(0.5, [0.0; 2], 0.0, &none, &vec![2.5; stations], &vec![2.5; stations]);
        let ring = vec![[-200.0, -2.5], [300.0, -2.5], [300.0, 2.5], [-200.0, 2.5]];
        corridor.areas = vec![AreaSpan { heads: 20..180, area: Arc::new(PlaneArea { rings: vec![ring] }) }];
        corridor
    }

    fn claim(corridor: &Corridor, rsc_m: f64) -> Claim {
        let plan = corridor.x.iter().zip(&corridor.y).map(|(x, y)| [*x, *y]).collect();
        let limiting = BodyPoint { foot_m: 0.0, unit: 0, side: 1.0, ahead_m: 0.0 };
        Claim { rsc_m, shrink: 1.0, hinge_margin_rad: 0.0, limiting, plan }
    }

    #[test]
    fn on_a_strip_the_adversary_gets_as_far_as_against_half_widths() {
        let vehicle = fleet::vehicle("EU-SEMI16.5");
        let corridor = strip();
        let open = claim(&corridor, 0.0);
        let found = attack_areas(&corridor, &vehicle, &open, &mut Draw(1), 4);
        let (_, outcome) =
            attack::margin_m(&Corridor { areas: Vec::new(), ..corridor.clone() }, &vehicle, &open, &mut Draw(1), 8);
        let least = found.least.unwrap();
        assert!((found.undisturbed_m - (2.5 - 0.5 * 2.55)).abs() < 1e-6);
        assert!((least.room_m - outcome.least.clearance_m).abs() < 0.01, "{least:?} {:?}", outcome.least);
        assert!(found.first_order_m <= least.room_m + 1e-3, "{found:?}");
        assert!(least.room_m < found.undisturbed_m - 0.15, "{found:?}");
        assert!(found.refutes(&open).is_none(), "{found:?}");
        // A claim of a centimetre more than was found is refuted, and so is one that forgets the disturbances.
        assert!(found.refutes(&claim(&corridor, least.room_m + 0.01)).is_some());
        assert!(found.refutes(&claim(&corridor, least.room_m - 0.01)).is_none());
    }

    #[test]
    fn an_island_under_a_body_refutes_a_claim_of_safety() {
        let vehicle = fleet::vehicle("US-WB67");
        let mut corridor = strip();
        let island = vec![[50.0, -0.1], [50.2, 0.0], [50.0, 0.1]];
        let mut area = PlaneArea::clone(&corridor.areas[0].area);
        area.rings.push(island);
        corridor.areas[0].area = Arc::new(area);
        let found = attack_areas(&corridor, &vehicle, &claim(&corridor, 0.0), &mut Draw(2), 2);
        assert!(found.under.is_some());
        assert!(found.refutes(&claim(&corridor, 0.0)).is_some());
        assert!(found.least.unwrap().room_m < 0.0);
    }

    #[test]
    fn in_turns_the_adversary_gets_as_far_as_is_possible_at_first_order() {
        for (index, id) in
            ["EU-SEMI16.5", "US-WB67", "US-WB40", "AU-BDOUBLE26"].into_iter().cycle().take(12).enumerate()
        {
            let vehicle = fleet::vehicle(id);
            let mut draw = Draw(0x51e6e + index as u64 * 7919);
            let crossing = Crossing::drawn(&mut draw);
            let corridor = crossing.corridor(&drivable(&crossing, &vehicle, 1).way, &vehicle);
            let found = attack_areas(&corridor, &vehicle, &claim(&corridor, 0.0), &mut draw, 5);
            let room_m = found.least.unwrap().room_m;
            assert!((room_m - found.first_order_m).abs() < 0.03, "{index} {id}: {found:?}");
            assert!(room_m < found.undisturbed_m - 0.1, "{index} {id}: {found:?}");
        }
    }
}
