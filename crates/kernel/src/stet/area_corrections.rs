//! Corrections taken back over areas where they make a vehicle fold.

use std::ops::Range;

use netcert_base::corrections::Options;
use netcert_base::corridor::Corridor;
use netcert_base::stop::Stop;

use super::marks::Marks;
use super::model::Model;
use super::results::{Planned, SpanResult};
use super::sweeps::Sweeps;

/// How often a vehicle is certified with corrections taken back over some areas only.
const HOLDS: usize = 4;

/// The sweeps along one plan for the whole corridor, with corrections taken back where that helps.
pub(super) fn swept_as_one<'m>(
    corridor: &Corridor,
    model: &'m Model,
    spans: &'m [Range<usize>],
    marks: Marks,
    options: &Options,
    stop: &'m Stop,
) -> (Sweeps<'m>, Vec<SpanResult>) {
    let sweeps = Sweeps::held(corridor, model, spans, marks, options, &[], stop);
    let results = sweeps.results();
    held(corridor, model, spans, marks, options, &results, stop).unwrap_or((sweeps, results))
}

/// The results along the plan that was swept on this corridor, or along one with corrections taken back.
pub(super) fn finished(sweeps: Sweeps<'_>, corridor: &Corridor, options: &Options) -> Planned {
    let results = sweeps.results();
    match held(corridor, sweeps.model, sweeps.spans, Marks::Ends, options, &results, sweeps.stop) {
        Some((held, spans)) => Planned { plan: held.plan, spans },
        None => Planned { plan: sweeps.plan, spans: results },
    }
}

/// How many spans are safe.
pub(super) fn safe(results: &[SpanResult]) -> usize {
    results.iter().filter(|result| result.safe()).count()
}

/// Certifies a vehicle again without corrections where areas count, if the corrected plan steers or folds too far. A path over a junction
/// is planned with the steering in mind; corrections are not. If corrections are needed over another area, they are taken back only over
/// areas where the vehicle folds. `None` if that is no remedy.
fn held<'m>(
    corridor: &Corridor,
    model: &'m Model,
    spans: &'m [Range<usize>],
    marks: Marks,
    options: &Options,
    results: &[SpanResult],
    stop: &'m Stop,
) -> Option<(Sweeps<'m>, Vec<SpanResult>)> {
    if corridor.areas.is_empty() || !options.correct() || !results.iter().any(SpanResult::folds) {
        return None;
    }
    let without = |held: &[Range<usize>]| {
        let sweeps = Sweeps::held(corridor, model, spans, marks, options, held, stop);
        let results = sweeps.results();
        (sweeps, results)
    };
    let all: Vec<Range<usize>> = corridor.areas.iter().map(|area| area.heads.clone()).collect();
    let mut best = Some(without(&all)).filter(|(_, held)| safe(held) > safe(results));
    let mut most = best.as_ref().map_or(safe(results), |(_, held)| safe(held));
    let mut held: Vec<Range<usize>> = Vec::new();
    for _ in 0..HOLDS {
        if most == spans.len() || all.len() < 2 || held.len() == all.len() || stop.told() {
            break;
        }
        let (sweeps, results) = without(&held);
        let folding: Vec<_> = all.iter().filter(|area| sweeps.result(area).folds()).cloned().collect();
        if safe(&results) > most {
            most = safe(&results);
            best = Some((sweeps, results));
        }
        let known = held.len();
        held.extend(folding.into_iter().filter(|area| !held.contains(area)).collect::<Vec<_>>());
        if held.len() == known {
            break;
        }
    }
    best
}
