//! The least leeway of one span in areas. Most time goes into distances there, so they are measured only where they may decide.
//!
//! A vehicle that would not fit if it kept to its path exactly is swept once more, at γ = 1 and at γ_min side by side. The others are swept
//! with the adjoint at once: where areas count, bends are tight.

use std::ops::Range;

use super::block::Minima;
use super::ride::{Refining, SweepScope};
use super::spans;
use super::sweep::sweep_hopeless;
use super::sweeps::Sweeps;

/// Steps with less leeway than this are all measured, metres, at γ = 1 and at γ_min: SHRINK asks for those that fail at γ = 1, and for
/// the next ones. At γ_min these have more leeway.
const KEEP_M: [f64; 2] = [0.2, 0.5];
/// A certificate's motion turns along curves, and the nominal one along their chords. The leeway is hardly ever greater than nominal
/// by more than this, metres.
const SWERVE_M: f64 = 0.05;

impl Sweeps<'_> {
    /// The sweeps along the plan, for the least leeway of one span. They end early if even the nominal leeway is less than `above_m`.
    /// Whether they did not. The least leeway of a vehicle that does not fit is believed to be below `believed_m`.
    pub(super) fn measure_least(&mut self, span: &Range<usize>, above_m: f64, believed_m: f64) -> bool {
        let nominal = self.sweep_once::<false>(1.0, SweepScope { only: Some(span), ..SweepScope::PLAIN });
        let stations = || spans::stations(&self.track, span);
        if nominal.least_on(stations()) < above_m {
            return false;
        }
        let mut fits = nominal.room_on(stations());
        let mut least = Minima::default();
        if !fits {
            let [full, tight] = self.hopeless(span, believed_m.min(nominal.floor + SWERVE_M));
            // The nominal motion is not quite that of a certificate. A sweep that ended early knows no leeway.
            let ended = tight.floor == f64::NEG_INFINITY;
            fits = !ended && !spans::least(&self.track, self.model, span, &tight).fails();
            (self.full, least, self.bare) = (full, tight, !fits);
        }
        self.nominal = Some(nominal);
        self.least = Some(least);
        if fits {
            self.add_adjoint(span, KEEP_M);
            // Where a hinge alone fails, SHRINK may find more room than that everywhere.
            if self.at_full(span).too_far_only() {
                self.add_adjoint(span, [f64::INFINITY; 2]);
            }
        }
        true
    }

    /// Sweeps with the adjoint at γ = 1, and at γ_min if that fails. Steps in areas with less leeway than `keep_m` are noted.
    fn add_adjoint(&mut self, span: &Range<usize>, keep_m: [f64; 2]) {
        let blocks = self.blocks(|_| true);
        let scopes = keep_m.map(|keep| SweepScope {
            blocks: Some(&blocks),
            refining: Refining::WhereLoose,
            only: Some(span),
            keep,
            ..SweepScope::ALL
        });
        self.full = self.sweep_once::<true>(1.0, scopes[0]);
        if self.at_full(span).fails() {
            self.least = Some(self.sweep_once::<true>(0.0, scopes[1]));
        }
    }

    /// The leeway at γ = 1 without areas, and at γ_min with them, of a vehicle whose leeway is believed to be below `below_m` there.
    fn hopeless(&self, span: &Range<usize>, below_m: f64) -> [Minima; 2] {
        let blocks = self.blocks(|_| true);
        let scope = SweepScope { only: Some(span), ..SweepScope::ALL };
        let full = self.ride(1.0, scope);
        let least = self.ride(0.0, SweepScope { blocks: Some(&blocks), ..scope });
        sweep_hopeless(&full, &least, below_m, self.stop)
    }
}
