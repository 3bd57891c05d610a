//! How far every hinge and the steering lock stay from their limits (proof, section 10).

use crate::swept_vehicle::SweptVehicle;
use crate::tubes::Tube;

impl SweptVehicle<'_> {
    /// The margin of a hinge (0: the steering lock) throughout a step (proof, section 10), radians. The adjoint is used
    /// if the filter's margin is below `least`. −∞ without bounds.
    pub(crate) fn hinge_margin(&mut self, step: usize, unit: usize, least: f64) -> f64 {
        let margin = self.plain_hinge_margin(step, unit);
        if margin >= least {
            return margin;
        }
        self.tighten_up_to(step);
        self.plain_hinge_margin(step, unit)
    }

    /// Bound of |y| of an axle throughout a step. The adjoint is used if the filter's bound is above `enough`.
    pub(crate) fn axle_bound(&mut self, step: usize, unit: usize, enough: f64) -> Option<f64> {
        let y = self.tubes.get(step, unit)?.y;
        if y <= enough {
            return Some(y);
        }
        self.tighten_up_to(step);
        let y = self.tubes.get(step, unit)?.y;
        Some(y.min(self.exact_pose(step, unit)?[0]))
    }

    /// The least margin of a hinge while any point of the vehicle is on the corridor, less the turn of the unit's
    /// coupling path within a station. A reader that looks at stations only may find this much less.
    pub fn coarse_hinge_margin(&self, unit: usize) -> f64 {
        let steps = self.steps(0..self.road.count - 1);
        let turn = |step: usize| self.motion.swing(step, unit).curvature * self.road.spacing;
        steps.map(|step| self.plain_hinge_margin(step, unit) - turn(step)).fold(f64::INFINITY, f64::min)
    }

    /// The margin of a hinge throughout a step from the current tubes, radians. −∞ without bounds.
    fn plain_hinge_margin(&self, step: usize, unit: usize) -> f64 {
        let swing = |unit: usize| self.motion.swing(step, unit);
        let angles = |unit: usize| [swing(unit).before, swing(unit).after].map(|half| 2.0 * half.atan());
        let limit = self.chain.links[unit].limit;
        let Some(tube) = self.tubes.get(step, unit) else { return f64::NEG_INFINITY };
        let delta = angles(unit);
        let Some(ahead) = unit.checked_sub(1) else {
            return limit - (delta[0].abs().max(delta[1].abs()) + tube.a + self.chain.heading_rad);
        };
        let Some(before) = self.tubes.get(step, ahead) else { return f64::NEG_INFINITY };
        let link = &self.chain.links[ahead];
        let chi = angles(ahead).map(|delta| (-link.k * delta.tan()).atan());
        let folded = (delta[0] - chi[0]).abs().max((delta[1] - chi[1]).abs());
        let shift = |unit: usize, tube: &Tube| {
            let delta = angles(unit)[0].abs();
            delta.tan() / self.chain.links[unit].l * tube.e * delta.sin()
        };
        limit - (folded + before.a + tube.a + shift(ahead, before) + shift(unit, tube))
    }
}
