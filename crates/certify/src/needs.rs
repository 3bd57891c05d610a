//! What would be enough where a certificate lacks room: the least width of an edge, the least kerb radius of a turn.
//!
//! An estimate costs nothing: the width less twice the RSC. A value that was searched for is certified: with it, the edge or turn is safe. The
//! search goes in steps, because nobody measures a road to the millimetre, and it ends with a value that does. A value one step lower need not fail.

use std::ops::Range;
use std::sync::Arc;

use rustc_hash::FxHashMap;

use super::job::Job;
use super::least::least_of;
use super::paths::fits;
use crate::corridor::{Corridor, StrokeCorridor, StrokeLayout, stroke_corridor};
use crate::network::{EdgeNo, Network, Stroke};
use crate::osm::facts::Policy;
use crate::rows::TurnNeed;
use crate::settings::Settings;
use crate::stet::{Case, Model, SpanResult, certify_cases, certify_spans};
use crate::verdict::UnknownReason;
use netcert_roads::turns::{LengthClass, StrokeLine, TurnFacts, TurnParams, turn_on};

/// Widths are tried in these parts of a metre.
const WIDTHS: f64 = 20.0;
/// The greatest additional width that is tried, metres.
pub const MOST_MORE_M: f64 = 8.0;
/// A width that leaves less than this is close enough to the least one, metres.
const CLOSE_M: f64 = 0.05;
/// Widths that differ by fewer steps are tried as one: half of the difference is leeway, and it is close enough.
const SHARED: i64 = (2.0 * CLOSE_M * WIDTHS) as i64;
/// How many widths are tried for one edge and vehicle.
const ROUNDS: usize = 12;
/// The kerb radii that are tried, metres.
pub const KERBS_M: [f64; 14] = [2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 12.0, 14.0, 16.0, 20.0, MOST_KERB_M];
/// The greatest one.
pub const MOST_KERB_M: f64 = 25.0;
/// Widths of both arms at a junction are tried in these parts of a metre, and how many of them.
const FLARES: f64 = 2.0;
const MORE_FLARES: u8 = 10;

/// Widths to try for the roads beside a turn of which the narrower one is so wide, metres.
#[must_use]
pub fn flares(has_m: f64) -> Vec<f64> {
    let next = (has_m * FLARES).floor() + 1.0;
    (0..MORE_FLARES).map(|k| (next + f64::from(k)) / FLARES).collect()
}

/// An edge of a stroke that is too narrow.
pub(super) struct Narrow<'r> {
    /// The edge.
    pub(super) edge: EdgeNo,
    /// Its result with the widths of the map.
    pub(super) result: &'r SpanResult,
    /// The width at its limiting place, metres.
    pub(super) width_m: f64,
}

impl<'r> Narrow<'r> {
    pub(super) fn of(made: &StrokeCorridor, edge: EdgeNo, result: &'r SpanResult) -> Self {
        let corridor = &made.corridor;
        let at = result.limiting.station.min(corridor.len() - 1);
        Self { edge, result, width_m: corridor.left_m[at] + corridor.right_m[at] }
    }
}

/// The steps of width that an edge's need may have, and the likely one.
struct Steps {
    /// A width that failed.
    fails: i64,
    /// The width less twice the RSC: half of what more width gives comes to the tight side. `None` if it is more than `most`.
    likely: Option<i64>,
    most: i64,
}

impl Steps {
    /// The steps of an edge whose strip is `least_m` wide. `None` if the edge has no RSC.
    fn of(narrow: &Narrow<'_>, least_m: f64) -> Option<Self> {
        let rsc_m = narrow.result.rsc_m?;
        let fails = (least_m * WIDTHS).floor() as i64;
        let most = fails + (MOST_MORE_M * WIDTHS) as i64;
        let likely = ((narrow.width_m - 2.0 * rsc_m) * WIDTHS).ceil() as i64;
        Some(Self { fails, likely: (likely <= most).then(|| likely.max(fails + 1)), most })
    }
}

/// The search for one edge's need, in steps of width.
struct Search {
    edge: EdgeNo,
    /// A width that failed, and the RSC with it.
    fails: (i64, f64),
    does: Option<i64>,
    next: Option<i64>,
    most: i64,
}

impl Search {
    fn begin(narrow: &Narrow<'_>, least_m: f64) -> Option<Self> {
        let Steps { fails, likely, most } = Steps::of(narrow, least_m)?;
        let next = Some(likely.unwrap_or(most));
        Some(Self { edge: narrow.edge, fails: (fails, narrow.result.rsc_m?), does: None, next, most })
    }

