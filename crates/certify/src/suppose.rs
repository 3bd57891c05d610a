//! Results under a supposition: a stroke that is nowhere narrower than some width, a turn whose own kerbs have some radius.
//!
//! They are certified like any other result, and are no certificates: nothing says that the supposition holds.

use super::paths::best_of;
use crate::corridor::StrokeLayout;
use crate::network::{EdgeNo, Network};
use crate::settings::Settings;
use crate::stet::{Model, SpanResult, certify_planned};
use crate::stop::{Stop, Stopped};
use netcert_roads::turns::{LengthClass, TurnFacts, TurnParams, corridors_of};

/// The results of a stroke's edges, if the strip of the settings' policy were nowhere narrower than `width_m` on the stroke. `stroke` is an index
/// into [`Network::strokes`]. Edges without a corridor are left out.
///
/// # Errors
/// `stop` was told. It is checked every few metres.
pub fn stroke_at_least(
    network: &Network,
    stroke: u32,
    width_m: f64,
    model: &Model,
    settings: &Settings,
    stop: &Stop,
) -> Result<Vec<(EdgeNo, SpanResult)>, Stopped> {
    stop.check()?;
    let Settings { policy, corridor, stet, .. } = settings;
    let Some(stroke) = network.strokes.get(stroke as usize) else { return Ok(Vec::new()) };
    let sections = |edge: &_| network.section(edge).at_least(*policy, width_m);
    let laid = StrokeLayout::new(network, stroke, corridor);
    let Ok(made) = laid.and_then(|laid| laid.corridor(&sections, *policy)) else { return Ok(Vec::new()) };
    let spans: Vec<_> = made.spans.iter().map(|span| span.stations.clone()).collect();
    let results = certify_planned(&made.corridor, model, &spans, stet, stop)?.map_or_else(Vec::new, |(_, spans)| spans);
    let known = made.spans.iter().zip(results).filter(|(span, _)| span.unknown.is_none());
    Ok(known.map(|(span, result)| (span.edge, result)).collect())
}

/// The result of a turn on its best path, if its own kerbs had this radius, metres. `None` if the turn has no corridor, or no path was found.
///
/// # Errors
/// `stop` was told. It is checked before the turn is made and before it is certified.
pub fn turn_with_kerb(
    network: &Network,
    turn: &TurnFacts,
    radius_m: f64,
    model: &Model,
    settings: &Settings,
    stop: &Stop,
) -> Result<Option<SpanResult>, Stopped> {
    let params = TurnParams { own_kerb_m: Some(radius_m), ..settings.turn_params() };
    best_result(network, turn, &params, model, settings, stop)
}

/// The result of a turn on its best path on a network, such as one on which a surface is supposed. `None` as in [`turn_with_kerb`].
///
/// # Errors
/// As [`turn_with_kerb`].
pub fn turn_as_it_is(
    network: &Network,
    turn: &TurnFacts,
    model: &Model,
    settings: &Settings,
    stop: &Stop,
) -> Result<Option<SpanResult>, Stopped> {
    best_result(network, turn, &settings.turn_params(), model, settings, stop)
}

fn best_result(
    network: &Network,
    turn: &TurnFacts,
    params: &TurnParams,
    model: &Model,
    settings: &Settings,
    stop: &Stop,
) -> Result<Option<SpanResult>, Stopped> {
    stop.check()?;
    let Some(reach) = LengthClass::of(&model.vehicle) else { return Ok(None) };
    let Ok(made) = corridors_of(network, turn, settings.policy, params, reach) else { return Ok(None) };
    stop.check()?;
    let best = best_of(&made, &[model], &settings.stet).pop().flatten();
    stop.check()?;
    Ok(best.map(|(_, result)| result))
}
