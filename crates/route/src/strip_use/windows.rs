//! The stations of a path at which bodies may be held against areas instead of half-widths.

use std::ops::Range;

use super::super::assemble::{PartKind, RoutePart, RoutePath};
use super::super::turn_ends::TurnEnds;
use crate::vehicle::Vehicle;

/// The feet of a vehicle's bodies lie at most so many lengths of the vehicle behind its front.
const BEHIND: f64 = 2.0;

/// Where an area counts instead of half-widths.
pub(super) struct AreaWindow {
    /// The stations at which a body may be meanwhile.
    pub(super) stations: Range<usize>,
    /// The turn that the area belongs to. `None`: it is the straight road beyond an end of the path.
    pub(super) turn: Option<TurnEnds>,
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

/// The stations of bodies that may be held against areas: those of each turn, and those of each area that holds no turn (the straight road
/// beyond the path's ends). Where turns follow each other closely several areas count at a turn, and its window holds the stations of all. An
/// area that only meets turns belongs to each of them.
pub(super) fn area_windows(path: &RoutePath, reach: BodyReach) -> Vec<AreaWindow> {
    let corridor = &path.corridor;
    let holds =
        |heads: &Range<usize>, part: &RoutePart| heads.start <= part.stations.start && heads.end >= part.stations.end;
    let turns = || {
        path.parts.iter().filter_map(|part| match part.kind {
            PartKind::Turn { from, to } => Some((part, TurnEnds { from, to })),
            PartKind::Edge(_) => None,
        })
    };
    let of_turn = |(part, ends): (&RoutePart, TurnEnds)| {
        let heads = corridor.areas.iter().map(|span| &span.heads).filter(|heads| holds(heads, part));
        let heads = heads.fold(part.stations.clone(), |all, heads| all.start.min(heads.start)..all.end.max(heads.end));
        AreaWindow { stations: reach.around(&heads, corridor.len()), turn: Some(ends) }
    };
    let alone = |heads: &&Range<usize>| !turns().any(|(part, _)| holds(heads, part));
    let of_area = |heads: &Range<usize>| {
        let meets = |part: &RoutePart| heads.start < part.stations.end && heads.end > part.stations.start;
        let mut met: Vec<_> = turns().filter(|(part, _)| meets(part)).map(|(_, ends)| Some(ends)).collect();
        if met.is_empty() {
            met.push(None);
        }
        let stations = reach.around(heads, corridor.len());
        met.into_iter().map(move |turn| AreaWindow { stations: stations.clone(), turn })
    };
    let alone = corridor.areas.iter().map(|span| &span.heads).filter(alone).flat_map(of_area);
    turns().map(of_turn).chain(alone).collect()
}
