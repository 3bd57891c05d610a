//! The check of columns of leeway, with an entry per station.

use std::cmp::Ordering;

use crate::claim::{Weight, asked_alone, weight};
use crate::subject::Subject;
use crate::swept_vehicle::SweptVehicle;
use crate::targets::{Shortfall, Targets};

/// A body that lacks as much room as it is wide is wholly outside of the road, metres. Entries of columns promise nothing there.
const OUTSIDE_M: f64 = 2.5;

impl Subject<'_> {
    /// Checks two columns of leeway (left, right), with one entry per station at γ = 1. Each entry claims what a span
    /// of its station alone would: the leeway over both stretches that meet there. Columns claim nothing about steps in
    /// areas: what they show there is for drawing. Returns for each side why it is not proved, or `None`. Where room is missing, nothing is
    /// promised: a place without a bound is a remark there, and so is every place at which a body is wholly outside of the road.
    pub fn leeway_columns(&self, columns: [&[Option<f64>]; 2]) -> [Option<(String, Weight)>; 2] {
        let stretches = self.road.count - 1;
        let claimed = |column: &[Option<f64>], k: usize| {
            let both = [column[k], column[k + 1]];
            both.into_iter().flatten().map(asked_alone).fold(f64::NEG_INFINITY, f64::max)
        };
        let targets = columns.map(|column| (0..stretches).map(|k| claimed(column, k)).collect::<Vec<_>>());
        let claims_nothing = |side: &[f64]| side.iter().all(|target| *target == f64::NEG_INFINITY);
        let Some(motion) = &self.motion else {
            let wrong = |side: &Vec<f64>| {
                (!claims_nothing(side)).then(|| ("the plan cannot be driven".to_owned(), Weight::Refuted))
            };
            return [wrong(&targets[0]), wrong(&targets[1])];
        };
        let mut swept = SweptVehicle::new(self.chain, &self.road, motion, self.chain.tolerance_m);
        let shortfalls = swept.refute(&Targets(targets.clone()));
        [0, 1].map(|side| {
            let weighed = |at: &Shortfall| {
                let claimed = targets[side][(at.station.max(0.0) as usize).min(stretches - 1)];
                let promised = if at.short_m.is_infinite() { claimed >= 0.0 } else { claimed > -OUTSIDE_M };
                if promised { weight(at.short_m) } else { Weight::Remark }
            };
            let own = shortfalls.iter().filter(|shortfall| shortfall.side == side);
            let worst = own.max_by(|a, b| {
                (weighed(a), a.short_m).partial_cmp(&(weighed(b), b.short_m)).unwrap_or(Ordering::Equal)
            })?;
            Some((self.describe(worst.short_m, worst), weighed(worst)))
        })
    }
}
