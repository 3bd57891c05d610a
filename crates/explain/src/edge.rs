//! Explains an edge of a network. The corridor and the certificate of its stroke are computed again as `pipeline` computes
//! them, and can be compared with the stored certificate.

use super::hints::{self, Hints};
use super::legal::RuleConflict;
use super::no_bound;
use super::ride::NominalRide;
use super::signs;
use super::tightest::{HingePlace, LimitingPlace};
use super::{Explanation, Geometry, LaneGroup, RoadFacts};
use crate::certify::verdict;
use crate::corridor::{Corridor, StrokeCorridor, stroke_corridor};
use crate::network::{Edge, EdgeNo, Network, Road, Stroke, destination_tag};
use crate::osm::facts::{CrossSection, Oneway, Policy, RuleSet, Rules, WidthSource};
use crate::rows::{CertificateRow, EdgeKey, RoadName};
use crate::settings::Settings;
use crate::stet::{Certificate, Model, Options, SpanResult, certify_planned, certify_spans};
use crate::stop::{Stop, Stopped};
use crate::vehicle::Vehicle;
use crate::verdict::{UnknownReason, Verdict};
use netcert_base::words::verdict_words;

/// Explains why an edge of the network is safe or unsafe for the vehicle of `model`. `None` if there is no such edge.
///
/// # Errors
/// `stop` was told. It is checked before each certificate, and every few metres of the edge's own certificate.
pub fn explain_edge(
    network: &Network,
    edge: EdgeNo,
    model: &Model,
    settings: &Settings,
    stop: &Stop,
) -> Result<Option<Explanation>, Stopped> {
    stop.check()?;
    let Some((key, facts)) = EdgeKey::of(network, edge).zip(network.edges.get(edge.index())) else { return Ok(None) };
    let conflict = RuleConflict::of(network, facts, &model.vehicle);
    let road = road_facts(network, key, facts, settings.policy, &model.vehicle);
    let case = Case::of(network, edge, settings);
    stop.check()?;
    let (geometry, unknown) = match &case {
        Ok(case) => (case.geometry(model, &settings.stet, stop)?, case.unknown()),
        Err(reason) => (None, Some(*reason)),
    };
    let verdict = verdict(network, facts, model, unknown, geometry.as_ref().map(|g| &g.result));
    let geometry = geometry.filter(|_| unknown.is_none());
    let mut hints = Hints::default();
    if let (Ok(case), Some(geometry), Verdict::Unsafe(_)) = (&case, &geometry, verdict) {
        hints = hints::of(&|corridor, model| case.result(corridor, model, &settings.stet, stop), geometry, model);
        hints.other_strips = other_strips(network, edge, model, geometry.result.rsc_m, settings, stop);
        if !geometry.result.closes() {
            let safe =
                |model: &Model| case.result(&case.made.corridor, model, &settings.stet, stop).is_some_and(|r| r.safe());
            hints.shorter = no_bound::shorter(&model.vehicle, &safe, stop)?;
        }
    }
    stop.check()?;
    let (road, vehicle) = (Some(road), model.vehicle.clone());
    let signs = if let Verdict::Unsafe(_) = verdict { signs::of(network, &[edge], &vehicle) } else { Vec::new() };
    Ok(Some(Explanation { road, turn: None, vehicle, verdict, geometry, hints, conflict, signs }))
}

impl Explanation {
    /// The difference between the stored certificate of a database and this explanation, in words. `None` if they agree, up
    /// to the rounding of stored values.
    #[must_use]
    pub fn disagreement(&self, stored: &CertificateRow) -> Option<String> {
        let words = |verdict| {
            let (verdict, reason) = verdict_words(verdict);
            if reason.is_empty() { verdict.to_owned() } else { format!("{verdict} ({reason})") }
        };
        if stored.verdict != self.verdict {
            return Some(format!("it says {}, computed now {}", words(stored.verdict), words(self.verdict)));
        }
        let (Some(geometry), Some(rsc_m)) = (&self.geometry, stored.rsc_m) else { return None };
        let result = &geometry.result;
        // Stored values are rounded down by less than one step.
        let below = |kept: f64, computed: f64, step: f64| (-1e-9..step + 1e-9).contains(&(computed - kept));
        let Some((now_m, margin_rad)) = result.rsc_m.zip(result.hinge_margin_rad) else {
            return Some(format!("its RSC is {rsc_m:.3} m, computed now none: no bound holds"));
        };
        if !below(rsc_m, now_m, 1e-3) {
            return Some(format!("its RSC is {rsc_m:.3} m, computed now {now_m:.4} m"));
        }
        let margin_deg = margin_rad.to_degrees();
        if let Some(kept) = stored.hinge_margin_deg.filter(|&kept| !below(kept, margin_deg, 1e-2)) {
            return Some(format!("its hinge margin is {kept:.2}°, computed now {margin_deg:.3}°"));
        }
        let shrink = stored.shrink.filter(|kept| (kept - result.shrink).abs() > 1e-9)?;
        Some(format!("its shrink is {shrink}, computed now {}", result.shrink))
    }
}

