//! Where a unit stands at a head station, and what bounds its deviations there.

use crate::stet::areas::PlanePoint;
use crate::stet::block::{BLOCK, row};
use crate::stet::model::MAX_POINTS;

use super::Body;

/// A unit at a head station.
pub(in crate::stet) struct Stand {
    pub(in crate::stet) head: usize,
    pub(in crate::stet) axle: PlanePoint,
    pub(in crate::stet) along: PlanePoint,
    /// Way of the axle to the next station, metres, and change of its curvature per metre, 1/m².
    pub(in crate::stet) way: f64,
    pub(in crate::stet) jerk: f64,
    /// Bounds of how far each body point is off across the nominal heading, to first order, metres; and of the heading, radians.
    pub(in crate::stet) across: [f64; MAX_POINTS],
    pub(in crate::stet) turned: f64,
}

impl Stand {
    #[inline]
    pub(in crate::stet) fn place(&self, ahead: f64, aside: f64) -> PlanePoint {
        let [x, y] = self.along;
        [self.axle[0] + ahead * x - aside * y, self.axle[1] + ahead * y + aside * x]
    }

    /// The unit at station `k` of the block that begins at station `head`.
    pub(in crate::stet) fn read<const REFINED: bool>(
        body: &Body,
        block: &[f64],
        refined: &[f64],
        head: usize,
        k: usize,
    ) -> Self {
        let at = |field: usize| block[field * BLOCK + k];
        let (extra_axle, extra_coupling, remainder) =
            (at(row::EXTRA_AXLE), at(row::EXTRA_COUPLING), at(row::REMAINDER));
        let a = (extra_axle + extra_coupling) * body.inverse_length + body.heading + remainder;
        let mut across = [0.0; MAX_POINTS];
        for (index, point) in body.points.iter().enumerate() {
            let on_axis = &point.on_axis;
            let first_order = if REFINED {
                refined[index * BLOCK + k]
            } else {
                on_axis.gain + extra_axle * on_axis.from_axle + extra_coupling * on_axis.from_coupling
            };
            across[index] = first_order + on_axis.ahead.abs() * remainder;
        }
        Self {
            head: head + k,
            axle: [at(row::X), at(row::Y)],
            along: [at(row::UX), at(row::UY)],
            way: at(row::WAY2).sqrt(),
            jerk: at(row::JERK),
            across,
            turned: a,
        }
    }
}
