//! What has to be measured so that items open, and what is open then: certified as if somebody had measured it.

use std::sync::Arc;

use rayon::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet};

use super::joints::{Item, Joints, Sense};
use crate::assemble::movement;
use crate::certify::{Dependents, Job, MOST_KERB_M, TurnJob, certify_some_turns, certify_strokes, edge_need};
use crate::conditions::{BESIDE_M, Condition, ConditionAt, Suppositions, Turning};
use crate::drive::{Drive, Join};
use crate::driver::Driver;
use crate::network::{EdgeNo, MovementKind, Network, pieces};
use crate::osm::facts::{Policy, WidthSource};
use crate::permits::{Permit, Permits};
use crate::reporter::Silent;
use crate::roads::Roads;
use crate::settings::{Needs, Settings};
use crate::stop::{Stop, Stopped};
use crate::turns::{TurnFacts, TurnNo, turn_facts};
use crate::verdict::Verdict;

/// How much of the roads before and after a turn is looked at, metres. No vehicle's turn needs more.
const AROUND_M: f64 = 250.0;
/// How often more is supposed where a turn is still not certified.
const ROUNDS: usize = 2;
/// How many turns are looked at at once. The number of threads does not matter for what is found.
const AT_ONCE: usize = 4;
/// How much is added then, and up to what, metres. Radii go up to `MOST_KERB_M`.
const ROUNDER_M: f64 = 2.0;
const PAVED_STEP_M: f64 = 3.0;
const MOST_PAVED_M: f64 = 36.0;
const WIDER_M: f64 = 0.5;

/// Opens places of one vehicle on roads on which some measurements are supposed already.
pub(super) struct Opener {
    roads: Arc<Roads>,
    driver: Arc<Driver>,
    settings: Settings,
    turns: Vec<TurnFacts>,
    /// By turn, and back.
    items: Vec<Option<Item>>,
    turn_of: FxHashMap<Item, TurnNo>,
    /// By edge: the other direction of the same piece of road.
    back_of: Vec<Option<EdgeNo>>,
    stroke_of: Arc<[u32]>,
    /// By edge: its place in `Network::stroke_edges`.
    place_of: Vec<u32>,
    /// The network with everything that is chosen.
    network: Network,
    chosen: Suppositions,
    /// What turns need, and edges, metres; `None` if nothing does.
    needs: FxHashMap<Item, Option<Suppositions>>,
    widths_m: FxHashMap<EdgeNo, Option<f64>>,
}

/// Items that are open if some conditions hold.
pub(super) struct Opened {
    pub(super) conditions: Vec<Condition>,
    pub(super) permits: Permits,
    supposed: Suppositions,
    /// Edges and turns that were certified again.
    touched: FxHashSet<Item>,
}

/// Items that nothing opens.
pub(super) struct HopelessItems(pub(super) Vec<Item>);

impl Opener {
    pub(super) fn new(roads: &Arc<Roads>, driver: &Arc<Driver>, joints: &Joints) -> Self {
        let network = roads.network.clone();
        // What has been opened needs no search for what would open it.
        let settings = Settings { needs: Needs::Off, ..driver.permits.settings.clone() };
        let turns = turn_facts(&network, &settings.kerbs);
        let mut place_of = vec![0; network.edges.len()];
        for stroke in &network.strokes {
            for place in stroke.edges.clone() {
                place_of[network.stroke_edges[place as usize].index()] = place;
            }
        }
        let items = joints.items_of(roads, &turns);
        let turn_of = TurnNo::all().zip(&items).filter_map(|(turn, item)| Some(((*item)?, turn))).collect();
        Self {
            back_of: backs(&network),
            items,
            turn_of,
            stroke_of: network.strokes_of_edges().into(),
            chosen: Suppositions::new(Arc::new(network.site.clone())),
            roads: Arc::clone(roads),
            driver: Arc::clone(driver),
            settings,
            turns,
            place_of,
            network,
            needs: FxHashMap::default(),
            widths_m: FxHashMap::default(),
        }
    }

    /// Takes what was opened as measured.
    pub(super) fn choose(&mut self, opened: Opened) {
        self.chosen = opened.supposed;
        self.chosen.apply(&mut self.network);
        // What sees the change may need less or more now.
        self.widths_m.retain(|edge, _| !opened.touched.contains(&edge.get()));
        self.needs.retain(|turn, _| !opened.touched.contains(turn));
    }

