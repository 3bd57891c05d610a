//! The stations of a path near its turns, where a junction's area counts instead of half-widths.

use std::ops::Range;

use super::super::assemble::{PartKind, RoutePart, RoutePath};
use crate::vehicle::Vehicle;

/// The feet of a vehicle's bodies lie at most so many lengths of the vehicle behind its front.
const BEHIND: f64 = 2.0;

/// Where an area counts instead of half-widths.
pub(super) struct AreaWindow {
    /// The stations at which a body may be meanwhile.
    pub(super) stations: Range<usize>,
    /// The turn that the area belongs to.
    pub(super) at: PartKind,
}

/// How far the stations of bodies are behind and ahead of the steer axle at most, stations.
#[derive(Debug, Clone, Copy)]
pub(super) struct BodyReach {
    pub(super) behind: usize,
    pub(super) ahead: usize,
}

impl BodyReach {
    pub(super) fn of(vehicle: &Vehicle, spacing_m: f64) -> Self {
        let stations = |metres: f64| (metres / spacing_m).ceil() as usize;
        Self {
            behind: stations(BEHIND * vehicle.length_m),
            ahead: stations(2.0 * vehicle.units.first().map_or(0.0, |unit| unit.front_overhang_m)),
        }
    }

    /// The stations at which bodies may be while the steer axle is at `heads`.
    pub(super) fn around(self, heads: &Range<usize>, len: usize) -> Range<usize> {
        heads.start.saturating_sub(self.behind)..(heads.end + self.ahead).min(len)
    }
}

/// The stations near the turns of a path. An area that belongs to no turn is the straight road beyond the path's ends, which is as wide as
/// the path is there.
pub(super) fn turn_windows(path: &RoutePath, reach: BodyReach) -> Vec<AreaWindow> {
    let corridor = &path.corridor;
    let turns = path.parts.iter().filter(|part| matches!(part.kind, PartKind::Turn { .. }));
    let window = |part: &RoutePart| {
        let of_turn = |heads: &Range<usize>| heads.start <= part.stations.start && heads.end >= part.stations.end;
        let heads = corridor.areas.iter().map(|span| span.heads.clone()).find(of_turn);
        let heads = heads.unwrap_or_else(|| part.stations.clone());
        AreaWindow { stations: reach.around(&heads, corridor.len()), at: part.kind }
    };
    turns.map(window).collect()
}
