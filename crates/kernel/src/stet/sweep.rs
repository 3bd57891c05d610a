//! One sweep of vehicles along tracks (docs/proof.md, sections 2 to 7). Nominal motion and curved tubes have rides in
//! lanes: each lane has its own vehicle and its own track. Leeway at the body points has stations in lanes. This layout was the
//! fastest of those measured.
//!
//! No leeway of a certifying sweep is above what any bounded disturbance leaves, within the model of the proof. A sweep
//! knows nothing of edges, corrections or shrinking.

use std::cell::RefCell;
use std::cmp::Reverse;

use super::adjoint::{self, Histories, Refined, Trail, first_loose};
use super::block::{BARELY_CLOSED_RAD, BLOCK, FIELDS, Minima};
use super::body::{self, Body};
use super::drive::{Motion, drive};
use super::group::Group;
use super::lanes::{LANES, Vector, on_widest};
use super::leeway;
use super::model::MAX_UNITS;
use super::ride::{Refining, Ride};
use super::spans;
use super::steer::SteerPaths;
use super::track::Track;
use netcert_base::stop::Stop;
use netcert_base::watch;
use netcert_base::work_count::{WorkKind, count};

/// Sweeps vehicles along their tracks, eight at a time, and returns the minima of each. No ride matters to another one. With
/// `CERTIFY`, all bounds are deducted and hinges are checked. Otherwise the result is the nominal leeway of a few points less
/// their straight gains, for planning. Each block polls `stop`; a cancelled sweep returns [`Minima::lost`].
pub(super) fn sweep<const CERTIFY: bool>(rides: &[Ride<'_>], stop: &Stop) -> Vec<Minima> {
    let refines = |ride: &Ride<'_>| CERTIFY && !matches!(ride.scope.refining, Refining::Nowhere);
    // Lanes take as long as the longest of their eight rides.
    let mut order: Vec<usize> = (0..rides.len()).collect();
    order.sort_by_key(|&i| (refines(&rides[i]), Reverse((rides[i].model.units.len(), rides[i].end()))));
    let mut swept = vec![Minima::default(); rides.len()];
    for alike in order.chunk_by(|&a, &b| refines(&rides[a]) == refines(&rides[b])) {
        for chunk in alike.chunks(LANES) {
            let members: Vec<&Ride<'_>> = chunk.iter().map(|&i| &rides[i]).collect();
            let minima = if refines(members[0]) {
                sweep_lanes::<CERTIFY, true>(&members, None, stop)
            } else {
                sweep_lanes::<CERTIFY, false>(&members, None, stop)
            };
            chunk.iter().zip(minima).for_each(|(&i, minima)| swept[i] = minima);
        }
    }
    swept
}

/// Sweeps a vehicle that does not fit anyway, at γ = 1 and at γ_min, to learn how much is missing. At γ = 1 areas are not looked
/// at; where the bounds do not close, the sweep ends. The least leeway in areas is believed to be below `below_m`; if it is not,
/// the sweep is repeated without that belief.
pub(super) fn sweep_hopeless(full: &Ride<'_>, least: &Ride<'_>, below_m: f64, stop: &Stop) -> [Minima; 2] {
    let swept = |below_m: f64| {
        let mut swept = sweep_lanes::<true, false>(&[full, least], Some(below_m), stop).into_iter();
        [swept.next().unwrap_or_default(), swept.next().unwrap_or_default()]
    };
    let found = swept(below_m);
    if below_m.is_finite() && found[1].floor >= below_m { swept(f64::INFINITY) } else { found }
}

/// A ride on its way.
struct Lane<'r> {
    ride: &'r Ride<'r>,
    bodies: Vec<Body>,
    minima: Minima,
    head: usize,
    /// The head station before which the ride ends, or sooner.
    end: usize,
    done: bool,
}

/// What sweeps write and no other sweep reads. Each thread keeps its own.
struct Scratch {
    rows: Vec<f64>,
    histories: Histories,
    tight: Refined,
}

thread_local! {
    static SCRATCH: RefCell<Scratch> =
        const { RefCell::new(Scratch { rows: Vec::new(), histories: Histories::new(), tight: Refined::new() }) };
}