    /// Finds what opens all of these items together.
    pub(super) fn open(
        &mut self,
        joints: &Joints,
        items: &[Item],
        permits: &Permits,
        stop: &Stop,
    ) -> Result<Result<Suppositions, HopelessItems>, Stopped> {
        let (on_edges, turns): (Vec<Item>, Vec<Item>) =
            items.iter().partition(|&&item| (item as usize) < joints.edges());
        let edges: Vec<EdgeNo> = on_edges.iter().copied().map(EdgeNo::new).collect();
        let mut supposed = self.chosen.clone();
        if let Err(hopeless) = self.widen(&edges, &mut supposed, stop)? {
            return Ok(Err(hopeless));
        }
        let edges_only = supposed.clone();
        if let Err(hopeless) = self.turn(joints, &turns, &mut supposed, stop)? {
            return Ok(Err(hopeless));
        }
        let mut verdicts: Vec<Verdict> = permits.edges.iter().map(|permit| permit.verdict).collect();
        edges.iter().for_each(|&edge| verdicts[edge.index()] = Verdict::Safe);
        for round in 0..=ROUNDS {
            stop.check()?;
            self.level(&mut supposed);
            if supposed.raises(&self.chosen) {
                // Two values for one place would contradict each other in the register.
                return Ok(Err(HopelessItems(if turns.is_empty() { on_edges } else { turns })));
            }
            let failed = self.not_turned(&turns, &supposed, &verdicts);
            if failed.is_empty() {
                return Ok(Ok(supposed));
            }
            if round == ROUNDS || !self.suppose_more(joints, &failed, &edges_only, &mut supposed) {
                return Ok(Err(HopelessItems(failed)));
            }
        }
        Ok(Err(HopelessItems(items.to_vec())))
    }

    /// Supposes for each edge the width that it needs.
    fn widen(
        &mut self,
        edges: &[EdgeNo],
        supposed: &mut Suppositions,
        stop: &Stop,
    ) -> Result<Result<(), HopelessItems>, Stopped> {
        let strip = self.settings.policy;
        let need = |&edge: &EdgeNo| {
            stop.check()?;
            let known = self.network.edges.get(edge.index()).and_then(|edge| self.network.section(edge).strip(strip));
            // What is measured already, another measurement does not widen.
            let open = known.is_some_and(|strip| strip.source != WidthSource::Surveyed);
            let stroke = self.stroke_of[edge.index()];
            let need = || edge_need(&self.network, stroke, edge, &self.driver.model, &self.settings);
            Ok((edge, open.then(need).flatten()))
        };
        let unknown: Vec<EdgeNo> = edges.iter().copied().filter(|edge| !self.widths_m.contains_key(edge)).collect();
        let found: Vec<(EdgeNo, Option<f64>)> = unknown.par_iter().map(need).collect::<Result<_, Stopped>>()?;
        self.widths_m.extend(found);
        let of = |edge: &EdgeNo| self.widths_m.get(edge).copied().flatten();
        let hopeless: Vec<Item> = edges.iter().filter(|edge| of(edge).is_none()).map(|edge| edge.get()).collect();
        if !hopeless.is_empty() {
            return Ok(Err(HopelessItems(hopeless)));
        }
        let needs: Vec<(EdgeNo, f64)> = edges.iter().filter_map(|edge| Some((*edge, of(edge)?))).collect();
        for &(edge, need_m) in &needs {
            self.suppose_width(edge, need_m, supposed);
        }
        let narrow = self.still_unsafe(edges, supposed);
        // The road beside them counts, too: the vehicle stands on both.
        for &(edge, need_m) in needs.iter().filter(|(edge, _)| narrow.contains(edge)) {
            let reach_m = self.driver.model.vehicle.length_m + BESIDE_M;
            for near in
                self.along(edge, reach_m, Sense::Back).into_iter().chain(self.along(edge, reach_m, Sense::Ahead))
            {
                self.suppose_width(near, need_m, supposed);
            }
        }
        let narrow = if narrow.is_empty() { narrow } else { self.still_unsafe(edges, supposed) };
        Ok(if narrow.is_empty() { Ok(()) } else { Err(HopelessItems(narrow.into_iter().map(EdgeNo::get).collect())) })
    }

