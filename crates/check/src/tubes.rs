//! The bounds of every unit's deviations in every step, as `filter` finds them and `adjoint` reads them.

use crate::coefficients::Coefficients;

/// Bounds of one unit throughout one step, metres and radians.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Tube {
    /// Beyond the straight gain: of the axle, and of the coupling times 1/cos δ.
    pub(crate) extra: f64,
    pub(crate) extra_coupling: f64,
    /// Y, E and A, with everything included.
    pub(crate) y: f64,
    pub(crate) e: f64,
    pub(crate) a: f64,
    pub(crate) r1: f64,
    pub(crate) z: f64,
    /// z^h of the *front* coupling, with foot shift and bulge. For unit 0 it is the bulge of the plan.
    pub(crate) zh: f64,
}

/// All tubes at one tolerance, from one step on. A step has `None` if nothing is bounded in it (A3 fails).
pub(crate) struct Tubes {
    pub(crate) step_m: f64,
    /// The first step stored.
    pub(crate) first: usize,
    pub(crate) tolerance_m: f64,
    /// Y of each unit after a straight of any length. It holds where the bounds begin anew, after a step that has none.
    pub(crate) anew: Vec<f64>,
    units: usize,
    tubes: Vec<Option<Tube>>,
    coefficients: Vec<Coefficients>,
}

impl Tubes {
    /// No steps yet.
    pub(crate) fn new(anew: Vec<f64>, step_m: f64, first: usize, tolerance_m: f64) -> Self {
        Self { step_m, first, tolerance_m, units: anew.len(), anew, tubes: Vec::new(), coefficients: Vec::new() }
    }

    /// Makes room for so many more steps.
    pub(crate) fn reserve(&mut self, steps: usize) {
        self.tubes.reserve_exact(steps * self.units);
        self.coefficients.reserve_exact(steps * self.units);
    }

    /// The step after the last one.
    pub(crate) fn end(&self) -> usize {
        self.first + self.tubes.len() / self.units
    }

    /// Begins a step with the coefficients of its units. Their tubes follow, front to rear.
    pub(crate) fn begin(&mut self, coefficients: impl Iterator<Item = Coefficients>) {
        self.coefficients.extend(coefficients);
    }

    /// Adds the tube of the next unit.
    pub(crate) fn push(&mut self, tube: Tube) {
        self.tubes.push(Some(tube));
    }

    /// Takes the last tube away.
    pub(crate) fn pop(&mut self) {
        self.tubes.pop();
    }

    /// Leaves a step that has been begun without bounds.
    pub(crate) fn unbounded(&mut self, step: usize) {
        self.tubes.truncate(self.index(step, 0));
        self.tubes.extend(std::iter::repeat_n(None, self.units));
    }

    pub(crate) fn coefficients(&self, step: usize, unit: usize) -> &Coefficients {
        &self.coefficients[self.index(step, unit)]
    }

    pub(crate) fn get(&self, step: usize, unit: usize) -> Option<&Tube> {
        self.tubes.get(step.checked_sub(self.first)? * self.units + unit)?.as_ref()
    }

    /// The tube of a stored step.
    pub(crate) fn get_mut(&mut self, step: usize, unit: usize) -> Option<&mut Tube> {
        let index = self.index(step, unit);
        self.tubes.get_mut(index)?.as_mut()
    }

    fn index(&self, step: usize, unit: usize) -> usize {
        (step - self.first) * self.units + unit
    }
}
