//! Sections of a way: stretches that are fitted one by one.
//!
//! A vehicle that goes straight on for long forgets the turn before. So the middle of a long leg between two turns parts a way. What each
//! section needs is found on the section alone, and the certificate over the whole way decides.

use std::ops::Range;

use super::joint;
use crate::assemble::Way;
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
    pub(super) fn way(&self) -> Way<'_> {
        Way { drive: &self.drive, start: self.start, end: self.end }
    }
}

/// The sections of a way in driving order. A leg of at least `long_m` metres between two turns is parted in its middle.
pub(super) fn sections(network: &Network, movements: &Movements, way: &Way<'_>, long_m: f64) -> Vec<Section> {
    let drive = way.drive;
    let mut sections = Vec::new();
    let (mut first, mut start) = (0, way.start);
    for turns in joint::turns(movements, drive).windows(2) {
        let leg = turns[0][1]..turns[1][0] + 1;
        let Some((at, share)) = middle(network, &drive.edges, leg, long_m) else { continue };
        sections.push(section(drive, first..at + 1, start, share));
        (first, start) = (at, share);
    }
    sections.push(section(drive, first..drive.edges.len(), start, way.end));
    sections
}

/// The edge in the middle of a leg that is long enough, and the share of the edge before the middle.
fn middle(network: &Network, edges: &[u32], leg: Range<usize>, long_m: f64) -> Option<(usize, f64)> {
    let length_m = |at: usize| network.edges.get(edges[at] as usize).map_or(0.0, |edge| network.length_m(edge));
    let whole_m: f64 = leg.clone().map(length_m).sum();
    if whole_m < long_m {
        return None;
    }
    let mut before_m = 0.5 * whole_m;
    for at in leg {
        let own_m = length_m(at);
        if own_m >= before_m {
            return Some((at, before_m / own_m.max(1e-9)));
        }
        before_m -= own_m;
    }
    None
}

fn section(drive: &Drive, range: Range<usize>, start: f64, end: f64) -> Section {
    let over = drive.over.iter().filter(|arcs| range.start < arcs.start && arcs.end < range.end);
    let over = over.map(|arcs| arcs.start - range.start..arcs.end - range.start).collect();
    Section { drive: Drive { edges: drive.edges[range.clone()].to_vec(), over }, first: range.start, start, end }
}
