//! A stroke laid out in a metric frame of its own. Corridors with different cross sections are made from it.

use std::cell::OnceCell;
use std::rc::Rc;

use super::Params;
use super::course::{ChainLine, ChainLink, Room, closed_course, open_course};
use super::frame::Frame;
use super::polyline::Polyline;
use super::smooth::{Smoothed, Smoothing, smooth};
use super::stretch::Across;
use super::taper::guideline_ratio;
use crate::network::{Edge, EdgeNo, Network, Stroke, length_m, offset_m};
use crate::osm::LonLat;
use crate::osm::facts::{CrossSection, Oneway, Policy, Strip};
use crate::verdict::UnknownReason;

/// The cross section of each edge.
pub type Sections<'a> = dyn Fn(&Edge) -> CrossSection + Sync + 'a;

/// Longest line of a stroke and its approach, metres. Strokes end at 40 km; only a single edge may be longer. One of hundreds of kilometres
/// has a misplaced node, and its corridor would not fit into memory.
const MOST_LENGTH_M: f64 = 500_000.0;

/// A stroke and its approach in a metric frame.
pub struct StrokeLayout<'n> {
    pub(super) network: &'n Network,
    pub(super) frame: Frame,
    pub(super) params: &'n Params,
    closed: bool,
    /// The first edges are the approach.
    edges: Vec<Laid<'n>>,
    approach: usize,
    /// The line of the first corridor, smoothed. Others mostly have the same line.
    smoothed: OnceCell<(Polyline, Rc<Smoothed>)>,
}

/// An edge in the frame.
struct Laid<'n> {
    index: EdgeNo,
    edge: &'n Edge,
    points: Vec<[f64; 2]>,
    /// How many positions of the edge lie before `points`.
    skipped: usize,
}

impl<'n> StrokeLayout<'n> {
    /// # Errors
    /// `Geometry`: the stroke has no edges, is wider than a metric frame, or has an edge of hundreds of kilometres.
    pub fn new(network: &'n Network, stroke: &Stroke, params: &'n Params) -> Result<Self, UnknownReason> {
        let range = |r: &std::ops::Range<u32>| network.stroke_edges.get(r.start as usize..r.end as usize);
        let (Some(approach), Some(own)) = (range(&stroke.approach), range(&stroke.edges)) else {
            return Err(UnknownReason::Geometry);
        };
        if own.is_empty() {
            return Err(UnknownReason::Geometry);
        }
        // A loop is its own approach.
        let approach = if stroke.closed { &[] } else { approach };
        let (approach, skipped) = lead_in(network, approach, params.lead_in_m);
        let chain: Vec<EdgeNo> = approach.iter().chain(own).copied().collect();
        let mut positions: Vec<LonLat> = Vec::new();
        let mut ends = Vec::with_capacity(chain.len());
        for (place, &index) in chain.iter().enumerate() {
            let skipped = if place == 0 { skipped } else { 0 };
            positions.extend(network.positions(&network.edges[index.index()]).skip(skipped));
            ends.push(positions.len());
        }
        if length_m(positions.iter().copied()) > MOST_LENGTH_M {
            return Err(UnknownReason::Geometry);
        }
        let metric = Frame::around(&positions).and_then(|frame| Ok((frame, frame.forward(&positions)?)));
        let (frame, metric) = metric.map_err(|_| UnknownReason::Geometry)?;
        let mut start = 0;
        let edges = chain
            .iter()
            .zip(ends)
            .map(|(&index, end)| {
                let (points, skipped) = (metric[start..end].to_vec(), if start == 0 { skipped } else { 0 });
                start = end;
                Laid { index, edge: &network.edges[index.index()], points, skipped }
            })
            .collect();
        let (closed, approach) = (stroke.closed, approach.len());
        Ok(Self { network, frame, params, closed, edges, approach, smoothed: OnceCell::new() })
    }

    /// The edges with their widths.
    pub(super) fn links(&self, sections: &Sections<'_>, policy: Policy) -> Vec<ChainLink<'_>> {
        self.edges
            .iter()
            .map(|laid| {
                let (road, section) = (self.network.road(laid.edge), sections(laid.edge));
                ChainLink {
                    index: laid.index,
                    edge: laid.edge,
                    points: &laid.points,
                    skipped: laid.skipped,
                    room: room(section, policy, self.params.map_tolerance_m),
                    direction: section.direction.and_then(|strip| across(strip, 0.0)),
                    two_way: road.oneway == Oneway::No,
                    ratio: guideline_ratio(road.class),
                }
            })
            .collect()
    }

    /// The line that is driven.
    pub(super) fn course(&self, links: &[ChainLink<'_>]) -> ChainLine {
        if self.closed { closed_course(links, self.params) } else { open_course(links, self.approach) }
    }

    /// A line, smoothed.
    pub(super) fn smoothed(&self, line: &Polyline) -> Rc<Smoothed> {
        let asked = Smoothing { tolerance_m: self.params.tolerance_m, cutoff_m: self.params.cutoff_m };
        let (known, smoothed) = self.smoothed.get_or_init(|| (line.clone(), Rc::new(smooth(line, asked))));
        if known == line { Rc::clone(smoothed) } else { Rc::new(smooth(line, asked)) }
    }
}

/// The part of an approach that is driven, and how many positions of its first edge lie before it. It begins at the position nearest to the
/// stroke from which it is long enough. What lies before it, and may lie beyond the end of a file, has no influence.
fn lead_in<'n>(network: &Network, approach: &'n [EdgeNo], least_m: f64) -> (&'n [EdgeNo], usize) {
    let mut length_m = 0.0;
    for (place, &index) in approach.iter().enumerate().rev() {
        let mut after: Option<LonLat> = None;
        for (from_end, position) in network.positions(&network.edges[index.index()]).rev().enumerate() {
            if let Some(after) = after.replace(position) {
                let [x, y] = offset_m(position, after);
                length_m += x.hypot(y);
                if length_m >= least_m {
                    let positions = network.positions(&network.edges[index.index()]).len();
                    return (&approach[place..], positions - 1 - from_end);
                }
            }
        }
    }
    (approach, 0)
}

fn across(strip: Strip, map_tolerance_m: f64) -> Option<Across> {
    let (left_m, right_m) = (f64::from(strip.left_m), f64::from(strip.right_m));
    let usable = (left_m - right_m).is_finite() && left_m > right_m;
    usable.then_some(Across { left_m: left_m - map_tolerance_m, right_m: right_m + map_tolerance_m })
}

/// The strips of an edge under a policy: the strip itself, the lanes of its direction in which a lane may shift, and
/// the paved surface.
fn room(section: CrossSection, policy: Policy, map_tolerance_m: f64) -> Option<Room> {
    let across = |strip: Strip| across(strip, map_tolerance_m);
    let strip = section.strip(policy).and_then(across)?;
    let wider = (policy == Policy::Lane).then_some(section.direction).flatten().and_then(across);
    let shift = wider.filter(|w| strip.within(*w)).unwrap_or(strip);
    let paved = section.carriageway.and_then(across);
    Some(Room { strip, shift, surface: paved.filter(|paved| shift.within(*paved)).unwrap_or(shift) })
}
