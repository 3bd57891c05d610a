//! Sections of a way: stretches that are fitted one by one.
//!
//! A vehicle that goes straight on for long forgets the turn before. So a way is parted in long legs between two turns. What each section
//! needs is found on the section alone, and the certificate over the whole way decides. A section with turns is certified many times, so it
//! is kept short.

use std::ops::Range;

use super::joint;
use crate::assemble::DrivenWay;
use crate::drive::Drive;
use crate::network::{Movements, Network};

/// A stretch of a way.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Section {
    /// Its edges. The first and the last one may belong to the neighbours, too.
    pub(super) drive: Drive,
    /// The index of its first edge in the way.
    pub(super) first: usize,
    /// The share of the first edge before its beginning, and of the last edge up to its end.
    pub(super) start: f64,
    pub(super) end: f64,
}

impl Section {
    /// The section as a way.
    pub(super) fn way(&self) -> DrivenWay<'_> {
        DrivenWay { drive: &self.drive, start: self.start, end: self.end }
    }
}

/// The sections of a way in driving order. A turn keeps `long_m` metres of road before and after it, or half of what lies between it and the
/// next turn. A road that is longer is a section without turns.
pub(super) fn sections(network: &Network, movements: &Movements, way: &DrivenWay<'_>, long_m: f64) -> Vec<Section> {
    let drive = way.drive;
    let turns = joint::turns(movements, drive);
    let mut sections = Vec::new();
    let (mut first, mut start) = (0, way.start);
    for leg in 0..=turns.len() {
        let before = leg.checked_sub(1).map(|turn| turns[turn][1]);
        let after = turns.get(leg).map(|turn| turn[0]);
        let range = before.unwrap_or(0)..after.map_or(drive.edges.len(), |at| at + 1);
        let driven: Vec<DrivenEdge> = range.map(|at| DrivenEdge::of(network, way, at)).collect();
        let whole_m = driven.iter().map(DrivenEdge::length_m).sum();
        let ends = [before, after].map(|turn| if turn.is_some() { LegEnd::Turn } else { LegEnd::Open });
        for cut_m in cuts_m(whole_m, long_m, ends) {
            let Some((at, share)) = edge_at(&driven, cut_m) else { continue };
            sections.push(section(drive, first..at + 1, start, share));
            (first, start) = (at, share);
        }
    }
    sections.push(section(drive, first..drive.edges.len(), start, way.end));
    sections
}

/// What a leg begins or ends with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum LegEnd {
    /// A turn.
    Turn,
    /// The end of the way.
    Open,
}

/// Where a leg is parted, in metres from its beginning. `ends`: its beginning and its end.
fn cuts_m(whole_m: f64, long_m: f64, ends: [LegEnd; 2]) -> Vec<f64> {
    use LegEnd::{Open, Turn};
    match ends {
        [Turn, Turn] if whole_m >= 3.0 * long_m => vec![long_m, whole_m - long_m],
        [Turn, Turn] if whole_m >= long_m => vec![0.5 * whole_m],
        [Turn, Open] if whole_m >= 2.0 * long_m => vec![long_m],
        [Open, Turn] if whole_m >= 2.0 * long_m => vec![whole_m - long_m],
        _ => Vec::new(),
    }
}

/// The part of an edge that a way drives.
struct DrivenEdge {
    /// The index of the edge in the way.
    at: usize,
    /// The shares of the edge at which the part begins and ends.
    shares: [f64; 2],
    /// The length of the whole edge, metres.
    edge_m: f64,
}

impl DrivenEdge {
    fn of(network: &Network, way: &DrivenWay<'_>, at: usize) -> Self {
        let edges = &way.drive.edges;
        let start = if at == 0 { way.start } else { 0.0 };
        let end = if at + 1 == edges.len() { way.end } else { 1.0 };
        let edge_m = network.edges.get(edges[at].index()).map_or(0.0, |edge| network.length_m(edge));
        Self { at, shares: [start, end], edge_m }
    }

    fn length_m(&self) -> f64 {
        (self.shares[1] - self.shares[0]).max(0.0) * self.edge_m
    }
}

/// The edge at a distance from the beginning of a leg, and the share of the edge before that place.
fn edge_at(driven: &[DrivenEdge], mut from_start_m: f64) -> Option<(usize, f64)> {
    for edge in driven {
        let own_m = edge.length_m();
        if own_m >= from_start_m {
            return Some((edge.at, edge.shares[0] + from_start_m / edge.edge_m.max(1e-9)));
        }
        from_start_m -= own_m;
    }
    None
}

fn section(drive: &Drive, range: Range<usize>, start: f64, end: f64) -> Section {
    let over = drive.over.iter().filter(|arcs| range.start < arcs.start && arcs.end < range.end);
    let over = over.map(|arcs| arcs.start - range.start..arcs.end - range.start).collect();
    Section { drive: Drive { edges: drive.edges[range.clone()].to_vec(), over }, first: range.start, start, end }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turn_keeps_enough_road_and_no_more() {
        use LegEnd::{Open, Turn};
        // Short legs are not parted, and those of middle length once.
        assert_eq!(cuts_m(99.0, 100.0, [Turn, Turn]), [0.0; 0]);
        assert_eq!(cuts_m(240.0, 100.0, [Turn, Turn]), [120.0]);
        assert_eq!(cuts_m(9000.0, 100.0, [Turn, Turn]), [100.0, 8900.0]);
        // Before the first turn and after the last one.
        assert_eq!(cuts_m(9000.0, 100.0, [Open, Turn]), [8900.0]);
        assert_eq!(cuts_m(9000.0, 100.0, [Turn, Open]), [100.0]);
        assert_eq!(cuts_m(150.0, 100.0, [Turn, Open]), [0.0; 0]);
        assert_eq!(cuts_m(9000.0, 100.0, [Open, Open]), [0.0; 0]);
    }

    #[test]
    fn a_place_counts_only_what_is_driven() {
        let edge = |at, shares, edge_m| DrivenEdge { at, shares, edge_m };
        let driven = [edge(0, [0.5, 1.0], 200.0), edge(1, [0.0, 1.0], 300.0), edge(2, [0.0, 0.25], 400.0)];
        assert_eq!(edge_at(&driven, 20.0), Some((0, 0.6)));
        assert_eq!(edge_at(&driven, 250.0), Some((1, 0.5)));
        assert_eq!(edge_at(&driven, 450.0), Some((2, 0.125)));
        assert_eq!(edge_at(&driven, 501.0), None);
    }
}