    /// Takes the result with a width, and decides what to try next.
    fn take(&mut self, steps: i64, result: Option<&SpanResult>) {
        let rsc_m = result.and_then(|result| result.rsc_m).unwrap_or(f64::NEG_INFINITY);
        if result.is_some_and(SpanResult::safe) {
            if self.does.is_none_or(|known| steps < known) {
                self.does = Some(steps);
                let less = ((2.0 * rsc_m * WIDTHS).floor() as i64).max(1);
                let next = (steps - less).max(self.fails.0 + 1);
                self.next = Some(next).filter(|&next| next < steps && rsc_m >= CLOSE_M);
            }
        } else if steps > self.fails.0 {
            let better = rsc_m > self.fails.1 + 1e-3;
            self.fails = (steps, rsc_m);
            let more =
                if rsc_m < 0.0 && rsc_m.is_finite() { ((-2.0 * rsc_m * WIDTHS).ceil() as i64).max(1) } else { 10 };
            self.next = match self.does {
                Some(does) => {
                    Some((steps + more).min(steps + (does - steps) / 2)).filter(|&next| next > steps && next < does)
                }
                None if steps >= self.most => None,
                // What another width does not change, such as a bollard, may be decided by the widest one at once.
                None => Some(if better { (steps + more).min(self.most) } else { self.most }),
            };
        }
    }
}

/// The edges of a stroke that are too narrow for a vehicle.
pub(super) struct Lacking<'r> {
    pub(super) stroke: &'r Stroke,
    pub(super) model: &'r Model,
    pub(super) narrow: Vec<Narrow<'r>>,
}

/// A width of a stroke that is tried for one vehicle, and the edges that ask for it or for a little less.
struct Probe {
    /// The first entry of the stroke in `Network::stroke_edges`.
    stroke: u32,
    steps: i64,
    /// Index of the stroke and vehicle.
    of: usize,
    edges: Vec<EdgeNo>,
}

impl Probe {
    /// What the searches of a stroke and vehicle ask for next. An edge that fits with [`CLOSE_M`] to spare or less is done, so
    /// edges that ask for nearly the same width share a probe.
    fn of(stroke: u32, of: usize, searches: &[Search]) -> Vec<Self> {
        let mut wanted: Vec<(i64, EdgeNo)> =
            searches.iter().filter_map(|search| Some((search.next?, search.edge))).collect();
        wanted.sort_unstable_by(|a, b| b.cmp(a));
        let mut probes: Vec<Self> = Vec::new();
        for (steps, edge) in wanted {
            match probes.last_mut() {
                Some(probe) if probe.steps - steps < SHARED => probe.edges.push(edge),
                _ => probes.push(Self { stroke, steps, of, edges: vec![edge] }),
            }
        }
        probes
    }
}

/// A stroke that is nowhere narrower than a width, for the edges of one probe: their numbers and stations.
struct Widened<'w> {
    probe: &'w Probe,
    corridor: &'w Corridor,
    edges: Vec<EdgeNo>,
    spans: Vec<Range<usize>>,
    /// Of all edges of the stroke: its plan serves them, too.
    planned: &'w [Range<usize>],
}

/// The width of an edge's strip, metres.
fn strip_m(job: &Job<'_>, edge: EdgeNo) -> Option<f64> {
    let edge = job.network.edges.get(edge.index())?;
    Some(f64::from(job.network.section(edge).strip(job.settings.policy)?.width_m()))
}

/// For each stroke and vehicle: edges with the width in metres with which each is likely to be safe, if its stroke were nowhere narrower.
/// An edge that is likely to need more than [`MOST_MORE_M`] more is left out.
pub(super) fn likely_needs(job: &Job<'_>, lacking: &[Lacking<'_>]) -> Vec<Vec<(EdgeNo, f64)>> {
    let likely = |narrow: &Narrow<'_>| {
        let steps = Steps::of(narrow, strip_m(job, narrow.edge)?)?.likely?;
        Some((narrow.edge, steps as f64 / WIDTHS))
    };
    lacking.iter().map(|lacking| lacking.narrow.iter().filter_map(likely).collect()).collect()
}

