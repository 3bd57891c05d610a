//! Certifies a way as a whole: joins its pieces, certifies the corridor, and says where a failure is.

use std::sync::Arc;

use rustc_hash::FxHashSet;

use super::assemble::{AssemblyError, DrivenWay, PartKind, RoutePart, RoutePath, assemble, movement};
use super::drive::{Drive, Join};
use super::driver::Driver;
use super::look::{Judged, judge};
use super::obstacles::Refutation;
use super::pieces::{Choices, Menu, Strokes, Turns};
use super::roads::Roads;
use super::rungs::Rungs;
use super::strip_use::{CertifiedPath, StripUse};
use super::turn_ends::TurnEnds;
use crate::corridor::Corridor;
use crate::network::{EdgeNo, MovementKind, Network, offset_m};
use crate::osm::LonLat;
use crate::stet::{self, Certificate, SpanResult};
use crate::stop::{Stop, Stopped};

/// A failure of the whole route is attributed to the nearest turn within this distance, metres, else to the edge at the place.
const TURN_REACH_M: f64 = 120.0;
/// What changes at this distance from a turn's nodes matters to no vehicle that takes the turn, metres: the road that counts before and
/// after a turn is shorter.
const BESIDE_M: f64 = 250.0;
/// The greatest number of combinations of paths that are joined for one way.
const MOST_STRUNG: usize = 100;
/// How many times what is missing a road gets: after a look, and after a certificate of the whole way, which takes longest.
const AFTER_LOOK: f64 = 2.0;
const AFTER_CERTIFICATE: f64 = 8.0;
/// How often what fails on one way is raised.
pub(super) const MOST_RAISED: usize = 40;

/// Certifies ways of one vehicle. It keeps the strokes and turns that it has made.
pub(super) struct Whole {
    roads: Arc<Roads>,
    driver: Arc<Driver>,
    strokes: Strokes,
    menu: Menu,
}

/// A way that passed as a whole.
pub(super) struct CertifiedWay {
    /// The corridor.
    pub(super) path: RoutePath,
    /// Its certificate, which is safe.
    pub(super) certificate: Certificate,
    /// Where it uses more than its own lane.
    pub(super) uses: Vec<StripUse>,
}

/// A way whose pieces could be joined, with the result for each of its parts.
pub(super) struct Looked {
    pub(super) path: RoutePath,
    /// By part of the path.
    pub(super) results: Vec<SpanResult>,
}

impl Looked {
    pub(super) fn safe(&self) -> bool {
        self.results.iter().all(SpanResult::safe)
    }
}

impl Whole {
    /// Nothing is made yet. Strokes and turns have the settings of the driver's permits.
    pub(super) fn new(roads: &Arc<Roads>, driver: Arc<Driver>, turns: Box<dyn Turns>) -> Self {
        let permits = &driver.permits;
        let strokes = Strokes::on_rungs(roads, permits.settings.clone(), permits.rungs.clone());
        Self { roads: Arc::clone(roads), driver, strokes, menu: Menu::new(turns) }
    }

    /// Changes strips. What lies beside edges whose strips change is made again.
    fn put_rungs(&mut self, rungs: Rungs, edges: &[EdgeNo]) {
        self.strokes.put_rungs(rungs, edges);
        self.forget_beside(edges.iter().copied(), &[]);
    }

    /// Changes strips as `raise` does. Returns whether anything stands higher now.
    fn raise(&mut self, raise: impl FnOnce(&mut Rungs, &Network) -> Vec<EdgeNo>) -> bool {
        let mut rungs = self.strokes.rungs().clone();
        let edges = raise(&mut rungs, &self.roads.network);
        if !edges.is_empty() {
            self.put_rungs(rungs, &edges);
        }
        !edges.is_empty()
    }

    /// Certifies a way on strips that are as narrow as it can be: where it fails, roads become wider and turns climb. It begins with the strips
    /// of the permits, whatever was raised for other ways.
    fn climb(&mut self, way: &DrivenWay<'_>, stop: &Stop) -> Result<Result<CertifiedWay, Refutation>, Stopped> {
        self.climb_from(self.driver.permits.rungs.clone(), MOST_RAISED, way, stop)
    }

