//! Leeway at the body points (docs/proof.md, section 7), for eight consecutive head stations at a time.
//!
//! The plain distance to the edge is reduced by the tube of the point, by its second-order terms, by what may happen
//! between two body points (inside of a curve), and by what may happen between two head stations.

mod bend;
mod between;
mod edge;
mod marks;
mod passing;
mod sample;
mod sides;
mod states;

use super::block::{BLOCK, FIELDS, Feet, Minima, row};
use super::body::Body;
use super::lanes::{LANES, Vector, by_instruction_set};
use super::plane;
use super::track::Track;
use between::Gap;
use sample::{Sample, lower, sample};
use sides::Knots;
use states::{StateRows, States};

by_instruction_set! {
    /// Lowers `minima` by all points of one unit over one block. With `REFINED`, `refined` holds a block of bounds per
    /// body point, which replace the gains and what curvature adds to them.
    #[allow(clippy::too_many_arguments)] // One call per unit and block, in the second innermost loop.
    pub(super) fn points<V, const CERTIFY: bool, const REFINED: bool>(
        track: &Track,
        body: &mut Body,
        block: &[f64],
        refined: &[f64],
        shift: &[f64],
        head: usize,
        minima: &mut Minima,
    ) {
        let mut alone = false;
        for group in 0..BLOCK / LANES {
            let first = head + group * LANES;
            alone = false;
            if track.areas.touch(first - 1, first + LANES) {
                alone = track.areas.replace(first, first + LANES - 1);
                plane::pass::<CERTIFY, REFINED>(track, body, block, refined, head, first, alone, minima);
            }
            let rows = StateRows { block, refined, group };
            let s = States::<V>::read(&rows);
            if !alone {
                pass::<V, CERTIFY, REFINED>(track, body, &s, &rows, first, minima);
            }
            if CERTIFY && let Some(axle) = &mut body.last_axle {
                axle.follow(track, [s.x, s.y], shift, minima);
            }
        }
        if let Some(axle) = &mut body.last_axle {
            axle.foot = axle.way.kept(track, head + BLOCK, axle.foot);
        }
        if !alone {
            for point in &mut body.points {
                point.keep_on_the_way(track, head + BLOCK, minima);
            }
        }
    }
}

/// All points of one unit at eight head stations, the first of which is `first`, from the front to the rear.
#[inline(always)]
fn pass<V: Vector, const CERTIFY: bool, const REFINED: bool>(
    track: &Track,
    body: &mut Body,
    s: &States<V>,
    rows: &StateRows<'_>,
    first: usize,
    minima: &mut Minima,
) {
    let mut before: Option<Sample<V>> = None;
    let mut knots = Knots::NONE;
    for index in 0..body.points.len() {
        if REFINED {
            knots = knots.next(body, index, |point| rows.bound(point));
        }
        let mut sample = sample::<V, CERTIFY, REFINED>(track, body, index, s, &knots);
        body.points[index].cover(sample.feet, minima);
        if CERTIFY {
            minima.pass(first, sample.feet);
            match &mut before {
                Some(before) => {
                    Gap { track, body, index, s, knots: &knots }.cover::<REFINED>(before, &mut sample, minima);
                }
                None => lower(&mut minima.hinge, Feet::Run(first), rows.load::<V>(row::HINGE).tagged(sample.tag)),
            }
        }
        if let Some(before) = before.replace(sample) {
            before.lower(minima);
        }
    }
    if let Some(last) = before {
        last.lower(minima);
    }
}

const _: () = assert!(FIELDS == row::WAY2 + 1);
