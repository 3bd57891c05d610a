//! The search for places where the leeway is below its claim. Coarse bounds decide most of them, and cells the rest.

use std::ops::Range;

use crate::STEPS;
use crate::cell::Cell;
use crate::coarse::{LocalPoint, Slab};
use crate::feet::Hint;
use crate::leeway::CLOSE_M;
use crate::swept_vehicle::SweptVehicle;
use crate::targets::{Shortfall, Shortfalls, Targets};
use netcert_base::watch;

/// Most halvings of a body for coarse bounds.
const COARSE_HALVINGS: u32 = 4;

/// How far a search goes.
#[derive(Clone, Copy, PartialEq)]
enum Until {
    AllDecided,
    FirstShortfall,
}

impl SweptVehicle<'_> {
    /// All places where the bound is below the claim: the worst one of each stretch and side. In areas half-widths mean
    /// nothing, so their steps are left out.
    pub(crate) fn refute(&mut self, targets: &Targets) -> Vec<Shortfall> {
        let found = self.search(targets, 0..self.chain.links.len(), Until::AllDecided);
        found.worst.into_iter().flatten().flatten().collect()
    }

    /// Whether the bound of one unit is below the claim anywhere.
    pub(crate) fn lacks(&mut self, targets: &Targets, unit: usize) -> bool {
        self.search(targets, unit..unit + 1, Until::FirstShortfall).any
    }

    /// Decides the cells of some units, in all steps or until one is below its claim.
    fn search(&mut self, targets: &Targets, units: Range<usize>, until: Until) -> Shortfalls {
        let claimed = |k: &usize| targets.0.iter().any(|side| side[*k] > f64::NEG_INFINITY);
        let stretches = targets.0[0].len();
        let mut found = Shortfalls::new(stretches);
        let (Some(first), Some(last)) = ((0..stretches).find(claimed), (0..stretches).rev().find(claimed)) else {
            return found;
        };
        // The local points of all sides' ends when a slab begins.
        let mut locals = vec![[None; 2]; self.chain.links.len() * 2];
        let all = self.steps(first..last + 1);
        for start in all.clone().step_by(STEPS) {
            watch::poll();
            let steps = start..(start + STEPS).min(all.end);
            if steps.clone().any(|step| self.road.areas.decides(step)) {
                // In areas feet move on unseen.
                locals.fill([None; 2]);
                for step in steps.filter(|&step| !self.road.areas.decides(step)) {
                    for (unit, side) in units.clone().flat_map(|unit| [(unit, 0), (unit, 1)]) {
                        self.cell(&self.whole(unit, side, step), [Hint::NONE; 2], targets, &mut found);
                    }
                }
                continue;
            }
            for (unit, side) in units.clone().flat_map(|unit| [(unit, 0), (unit, 1)]) {
                let Cell { a, .. } = self.whole(unit, side, start);
                let before: [Option<LocalPoint>; 2] = locals[unit * 2 + side];
                let before = [0, 1].map(|k| before[k].or_else(|| self.local_point(start, unit, side, a[k], None)));
                let after =
                    [0, 1].map(|k| self.local_point(steps.end, unit, side, a[k], before[k].map(|local| local.station)));
                locals[unit * 2 + side] = after;
                let slab = Slab { unit, side, steps: steps.clone(), a, halvings: 0 };
                self.decide(&slab, [before, after], targets, &mut found);
            }
            if until == Until::FirstShortfall && found.any {
                break;
            }
        }
        found
    }

    /// A side of a unit during a step.
    fn whole(&self, unit: usize, side: usize, step: usize) -> Cell {
        let link = &self.chain.links[unit];
        Cell { unit, side, step, t: [0.0, 1.0], a: [link.rear, link.front], halvings: 0 }
    }

    /// Decides a slab by its coarse bound, or those of its parts. What remains is decided by cells.
    fn decide(&mut self, slab: &Slab, locals: [[Option<LocalPoint>; 2]; 2], targets: &Targets, found: &mut Shortfalls) {
        let mut known = None;
        if let [[Some(c00), Some(c01)], [Some(c10), Some(c11)]] = locals {
            let corners = [[c00, c01], [c10, c11]];
            let outside = corners.as_flattened().iter().filter(|local| self.outside(local)).count();
            if outside == 4 {
                return;
            }
            let coarse = self.coarse(slab, &corners);
            // Only a part of the body may be on the corridor already.
            let mut halve = coarse.is_none() && outside > 0;
            if let Some(coarse) = coarse {
                let (first, last) = self.range(coarse.stations);
                let Some(target) = found.target(targets, slab.side, first, last) else { return };
                if coarse.bound >= target + CLOSE_M {
                    return;
                }
                // A part may be on a stretch of which less is claimed, or nothing.
                let least = targets.0[slab.side][first..=last].iter().copied().fold(target, f64::min);
                halve = coarse.bound + coarse.body >= least;
            }
            if halve && slab.halvings < COARSE_HALVINGS {
                return self.halve(slab, &corners, targets, found);
            }
            known = Some(corners);
        }
        if slab.steps.len() > 1 {
            let mut before = locals[0];
            for step in slab.steps.clone() {
                let from = before.map(|local| local.map(|local| local.station));
                let after = if step + 1 == slab.steps.end {
                    locals[1]
                } else {
                    [0, 1].map(|k| self.local_point(step + 1, slab.unit, slab.side, slab.a[k], from[k]))
                };
                self.decide(&Slab { steps: step..step + 1, ..*slab }, [before, after], targets, found);
                before = after;
            }
            return;
        }
        let hints =
            known.map_or([Hint::NONE; 2], |[start, _]| start.map(|local| Hint::at(local.rough(self.road.spacing))));
        let Slab { unit, side, a, halvings, .. } = *slab;
        self.cell(&Cell { unit, side, step: slab.steps.start, t: [0.0, 1.0], a, halvings }, hints, targets, found);
    }

    /// Decides both halves of a slab's body.
    fn halve(&mut self, slab: &Slab, corners: &[[LocalPoint; 2]; 2], targets: &Targets, found: &mut Shortfalls) {
        let middle = f64::midpoint(slab.a[0], slab.a[1]);
        let at = |node: usize, ends: &[LocalPoint; 2]| {
            let from = usize::midpoint(ends[0].station, ends[1].station);
            self.local_point(node, slab.unit, slab.side, middle, Some(from))
        };
        let middles = [at(slab.steps.start, &corners[0]), at(slab.steps.end, &corners[1])];
        let half = |a: [f64; 2]| Slab { steps: slab.steps.clone(), a, halvings: slab.halvings + 1, ..*slab };
        let rear = [0, 1].map(|t| [Some(corners[t][0]), middles[t]]);
        let front = [0, 1].map(|t| [middles[t], Some(corners[t][1])]);
        self.decide(&half([slab.a[0], middle]), rear, targets, found);
        self.decide(&half([middle, slab.a[1]]), front, targets, found);
    }
}
