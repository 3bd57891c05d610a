//! Finds what has to hold on one way, so that the whole way is certified.

use std::sync::Arc;

use rustc_hash::FxHashMap;

use super::suppositions::Suppositions;
use super::turn_need::Turning;
use crate::certify::{MOST_KERB_M, MOST_MORE_M, edge_need};
use crate::network::{self, MovementKind, Network};
use crate::osm::facts::Policy;
use crate::route::assemble::{PartKind, Way, movement};
use crate::route::drive::{Drive, Join};
use crate::route::driver::Driver;
use crate::route::graph::Access;
use crate::route::obstacles::Refutation;
use crate::route::roads::Roads;
use crate::route::turning::MadeTurns;
use crate::route::whole::{Certified, Whole};
use crate::stop::{Stop, Stopped};

/// How many paths of a turn are tried beside the best one.
const MORE_PATHS: usize = 1;
/// How often a whole way is tried, each time with more supposed where it failed.
const ROUNDS: usize = 10;
/// Where an edge lacks room, its way is as wide as it must be over the vehicle's length and this, metres.
pub(in crate::route) const BESIDE_M: f64 = 20.0;
/// The least that is added to a width or a radius where the whole fails, metres.
const WIDER_M: f64 = 0.1;
const ROUNDER_M: f64 = 1.0;
/// How far a junction is supposed to be paved: by how much more, at most and at first, metres.
const PAVED_STEP_M: f64 = 3.0;
const MOST_PAVED_M: f64 = 36.0;
const FIRST_PAVED_M: f64 = 9.0;
/// Where the whole lacks this much, more than one thing is supposed at once, metres; what it lacks where no bound holds.
const MUCH_M: f64 = 0.3;
const NO_BOUND_M: f64 = 1.0;

/// Fits ways, and keeps what it has found out about edges.
pub(super) struct Fitter {
    roads: Arc<Roads>,
    driver: Arc<Driver>,
    base: Arc<network::Site>,
    stroke_of: Arc<[u32]>,
    needs_m: FxHashMap<u32, Option<f64>>,
    /// What turns need; `None` if nothing does.
    turns: FxHashMap<TurnKey, Option<Suppositions>>,
    /// What was certified last, and what was supposed there.
    whole: Option<(Whole, Suppositions)>,
}

/// The edges before and after a turn, and the widths of the roads beside it in centimetres.
type TurnKey = (u32, u32, Vec<i64>);

/// A way that is certified if everything supposed holds.
pub(super) struct Fitted {
    pub(super) certified: Certified,
    pub(super) supposed: Suppositions,
}

/// The places on a way for which nothing does.
pub(super) struct Unfit(pub(super) Vec<PartKind>);

impl Fitter {
    pub(super) fn new(roads: &Arc<Roads>, driver: &Arc<Driver>) -> Self {
        let base = Arc::new(roads.network.site.clone());
        Self {
            roads: Arc::clone(roads),
            driver: Arc::clone(driver),
            base,
            stroke_of: roads.network.strokes_of_edges().into(),
            needs_m: FxHashMap::default(),
            turns: FxHashMap::default(),
            whole: None,
        }
    }

    /// Fits a way. `access` says what has a price.
    pub(super) fn fit(
        &mut self,
        way: &Way<'_>,
        access: &Access,
        stop: &Stop,
    ) -> Result<Result<Fitted, Unfit>, Stopped> {
        let mut supposed = Suppositions::new(Arc::clone(&self.base));
        let mut unfit = self.suppose_widths(way.drive, access, &mut supposed, stop)?;
        unfit.extend(self.suppose_turns(way.drive, access, &mut supposed, stop)?);
        if !unfit.is_empty() {
            return Ok(Err(Unfit(unfit)));
        }
        let mut last = None;
        for _ in 0..ROUNDS {
            supposed.apply(network_of(&mut self.roads));
            let fresh = self.whole.is_none();
            let going = match self.whole.take() {
                None => self.new_whole(),
                Some((mut whole, before)) => {
                    let (edges, nodes) = supposed.differ(&before);
                    whole.go_on_with(&self.roads, &edges, &nodes);
                    whole
                }
            };
            let (going, _) = self.whole.insert((going, supposed.clone()));
            let result = certify(going, way, stop)?;
            let refutation = match result {
                Ok(certified) if fresh => return Ok(Ok(Fitted { certified, supposed })),
                // The answer is made from nothing that was made before.
                Ok(_) => match certify(&mut self.new_whole(), way, stop)? {
                    Ok(certified) => return Ok(Ok(Fitted { certified, supposed })),
                    Err(refutation) => refutation,
                },
                Err(refutation) => refutation,
            };
            last = Some(refutation.at);
            if !self.suppose_more(way.drive, &refutation, &mut supposed) {
                break;
            }
        }
        Ok(Err(Unfit(last.into_iter().collect())))
    }