    /// As [`Self::climb`], from other strips than those of the permits. What fails is raised `most_raised` times at most.
    pub(super) fn climb_from(
        &mut self,
        rungs: Rungs,
        most_raised: usize,
        way: &DrivenWay<'_>,
        stop: &Stop,
    ) -> Result<Result<CertifiedWay, Refutation>, Stopped> {
        let known = self.strokes.rungs();
        let rungs = rungs.on_way(&way.drive.edges);
        let differing: Vec<EdgeNo> = known.above(&rungs).into_iter().chain(rungs.above(known)).collect();
        self.put_rungs(rungs, &differing);
        let mut judged = Judged::default();
        let mut raised = 0;
        loop {
            // The place that refutes the way, and what is missing there, metres.
            let (refutation, missing_m) = match self.joined(way, stop)? {
                Err(refutation) => (refutation, f32::MAX),
                Ok(path) => {
                    judged = judge(&path, &judged, &self.driver, stop)?;
                    let looked_safe = judged.safe();
                    let mut refutation = None;
                    if looked_safe {
                        let (certificate, of_parts) = self.certificate(&path, stop)?;
                        if let Some(certificate) = certificate {
                            if certificate.result.safe() {
                                return Ok(Ok(self.certified(path, certificate, stop)?));
                            }
                            refutation = Some(refuted(&path, Some(&certificate)));
                        }
                        judged.put(of_parts);
                    }
                    if raised == most_raised {
                        return Ok(Err(refutation.unwrap_or_else(|| worst(&judged.parts))));
                    }
                    let times = if looked_safe { AFTER_CERTIFICATE } else { AFTER_LOOK };
                    if self.raise(|rungs, network| rungs.raise_failing(network, &judged.parts, times)) {
                        raised += 1;
                        continue;
                    }
                    let refutation = refutation.unwrap_or_else(|| worst(&judged.parts));
                    if !looked_safe {
                        return Ok(Err(refutation));
                    }
                    // What lies beside the place may be too narrow for the whole way.
                    (refutation, 0.0)
                }
            };
            let at = refutation.at;
            if raised == most_raised || !self.raise(|rungs, network| rungs.raise(network, way.drive, at, missing_m)) {
                return Ok(Err(refutation));
            }
            raised += 1;
        }
    }

    /// Forgets the turns near edges, and near nodes at these positions.
    fn forget_beside(&mut self, edges: impl Iterator<Item = EdgeNo>, nodes: &[LonLat]) {
        let network = &self.roads.network;
        let line = |edge: EdgeNo| network.edges.get(edge.index()).map(|edge| network.positions(edge));
        let changed: Vec<LonLat> = edges.filter_map(line).flatten().chain(nodes.iter().copied()).collect();
        let near = |a: LonLat, b: LonLat| {
            let [east_m, north_m] = offset_m(a, b);
            east_m.hypot(north_m) < BESIDE_M
        };
        self.menu.forget(|from, to| {
            let ends = [line(from).and_then(|mut line| line.next_back()), line(to).and_then(|mut line| line.next())];
            ends.into_iter().flatten().any(|end| changed.iter().any(|&at| near(at, end)))
        });
    }

    /// Lets go of the roads, so that their network can be changed. [`Self::go_on_with`] must follow.
    pub(super) fn let_go_of_roads(&mut self) {
        self.roads = Arc::default();
        self.strokes.let_go_of_roads();
    }

    /// Goes on with roads on which these edges have other widths, and nodes at these positions other corners or surfaces. What lies
    /// beside them is made again.
    pub(super) fn go_on_with(&mut self, roads: &Arc<Roads>, edges: &FxHashSet<EdgeNo>, nodes: &[LonLat]) {
        let stroke = |edge: EdgeNo| self.strokes.of(edge).map(|place| place.0);
        let strokes: FxHashSet<u32> = edges.iter().filter_map(|&edge| stroke(edge)).collect();
        self.roads = Arc::clone(roads);
        self.forget_beside(edges.iter().copied(), nodes);
        self.strokes.go_on_with(roads, |stroke| strokes.contains(&stroke));
    }

