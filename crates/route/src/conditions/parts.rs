//! What the edges and turns of a way need by themselves.

use std::sync::Arc;

use super::fitter::{Fitter, Fitting, network_of};
use super::joint;
use super::turn_need::Turning;
use crate::assemble::{PartKind, movement};
use crate::certify::edge_need;
use crate::drive::{Drive, Join};
use crate::graph::Access;
use crate::network::{EdgeNo, MovementKind};
use crate::osm::facts::Policy;
use crate::stop::{Stop, Stopped};

/// Where an edge lacks room, its way is as wide as it must be over the vehicle's length and this, metres.
pub(crate) const BESIDE_M: f64 = 20.0;

/// What becomes of a step of a way.
enum Step {
    /// It needs nothing, or what is supposed now.
    Done,
    /// It is now part of a longer passage.
    Merged,
    /// Nothing does.
    Unfit,
}

impl Fitter {
    /// Supposes for each edge with a price the width that it needs, and as much for the way near it.
    pub(super) fn suppose_widths(
        &mut self,
        fitting: &mut Fitting,
        access: &Access,
        stop: &Stop,
    ) -> Result<Vec<PartKind>, Stopped> {
        let strip = self.driver.permits.settings.policy;
        let mut unfit = Vec::new();
        fitting.supposed.apply(network_of(&mut self.roads));
        for (i, edge) in fitting.drive.edges.clone().into_iter().enumerate() {
            let inside = fitting.drive.over.iter().any(|arcs| arcs.contains(&i));
            if inside || access.edges.get(edge.index()).is_none_or(|&price| price == 0) {
                continue;
            }
            stop.check()?;
            let (network, driver) = (&self.roads.network, &self.driver);
            let stroke = self.stroke_of.get(edge.index()).copied().unwrap_or(u32::MAX);
            let need = || edge_need(network, stroke, edge, &driver.model, &driver.permits.settings);
            match *self.needs_m.entry(edge).or_insert_with(need) {
                Some(need_m) => {
                    self.widen_near(fitting, i, strip, need_m);
                }
                None => unfit.push(PartKind::Edge(edge)),
            }
        }
        Ok(unfit)
    }

    /// Supposes a width for an edge of a way, and for its neighbours on the same stroke up to the vehicle's length.
    pub(super) fn widen_near(&self, fitting: &mut Fitting, at: usize, strip: Policy, width_m: f64) -> bool {
        let network = &self.roads.network;
        let reach_m = self.driver.model.vehicle.length_m + BESIDE_M;
        let Fitting { drive, supposed, .. } = fitting;
        let edges = &drive.edges;
        let stroke = |edge: EdgeNo| self.stroke_of.get(edge.index());
        let mut more = supposed.widen(network, edges[at], strip, width_m);
        let mut go = |others: &mut dyn Iterator<Item = EdgeNo>| {
            let mut far_m = 0.0;
            for edge in others.take_while(|&edge| stroke(edge) == stroke(edges[at])) {
                if far_m >= reach_m {
                    break;
                }
                more |= supposed.widen(network, edge, strip, width_m);
                far_m += network.edges.get(edge.index()).map_or(0.0, |edge| network.length_m(edge));
            }
        };
        go(&mut edges[..at].iter().rev().copied());
        go(&mut edges[at + 1..].iter().copied());
        more
    }

    /// Supposes for each turn with a price what it needs.
    pub(super) fn suppose_turns(
        &mut self,
        fitting: &mut Fitting,
        access: &Access,
        stop: &Stop,
    ) -> Result<Vec<PartKind>, Stopped> {
        let mut unfit = Vec::new();
        let mut place = 0;
        loop {
            let step = |join: Join<'_>| (PartKind::Turn { from: join.from, to: join.to }, self.price(access, join));
            let Some((at, price)) = fitting.drive.joins().nth(place).map(step) else { break };
            if price == 0 {
                place += 1;
                continue;
            }
            match self.suppose_turn(fitting, place, stop)? {
                Step::Done => place += 1,
                // The way has fewer steps now, and the earlier turn may be the one that was merged.
                Step::Merged => place = place.saturating_sub(1),
                Step::Unfit => {
                    unfit.push(at);
                    place += 1;
                }
            }
        }
        Ok(unfit)
    }

    /// Supposes what a step of the way needs, or merges it with the turn nearest to it if nothing does.
    fn suppose_turn(&mut self, fitting: &mut Fitting, place: usize, stop: &Stop) -> Result<Step, Stopped> {
        stop.check()?;
        let Some(join) = fitting.drive.joins().nth(place) else { return Ok(Step::Done) };
        let at = PartKind::Turn { from: join.from, to: join.to };
        let need = match self.turning(&fitting.drive, join) {
            None => None,
            Some(None) => return Ok(Step::Done),
            Some(Some(turning)) => {
                let network = network_of(&mut self.roads);
                let known = turning.widths(network, &fitting.supposed);
                let edges = [&[join.from], join.arcs, &[join.to]].concat();
                let need = self.turns.entry((edges, turning.widths_cm(network, &known))).or_insert_with(|| {
                    let mut own = known.clone();
                    own.apply(network);
                    let does =
                        turning.is_safe(network) || turning.meet(network, &mut own) || turning.hope(network, &mut own);
                    does.then(|| own.beyond(&known))
                });
                need.clone()
            }
        };
        match need {
            Some(need) => {
                fitting.supposed.add(&need);
                Ok(Step::Done)
            }
            None if self.merge(fitting, at, stop)? => Ok(Step::Merged),
            None => Ok(Step::Unfit),
        }
    }

    /// Makes one passage of a turn and the turn nearest to it, and supposes what the passage needs.
    pub(super) fn merge(&mut self, fitting: &mut Fitting, at: PartKind, stop: &Stop) -> Result<bool, Stopped> {
        let roads = Arc::clone(&self.roads);
        let Some((merged, at)) = joint::merged(&roads.network, &roads.movements, &fitting.drive, at) else {
            return Ok(false);
        };
        drop(roads);
        let before = std::mem::replace(&mut fitting.drive, merged);
        let place = fitting.drive.joins().position(|join| (join.from, join.to) == at);
        let step = place.map_or(Ok(Step::Unfit), |place| self.suppose_turn(fitting, place, stop))?;
        if matches!(step, Step::Unfit) {
            fitting.drive = before;
        }
        Ok(!matches!(step, Step::Unfit))
    }

    pub(super) fn price(&self, access: &Access, join: Join<'_>) -> u64 {
        let movements = &self.roads.movements;
        let price = match movements.index(join.from, join.to) {
            Some(place) => access.movements.get(place),
            None => movements.passage(join.from, join.to).and_then(|place| access.passages.get(place)),
        };
        price.copied().unwrap_or(0)
    }

    /// The turn of a step; `Some(None)` if the step goes straight on.
    pub(super) fn turning<'t>(&self, drive: &'t Drive, join: Join<'t>) -> Option<Option<Turning<'t>>> {
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
}
