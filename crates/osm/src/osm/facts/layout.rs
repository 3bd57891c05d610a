//! A cross section laid out from the left of the way's node order to its right, and the strips that follow from it.
//!
//! Everything about sides is in this file: positions, `placement`, and the kerb by driving side and direction. A strip has
//! a width, however small, and its edges are finite; otherwise there is no strip.

use crate::osm::facts::section::{LaneLine, Placement};
use crate::osm::facts::{CrossSection, Direction, Strip, TrafficSide, WidthSource};

/// Use of a part of the cross section.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Use {
    /// Heavy vehicles of one direction.
    Lane(Direction),
    /// Heavy vehicles of both directions, by turns.
    Shared,
    /// Paved, but not for heavy vehicles in normal running: bus lanes, turning lanes of both directions, shoulders.
    Paved,
    /// Parking and cycle lanes.
    Aside,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LayoutSegment {
    /// Width, metres. `None` until the carriageway has been shared out.
    pub(super) width_m: Option<f32>,
    /// What the width does not exceed, metres: a list's width that may be this lane's.
    pub(super) most_m: Option<f32>,
    /// Whether a list gives the width of this very lane.
    pub(super) listed: bool,
    /// Direction of the lane, whether or not it is open. Placements count these lanes.
    pub(super) of: Option<Direction>,
    pub(super) used: Use,
}

impl LayoutSegment {
    /// A part of unknown width.
    pub(super) const fn new(of: Option<Direction>, used: Use) -> LayoutSegment {
        LayoutSegment { width_m: None, most_m: None, listed: false, of, used }
    }

    /// The part with its share of a carriageway, unless its width is known.
    pub(super) fn with_share(self, share_m: f32) -> LayoutSegment {
        let share_m = self.most_m.map_or(share_m, |most_m| most_m.min(share_m));
        LayoutSegment { width_m: self.width_m.or(Some(share_m)), ..self }
    }

    pub(super) fn is_open_to(&self, direction: Direction) -> bool {
        self.used == Use::Shared || self.used == Use::Lane(direction)
    }
}

/// One lane for both directions by turns.
pub(super) const SHARED: LayoutSegment = LayoutSegment::new(None, Use::Shared);

pub(super) const NO_SECTION: CrossSection = CrossSection { lane: None, direction: None, carriageway: None };

/// The parts of the road from the left of the way's node order to the right.
#[derive(Debug, Default)]
pub(super) struct RoadLayout {
    pub(super) segments: Vec<LayoutSegment>,
    /// Evidence of the whole carriageway, and of its division into lanes.
    pub(super) whole: Option<WidthSource>,
    pub(super) divided: Option<WidthSource>,
    /// Evidence of lanes whose width a list gives.
    pub(super) listed: Option<WidthSource>,
    pub(super) placement: Placement,
}

impl RoadLayout {
    /// Left edges of the segments across the way's line, and the last right edge. Metres, positive to the left of the
    /// node order.
    fn positions(&self) -> Vec<f32> {
        let total_m: f32 = self.segments.iter().filter_map(|s| s.width_m).sum();
        let mut at_m = total_m / 2.0;
        let mut edges = vec![at_m];
        for segment in &self.segments {
            at_m -= segment.width_m.unwrap_or(0.0);
            edges.push(at_m);
        }
        let line_m = self.way_line(&edges).unwrap_or(0.0);
        edges.iter_mut().for_each(|edge| *edge -= line_m);
        edges
    }

    /// The position at which `placement` puts the way's line, if the lane exists.
    fn way_line(&self, edges: &[f32]) -> Option<f32> {
        let Placement::At(line, lane, direction) = self.placement else { return None };
        let mut lanes: Vec<usize> = (0..self.segments.len())
            .filter(|&at| self.segments[at].of == Some(direction) && self.segments[at].used != Use::Aside)
            .collect();
        if direction == Direction::Backward {
            lanes.reverse();
        }
        let at = *lanes.get(usize::from(lane).checked_sub(1)?)?;
        let (left, right) = match direction {
            Direction::Forward => (edges[at], edges[at + 1]),
            Direction::Backward => (edges[at + 1], edges[at]),
        };
        Some(match line {
            LaneLine::Left => left,
            LaneLine::Middle => (left + right) / 2.0,
            LaneLine::Right => right,
        })
    }

    /// The strips of one direction of travel.
    pub(super) fn section(&self, direction: Direction, side: TrafficSide) -> CrossSection {
        let mut inwards: Vec<usize> = (0..self.segments.len()).collect();
        if !kerb_on_the_left_of_the_way(direction, side) {
            inwards.reverse();
        }
        let (Some(whole), Some(divided)) = (self.whole, self.divided) else { return NO_SECTION };
        let Some(kerb_side) = inwards.iter().position(|&at| self.segments[at].is_open_to(direction)) else {
            return NO_SECTION;
        };
        let edges = self.positions();
        let strip = |first: usize, last: usize, source| {
            let (low, high) = (inwards[first].min(inwards[last]), inwards[first].max(inwards[last]));
            let (left, right) = (edges[low], edges[high + 1]);
            let (left_m, right_m) = match direction {
                Direction::Forward => (left, right),
                Direction::Backward => (-right, -left),
            };
            (left_m > right_m).then_some(Strip { left_m, right_m, source })
        };
        // A list's lanes need no other evidence.
        let lanes = |first: usize, last: usize| {
            let listed = inwards[first..=last].iter().all(|&at| self.segments[at].listed);
            strip(first, last, self.listed.filter(|_| listed).unwrap_or(divided))
        };
        let run = |from: usize, fits: &dyn Fn(&LayoutSegment) -> bool| {
            let after = inwards[from..].iter().take_while(|&&at| fits(&self.segments[at])).count();
            let before = inwards[..from].iter().rev().take_while(|&&at| fits(&self.segments[at])).count();
            (from - before, from + after - 1)
        };
        let (_, last_open) = run(kerb_side, &|s| s.is_open_to(direction));
        let (first_paved, last_paved) = run(kerb_side, &|s| s.used != Use::Aside);
        CrossSection {
            lane: lanes(kerb_side, kerb_side),
            direction: lanes(kerb_side, last_open),
            carriageway: strip(first_paved, last_paved, whole),
        }
    }
}

/// Whether the kerb of a direction's slow lane lies to the left of the node order. It does for left-hand traffic going
/// forward, and for right-hand traffic going backward.
pub(super) fn kerb_on_the_left_of_the_way(direction: Direction, side: TrafficSide) -> bool {
    (side == TrafficSide::Left) == (direction == Direction::Forward)
}