    /// Supposes a width of an edge. A carriageway has one width for both directions.
    fn suppose_width(&self, edge: EdgeNo, width_m: f64, supposed: &mut Suppositions) {
        let strip = self.settings.policy;
        supposed.widen(&self.network, edge, strip, width_m);
        if let Some(back) = self.back_of[edge.index()].filter(|_| strip == Policy::Carriageway) {
            supposed.widen(&self.network, back, strip, width_m);
        }
    }

    /// Gives one value to what is one thing on site: the kerb of a corner, and the carriageway of both directions.
    fn level(&self, supposed: &mut Suppositions) {
        supposed.level_corners(&self.network);
        if self.settings.turn_policy.max(self.settings.policy) != Policy::Carriageway {
            return;
        }
        let edges = supposed.differing_edges(&self.chosen);
        for (edge, back) in edges.into_iter().filter_map(|edge| Some((edge, self.back_of[edge.index()]?))) {
            if let Some(width_m) = supposed.width_m(&self.network, edge, Policy::Carriageway) {
                supposed.widen(&self.network, back, Policy::Carriageway, width_m);
            }
        }
    }

    /// The edges that are not safe under suppositions.
    fn still_unsafe(&self, edges: &[EdgeNo], supposed: &Suppositions) -> Vec<EdgeNo> {
        if edges.is_empty() {
            return Vec::new();
        }
        let mut network = self.network.clone();
        supposed.apply(&mut network);
        let mut strokes: Vec<u32> = edges.iter().map(|&edge| self.stroke_of[edge.index()]).collect();
        strokes.sort_unstable();
        strokes.dedup();
        let mut narrow = Vec::new();
        let models = std::slice::from_ref(&self.driver.model);
        let job = Job { network: &network, models, settings: &self.settings };
        let Ok(_) = certify_strokes::<std::convert::Infallible>(&job, &strokes, &Silent, |_, made| {
            if made.conclusion.verdict != Verdict::Safe && edges.contains(&made.edge) {
                narrow.push(made.edge);
            }
            Ok(())
        });
        narrow
    }

    /// Supposes for each turn what it needs.
    fn turn(
        &mut self,
        joints: &Joints,
        turns: &[Item],
        supposed: &mut Suppositions,
        stop: &Stop,
    ) -> Result<Result<(), HopelessItems>, Stopped> {
        // What turns need beside edges that are widened is not kept: it depends on these widths.
        let keep = *supposed == self.chosen;
        let unknown: Vec<Item> = turns.iter().copied().filter(|turn| !keep || !self.needs.contains_key(turn)).collect();
        let (base, this) = (&*supposed, &*self);
        let need = |&item: &Item| {
            stop.check()?;
            let need = this.on_way(joints, item, |turning| {
                let mut network = this.network.clone();
                base.apply(&mut network);
                let mut own = base.clone();
                (turning.is_safe(&network) || turning.meet(&mut network, &mut own)).then(|| own.beyond(base))
            });
            Ok((item, need.flatten()))
        };
        let mut found: Vec<(Item, Option<Suppositions>)> = Vec::new();
        // One turn that nothing opens is enough, so the others are not looked at.
        for few in unknown.chunks(AT_ONCE) {
            found.extend(few.par_iter().map(need).collect::<Result<Vec<_>, Stopped>>()?);
            if found.iter().any(|(_, need)| need.is_none()) {
                break;
            }
        }
        let known = turns.iter().filter_map(|turn| Some((*turn, self.needs.get(turn).filter(|_| keep)?.clone())));
        let all: Vec<(Item, Option<Suppositions>)> = known.chain(found.iter().cloned()).collect();
        if keep {
            self.needs.extend(found);
        }
        let hopeless: Vec<Item> = all.iter().filter(|(_, need)| need.is_none()).map(|(item, _)| *item).collect();
        if !hopeless.is_empty() {
            return Ok(Err(HopelessItems(hopeless)));
        }
        all.iter().filter_map(|(_, need)| need.as_ref()).for_each(|need| supposed.add(need));
        Ok(Ok(()))
    }

    /// Supposes more for turns that are not certified yet. Returns whether there is more to suppose.
    fn suppose_more(
        &self,
        joints: &Joints,
        failed: &[Item],
        edges_only: &Suppositions,
        supposed: &mut Suppositions,
    ) -> bool {
        let mut more = false;
        for &item in failed.iter().filter(|&&item| item as usize >= joints.edges()) {
            more |= self.on_way(joints, item, |turning| self.grow(turning, edges_only, supposed)).unwrap_or(false);
        }
        more
    }

