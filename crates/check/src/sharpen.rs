//! Sharper bounds: where the filter says too little, the adjoint (proof, section 6) says more.

use std::ops::Range;

use crate::adjoint::{self, Output};
use crate::gains::Knots;
use crate::swept_vehicle::{HISTORY_LENGTHS, KNOT_M, SweptVehicle};

/// Number of outputs that one run of the adjoint carries.
const ABREAST: usize = 4;
/// The adjoint does not run where the filter adds less than this to the straight bounds, metres. It would gain no more.
const WORTH_M: f64 = 2e-4;
/// For the second order of later steps it takes this much.
const TIGHTEN_M: f64 = 5e-3;

impl SweptVehicle<'_> {
    /// Whether the adjoint is allowed and may improve on the filter.
    pub(crate) fn worth(&self, step: usize, unit: usize) -> bool {
        !self.filter.forbids_adjoint()
            && self.tubes.get(step, unit).is_some_and(|tube| tube.extra + tube.extra_coupling > WORTH_M)
    }

    /// Whether the adjoint has run at all of these knots.
    pub(crate) fn sharp(&self, step: usize, unit: usize, knots: &Range<usize>) -> bool {
        let known = self.known.exact.get(&(unit, step));
        known.is_some_and(|known| known[knots.clone()].iter().all(|bound| !bound.is_nan()))
    }

    /// Whether the adjoint may improve on the bounds of a piece of a body, from `a[0]` to `a[1]` ahead of its axle.
    pub(crate) fn dull(&self, step: usize, unit: usize, a: [f64; 2]) -> bool {
        let knots = Knots::new(&self.chain.links[unit], KNOT_M).about(a);
        self.worth(step, unit) && !self.sharp(step, unit, &knots)
    }

    /// Computes the adjoint's bounds of a piece of a body.
    pub(crate) fn sharpen_about(&mut self, step: usize, unit: usize, a: [f64; 2]) {
        self.sharpen(step, unit, Knots::new(&self.chain.links[unit], KNOT_M).about(a));
    }

    /// Computes the adjoint's bounds for a unit throughout a step, after tightening the second order of its history.
    pub(crate) fn sharpen(&mut self, step: usize, unit: usize, knots: Range<usize>) {
        self.tighten_up_to(step);
        self.run(unit, step + 1, knots.clone());
        let first = step == self.tubes.first;
        if !first {
            self.run(unit, step, knots.clone());
        }
        let bow = adjoint::bow(self.chain, unit, self.tubes.step_m);
        let count = Knots::new(&self.chain.links[unit], KNOT_M).places().len();
        let at = |node: usize, knot: usize| self.known.at_nodes.get(&(unit, node)).map_or(f64::INFINITY, |at| at[knot]);
        let exact = self.known.exact.entry((unit, step)).or_insert_with(|| vec![f64::NAN; count]);
        for knot in knots {
            let end = at(step + 1, knot);
            exact[knot] = throughout([if first { end } else { at(step, knot) }, end], bow);
        }
    }

    /// Runs the adjoint at a node, for body points at knots where it has not run.
    fn run(&mut self, unit: usize, node: usize, knots: Range<usize>) {
        let places: Vec<f64> = Knots::new(&self.chain.links[unit], KNOT_M).places().collect();
        let known = self.known.at_nodes.entry((unit, node)).or_insert_with(|| vec![f64::NAN; places.len()]);
        let missing: Vec<usize> = knots.filter(|&knot| known[knot].is_nan()).collect();
        for some in missing.chunks(ABREAST) {
            let outputs = std::array::from_fn(|w| Output::Point(places[some[w.min(some.len() - 1)]]));
            let bounds = adjoint::bounds::<ABREAST>(self.chain, &self.tubes, unit, node, outputs);
            for (w, &knot) in some.iter().enumerate() {
                known[knot] = bounds.map_or(f64::INFINITY, |bounds| bounds[w]);
            }
        }
    }

    /// The adjoint's bounds of axle and heading throughout a step: the greater of both ends, times the factor of
    /// [`adjoint::bow`].
    pub(crate) fn exact_pose(&mut self, step: usize, unit: usize) -> Option<[f64; 2]> {
        let bow = adjoint::bow(self.chain, unit, self.tubes.step_m);
        let mut at = |node: usize| {
            let (chain, tubes) = (self.chain, &self.tubes);
            let outputs = [Output::Point(0.0), Output::Heading];
            *self
                .known
                .poses
                .entry((unit, node))
                .or_insert_with(|| adjoint::bounds::<2>(chain, tubes, unit, node, outputs))
        };
        let end = at(step + 1)?;
        let start = if step == self.tubes.first { end } else { at(step)? };
        Some([0, 1].map(|k| throughout([start[k], end[k]], bow)))
    }

    /// Tightens the steps that a step's bounds rest on.
    pub(crate) fn tighten_up_to(&mut self, last: usize) {
        let (_, behind) = self.chain.reach_m();
        let history = (HISTORY_LENGTHS * behind / self.tubes.step_m) as usize;
        for step in last.saturating_sub(history).max(self.tubes.first)..=last {
            self.tighten(step);
        }
    }

    /// Bounds axle and heading of all units in a step by the adjoint, so that the second order uses these bounds.
    fn tighten(&mut self, step: usize) {
        if std::mem::replace(&mut self.known.tightened[step], true) {
            return;
        }
        for unit in 0..self.chain.links.len() {
            let Some(tube) = self.tubes.get(step, unit).copied() else { return };
            if tube.extra + tube.extra_coupling < TIGHTEN_M {
                continue;
            }
            self.tubes.tighten_coupling(self.chain, self.motion, step, unit);
            if let Some([y, a]) = self.exact_pose(step, unit) {
                let a = a + tube.r1 / self.chain.links[unit].l;
                self.tubes.tighten(self.chain, self.motion, step, unit, y, a);
            }
        }
    }
}

/// A bound throughout a step, from those at both of its ends: the greater, times the factor of [`adjoint::bow`]. A bound that is no number is
/// none: `f64::max` would take the other end's, and a cell would be sharpened again and again.
fn throughout([start, end]: [f64; 2], bow: f64) -> f64 {
    let bound = start.max(end) * bow;
    if start.is_nan() || end.is_nan() || bound.is_nan() { f64::INFINITY } else { bound }
}

#[cfg(test)]
mod tests {
    use super::throughout;

    #[test]
    fn a_bound_that_is_no_number_is_none() {
        assert_eq!(throughout([1.0, 2.0], 1.5), 3.0);
        assert_eq!(throughout([2.0, 1.0], 1.5), 3.0);
        for ends in [[f64::NAN; 2], [f64::NAN, 1.0], [1.0, f64::NAN], [f64::INFINITY, 1.0]] {
            assert_eq!(throughout(ends, 1.5), f64::INFINITY);
        }
        assert_eq!(throughout([0.0, 0.0], f64::INFINITY), f64::INFINITY);
        assert_eq!(throughout([0.0, 0.0], f64::NAN), f64::INFINITY);
    }
}
