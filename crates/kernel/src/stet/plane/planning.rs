//! Nominal room in areas, for planning.

use crate::stet::block::Minima;
use crate::stet::body::{Body, PIECE_M, Stand, least};
use crate::stet::lanes::tagged;
use crate::stet::model::MAX_POINTS;
use crate::stet::track::Track;

/// Lowers the planning leeways at the feet of a unit's points: the nominal room of the sides between them, less the straight gains.
pub(super) fn plan(track: &Track, body: &mut Body, stand: &Stand, feet: &[usize; MAX_POINTS], minima: &mut Minima) {
    if track.areas.count(stand.head, stand.head).next().is_none() {
        return;
    }
    let only = !minima.counted.is_empty();
    let changes = track.areas.changes(stand.head) || track.areas.changes(stand.head.saturating_sub(1));
    body.rooms.enter_nominal(stand.head, changes);
    let mut number = 0;
    for index in 0..body.points.len() {
        let before = index.saturating_sub(1);
        let (ahead, behind) = (&body.points[before], &body.points[index]);
        let (from, to) = (ahead.on_axis.ahead, behind.on_axis.ahead);
        let parts = ((from - to) / PIECE_M).ceil().max(1.0);
        for (side, aside) in [body.half_width, -body.half_width].into_iter().enumerate() {
            // The first part begins where the one ahead ends. The first point is a place by itself.
            let places = if index == 0 { 0..=0 } else { 1..=parts as usize };
            for part in places {
                let share = part as f64 / parts;
                let p = stand.place(from + (to - from) * share, aside);
                // Only what is negative or the least is asked for.
                let enough = if only { minima.floor.max(0.0) } else { f64::INFINITY };
                number += 1;
                let room = body.rooms.nominal(&track.areas, stand.head, number - 1, p, enough);
                let Some(room) = room else { continue };
                let near = if share < 0.5 { before } else { index };
                let point = &body.points[near];
                let leeway = room - point.on_axis.gain;
                if minima.counted.contains(&stand.head) {
                    minima.floor = minima.floor.min(leeway);
                }
                let tagged = tagged(leeway, point.tag);
                let column = if side == 0 { &mut minima.left } else { &mut minima.right };
                column[feet[near]] = least(column[feet[near]], tagged);
            }
        }
    }
}