    /// Certifies a way. Each turn starts on its best path. Returns the certified way, if one passed, and the failures before it:
    /// failed certificates, and after the last path the pieces that could not be joined.
    pub(super) fn on_any_paths(
        &mut self,
        way: &DrivenWay<'_>,
        tries: usize,
        stop: &Stop,
    ) -> Result<(Option<CertifiedWay>, Vec<Refutation>), Stopped> {
        self.menu.begin();
        let mut failed: Vec<Refutation> = Vec::new();
        if !self.driver.permits.rungs.is_level() {
            return Ok(match self.climb(way, stop)? {
                Ok(certified) => (Some(certified), failed),
                Err(refutation) => (None, vec![refutation]),
            });
        }
        for strung in 1.. {
            let refutation = match self.certify(way, stop)? {
                Ok(certified) => return Ok((Some(certified), failed)),
                Err(refutation) => refutation,
            };
            let another = match (&refutation.assembly, refutation.at) {
                // All pairs of paths of the two turns were tried.
                (Some(AssemblyError::Overlap { .. }), _) => false,
                (_, at) => self.make_all(way.drive, at).is_some_and(|turn| self.menu.another(turn)),
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

    /// Joins the pieces of a way and certifies each of its parts. Turns have the chosen paths, unless two of them overlap; then others
    /// are chosen.
    pub(super) fn look(
        &mut self,
        way: &DrivenWay<'_>,
        choices: &mut Choices,
        stop: &Stop,
    ) -> Result<Result<Looked, Refutation>, Stopped> {
        self.menu.choose(choices);
        let path = match self.joined(way, stop)? {
            Ok(path) => path,
            Err(refutation) => return Ok(Err(refutation)),
        };
        choices.clone_from(self.menu.choices());
        let (model, options) = (&self.driver.model, &self.driver.permits.settings.stet);
        let results = stet::certify_parts(&path.corridor, model, &parts(&path), options, stop)?;
        Ok(Ok(Looked { path, results }))
    }

    /// The certificate of a way over the whole, if it is safe, with the plan that is best for its parts. Turns have the chosen paths, unless
    /// two of them overlap; then others are chosen.
    pub(super) fn prove(
        &mut self,
        way: &DrivenWay<'_>,
        choices: &Choices,
        stop: &Stop,
    ) -> Result<Option<CertifiedWay>, Stopped> {
        self.menu.choose(choices);
        let Ok(path) = self.joined(way, stop)? else { return Ok(None) };
        let safe = self.certificate(&path, stop)?.0.filter(|certificate| certificate.result.safe());
        safe.map(|certificate| self.certified(path, certificate, stop)).transpose()
    }

    /// The certificate of a path over the whole along the plan that is best for its parts, if all of these are safe, and their results.
    fn certificate(&self, path: &RoutePath, stop: &Stop) -> Result<(Option<Certificate>, Vec<SpanResult>), Stopped> {
        let (model, options) = (&self.driver.model, &self.driver.permits.settings.stet);
        stet::certify_whole(&path.corridor, model, &parts(path), options, stop)
    }

    /// Chooses paths of turns, and of every other turn the best one.
    pub(super) fn choose(&mut self, choices: &Choices) {
        self.menu.choose(choices);
    }

    /// Chooses the next path of a turn of a way. Returns whether there is one.
    pub(super) fn another(&mut self, drive: &Drive, at: PartKind, choices: &mut Choices) -> bool {
        self.menu.choose(choices);
        let another = self.make_all(drive, at).is_some_and(|turn| self.menu.another(turn));
        choices.clone_from(self.menu.choices());
        another
    }

    /// Makes all paths of a turn of a way. Returns the turn's ends. `None` if the way has no such turn.
    fn make_all(&mut self, drive: &Drive, at: PartKind) -> Option<TurnEnds> {
        let PartKind::Turn { from, to } = at else { return None };
        let join = drive.joins().find(|join| (join.from, join.to) == (from, to))?;
        let movement = movement(&self.roads.movements, from, join.arcs, to)?;
        self.menu.make_all(&mut self.strokes, &movement, join.arcs);
        Some(TurnEnds { from, to })
    }

    /// Joins the pieces of a way. If two turns overlap, their other paths are tried.
    fn joined(&mut self, way: &DrivenWay<'_>, stop: &Stop) -> Result<Result<RoutePath, Refutation>, Stopped> {
        let movements = &self.roads.movements;
        let of_join = |join: Join<'_>| movement(movements, join.from, join.arcs, join.to);
        let turns = way.drive.joins().filter_map(|join| Some((of_join(join)?, join.arcs)));
        let turns: Vec<_> = turns.filter(|(movement, _)| movement.kind != MovementKind::StraightOn).collect();
        self.menu.make(&mut self.strokes, &turns, stop)?;
        let mut strung = 0;
        loop {
            strung += 1;
            let roads = &self.roads;
            let error = match assemble(&roads.network, &roads.movements, &mut self.strokes, &mut self.menu, way, stop) {
                Ok(path) => return Ok(Ok(path)),
                Err(AssemblyError::Stopped(stopped)) => return Err(stopped),
                Err(error) => error,
            };
            let another = match error {
                AssemblyError::Overlap { before, at } => {
                    let turns = self.make_all(way.drive, before).zip(self.make_all(way.drive, at));
                    turns.is_some_and(|(before, at)| self.menu.another_pair(before, at))
                }
                _ => false,
            };
            if !another || strung >= MOST_STRUNG {
                return Ok(Err(unassembled(error, way.drive)));
            }
        }
    }

    fn certify(&mut self, way: &DrivenWay<'_>, stop: &Stop) -> Result<Result<CertifiedWay, Refutation>, Stopped> {
        match self.joined(way, stop)? {
            Ok(path) => self.certify_path(path, stop),
            Err(refutation) => Ok(Err(refutation)),
        }
    }

    fn certify_path(&mut self, path: RoutePath, stop: &Stop) -> Result<Result<CertifiedWay, Refutation>, Stopped> {
        let certificate = stet::certify(&path.corridor, &self.driver.model, &self.driver.permits.settings.stet, stop)?;
        Ok(match certificate {
            Some(certificate) if certificate.result.safe() => Ok(self.certified(path, certificate, stop)?),
            certificate => Err(refuted(&path, certificate.as_ref())),
        })
    }

    fn certified(&mut self, path: RoutePath, certificate: Certificate, stop: &Stop) -> Result<CertifiedWay, Stopped> {
        let of = CertifiedPath { path: &path, certificate: &certificate, model: &self.driver.model };
        let uses = StripUse::all(&mut self.strokes, of, stop)?;
        Ok(CertifiedWay { path, certificate, uses })
    }
}

/// The refutation of a way by the certificate of its path.
fn refuted(path: &RoutePath, certificate: Option<&Certificate>) -> Refutation {
    Refutation {
        at: culprit(path, certificate),
        result: certificate.and_then(|c| c.result.rsc_m.zip(c.result.hinge_margin_rad)),
        assembly: None,
        left_out: false,
    }
}

/// The refutation of a way at its worst part.
fn worst(parts: &[(PartKind, SpanResult)]) -> Refutation {
    let rsc_m = |result: &SpanResult| result.rsc_m.unwrap_or(f64::NEG_INFINITY);
    let failing = parts.iter().filter(|(_, result)| !result.safe());
    let worst = failing.min_by(|a, b| rsc_m(&a.1).total_cmp(&rsc_m(&b.1)));
    Refutation {
        at: worst.map_or(PartKind::Edge(EdgeNo::new(0)), |worst| worst.0),
        result: worst.and_then(|(_, result)| result.rsc_m.zip(result.hinge_margin_rad)),
        assembly: None,
        left_out: false,
    }
}

/// The stations of a path's parts.
fn parts(path: &RoutePath) -> Vec<std::ops::Range<usize>> {
    path.parts.iter().map(|part| part.stations.clone()).collect()
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
    first.unwrap_or(PartKind::Edge(drive.edges.first().copied().unwrap_or(EdgeNo::new(0))))
}

/// What to leave out when a whole route fails: the turn nearest to the failing place, or the edge at the place.
fn culprit(path: &RoutePath, certificate: Option<&Certificate>) -> PartKind {
    let corridor = &path.corridor;
    let at = match certificate {
        Some(c) if c.result.too_narrow() => c.result.limiting.station,
        // The place of a hinge's failure is not known, so the sharpest bend is taken.
        _ => sharpest(corridor),
    };
    let on = || path.parts.iter().find(|part| part.stations.contains(&at)).or(path.parts.first());
    turn_near(path, at, TURN_REACH_M).or_else(|| on().map(|part| part.kind)).unwrap_or(PartKind::Edge(EdgeNo::new(0)))
}

/// The turn that is nearest to a station, if it is within some metres.
pub(super) fn turn_near(path: &RoutePath, at: usize, within_m: f64) -> Option<PartKind> {
    let distance = |part: &&RoutePart| {
        let stations = &part.stations;
        if stations.contains(&at) { 0 } else { stations.start.abs_diff(at).min(stations.end.abs_diff(at)) }
    };
    let turns = path.parts.iter().filter(|part| matches!(part.kind, PartKind::Turn { .. }));
    let nearest = turns.min_by_key(distance)?;
    (distance(&nearest) as f64 * path.corridor.spacing_m <= within_m).then_some(nearest.kind)
}

fn sharpest(corridor: &Corridor) -> usize {
    let bend = |k: &usize| corridor.curvature.get(*k).map_or(0.0, |c| c.abs());
    (0..corridor.len()).max_by(|a, b| bend(a).total_cmp(&bend(b))).unwrap_or(0)
}
