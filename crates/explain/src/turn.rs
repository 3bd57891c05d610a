//! Explains a turn of the network. Its corridors are made again, and the one with the best certificate is explained.

use super::edge::{edge_verdict, geometry};
use super::hints::{self, Hints, KerbHint};
use super::legal::RuleConflict;
use super::signs;
use super::{Explanation, Geometry, TurnRoads, no_bound};
use crate::certify::{MOST_KERB_M, best_of, turn_verdict};
use crate::corridor::Corridor;
use crate::network::{Edge, EdgeNo, Network, PassageKind};
use crate::osm::facts::Policy;
use crate::settings::Settings;
use crate::stet::{Model, Options, SpanResult, certify_spans};
use crate::stop::{Stop, Stopped};
use crate::turns::{KerbSource, Kerbs, LengthClass, TurnCorridors, TurnFacts, TurnParams, TurnPath, corridors_of};
use crate::verdict::{ForbiddenReason, UnknownReason, Verdict};

/// Kerb radii are tried in these steps, metres, up to [`MOST_KERB_M`].
const KERB_STEP_M: f64 = 0.5;

/// What limits a vehicle in a turn.
#[derive(Debug, Clone)]
pub struct TurnExplanation {
    /// The facts of the turn from the map.
    pub facts: TurnFacts,
    /// The junction that it leads over, if it is a passage.
    pub passage: Option<PassageKind>,
    /// Names of the roads that the turn leads from and to.
    pub roads: [String; 2],
    /// The area of the turn, and what its paths are made from. `None` if the turn has no corridor.
    pub corridors: Option<TurnCorridors>,
    /// The best path.
    pub path: Option<TurnPath>,
    /// The policy of the certificate.
    pub policy: Policy,
    /// The strip that the vehicle may use near the turn.
    pub strip: Policy,
    /// The explanation of the certificate on the best path. Its verdict is that of the turn alone, not of its edges.
    pub explanation: Explanation,
}

/// Explains why a turn is safe or unsafe for the vehicle of `model`.
///
/// # Errors
/// `stop` was told. It is checked before the turn's corridors are made, before they are certified, and every few metres of
/// the best corridor's certificate.
pub fn explain_turn(
    network: &Network,
    facts: &TurnFacts,
    model: &Model,
    settings: &Settings,
    stop: &Stop,
) -> Result<TurnExplanation, Stopped> {
    stop.check()?;
    let roads = [facts.movement.from, facts.movement.to]
        .map(|edge| network.edges.get(edge.index()).map_or(String::new(), |edge| network.title(edge)));
    let made = match LengthClass::of(&model.vehicle) {
        Some(reach) => corridors_of(network, facts, settings.policy, &settings.turn_params(), reach),
        None => Err(UnknownReason::Geometry),
    };
    stop.check()?;
    let best = made.as_ref().ok().and_then(|made| best_of(made, &[model], &settings.stet).pop().flatten());
    let of = |edge: &EdgeNo| network.edges.get(edge.index());
    let ends = [facts.movement.from, facts.movement.to];
    let ends = ends.iter().filter_map(of).filter_map(|edge| forbids(network, edge, model));
    // Of the edges between, rules count and room does not.
    let between = facts.through.iter().filter_map(of);
    let between = between
        .filter_map(|edge| forbids(network, edge, model).or_else(|| network.legal(edge).forbids(&model.vehicle)));
    let legal: Vec<Verdict> = ends.chain(between).collect();
    let time = Verdict::Unknown(UnknownReason::Time);
    let barred = legal
        .iter()
        .find(|verdict| matches!(verdict, Verdict::Forbidden(_)))
        .or_else(|| legal.iter().find(|verdict| **verdict != time));
    let verdict = match (&made, &best) {
        _ if facts.movement.forbidden.is_some() => Verdict::Forbidden(ForbiddenReason::Restriction),
        (Err(reason), _) => barred.copied().unwrap_or(Verdict::Unknown(*reason)),
        (Ok(_), best) => match (barred, turn_verdict(best.as_ref().map(|(_, result)| result))) {
            (Some(barred), _) => *barred,
            (None, Verdict::Safe) if legal.contains(&time) => time,
            (None, verdict) => verdict,
        },
    };
    let mut hints = Hints::default();
    let mut geometry = None;
    if let Some((path, result)) = &best {
        let found = turn_geometry(path, result, model, settings, stop)?;
        if let (Some((options, geometry)), Verdict::Unsafe(_)) = (&found, verdict) {
            let again = |corridor: &Corridor, model: &Model| {
                stop.check().ok()?;
                let rows = certify_spans(corridor, &[model], std::slice::from_ref(&path.counted), options);
                rows.into_iter().next()?.spans.into_iter().next()
            };
            hints = hints::of(&again, geometry, model);
        }
        let frame = made.as_ref().ok().map(|made| made.frame);
        geometry = found.map(|(_, geometry)| Geometry { frame, ..geometry });
    }
    if let (Ok(made), Verdict::Unsafe(_)) = (&made, verdict) {
        hints.kerb = match made.kerb_radius_m {
            Some(radius_m) => Some(kerb(network, facts, model, settings, radius_m, stop)?),
            None => None,
        };
    }
    stop.check()?;
    let vehicle = model.vehicle.clone();
    if let (Ok(_), Verdict::Unsafe(_)) = (&made, verdict)
        && geometry.as_ref().is_none_or(|geometry| !geometry.result.closes())
    {
        let safe = |model: &Model| is_safe(network, facts, model, settings, &settings.turn_params());
        hints.shorter = no_bound::shorter(&vehicle, &safe, stop)?;
    }
    let (named, conflict) = roads_that_decide(network, facts, model, settings, verdict, stop)?;
    let ends = [facts.movement.from, facts.movement.to];
    let signs = if let Verdict::Unsafe(_) = verdict { signs::of(network, &ends, &vehicle) } else { Vec::new() };
    let explanation = Explanation { road: None, turn: Some(named), vehicle, verdict, geometry, hints, conflict, signs };
    let path = best.map(|(path, _)| path);
    let strip = settings.turn_policy.max(settings.policy);
    let (facts, policy, passage) = (facts.clone(), settings.policy, network.passage_kind(&facts.through));
    Ok(TurnExplanation { facts, passage, roads, corridors: made.ok(), path, policy, strip, explanation })
}