    /// Supposes more of what was found for a turn: greater radii, else more that is paved, else wider roads.
    fn grow(&self, turning: &Turning<'_>, edges_only: &Suppositions, supposed: &mut Suppositions) -> bool {
        let mut more = false;
        for (node, between) in turning.corners(&self.network) {
            let radius_m = supposed.radius_m(node, between).filter(|&radius_m| radius_m < MOST_KERB_M);
            if let Some(radius_m) = radius_m {
                supposed.round(node, between, (radius_m + ROUNDER_M).min(MOST_KERB_M));
                more = true;
            }
        }
        for (node, at) in turning.nodes(&self.network).into_iter().filter(|_| !more).collect::<Vec<_>>() {
            if let Some(radius_m) = supposed.paved_m(node).filter(|&radius_m| radius_m < MOST_PAVED_M) {
                supposed.pave(node, at, radius_m + PAVED_STEP_M);
                more = true;
            }
        }
        let strip = turning.strip();
        for edge in turning.near(&self.network).into_iter().filter(|_| !more).collect::<Vec<_>>() {
            let [before_m, has_m] = [edges_only, &*supposed].map(|all| all.width_m(&self.network, edge, strip));
            if let Some(has_m) = has_m.filter(|_| has_m > before_m) {
                more |= supposed.widen(&self.network, edge, strip, has_m + WIDER_M);
            }
        }
        more
    }

