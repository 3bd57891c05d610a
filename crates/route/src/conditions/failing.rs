//! Where a way fails as a whole, and what is supposed there beyond what its parts need.

use super::fitter::{Fitter, Fitting};
use super::suppositions::Suppositions;
use super::turn_need::Turning;
use crate::assemble::{PartKind, RoutePart};
use crate::certify::{MOST_KERB_M, MOST_MORE_M};
use crate::stet::SpanResult;
use crate::whole::{Looked, turn_near};

/// A failure on an edge is that of the nearest turn within this distance, metres.
const TURN_REACH_M: f64 = 60.0;
/// The least that is added to a width or a radius where the whole fails first, metres.
const WIDER_M: f64 = 0.1;
const ROUNDER_M: f64 = 1.0;
/// How far a junction is supposed to be paved: by how much more, at most and at first, metres.
const PAVED_STEP_M: f64 = 3.0;
const MOST_PAVED_M: f64 = 36.0;
const FIRST_PAVED_M: f64 = 9.0;
/// Where the whole lacks this much, more than one thing is supposed at once, metres; what it lacks where no bound holds.
const MUCH_M: f64 = 0.3;
const NO_BOUND_M: f64 = 1.0;

/// A place where a whole way fails.
pub(super) struct Failing {
    pub(super) at: PartKind,
    /// What is missing, metres.
    missing_m: f64,
    /// Whether there is room, but the vehicle would fold or steer too far.
    pub(super) folds: bool,
    /// Whether the road before or after the turn limits, not the junction.
    beside: bool,
}

impl Failing {
    /// Whether so much room is missing that one thing alone does not help.
    pub(super) fn lacks_much(&self) -> bool {
        !self.folds && self.missing_m >= MUCH_M
    }
}

/// The least that is added to a width, metres. A wider road has another middle, so a little more may not help at once: later rounds add
/// more.
fn wider_m(round: usize) -> f64 {
    WIDER_M * (1 + round) as f64
}

/// The places where a way fails, in driving order, each once.
pub(super) fn failing(looked: &Looked) -> Vec<Failing> {
    let mut found: Vec<Failing> = Vec::new();
    let mut open = false;
    for (part, result) in looked.path.parts.iter().zip(&looked.results).filter(|(_, result)| !result.safe()) {
        // Where the bounds do not close, nothing is known of what comes after.
        if !result.closes() && std::mem::replace(&mut open, true) {
            continue;
        }
        let at = culprit(looked, part, result);
        let missing_m = result.rsc_m.map_or(NO_BOUND_M, |rsc_m| (-rsc_m).max(0.0));
        let beside = result.too_narrow() && !result.limiting.in_area;
        let folds = result.closes() && !result.too_narrow();
        match found.iter_mut().find(|known| known.at == at) {
            Some(known) => {
                known.missing_m = known.missing_m.max(missing_m);
                known.beside &= beside;
                known.folds &= folds;
            }
            None => found.push(Failing { at, missing_m, folds, beside }),
        }
    }
    found
}

/// The turn that a part's failure is attributed to, or the part itself if no turn is near.
fn culprit(looked: &Looked, part: &RoutePart, result: &SpanResult) -> PartKind {
    if matches!(part.kind, PartKind::Turn { .. }) {
        return part.kind;
    }
    let stations = &part.stations;
    let limiting = result.limiting.station.clamp(stations.start, stations.end);
    let at = if result.too_narrow() { limiting } else { stations.start };
    turn_near(&looked.path, at, TURN_REACH_M).unwrap_or(part.kind)
}

impl Fitter {
    /// Supposes more room at a place. Returns whether there is more to suppose.
    pub(super) fn more_room(&self, fitting: &mut Fitting, place: &Failing) -> bool {
        let missing_m = place.missing_m;
        match place.at {
            PartKind::Edge(edge) => {
                let at = fitting.drive.edges.iter().position(|&other| other == edge);
                at.is_some_and(|at| self.widen_by(fitting, at, 2.0 * missing_m))
            }
            PartKind::Turn { from, to } => {
                let Fitting { drive, supposed, round, .. } = fitting;
                let Some(join) = drive.joins().find(|join| (join.from, join.to) == (from, to)) else { return false };
                let Some(Some(turning)) = self.turning(drive, join) else { return false };
                // The road that limits may not be one that the vehicle drives.
                let wider_m = (2.0 * missing_m).max(wider_m(*round));
                if place.beside && *round % 3 < 2 && self.wider(&turning, wider_m, supposed) {
                    return true;
                }
                let small = missing_m < MUCH_M;
                let rounder = self.rounder(&turning, missing_m, supposed);
                // Where little is missing, what is not paved yet stays so.
                let first_m = if small { None } else { Some(FIRST_PAVED_M) };
                let paved = !(rounder && small) && self.more_paved(&turning, first_m, supposed);
                let wider = !((rounder || paved) && small) && self.wider(&turning, wider_m, supposed);
                rounder || paved || wider
            }
        }
    }

    fn widen_by(&self, fitting: &mut Fitting, at: usize, more_m: f64) -> bool {
        let (network, strip) = (&self.roads.network, self.driver.permits.settings.policy);
        let edge = fitting.drive.edges[at];
        let Some(has_m) = fitting.supposed.width_m(network, edge, strip) else { return false };
        let first_m = fitting.supposed.known_width_m(network, edge, strip).unwrap_or(has_m);
        let width_m = has_m + more_m.max(wider_m(fitting.round));
        width_m <= first_m + MOST_MORE_M && self.widen_near(fitting, at, strip, width_m)
    }

    /// Supposes greater radii of a turn's corners, if radii were what helped it.
    fn rounder(&self, turning: &Turning<'_>, missing_m: f64, supposed: &mut Suppositions) -> bool {
        let corners = turning.corners(&self.roads.network);
        let known: Vec<_> = corners.iter().filter_map(|&(node, between)| supposed.radius_m(node, between)).collect();
        let Some(radius_m) = known.into_iter().reduce(f64::max).filter(|&radius_m| radius_m < MOST_KERB_M) else {
            return false;
        };
        let radius_m = (radius_m + (4.0 * missing_m).max(ROUNDER_M)).min(MOST_KERB_M);
        for (node, between) in corners {
            supposed.round(node, between, radius_m);
        }
        true
    }

    /// Supposes more of a junction to be paved. Where nothing is supposed to be paved yet it begins at `first_m`, metres; `None`: it begins
    /// nowhere.
    fn more_paved(&self, turning: &Turning<'_>, first_m: Option<f64>, supposed: &mut Suppositions) -> bool {
        let mut more = false;
        for (node, at) in turning.nodes(&self.roads.network) {
            let known_m = supposed.paved_m(node).or(first_m);
            if let Some(radius_m) = known_m.filter(|&radius_m| radius_m < MOST_PAVED_M) {
                supposed.pave(node, at, radius_m + PAVED_STEP_M);
                more = true;
            }
        }
        more
    }

    /// Supposes wider roads before and after a turn.
    fn wider(&self, turning: &Turning<'_>, more_m: f64, supposed: &mut Suppositions) -> bool {
        let (network, strip) = (&self.roads.network, turning.strip());
        let mut more = false;
        for edge in turning.near(network) {
            let Some(has_m) = supposed.width_m(network, edge, strip) else { continue };
            let first_m = supposed.known_width_m(network, edge, strip).unwrap_or(has_m);
            let width_m = has_m + more_m;
            more |= width_m <= first_m + MOST_MORE_M && supposed.widen(network, edge, strip, width_m);
        }
        more
    }
}