/// An edge in the corridor of its stroke.
struct Case {
    made: StrokeCorridor,
    /// Index of the edge's span.
    which: usize,
}

impl Case {
    fn of(network: &Network, edge: EdgeNo, settings: &Settings) -> Result<Self, UnknownReason> {
        let stroke = stroke_of(network, edge).ok_or(UnknownReason::Geometry)?;
        let made = stroke_corridor(network, stroke, settings.policy, &settings.corridor)?;
        let which = made.spans.iter().position(|span| span.edge == edge).ok_or(UnknownReason::Geometry)?;
        Ok(Self { made, which })
    }

    fn unknown(&self) -> Option<UnknownReason> {
        self.made.spans.get(self.which)?.unknown
    }

    fn spans(&self) -> Vec<std::ops::Range<usize>> {
        self.made.spans.iter().map(|span| span.stations.clone()).collect()
    }

    /// The edge's geometry. As in the pipeline, the plan is made for all edges of the stroke together.
    fn geometry(&self, model: &Model, options: &Options, stop: &Stop) -> Result<Option<Geometry>, Stopped> {
        let geometry = geometry(&self.made.corridor, &self.spans(), self.which, model, options, stop)?;
        let placed = |geometry| Geometry { frame: Some(self.made.frame), tapers: self.made.tapers.clone(), ..geometry };
        Ok(geometry.map(placed))
    }

    /// The edge's result in another corridor with the same stations. `None` after `stop` was told.
    fn result(&self, corridor: &Corridor, model: &Model, options: &Options, stop: &Stop) -> Option<SpanResult> {
        stop.check().ok()?;
        let rows = certify_spans(corridor, &[model], &self.spans(), options);
        rows.into_iter().next()?.spans.into_iter().nth(self.which)
    }
}

/// The verdict of an edge, as `explain_edge` finds it.
pub(super) fn edge_verdict(
    network: &Network,
    edge: EdgeNo,
    model: &Model,
    settings: &Settings,
    stop: &Stop,
) -> Result<Option<Verdict>, Stopped> {
    stop.check()?;
    let Some(facts) = network.edges.get(edge.index()) else { return Ok(None) };
    let (result, unknown) = match Case::of(network, edge, settings) {
        Ok(case) => (case.result(&case.made.corridor, model, &settings.stet, stop), case.unknown()),
        Err(reason) => (None, Some(reason)),
    };
    stop.check()?;
    Ok(Some(verdict(network, facts, model, unknown, result.as_ref())))
}

/// The geometry of one span of a corridor, from the certificate of the whole corridor.
pub(super) fn geometry(
    corridor: &Corridor,
    spans: &[std::ops::Range<usize>],
    which: usize,
    model: &Model,
    options: &Options,
    stop: &Stop,
) -> Result<Option<Geometry>, Stopped> {
    let certified = certify_planned(corridor, model, spans, options, stop)?;
    Ok(certified.and_then(|(certificate, results)| seen_from(corridor, spans, which, model, certificate, results)))
}

fn seen_from(
    corridor: &Corridor,
    spans: &[std::ops::Range<usize>],
    which: usize,
    model: &Model,
    mut certificate: Certificate,
    results: Vec<SpanResult>,
) -> Option<Geometry> {
    let (span, result) = (spans.get(which)?.clone(), results.into_iter().nth(which)?);
    certificate.result = result.clone();
    let ride = NominalRide::new(corridor, &certificate.plan, &model.vehicle);
    let place = LimitingPlace::of(corridor, &ride, &model.vehicle, &result)?;
    let hinge = HingePlace::of(corridor, &ride, &model.vehicle, &span, &result)?;
    let (frame, corridor, tapers) = (None, corridor.clone(), Vec::new());
    Some(Geometry { frame, corridor, span, result, certificate, ride, place, hinge, tapers })
}

fn stroke_of(network: &Network, edge: EdgeNo) -> Option<&Stroke> {
    network.strokes.iter().find(|stroke| {
        let edges = network.stroke_edges.get(stroke.edges.start as usize..stroke.edges.end as usize);
        edges.is_some_and(|edges| edges.contains(&edge))
    })
}