    /// Certifies ways on the roads as they are now.
    fn new_whole(&self) -> Whole {
        let turns = Box::new(MadeTurns { driver: Arc::clone(&self.driver), more: MORE_PATHS });
        Whole::new(&self.roads, Arc::clone(&self.driver), turns)
    }

    /// Supposes for each edge with a price the width that it needs, and as much for the way near it.
    fn suppose_widths(
        &mut self,
        drive: &Drive,
        access: &Access,
        supposed: &mut Suppositions,
        stop: &Stop,
    ) -> Result<Vec<PartKind>, Stopped> {
        let strip = self.driver.permits.settings.policy;
        let mut unfit = Vec::new();
        supposed.apply(network_of(&mut self.roads));
        for (i, &edge) in drive.edges.iter().enumerate() {
            let inside = drive.over.iter().any(|arcs| arcs.contains(&i));
            if inside || access.edges.get(edge as usize).is_none_or(|&price| price == 0) {
                continue;
            }
            stop.check()?;
            let (network, driver) = (&self.roads.network, &self.driver);
            let stroke = self.stroke_of.get(edge as usize).copied().unwrap_or(u32::MAX);
            let need = || edge_need(network, (stroke, edge), &driver.model, &driver.permits.settings);
            match *self.needs_m.entry(edge).or_insert_with(need) {
                Some(need_m) => {
                    self.widen_near(drive, i, strip, need_m, supposed);
                }
                None => unfit.push(PartKind::Edge(edge)),
            }
        }
        Ok(unfit)
    }

    /// Supposes a width for an edge of a way, and for its neighbours on the same stroke up to the vehicle's length.
    fn widen_near(&self, drive: &Drive, at: usize, strip: Policy, width_m: f64, supposed: &mut Suppositions) -> bool {
        let network = &self.roads.network;
        let reach_m = self.driver.model.vehicle.length_m + BESIDE_M;
        let edges = &drive.edges;
        let stroke = |edge: u32| self.stroke_of.get(edge as usize);
        let mut more = supposed.widen(network, edges[at], strip, width_m);
        let mut go = |others: &mut dyn Iterator<Item = u32>| {
            let mut far_m = 0.0;
            for edge in others.take_while(|&edge| stroke(edge) == stroke(edges[at])) {
                if far_m >= reach_m {
                    break;
                }
                more |= supposed.widen(network, edge, strip, width_m);
                far_m += network.edges.get(edge as usize).map_or(0.0, |edge| network.length_m(edge));
            }
        };
        go(&mut edges[..at].iter().rev().copied());
        go(&mut edges[at + 1..].iter().copied());
        more
    }

    /// Supposes for each turn with a price what it needs.
    fn suppose_turns(
        &mut self,
        drive: &Drive,
        access: &Access,
        supposed: &mut Suppositions,
        stop: &Stop,
    ) -> Result<Vec<PartKind>, Stopped> {
        let mut unfit = Vec::new();
        for join in drive.joins() {
            let at = PartKind::Turn { from: join.from, to: join.to };
            let Some(turning) = self.turning(drive, join) else {
                unfit.push(at);
                continue;
            };
            let Some(turning) = turning.filter(|_| self.price(access, join) > 0) else { continue };
            stop.check()?;
            let network = network_of(&mut self.roads);
            let key = (join.from, join.to, turning.widths_cm(network, supposed));
            let need = self.turns.entry(key).or_insert_with(|| {
                let mut own = supposed.clone();
                own.apply(network);
                (turning.is_safe(network) || turning.meet(network, &mut own)).then(|| own.beyond(supposed))
            });
            match need {
                Some(need) => supposed.add(need),
                None => unfit.push(at),
            }
        }
        Ok(unfit)
    }

    fn price(&self, access: &Access, join: Join<'_>) -> u64 {
        let movements = &self.roads.movements;
        let price = match movements.index(join.from, join.to) {
            Some(place) => access.movements.get(place),
            None => movements.passage(join.from, join.to).and_then(|place| access.passages.get(place)),
        };
        price.copied().unwrap_or(0)
    }

    /// The turn of a step; `Some(None)` if the step goes straight on.
    fn turning<'t>(&self, drive: &'t Drive, join: Join<'t>) -> Option<Option<Turning<'t>>> {
        let movement = movement(&self.roads.movements, join.from, join.arcs, join.to)?;
        let turns = movement.kind != MovementKind::StraightOn;
        Some(turns.then(|| Turning {
            driver: Arc::clone(&self.driver),
            drive,
            join,
            movement,
            stroke_of: Arc::clone(&self.stroke_of),
        }))
    }