/// The geometry of a path, with the options that gave `result`. Some paths are certified without corrections.
fn turn_geometry(
    path: &TurnPath,
    result: &SpanResult,
    model: &Model,
    settings: &Settings,
    stop: &Stop,
) -> Result<Option<(Options, Geometry)>, Stopped> {
    let spans = std::slice::from_ref(&path.counted);
    let corrected = geometry(&path.corridor, spans, 0, model, &settings.stet, stop)?;
    if let Some(geometry) = corrected.filter(|geometry| geometry.result == *result) {
        return Ok(Some((settings.stet, geometry)));
    }
    let plain = Options { max_shift_m: 0.0, correction_sweeps: 0 };
    Ok(geometry(&path.corridor, spans, 0, model, &plain, stop)?.map(|geometry| (plain, geometry)))
}

/// The least radius of a kerb return with which the turn is safe, in half metres. The turn is made and certified
/// again for every radius that is tried.
fn kerb(
    network: &Network,
    facts: &TurnFacts,
    model: &Model,
    settings: &Settings,
    radius_m: f64,
    stop: &Stop,
) -> Result<KerbHint, Stopped> {
    let safe_with = |steps: u32| -> Result<bool, Stopped> {
        stop.check()?;
        let radius_m = f64::from(steps) * KERB_STEP_M;
        // A surveyed corner keeps its radius, whatever is assumed of corners. The turn's own one must not.
        let (kerbs, own_kerb_m) = (Kerbs::everywhere(radius_m), Some(radius_m));
        Ok(is_safe(network, facts, model, settings, &TurnParams { kerbs, own_kerb_m, ..settings.turn_params() }))
    };
    let (mut fails, mut does) = ((radius_m / KERB_STEP_M) as u32, (MOST_KERB_M / KERB_STEP_M) as u32);
    if fails >= does || !safe_with(does)? {
        return Ok(KerbHint::NotUpTo(MOST_KERB_M));
    }
    while does - fails > 1 {
        let middle = u32::midpoint(fails, does);
        if safe_with(middle)? { does = middle } else { fails = middle }
    }
    Ok(KerbHint::AtLeast(f64::from(does) * KERB_STEP_M))
}

/// Whether the turn is safe for a vehicle, on the best of its own paths.
fn is_safe(network: &Network, facts: &TurnFacts, model: &Model, settings: &Settings, params: &TurnParams) -> bool {
    let Some(reach) = LengthClass::of(&model.vehicle) else { return false };
    let made = corridors_of(network, facts, settings.policy, params, reach).ok();
    let best = made.and_then(|made| best_of(&made, &[model], &settings.stet).pop().flatten());
    best.is_some_and(|(_, result)| result.safe())
}