    /// Takes a turn as part of the road straight on before and after it.
    fn on_way<T>(&self, joints: &Joints, item: Item, with: impl FnOnce(&Turning<'_>) -> T) -> Option<T> {
        let step = joints.step(item)?;
        let movements = &self.roads.movements;
        let passage = movements.passage(step.from, step.to).filter(|_| movements.index(step.from, step.to).is_none());
        let arcs = passage.map_or(&[][..], |place| &movements.passages()[place].through);
        let mut edges = self.along(step.from, AROUND_M, Sense::Back);
        edges.reverse();
        edges.push(step.from);
        let first = edges.len();
        edges.extend(arcs);
        let at = edges.len();
        edges.push(step.to);
        edges.extend(self.along(step.to, AROUND_M, Sense::Ahead));
        let over = if arcs.is_empty() { Vec::new() } else { std::iter::once(first..at).collect() };
        let drive = Drive { edges, over };
        let join = Join { from: step.from, arcs: &drive.edges[first..at], to: step.to, at };
        let movement = movement(movements, step.from, arcs, step.to).filter(|m| m.kind == MovementKind::Turn)?;
        let (driver, stroke_of) = (Arc::clone(&self.driver), Arc::clone(&self.stroke_of));
        Some(with(&Turning { driver, drive: &drive, join, movement, stroke_of }))
    }

    /// The edges of a stroke before or after one of them, up to a distance, from it on.
    fn along(&self, edge: EdgeNo, most_m: f64, sense: Sense) -> Vec<EdgeNo> {
        let network = &self.network;
        let Some(stroke) = network.strokes.get(self.stroke_of[edge.index()] as usize) else { return Vec::new() };
        let place = self.place_of[edge.index()];
        let range = |from: u32, to: u32| &network.stroke_edges[from as usize..to as usize];
        let others: Vec<EdgeNo> = match sense {
            Sense::Ahead => range(place + 1, stroke.edges.end).to_vec(),
            Sense::Back => range(stroke.edges.start, place).iter().rev().copied().collect(),
        };
        let mut far_m = 0.0;
        let near = others.into_iter().take_while(|&edge| {
            let begins_m = far_m;
            far_m += network.length_m(&network.edges[edge.index()]);
            begins_m < most_m
        });
        near.collect()
    }

    /// The turns that are not safe under suppositions, of some on edges with these verdicts.
    fn not_turned(&self, turns: &[Item], supposed: &Suppositions, verdicts: &[Verdict]) -> Vec<Item> {
        let mut network = self.network.clone();
        supposed.apply(&mut network);
        let numbers: Vec<TurnNo> = turns.iter().filter_map(|item| self.turn_of.get(item).copied()).collect();
        let (models, edges) = (std::slice::from_ref(&self.driver.model), [verdicts.to_vec()]);
        let job = TurnJob { network: &network, turns: &self.turns, models, edges: &edges, settings: &self.settings };
        let mut failed = turns.to_vec();
        let Ok(_) = certify_some_turns::<std::convert::Infallible>(&job, &numbers, &Silent, |_, made| {
            if made.conclusion.verdict == Verdict::Safe {
                failed.retain(|item| self.turn_of.get(item) != Some(&made.turn));
            }
            Ok(())
        });
        failed
    }

    /// Certifies again what sees the suppositions, as `netcert evidence add` would. `before` are the permits with everything chosen.
    pub(super) fn certify(&self, joints: &Joints, supposed: Suppositions, before: &Permits) -> Opened {
        let mut network = self.network.clone();
        supposed.apply(&mut network);
        let (edges, nodes) = network.site.differences(&self.network.site);
        let touched = Dependents::find(&network, &self.turns, &edges, &nodes);
        let models = std::slice::from_ref(&self.driver.model);
        let mut permits = before.clone();
        let job = Job { network: &network, models, settings: &self.settings };
        let Ok(_) = certify_strokes::<std::convert::Infallible>(&job, &touched.strokes, &Silent, |_, made| {
            let rsc_m = made.conclusion.measured.map(|measured| measured.rsc_m);
            permits.edges[made.edge.index()] = Permit { verdict: made.conclusion.verdict, rsc_m };
            Ok(())
        });
        let verdicts = [permits.edges.iter().map(|permit| permit.verdict).collect()];
        let job = TurnJob { network: &network, turns: &self.turns, models, edges: &verdicts, settings: &self.settings };
        let Ok(_) = certify_some_turns::<std::convert::Infallible>(&job, &touched.turns, &Silent, |_, made| {
            let rsc_m = made.conclusion.measured.map(|measured| measured.rsc_m);
            let item = self.items.get(made.turn.index()).copied().flatten();
            let slot = item.and_then(|item| slot(&mut permits, item as usize - joints.edges()));
            if let Some(slot) = slot {
                *slot = Permit { verdict: made.conclusion.verdict, rsc_m };
            }
            Ok(())
        });
        let strokes = touched.strokes.iter().filter_map(|&stroke| network.strokes.get(stroke as usize));
        let on = strokes.flat_map(|s| &network.stroke_edges[s.edges.start as usize..s.edges.end as usize]);
        let turned = touched.turns.iter().filter_map(|&turn| self.items.get(turn.index()).copied().flatten());
        let touched = on.map(|edge| edge.get()).chain(turned).collect();
        Opened { conditions: self.conditions(&supposed), permits, touched, supposed }
    }

    /// What is supposed beyond what was chosen before.
    fn conditions(&self, supposed: &Suppositions) -> Vec<Condition> {
        let new = supposed.beyond(&self.chosen);
        let edges = supposed.differing_edges(&self.chosen);
        let mut way: Vec<EdgeNo> = edges.into_iter().collect();
        way.sort_by_key(|&edge| self.place_of[edge.index()]);
        let mut conditions = new.conditions(&self.roads.network, &self.settings.kerbs, &way);
        // Both ways round a corner have one kerb.
        let mut kerbs = FxHashSet::default();
        conditions.retain(|condition| match condition.at {
            ConditionAt::Corner { node, between } => {
                let edges = between.map(|edge| &self.network.edges[edge.index()]);
                kerbs.insert((node, pieces(edges)))
            }
            ConditionAt::Road(_) | ConditionAt::Junction(_) => true,
        });
        conditions
    }
}

/// The slot of a movement or passage.
fn slot(permits: &mut Permits, place: usize) -> Option<&mut Permit> {
    match place.checked_sub(permits.movements.len()) {
        None => permits.movements.get_mut(place),
        Some(place) => permits.passages.get_mut(place),
    }
}

/// By edge: the other direction of the same piece of road.
fn backs(network: &Network) -> Vec<Option<EdgeNo>> {
    let mut first: FxHashMap<(u32, u32), EdgeNo> = FxHashMap::default();
    let mut backs = vec![None; network.edges.len()];
    for (index, edge) in network.numbered_edges() {
        if let Some(other) = first.insert((edge.road, edge.shape.start), index) {
            backs[index.index()] = Some(other);
            backs[other.index()] = Some(index);
        }
    }
    backs
}