/// For each stroke and vehicle: edges with the least width in metres with which each would be safe, if its stroke were nowhere narrower.
/// An edge for which no width up to [`MOST_MORE_M`] more would do is left out. All searches take their next step together, so that
/// the kernel certifies many widened strokes side by side.
pub(super) fn edge_needs(job: &Job<'_>, lacking: &[Lacking<'_>]) -> Vec<Vec<(EdgeNo, f64)>> {
    let begin = |lacking: &Lacking<'_>| -> Vec<Search> {
        lacking.narrow.iter().filter_map(|narrow| Search::begin(narrow, strip_m(job, narrow.edge)?)).collect()
    };
    let mut searches: Vec<Vec<Search>> = lacking.iter().map(begin).collect();
    let mut laid: FxHashMap<u32, Option<StrokeLayout<'_>>> = FxHashMap::default();
    for _ in 0..ROUNDS {
        let of_stroke = |(of, lacking): (usize, &Lacking<'_>)| Probe::of(lacking.stroke.edges.start, of, &searches[of]);
        let mut probes: Vec<Probe> = lacking.iter().enumerate().flat_map(of_stroke).collect();
        if probes.is_empty() {
            break;
        }
        probes.sort_by_key(|probe| (probe.stroke, probe.steps, probe.of));
        // Probes of the same width of a stroke share its corridor.
        let alike: Vec<&[Probe]> = probes.chunk_by(|a, b| (a.stroke, a.steps) == (b.stroke, b.steps)).collect();
        let widened = |same: &&[Probe]| {
            let Probe { stroke, of, steps, .. } = same[0];
            let lay = || StrokeLayout::new(job.network, lacking[of].stroke, &job.settings.corridor).ok();
            widened(job, laid.entry(stroke).or_insert_with(lay).as_ref()?, steps as f64 / WIDTHS)
        };
        let made: Vec<Option<(StrokeCorridor, Vec<Range<usize>>)>> = alike.iter().map(widened).collect();
        let wide = alike.iter().zip(&made).filter_map(|(same, made)| Some((same, made.as_ref()?)));
        let wide: Vec<Widened<'_>> =
            wide.flat_map(|(same, made)| same.iter().map(move |probe| Widened::of(probe, made))).collect();
        let cases: Vec<Case<'_>> = wide
            .iter()
            .map(|Widened { probe, corridor, spans, planned, .. }| Case {
                corridor,
                spans,
                planned,
                model: lacking[probe.of].model,
            })
            .collect();
        let rows = certify_cases(&cases, &job.settings.stet);
        let mut results: FxHashMap<(usize, EdgeNo), &SpanResult> = FxHashMap::default();
        for (wide, row) in wide.iter().zip(&rows) {
            results.extend(wide.edges.iter().zip(&row.spans).map(|(&edge, result)| ((wide.probe.of, edge), result)));
        }
        for probe in &probes {
            let of_probe = searches[probe.of].iter_mut().filter(|search| probe.edges.contains(&search.edge));
            of_probe.for_each(|search| search.take(probe.steps, results.get(&(probe.of, search.edge)).copied()));
        }
    }
    let found = |search: Search| Some((search.edge, search.does? as f64 / WIDTHS));
    searches.into_iter().map(|searches| searches.into_iter().filter_map(found).collect()).collect()
}

impl<'w> Widened<'w> {
    /// The edges of the probe that have a corridor.
    fn of(probe: &'w Probe, (made, planned): &'w (StrokeCorridor, Vec<Range<usize>>)) -> Self {
        let asked = made.spans.iter().filter(|span| span.unknown.is_none() && probe.edges.contains(&span.edge));
        let (edges, spans) = asked.map(|span| (span.edge, span.stations.clone())).unzip();
        Self { probe, corridor: &made.corridor, edges, spans, planned }
    }
}

/// The least width in metres with which an edge that lacks room would be safe, if its stroke were nowhere narrower. `stroke` is an index
/// into [`Network::strokes`]. `None` if no width up to 8 m more would do.
#[must_use]
pub fn edge_need(network: &Network, stroke: u32, edge: EdgeNo, model: &Model, settings: &Settings) -> Option<f64> {
    let stroke = network.strokes.get(stroke as usize)?;
    let made = stroke_corridor(network, stroke, settings.policy, &settings.corridor).ok()?;
    let span = made.spans.iter().find(|span| span.edge == edge && span.unknown.is_none())?;
    let rows = certify_spans(&made.corridor, &[model], std::slice::from_ref(&span.stations), &settings.stet);
    let narrow = Narrow::of(&made, edge, rows.first()?.spans.first()?);
    let job = Job { network, models: std::slice::from_ref(model), settings };
    let lacking = Lacking { stroke, model, narrow: vec![narrow] };
    edge_needs(&job, &[lacking]).pop()?.pop().map(|(_, need_m)| need_m)
}

