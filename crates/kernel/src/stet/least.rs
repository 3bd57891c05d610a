//! The least leeway of one span in areas. Most time goes into distances there, so they are measured only where they may decide.
//!
//! A vehicle that would not fit if it kept to its path exactly is swept once more, at γ = 1 and at γ_min side by side. The others are swept
//! with the adjoint at once: where areas count, bends are tight.

use std::ops::Range;

use super::block::{BLOCK, Minima};
use super::group::Group;
use super::lanes::V;
use super::sweep::{Hopeless, Refining, Wanted, sweep};
use super::{Swept, spans};

/// Steps with less leeway than this are all measured, metres: SHRINK asks for those that fail at γ = 1, and for the next ones.
const KEEP_M: f64 = 0.5;
/// A certificate's motion turns along curves, and the nominal one along their chords. The leeway is hardly ever greater than nominal
/// by more than this, metres.
const SWERVE_M: f64 = 0.05;

impl Swept<'_> {
    /// The sweeps along the plans, as [`Self::measure`]. With a single vehicle they end early if even its nominal leeway is less than
    /// `above_m`. Whether they did not.
    pub(super) fn measure_least(&mut self, span: &Range<usize>, shift: &[V], above_m: f64) -> bool {
        let plain = Wanted { only: Some(span), ..Wanted::PLAIN };
        let nominal = sweep::<false>(&self.track, &self.group, shift, &plain, self.stop);
        let stations = || spans::stations(&self.track, span);
        if nominal.iter().all(|m| m.least_on(stations()) < above_m) {
            return false;
        }
        let mut fits: Vec<bool> = nominal.iter().map(|m| m.room_on(stations())).collect();
        self.full = vec![Minima::default(); fits.len()];
        let mut least = self.full.clone();
        for (lane, fits) in fits.iter_mut().enumerate().filter(|(_, fits)| !**fits) {
            let (full, tight) = self.hopeless(lane, span, shift, nominal[lane].floor + SWERVE_M);
            // The nominal motion is not quite that of a certificate.
            *fits = !spans::least(&self.track, self.group.models[lane], span, &tight).fails();
            (self.full[lane], least[lane], self.bare[lane]) = (full, tight, !*fits);
        }
        self.nominal = Some(nominal);
        self.least = Some(least);
        self.with_adjoint(&fits, span, shift, KEEP_M);
        // Where a hinge alone fails, SHRINK may find more room than that everywhere.
        let hinged = |lane: usize| fits[lane] && self.at_full(lane, span).too_far_only();
        let hinged: Vec<bool> = (0..fits.len()).map(hinged).collect();
        self.with_adjoint(&hinged, span, shift, f64::INFINITY);
        true
    }

    /// Sweeps some vehicles with the adjoint at γ = 1, and those that fail at γ_min. Steps in areas with less leeway than `keep_m` are noted.
    fn with_adjoint(&mut self, lanes: &[bool], span: &Range<usize>, shift: &[V], keep_m: f64) {
        let touching: Vec<Range<usize>> = (0..lanes.len()).map(|lane| self.touching(lane, span)).collect();
        let wanted = Wanted { refining: Refining::WhereLoose, only: Some(span), keep: keep_m, ..Wanted::ALL };
        let swept = |group: &Group<'_>, lanes: &[bool]| {
            let blocks = |lane: usize, head: usize| lanes[lane] && touching[lane].contains(&(head / BLOCK));
            let some = lanes.contains(&true);
            let all = some
                .then(|| sweep::<true>(&self.track, group, shift, &Wanted { blocks: &blocks, ..wanted }, self.stop));
            all.unwrap_or_default()
        };
        let full = swept(&self.group, lanes);
        choose(&mut self.full, full, lanes);
        let failing = |lane: usize| lanes[lane] && self.at_full(lane, span).fails();
        let failing: Vec<bool> = (0..lanes.len()).map(failing).collect();
        let tight = swept(&Group::new(&self.group.models, 0.0), &failing);
        choose(self.least.get_or_insert_default(), tight, &failing);
    }

    /// The leeway at γ = 1 without areas, and at γ_min with them, of a vehicle whose leeway is believed to be below `below_m` there.
    fn hopeless(&self, lane: usize, span: &Range<usize>, shift: &[V], below_m: f64) -> (Minima, Minima) {
        let model = self.group.models[lane];
        let pair = Group::mixed(&[model; 2], vec![1.0, 0.0]);
        let own: Vec<V> = shift.iter().map(|shift| V::splat(shift.0[lane])).collect();
        let touching = self.touching(lane, span);
        let blocks = |tight: usize, head: usize| tight == 0 || touching.contains(&(head / BLOCK));
        let hopeless = Some(Hopeless { below_m });
        let wanted = Wanted { blocks: &blocks, only: Some(span), hopeless, ..Wanted::ALL };
        let mut swept = sweep::<true>(&self.track, &pair, &own, &wanted, self.stop).into_iter();
        (swept.next().unwrap_or_default(), swept.next().unwrap_or_default())
    }
}

/// Replaces some vehicles' minima.
fn choose(into: &mut [Minima], from: Vec<Minima>, lanes: &[bool]) {
    let pairs = into.iter_mut().zip(from).zip(lanes);
    pairs.filter(|(_, wanted)| **wanted).for_each(|((into, from), _)| *into = from);
}
