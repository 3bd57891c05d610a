//! The corners that a vehicle takes, known before a map is asked: for two drawn straight roads that cross, the least kerb radius that certifies
//! the turn.
//!
//! Every value is certified for its drawn corner. For a corner of the map it is an estimate: roads bend, and the other roads of a junction
//! leave more room.

use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

use super::least::least_of;
use super::needs::KERBS_M;
use super::paths::best_of;
use crate::reporter::Reporter;
use crate::stop::{Stop, Stopped};
use netcert_kernel::stet::{Model, Options};
use netcert_roads::turns::{DrawnCorner, LengthClass};

/// The usual angles of a table, degrees: what the vehicle turns by.
pub const CORNER_ANGLES_DEG: [f64; 8] = [30.0, 45.0, 60.0, 75.0, 90.0, 105.0, 120.0, 135.0];
/// The widths of both roads, metres. The vehicle uses all of them.
pub const CORNER_WIDTHS_M: [f64; 10] = [2.75, 3.25, 3.75, 4.5, 5.5, 6.5, 7.5, 9.0, 11.0, 14.0];
/// A corner without a kerb return.
const SHARP_M: f64 = 0.0;

/// By width of the road that is left and width of the road that is entered: the least radius, metres, or `None` if no radius does.
type OfAngle = [[Option<f64>; CORNER_WIDTHS_M.len()]; CORNER_WIDTHS_M.len()];

/// The corners that one vehicle takes.
#[derive(Debug, Clone, PartialEq)]
pub struct Corners {
    angles_deg: Vec<f64>,
    least: Vec<OfAngle>,
}

impl Corners {
    /// Certifies the drawn corners of some angles, degrees, for a vehicle. `None` if the vehicle is too long for turns. Polls `stop` before each
    /// corner; an angle takes some seconds of processor time.
    ///
    /// # Errors
    /// `stop` was told.
    pub fn certify(
        model: &Model,
        angles_deg: &[f64],
        options: &Options,
        reporter: &dyn Reporter,
        stop: &Stop,
    ) -> Result<Option<Self>, Stopped> {
        let Some(reach) = LengthClass::of(&model.vehicle) else { return Ok(None) };
        reporter.begin("corners", angles_deg.len() as u64);
        let done = AtomicU64::new(0);
        let of_angle = |&turn_deg: &f64| {
            let found = Angle { turn_rad: turn_deg.to_radians(), model, options, reach }.certify(stop);
            reporter.advance(1 + done.fetch_add(1, Ordering::Relaxed));
            found
        };
        let least = angles_deg.par_iter().map(of_angle).collect::<Result<_, _>>();
        reporter.end();
        Ok(Some(Self { angles_deg: angles_deg.to_vec(), least: least? }))
    }

    /// The angles, degrees.
    #[must_use]
    pub fn angles_deg(&self) -> &[f64] {
        &self.angles_deg
    }

    /// The least kerb radius at a corner, metres; 0: a sharp corner does. `None` if no radius up to 25 m is certified. The numbers are places in
    /// [`Self::angles_deg`] and [`CORNER_WIDTHS_M`]: the angle, the road that is left, the road that is entered.
    #[must_use]
    pub fn least_m(&self, angle: usize, from: usize, to: usize) -> Option<f64> {
        *self.least.get(angle)?.get(from)?.get(to)?
    }
}

/// The corners of one angle.
struct Angle<'a> {
    turn_rad: f64,
    model: &'a Model,
    options: &'a Options,
    reach: LengthClass,
}

impl Angle<'_> {
    /// From wide roads to narrow ones: a narrower road never needs less.
    fn certify(&self, stop: &Stop) -> Result<OfAngle, Stopped> {
        let mut least: OfAngle = Default::default();
        let widths = || (0..CORNER_WIDTHS_M.len()).rev();
        for (from, to) in widths().flat_map(|from| widths().map(move |to| (from, to))) {
            stop.check()?;
            let wider = |from: usize, to: usize| least.get(from).and_then(|row| row.get(to)).copied();
            let wider = [wider(from + 1, to), wider(from, to + 1)].into_iter().flatten();
            // `None` if a wider road has none.
            let at_least_m = wider.map(|least| least.unwrap_or(f64::INFINITY)).fold(SHARP_M, f64::max);
            least[from][to] = self.least_m([from, to].map(|i| CORNER_WIDTHS_M[i]), at_least_m);
        }
        Ok(least)
    }

    fn least_m(&self, widths_m: [f64; 2], at_least_m: f64) -> Option<f64> {
        let radii = std::iter::once(SHARP_M).chain(KERBS_M).filter(|&radius_m| radius_m >= at_least_m);
        let radii: Vec<f64> = radii.collect();
        let (&first, others) = radii.split_first()?;
        // Most corners need what a road one step wider needs, or one step more.
        if self.safe(widths_m, first) { Some(first) } else { least_of(others, |&m| self.safe(widths_m, m)) }
    }

    fn safe(&self, widths_m: [f64; 2], kerb_radius_m: f64) -> bool {
        let corner = DrawnCorner { turn_rad: self.turn_rad, widths_m, kerb_radius_m };
        let Ok(made) = corner.corridors(self.reach) else { return false };
        best_of(&made, &[self.model], self.options).pop().flatten().is_some_and(|(_, result)| result.safe())
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::reporter::Silent;
    use netcert_base::vehicle::Catalogue;

    fn table(id: &str, angles_deg: &[f64]) -> Corners {
        let model = Model::new(Catalogue::builtin().unwrap().get(id).unwrap()).unwrap();
        let certified = Corners::certify(&model, angles_deg, &Options::default(), &Silent, &Stop::never());
        certified.unwrap().unwrap()
    }

    /// Wider roads never need more, and a right angle is not alone among its neighbours: at 90° unions draw corners twice.
    #[test]
    fn a_table_falls_with_both_widths_and_hardly_changes_with_the_angle() {
        let corners = table("US-WB40", &[88.0, 90.0]);
        let of = |angle: usize, from: usize, to: usize| corners.least_m(angle, from, to).unwrap_or(f64::INFINITY);
        let last = CORNER_WIDTHS_M.len() - 1;
        let (mut some, mut steps) = (0, Vec::new());
        for (from, to) in (0..last).flat_map(|from| (0..last).map(move |to| (from, to))) {
            assert!(of(1, from, to) >= of(1, from + 1, to).max(of(1, from, to + 1)), "{from} {to}");
            some += u32::from(of(1, from, to) > 0.0 && of(1, from, to).is_finite());
            let place = |least_m: f64| KERBS_M.iter().position(|m| *m == least_m).map_or(-1, |place| place as i32);
            if of(0, from, to).is_finite() && of(1, from, to).is_finite() {
                steps.push((place(of(0, from, to)) - place(of(1, from, to))).abs());
            }
        }
        assert!(some > 15, "{some} corners need a kerb return");
        assert!(steps.iter().all(|steps| *steps <= 2), "{steps:?}");
        assert_eq!(of(1, last, last), 0.0, "on the widest roads a sharp corner does");
    }

    #[test]
    fn a_stopped_table_is_none() {
        let model = Model::new(Catalogue::builtin().unwrap().get("US-WB40").unwrap()).unwrap();
        let stopped = Corners::certify(&model, &[90.0], &Options::default(), &Silent, &Stop::after(3));
        assert_eq!(stopped, Err(Stopped));
    }
}