fn sweep_lanes<const CERTIFY: bool, const REFINE: bool>(
    rides: &[&Ride<'_>],
    hopeless: Option<f64>,
    stop: &Stop,
) -> Vec<Minima> {
    count(WorkKind::Sweep, rides.len() as u64);
    SCRATCH.with_borrow_mut(|scratch| on_widest!(V => sweep_with::<V, CERTIFY, REFINE>(scratch, rides, hopeless, stop)))
}

fn sweep_with<V: Vector, const CERTIFY: bool, const REFINE: bool>(
    Scratch { rows, histories, tight }: &mut Scratch,
    rides: &[&Ride<'_>],
    hopeless: Option<f64>,
    stop: &Stop,
) -> Vec<Minima> {
    let group = Group::<V>::new(&rides.iter().map(|ride| (ride.model, ride.shrink)).collect::<Vec<_>>());
    let mut lanes: Vec<Lane<'_>> = rides.iter().map(|ride| Lane::new::<CERTIFY>(ride)).collect();
    if let (Some(below_m), [full, least]) = (hopeless, lanes.as_mut_slice()) {
        (full.minima.bare, least.minima.floor) = (true, below_m);
    }
    rows.resize(MAX_UNITS * LANES * FIELDS * BLOCK, 0.0);
    let mut trail = if REFINE { histories.trail(&group) } else { Trail::none() };
    let mut paths = SteerPaths::new(rides);
    let mut motion = Motion::new(&group, &paths);
    while lanes.iter().any(|lane| !lane.done) {
        watch::poll();
        if stop.told() {
            return rides.iter().map(|ride| unvisited(ride.track).lost()).collect();
        }
        paths.next_block(rides);
        drive::<V, CERTIFY, REFINE>(&mut motion, &group, &paths, rows, &mut trail);
        for (index, lane) in lanes.iter_mut().enumerate().filter(|(_, lane)| !lane.done) {
            let scope = lane.ride.scope;
            if CERTIFY && !matches!(scope.refining, Refining::From(_)) {
                lane.minima.note_loose(lane.head, first_loose(&group, index, rows));
            }
            let block = lane.head / BLOCK;
            let asked = scope.blocks.is_none_or(|blocks| blocks[block]);
            let tight_from = match scope.refining {
                Refining::From(units) if REFINE && asked => units[block],
                Refining::WhereLoose if REFINE && asked => lane.minima.loose[block],
                _ => usize::MAX,
            };
            if tight_from < lane.bodies.len() {
                adjoint::refine(&mut trail, &group, index, tight_from, &mut motion.extra, rows, tight);
            }
            if REFINE {
                adjoint::close(&mut trail, index, lane.bodies.len());
            }
            if asked {
                lane.look::<V, CERTIFY>(index, tight_from, rows, tight);
            } else {
                lane.pass_over();
            }
            lane.go_on();
        }
        if hopeless.is_some() && lanes[0].open_ended() {
            for lane in &mut lanes {
                (lane.minima.floor, lane.done) = (f64::NEG_INFINITY, true);
            }
        }
    }
    lanes.into_iter().map(Lane::finish).collect()
}

/// The minima of a ride along a track before it begins.
fn unvisited(track: &Track) -> Minima {
    if track.areas.is_empty() { Minima::new(track.len()) } else { Minima::with_areas(track.len()) }
}

impl<'r> Lane<'r> {
    fn new<const CERTIFY: bool>(ride: &'r Ride<'r>) -> Self {
        let Ride { track, model, shrink, scope, .. } = *ride;
        let mut minima = unvisited(track);
        if let Some(span) = scope.only {
            (minima.counted, minima.keep) = (spans::straight(track, model, span), scope.keep);
        }
        let mut bodies = body::bodies::<CERTIFY>(model, track, shrink);
        if scope.plain && !CERTIFY {
            bodies.iter_mut().for_each(Body::forget_gains);
        }
        let (head, end) = (track.first_head, ride.end());
        Self { ride, bodies, minima, head, end, done: head >= end }
    }

    /// Looks at the points over the block that was driven last.
    fn look<V: Vector, const CERTIFY: bool>(&mut self, index: usize, tight_from: usize, rows: &[f64], tight: &Refined) {
        let Self { ride: Ride { track, shift, .. }, bodies, minima, head, .. } = self;
        let (track, shift, head) = (*track, *shift, *head);
        for (unit, body) in bodies.iter_mut().enumerate() {
            let start = (unit * LANES + index) * FIELDS * BLOCK;
            let block = &rows[start..start + FIELDS * BLOCK];
            if unit >= tight_from {
                leeway::points::<V, CERTIFY, true>(track, body, block, tight.unit(unit), shift, head, minima);
            } else {
                leeway::points::<V, CERTIFY, false>(track, body, block, &[], shift, head, minima);
            }
        }
    }

    /// Leaves out the block that was driven last.
    fn pass_over(&mut self) {
        self.bodies.iter_mut().for_each(|body| body::skip(self.ride.track, body, self.head));
    }

    /// Goes on to the next block, or ends.
    fn go_on(&mut self) {
        let Self { ride: Ride { track, model, scope, .. }, bodies, minima, .. } = self;
        self.head += BLOCK;
        // Nothing else counts when all of the vehicle has left.
        let whole = 0..track.count;
        let span = scope.only.unwrap_or(&whole);
        let touched = spans::stations(track, span);
        let left = || {
            self.head >= spans::straight(track, model, span).end
                && bodies.iter().flat_map(|body| &body.points).all(|point| point.foot > *touched.end() + 1)
        };
        let narrow = || scope.plain && scope.only.is_some() && !minima.room_on(spans::stations(track, span));
        self.done = self.head >= self.end || narrow() || left();
    }

    /// Whether the bounds did not close over the last block, at a step that counts.
    fn open_ended(&self) -> bool {
        let steps = self.head - BLOCK..self.head;
        let mut hinges = self.minima.hinge[steps.clone()].iter().zip(steps);
        hinges.any(|(&hinge, k)| hinge < BARELY_CLOSED_RAD && self.minima.counted.contains(&k))
    }

    fn finish(mut self) -> Minima {
        let track = self.ride.track;
        if self.ride.asked_end().is_some_and(|end| self.head >= end) {
            // Stations farther on are not asked for, and not lost.
            self.bodies.iter_mut().for_each(|body| body::skip(track, body, track.len()));
        }
        self.bodies.iter().for_each(|body| body::finish(track, body, &mut self.minima));
        track.torn.iter().for_each(|&k| self.minima.lose(k));
        self.minima
    }
}
