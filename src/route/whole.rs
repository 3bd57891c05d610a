//! Certifies a way as a whole: joins its pieces, certifies the corridor, and says where a failure is.

use std::sync::Arc;

use rustc_hash::FxHashSet;

use super::assemble::{AssemblyError, PartKind, RoutePath, Way, assemble};
use super::drive::Drive;
use super::driver::Driver;
use super::obstacles::Refutation;
use super::pieces::{Menu, Strokes, Turns};
use super::roads::Roads;
use crate::corridor::Corridor;
use crate::stet::{self, Certificate};
use crate::stop::{Stop, Stopped};

/// A failure of the whole route is attributed to the nearest turn within this distance, metres, else to the edge at the place.
const TURN_REACH_M: f64 = 120.0;
/// The greatest number of combinations of paths that are joined for one way.
const MOST_STRUNG: usize = 100;

/// Certifies ways of one vehicle. It keeps the strokes and turns that it has made.
pub(super) struct Whole {
    roads: Arc<Roads>,
    driver: Arc<Driver>,
    strokes: Strokes,
    menu: Menu,
}

/// A way that passed as a whole.
pub(super) struct Certified {
    /// The corridor.
    pub(super) path: RoutePath,
    /// Its certificate, which is safe.
    pub(super) certificate: Certificate,
}

impl Whole {
    /// Nothing is made yet. Strokes and turns have the settings of the driver's permits.
    pub(super) fn new(roads: &Arc<Roads>, driver: Arc<Driver>, turns: Box<dyn Turns>) -> Self {
        let strokes = Strokes::new(roads, driver.permits.settings.clone());
        Self { roads: Arc::clone(roads), driver, strokes, menu: Menu::new(turns) }
    }

    /// Goes on with roads whose site differs at these edges and nodes. What lies beside them is made again.
    pub(super) fn go_on_with(&mut self, roads: &Arc<Roads>, edges: &FxHashSet<u32>, nodes: &FxHashSet<i64>) {
        let network = &roads.network;
        let stroke = |edge: u32| self.strokes.of(edge).map(|place| place.0);
        let strokes: FxHashSet<u32> = edges.iter().filter_map(|&edge| stroke(edge)).collect();
        let node = |edge: u32, end: bool| {
            network.edges.get(edge as usize).map_or(0, |edge| if end { edge.to_node } else { edge.from_node })
        };
        let ends = edges.iter().flat_map(|&edge| [node(edge, false), node(edge, true)]);
        let nodes: FxHashSet<i64> = nodes.iter().copied().chain(ends).collect();
        self.menu.forget(|from, to| {
            let [a, b] = [node(from, true), node(to, false)];
            // The edges inside a passage are not known here.
            a != b
                || nodes.contains(&a)
                || [from, to].into_iter().filter_map(stroke).any(|stroke| strokes.contains(&stroke))
        });
        self.strokes.go_on_with(roads, |stroke| strokes.contains(&stroke));
        self.roads = Arc::clone(roads);
    }

    /// Certifies a way. Each turn starts on its best path. Returns the certified way, if one passed, and the failures before it:
    /// failed certificates, and after the last path the pieces that could not be joined.
    pub(super) fn on_any_paths(
        &mut self,
        way: &Way<'_>,
        tries: usize,
        stop: &Stop,
    ) -> Result<(Option<Certified>, Vec<Refutation>), Stopped> {
        self.menu.begin();
        let mut failed: Vec<Refutation> = Vec::new();
        for strung in 1.. {
            let refutation = match self.certify(way, stop)? {
                Ok(certified) => return Ok((Some(certified), failed)),
                Err(refutation) => refutation,
            };
            let turn = |at| if let PartKind::Turn { from, to } = at { Some((from, to)) } else { None };
            let another = match (&refutation.assembly, turn(refutation.at)) {
                (Some(AssemblyError::Overlap { before, at }), _) => {
                    turn(*before).zip(turn(*at)).is_some_and(|(before, at)| self.menu.another_pair(before, at))
                }
                (_, Some((from, to))) => self.menu.another(from, to),
                (_, None) => false,
            };
            let goes_on = another && strung < MOST_STRUNG && failed.len() < tries;
            if refutation.assembly.is_none() || !goes_on {
                failed.push(refutation);
            }
            if !goes_on {
                break;
            }
        }
        Ok((None, failed))
    }

    fn certify(&mut self, way: &Way<'_>, stop: &Stop) -> Result<Result<Certified, Refutation>, Stopped> {
        let roads = &self.roads;
        let path = match assemble(&roads.network, &roads.movements, &mut self.strokes, &mut self.menu, way, stop) {
            Ok(path) => path,
            Err(AssemblyError::Stopped(stopped)) => return Err(stopped),
            Err(error) => return Ok(Err(unassembled(error, way.drive))),
        };
        let certificate = stet::certify(&path.corridor, &self.driver.model, &self.driver.permits.settings.stet, stop)?;
        let refuted = |certificate: Option<&Certificate>| Refutation {
            at: culprit(&path, certificate),
            result: certificate.and_then(|c| c.result.rsc_m.zip(c.result.hinge_margin_rad)),
            assembly: None,
            left_out: false,
        };
        let Some(certificate) = certificate else { return Ok(Err(refuted(None))) };
        if !certificate.result.safe() {
            return Ok(Err(refuted(Some(&certificate))));
        }
        Ok(Ok(Certified { path, certificate }))
    }
}

/// The refutation of a way whose pieces could not be joined.
fn unassembled(error: AssemblyError, drive: &Drive) -> Refutation {
    let at = match &error {
        AssemblyError::Unknown { at, .. }
        | AssemblyError::Overlap { at, .. }
        | AssemblyError::Centreline { at, .. } => *at,
        AssemblyError::Frame(_) | AssemblyError::Stopped(_) => first_turn(drive),
    };
    Refutation { at, result: None, assembly: Some(error), left_out: false }
}

fn first_turn(drive: &Drive) -> PartKind {
    let first = drive.joins().next().map(|join| PartKind::Turn { from: join.from, to: join.to });
    first.unwrap_or(PartKind::Edge(drive.edges.first().copied().unwrap_or_default()))
}

/// What to leave out when a whole route fails: the turn nearest to the failing place, or the edge at the place.
fn culprit(path: &RoutePath, certificate: Option<&Certificate>) -> PartKind {
    let corridor = &path.corridor;
    let at = match certificate {
        Some(c) if c.result.too_narrow() => c.result.limiting.station,
        // The place of a hinge's failure is not known, so the sharpest bend is taken.
        _ => sharpest(corridor),
    };
    let distance = |stations: &std::ops::Range<usize>| {
        if stations.contains(&at) { 0 } else { stations.start.abs_diff(at).min(stations.end.abs_diff(at)) }
    };
    let turns = path.parts.iter().filter(|part| matches!(part.kind, PartKind::Turn { .. }));
    let nearest = turns.min_by_key(|part| distance(&part.stations));
    let near = nearest.filter(|part| distance(&part.stations) as f64 * corridor.spacing_m <= TURN_REACH_M);
    let on = || path.parts.iter().find(|part| part.stations.contains(&at)).or(path.parts.first());
    near.or_else(on).map_or(PartKind::Edge(0), |part| part.kind)
}

fn sharpest(corridor: &Corridor) -> usize {
    let bend = |k: &usize| corridor.curvature.get(*k).map_or(0.0, |c| c.abs());
    (0..corridor.len()).max_by(|a, b| bend(a).total_cmp(&bend(b))).unwrap_or(0)
}