/// A stroke that is nowhere narrower than a width, and the stations of its edges. `None` if it has no corridor then.
fn widened(job: &Job<'_>, laid: &StrokeLayout<'_>, width_m: f64) -> Option<(StrokeCorridor, Vec<Range<usize>>)> {
    let policy = job.settings.policy;
    let sections = |edge: &_| job.network.section(edge).at_least(policy, width_m);
    let made = laid.corridor(&sections, policy).ok()?;
    let stations = made.spans.iter().map(|span| span.stations.clone()).collect();
    Some((made, stations))
}

/// The lines of strokes, by edge.
pub type LineOf<'l> = dyn Fn(EdgeNo) -> Result<&'l StrokeLine, UnknownReason> + 'l;

/// The inputs of a search for what a turn needs.
#[derive(Clone, Copy)]
pub struct TurnCase<'a> {
    /// The road network.
    pub network: &'a Network,
    /// The turn.
    pub turn: &'a TurnFacts,
    /// The vehicle.
    pub model: &'a Model,
    /// Settings of the certificates.
    pub settings: &'a Settings,
}

impl TurnCase<'_> {
    /// What would be enough for a turn that lacks room: the least of some radii of its own kerbs; if no radius up to
    /// [`MOST_KERB_M`] does, the least width of both roads at the junction. `radius_m` is the radius it has, `None` if its corner is
    /// not rounded.
    #[must_use]
    pub fn need(&self, radius_m: Option<f64>, line: &LineOf<'_>) -> TurnNeed {
        let kerb_radius_m = radius_m.and_then(|radius_m| self.kerb(radius_m, line));
        let flare_m = if kerb_radius_m.is_none() { self.flare(line) } else { None };
        TurnNeed { kerb_radius_m, flare_m }
    }

    /// The least radius of the turn's own kerbs with which the turn is safe, metres.
    fn kerb(&self, radius_m: f64, line: &LineOf<'_>) -> Option<f64> {
        let safe = |&own_kerb_m: &f64| {
            self.is_safe(&TurnParams { own_kerb_m: Some(own_kerb_m), ..self.settings.turn_params() }, line)
        };
        let radii: Vec<f64> = KERBS_M.iter().copied().filter(|&other_m| other_m > radius_m).collect();
        least_of(&radii, safe)
    }

    /// The least width of the vehicle's strip near the turn, on both roads, with which the turn is safe, metres.
    fn flare(&self, line: &LineOf<'_>) -> Option<f64> {
        let (network, params) = (self.network, self.settings.turn_params());
        let strip = params.strip.max(self.settings.policy);
        let ends = [self.turn.movement.from, self.turn.movement.to];
        let has_m = ends.iter().map(|&edge| {
            let edge = network.edges.get(edge.index())?;
            Some(f64::from(network.section(edge).strip(strip)?.width_m()))
        });
        let has_m = has_m.collect::<Option<Vec<f64>>>()?.into_iter().fold(f64::INFINITY, f64::min);
        let strokes = ends.map(|edge| line(edge).ok().map(|line| line.stroke));
        let [Some(from), Some(to)] = strokes else { return None };
        let safe = |&width_m: &f64| {
            let wide = |stroke: u32| self.widened(stroke, strip, width_m).ok().map(Arc::new);
            let (Some(a), Some(b)) = (wide(from), wide(to)) else { return false };
            let lines = |edge: EdgeNo| match line(edge)?.stroke {
                stroke if stroke == a.stroke => Ok(a.as_ref()),
                stroke if stroke == b.stroke => Ok(b.as_ref()),
                _ => line(edge),
            };
            self.is_safe(&params, &lines)
        };
        least_of(&flares(has_m), safe)
    }

    fn widened(&self, stroke: u32, strip: Policy, width_m: f64) -> Result<StrokeLine, UnknownReason> {
        let sections = |edge: &_| self.network.section(edge).at_least(strip, width_m);
        StrokeLine::on(self.network, stroke, &sections, self.settings.policy, &self.settings.corridor)
    }

    /// Whether the turn is safe on one of its paths.
    fn is_safe(&self, params: &TurnParams, line: &LineOf<'_>) -> bool {
        let Some(reach) = LengthClass::of(&self.model.vehicle) else { return false };
        let made = turn_on(self.network, self.turn.edges(), line, self.settings.policy, params, reach).ok();
        made.is_some_and(|made| fits(&made, self.model, &self.settings.stet))
    }
}
