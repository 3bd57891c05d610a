//! A vehicle on a corridor along a plan, of which claims are made.

use std::ops::Range;

use crate::STEPS;
use crate::chain::Chain;
use crate::feet::{Foot, foot};
use crate::fit::{RoadError, StationReading};
use crate::motion::Motion;
use crate::road::Road;
use crate::swept_vehicle::SweptVehicle;
use netcert_base::corridor::Corridor;

/// Vehicle lengths by which the rear may lag behind the steer axle: the arc of a quarter turn instead of its chord
/// (proof, section 7).
pub(crate) const FARTHEST: f64 = 1.6;
/// Stations of the straight road beyond the places that a straight vehicle reaches.
const SPARE: f64 = 3.0;

/// A vehicle on a corridor along a plan.
pub struct Subject<'a> {
    pub(crate) chain: &'a Chain,
    pub(crate) road: Road,
    pub(crate) motion: Option<Motion>,
    /// Shift of the steer axle's path at the corridor's stations, metres.
    shifts: Vec<f64>,
}

impl<'a> Subject<'a> {
    /// `shift(s)` is the plan: metres left of the centreline at `s` stations from the corridor's first. It is held
    /// beyond both ends.
    ///
    /// # Errors
    /// [`RoadError`] if stations do not fit each other, or an area is malformed.
    pub fn new(
        chain: &'a Chain,
        corridor: &Corridor,
        shift: impl Fn(f64) -> f64,
        reading: StationReading,
    ) -> Result<Self, RoadError> {
        let (ahead, behind) = chain.reach_m();
        let road = Road::new(
            corridor,
            ahead + SPARE * corridor.spacing_m,
            FARTHEST * behind + SPARE * corridor.spacing_m,
            reading,
        )?;
        let (lead, last) = (road.lead as f64, road.count as f64 - 1.0);
        let motion = Motion::new(chain, &road, |s| shift((s - lead).clamp(0.0, last)));
        let shifts = (0..road.count).map(|k| shift(k as f64)).collect();
        Ok(Self { chain, road, motion, shifts })
    }

    /// Shift of the steer axle's path `s` stations from the corridor's first, metres.
    pub(crate) fn planned(&self, s: f64) -> f64 {
        let last = self.shifts.len() - 1;
        let s = s.clamp(0.0, last as f64);
        let k = (s as usize).min(last.saturating_sub(1));
        self.shifts[k] + (self.shifts[(k + 1).min(last)] - self.shifts[k]) * (s - k as f64)
    }

    /// Nominal leeway of a body point as it passes the normal `s` metres along the corridor, with exact steering.
    pub fn nominal_at(&self, s: f64, unit: usize, side: usize, a: f64) -> Option<f64> {
        let swept = self.swept(self.chain.tolerance_m)?;
        swept.nominal_at(s / self.road.spacing + self.road.lead as f64, unit, side, a)
    }

    /// Nominal place of an axle (from the corridor's first station) when the steer axle is at station `k`.
    pub fn axle_at(&self, k: usize, unit: usize) -> Option<[f64; 2]> {
        Some(self.motion.as_ref()?.pose((self.road.lead + k) * STEPS, unit).p)
    }

    /// Bound of an axle's deviation when the steer axle is at station `k`. It is the filter's bound if that is at most
    /// `enough`, otherwise the adjoint's.
    pub fn tube_at(&self, swept: &mut SweptVehicle<'_>, k: usize, unit: usize, enough: f64) -> Option<f64> {
        let step = (self.road.lead + k) * STEPS;
        swept.axle_bound(step.checked_sub(1)?, unit, enough)
    }

    /// The vehicle swept at a tolerance, metres.
    pub fn swept(&self, tolerance_m: f64) -> Option<SweptVehicle<'_>> {
        Some(SweptVehicle::new(self.chain, &self.road, self.motion.as_ref()?, tolerance_m))
    }

    /// As [`Self::swept`], by the filter alone.
    pub fn filtered(&self, tolerance_m: f64) -> Option<SweptVehicle<'_>> {
        Some(SweptVehicle::filtered(self.chain, &self.road, self.motion.as_ref()?, tolerance_m))
    }

    /// The foot of a point near `guess` (stations of the road), its place, and the point's lateral place.
    pub(crate) fn foot(&self, x: [f64; 2], guess: f64) -> Option<Foot> {
        foot(&self.road, x, guess)
    }

    /// Stretches between the stations of a span. For a single station, the stretches that meet there.
    pub(crate) fn stretches(&self, stations: &Range<usize>) -> Range<usize> {
        let last = self.road.count - 1;
        let (from, to) = (stations.start.min(last), stations.end.saturating_sub(1).min(last));
        if to > from { from..to } else { from.saturating_sub(1)..(from + 1).min(last) }
    }
}
