//! Many vehicles on many corridors at once, each with its own plan.

use std::ops::Range;
use std::rc::Rc;

use netcert_base::corrections::Options;
use netcert_base::corridor::Corridor;
use netcert_base::stop::Stop;

use super::area_corrections::finished;
use super::areas::Grounds;
use super::marks::{Marks, marked};
use super::model::Model;
use super::plan::{self, Unplanned};
use super::reach::VehicleReach;
use super::results::Planned;
use super::shift::Plan;
use super::sweeps::{self, Sweeps};
use super::track::Track;

/// A vehicle on a corridor, with the spans of stations that are asked for.
#[derive(Clone, Copy)]
pub struct Case<'c> {
    /// The corridor.
    pub corridor: &'c Corridor,
    /// Spans of its stations for which results are asked.
    pub spans: &'c [Range<usize>],
    /// Spans that the plan serves. The plan does not depend on which of them are asked for.
    pub planned: &'c [Range<usize>],
    /// The vehicle.
    pub model: &'c Model,
}

/// Certifies each case as [`super::certify_spans`] does, and faster: eight vehicles share a sweep, whichever corridors they are on. No case
/// matters to another one. The result of an empty corridor has no spans.
#[must_use]
pub fn certify_cases(cases: &[Case<'_>], options: &Options) -> Vec<Planned> {
    let never = Stop::default();
    let known: Vec<&Case<'_>> = cases.iter().filter(|case| !case.corridor.is_empty()).collect();
    let mut tracks: Vec<Rc<Track>> = Vec::with_capacity(known.len());
    for (i, case) in known.iter().enumerate() {
        // Cases of one corridor follow each other.
        let same = |other: &Case<'_>| std::ptr::eq(other.corridor, case.corridor);
        let alike = |other: &Case<'_>| {
            std::ptr::eq(other.spans, case.spans) && VehicleReach::of(other.model) == VehicleReach::of(case.model)
        };
        let mut before = known[..i].iter().zip(&tracks).rev().take_while(|(other, _)| same(other));
        let shared = before.find(|(other, _)| alike(other)).map(|(_, track)| Rc::clone(track));
        let made = || marked(case.corridor, case.model, case.spans, Marks::Ends, &Grounds::default());
        tracks.push(shared.unwrap_or_else(made));
    }
    let unplanned: Vec<Unplanned<'_>> = known
        .iter()
        .zip(&tracks)
        .map(|(case, track)| Unplanned { track, model: case.model, spans: case.planned, held: &[] })
        .collect();
    let plans = plan::best(&unplanned, options, &never);
    let mut sweeps: Vec<Sweeps<'_>> = known
        .iter()
        .zip(&tracks)
        .zip(plans)
        .map(|((case, track), plan)| Sweeps::ready(Rc::clone(track), case.model, plan, case.spans, &never))
        .collect();
    sweeps::measure(&mut sweeps, Marks::Ends, &never);
    let mut sweeps = sweeps.into_iter();
    let planned = |case: &Case<'_>| {
        let sweeps = if case.corridor.is_empty() { None } else { sweeps.next() };
        let nothing = || Planned { plan: Plan::centred(0), spans: Vec::new() };
        sweeps.map_or_else(nothing, |sweeps| finished(sweeps, case.corridor, options))
    };
    cases.iter().map(planned).collect()
}