/// The roads that the turn's sentences name, and the rule of the one that forbids it.
fn roads_that_decide(
    network: &Network,
    facts: &TurnFacts,
    model: &Model,
    settings: &Settings,
    own: Verdict,
    stop: &Stop,
) -> Result<(TurnRoads, Option<RuleConflict>), Stopped> {
    let banning = facts.movement.forbidden.and_then(|no| network.restrictions.get(no as usize));
    let restriction = banning.map(|ban| format!("{}, relation {}", ban.kind.name(), ban.relation_id));
    let mut named = TurnRoads { restriction, decides: None, refused: Vec::new() };
    let edges = [facts.movement.from].into_iter().chain(facts.through.iter().copied()).chain([facts.movement.to]);
    if let Verdict::Forbidden(ForbiddenReason::Restriction) = own {
        return Ok((named, None));
    }
    let mut conflict = None;
    for index in edges {
        let Some(edge) = network.edges.get(index.index()) else { continue };
        let ends = [facts.movement.from, facts.movement.to].contains(&index);
        let rule = network.legal(edge).forbids(&model.vehicle).filter(|_| !ends);
        let Some(verdict) =
            rule.map_or_else(|| edge_verdict(network, index, model, settings, stop), |rule| Ok(Some(rule)))?
        else {
            continue;
        };
        if verdict == own && !matches!(own, Verdict::Safe | Verdict::Unsafe(_)) && named.decides.is_none() {
            named.decides = Some(network.title(edge));
            conflict = RuleConflict::of(network, edge, &model.vehicle);
        }
        // The edges that a passage leads over need no certificates of their own.
        if ends && verdict != Verdict::Safe && matches!(own, Verdict::Safe | Verdict::Unsafe(_)) {
            named.refused.push((format!("{} (edge {})", network.title(edge), edge.id), verdict));
        }
    }
    // The order in which `certify` lets roads decide.
    named.refused.sort_by_key(|(_, verdict)| match verdict {
        Verdict::Forbidden(_) => 0,
        Verdict::Unsafe(_) => 1,
        _ => 2,
    });
    Ok((named, conflict))
}

fn forbids(network: &Network, edge: &Edge, model: &Model) -> Option<Verdict> {
    match network.legal(edge).forbids(&model.vehicle) {
        Some(forbidden @ Verdict::Forbidden(_)) => Some(forbidden),
        _ => edge.barred.then_some(Verdict::Forbidden(ForbiddenReason::Barrier)),
    }
}

impl TurnExplanation {
    /// The turn in one line: the two roads, the angle, the kerb and the islands.
    #[must_use]
    pub fn title(&self) -> String {
        let [from, to] = &self.roads;
        let count = self.facts.through.len();
        let islands = match self.corridors.as_ref().map_or(0, |made| made.islands.len()) {
            0 => String::new(),
            1 => ", a traffic island in its area".to_owned(),
            many => format!(", {many} traffic islands in its area"),
        };
        match self.passage {
            Some(PassageKind::Roundabout) => {
                let arcs = if count == 1 { "arc" } else { "arcs" };
                return format!("{from} → {to}: over a roundabout, {count} {arcs}{islands}");
            }
            Some(PassageKind::Complex) => {
                return format!("{from} → {to}: one movement over {} nodes{islands}", count + 1);
            }
            None => {}
        }
        let angle = self.facts.angle_deg;
        let side = if angle > 0.0 { "left" } else { "right" };
        // Edges of roads that bend or taper may leave no room for the return that is assumed.
        let left_out = self.corridors.as_ref().is_some_and(|made| made.kerb_radius_m.is_none());
        let kerb = match (self.facts.kerb_radius_m, self.facts.kerb_source) {
            (Some(_), _) if left_out => ", corner not rounded".to_owned(),
            (Some(m), Some(KerbSource::Surveyed)) => format!(", kerb radius {m:.1} m (surveyed)"),
            (Some(m), _) => format!(", kerb radius {m:.1} m (assumed)"),
            (None, Some(KerbSource::Mapped)) => ", kerb as mapped".to_owned(),
            _ => String::new(),
        };
        format!("{from} → {to}: {:.0}° to the {side}{kerb}{islands}", angle.abs())
    }
}