/// The edge's results with each of the wider strips. A strip that changes nothing, as on a road of a single lane, is left
/// out.
fn other_strips(
    network: &Network,
    edge: EdgeNo,
    model: &Model,
    rsc_m: Option<f64>,
    settings: &Settings,
    stop: &Stop,
) -> Vec<hints::OtherStrip> {
    let wider = match settings.policy {
        Policy::Lane => [Policy::Direction, Policy::Carriageway].as_slice(),
        Policy::Direction => &[Policy::Carriageway],
        Policy::Carriageway => &[],
    };
    let strip = |&policy: &Policy| {
        let case = Case::of(network, edge, &Settings { policy, ..settings.clone() }).ok()?;
        if case.unknown().is_some() {
            return None;
        }
        let result = case.result(&case.made.corridor, model, &settings.stet, stop)?;
        let corridor = &case.made.corridor;
        let stations = case.made.spans.get(case.which)?.stations.clone();
        let width_m = stations.map(|k| corridor.left_m[k] + corridor.right_m[k]).fold(f64::INFINITY, f64::min);
        Some(hints::OtherStrip { policy, width_m, safe: result.safe(), rsc_m: result.rsc_m })
    };
    let mut strips: Vec<hints::OtherStrip> = wider.iter().filter_map(strip).collect();
    let same = |a: Option<f64>, b: Option<f64>| a == b || a.zip(b).is_some_and(|(a, b)| (a - b).abs() <= 5e-4);
    strips.retain(|other| !same(other.rsc_m, rsc_m));
    strips.dedup_by(|b, a| same(a.rsc_m, b.rsc_m));
    strips
}

/// The tags behind a width of that source.
fn width_tags(road: &Road, source: Option<WidthSource>) -> Vec<String> {
    let behind = |line: &&str| {
        let lanes = line.starts_with("lanes");
        match source {
            Some(WidthSource::Tagged | WidthSource::Estimated | WidthSource::Assumed) => !lanes,
            Some(WidthSource::FromLanes) => true,
            Some(WidthSource::Surveyed) | None => false,
        }
    };
    road.width_tags.iter().flat_map(|lines| lines.lines()).filter(behind).map(str::to_owned).collect()
}

/// The group that says how many lanes a road has, if it is not its class alone.
fn lane_group(road: &Road, section: &CrossSection) -> Option<LaneGroup> {
    let lanes = section.supposed_lanes()?;
    let rules = Rules::builtin().ok()?;
    let of_class = lanes <= rules.class_lanes(road.class);
    if of_class || road.oneway == Oneway::No || road.link || road.roundabout {
        return None;
    }
    let country = std::str::from_utf8(&road.country).ok()?.to_owned();
    let rests_on = rules.one_way_lanes(road.class, road.country).filter(|group| group.lanes == lanes);
    Some(LaneGroup { country, class: road.class, lanes, rests_on })
}

/// The tags of narrow places on an edge. A tag of the whole road is none, unless there is no other.
fn narrow_places(road: &Road, edge: &Edge) -> Vec<String> {
    let of_road = road.legal[edge.direction as usize].passage_tags();
    let (of_road, of_places): (Vec<_>, Vec<_>) =
        edge.legal.passage_tags().into_iter().partition(|tag| of_road.contains(tag));
    if of_places.is_empty() { of_road } else { of_places }
}

fn road_facts(network: &Network, key: EdgeKey, edge: &Edge, policy: Policy, vehicle: &Vehicle) -> RoadFacts {
    let road = network.road(edge);
    let section = network.section(edge);
    let width_source = section.strip(policy).map(|strip| strip.source);
    RoadFacts {
        edge: key,
        road: RoadName::of(network, road).into_owned(),
        title: network.title(edge),
        policy,
        width_source,
        supposed_lanes: lane_group(road, &section).filter(|_| width_source == Some(WidthSource::Assumed)),
        width_tags: width_tags(road, width_source),
        narrowed_by: if edge.narrowings.is_empty() { Vec::new() } else { narrow_places(road, edge) },
        unreadable_widths: edge.legal.rules.iter().flat_map(RuleSet::unreadable_widths).map(str::to_owned).collect(),
        lane_shared: policy == Policy::Lane && road.oneway == Oneway::No && section.shares_lane(),
        destination_tag: destination_tag(network, edge, vehicle),
        line: network.positions(edge).collect(),
    }
}