    /// Supposes more where the whole failed. Returns whether there is more to suppose.
    fn suppose_more(&mut self, drive: &Drive, refutation: &Refutation, supposed: &mut Suppositions) -> bool {
        // What cannot be joined is no matter of room. If no bound holds, much is missing.
        if refutation.assembly.is_some() {
            return false;
        }
        let missing_m = refutation.result.map_or(NO_BOUND_M, |(rsc_m, _)| (-rsc_m).max(0.0));
        match refutation.at {
            PartKind::Edge(edge) => {
                let strip = self.driver.permits.settings.policy;
                let place = drive.edges.iter().position(|&other| other == edge);
                place.is_some_and(|at| self.widen_by(drive, at, strip, 2.0 * missing_m, supposed))
            }
            PartKind::Turn { from, to } => {
                let Some(join) = drive.joins().find(|join| (join.from, join.to) == (from, to)) else { return false };
                let Some(Some(turning)) = self.turning(drive, join) else { return false };
                let small = missing_m < MUCH_M;
                let rounder = self.rounder(&turning, missing_m, supposed);
                let paved = !(rounder && small) && self.more_paved(&turning, small, supposed);
                let wider = !((rounder || paved) && small) && self.wider(&turning, missing_m, supposed);
                rounder || paved || wider
            }
        }
    }

    fn widen_by(&self, drive: &Drive, at: usize, strip: Policy, more_m: f64, supposed: &mut Suppositions) -> bool {
        let edge = drive.edges[at];
        let network = &self.roads.network;
        let Some(has_m) = supposed.width_m(network, edge, strip) else { return false };
        let first_m = supposed.known_width_m(network, edge, strip).unwrap_or(has_m);
        let width_m = has_m + more_m.max(WIDER_M);
        width_m <= first_m + MOST_MORE_M && self.widen_near(drive, at, strip, width_m, supposed)
    }

    /// Supposes greater radii of a turn's corners, if radii were what helped it.
    fn rounder(&self, turning: &Turning<'_>, missing_m: f64, supposed: &mut Suppositions) -> bool {
        let corners = turning.corners(&self.roads.network);
        let known: Vec<_> = corners.iter().filter_map(|&(node, between)| supposed.radius_m(node, between)).collect();
        let Some(radius_m) = known.into_iter().reduce(f64::max).filter(|&radius_m| radius_m < MOST_KERB_M) else {
            return false;
        };
        let radius_m = (radius_m + (4.0 * missing_m).max(ROUNDER_M)).min(MOST_KERB_M);
        for (node, between) in corners {
            supposed.round(node, between, radius_m);
        }
        true
    }

    /// Supposes more of a junction to be paved; `only_more`: if that was what helped the turn.
    fn more_paved(&self, turning: &Turning<'_>, only_more: bool, supposed: &mut Suppositions) -> bool {
        let mut more = false;
        for (node, at) in turning.nodes(&self.roads.network) {
            let known_m = supposed.paved_m(node).or((!only_more).then_some(FIRST_PAVED_M));
            if let Some(radius_m) = known_m.filter(|&radius_m| radius_m < MOST_PAVED_M) {
                supposed.pave(node, at, radius_m + PAVED_STEP_M);
                more = true;
            }
        }
        more
    }

    /// Supposes wider roads before and after a turn.
    fn wider(&self, turning: &Turning<'_>, missing_m: f64, supposed: &mut Suppositions) -> bool {
        let (network, strip) = (&self.roads.network, turning.strip());
        let mut more = false;
        for edge in turning.near(network) {
            let Some(has_m) = supposed.width_m(network, edge, strip) else { continue };
            let first_m = supposed.known_width_m(network, edge, strip).unwrap_or(has_m);
            let width_m = has_m + (2.0 * missing_m).max(WIDER_M);
            more |= width_m <= first_m + MOST_MORE_M && supposed.widen(network, edge, strip, width_m);
        }
        more
    }
}

/// Certifies a way, or says where it failed.
fn certify(whole: &mut Whole, way: &Way<'_>, stop: &Stop) -> Result<Result<Certified, Refutation>, Stopped> {
    let (certified, mut failed) = whole.on_any_paths(way, 1, stop)?;
    let nowhere = || Refutation {
        at: PartKind::Edge(way.drive.edges.first().copied().unwrap_or_default()),
        result: None,
        assembly: None,
        left_out: false,
    };
    Ok(certified.ok_or_else(|| failed.pop().unwrap_or_else(nowhere)))
}

/// The network of roads that nobody else holds. If somebody does, it is copied first.
fn network_of(roads: &mut Arc<Roads>) -> &mut Network {
    &mut Arc::make_mut(roads).network
}
