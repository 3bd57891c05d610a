//! A piece of road beside a drawn line: how much of it the line covers, how far away, and in which direction.
//!
//! Samples lie every 5 m on the piece, so that its covered share is what is counted. Headings are those of chords, and their
//! mean counts: noise of some metres turns a short segment of a line by more than any road bends.

use super::directed;
use super::index::{MatchingIndex, RoadPiece};
use super::names::Fit;
use super::track::{MeasuredLine, turn_deg};
use crate::network::EdgeNo;
use crate::osm::{LonLat, NodeId};
use crate::row::Along;

/// Greatest distance between a road and what was drawn along it, metres.
pub(super) const REACH_M: f64 = 15.0;
/// Distance of samples, metres.
pub(super) const STEP_M: f64 = 5.0;
/// A sample may lie so far beyond the end of the line, metres.
const BEYOND_M: f64 = 1.0;
/// Half the length of the chords whose headings are compared, metres.
const CHORD_M: f64 = 10.0;
/// Greatest difference of heading of a piece, degrees; of one sample, more.
const HEADING_DEG: f64 = 20.0;
const SAMPLE_HEADING_DEG: f64 = 45.0;

/// A piece shorter than this is passed by chance where a line begins or ends a little off. It is meant only where the line goes
/// on beyond both its ends, metres.
pub(super) const SHORT_M: f64 = 10.0;
pub(super) const GOES_ON_M: f64 = 5.0;

/// A place on the piece that the line passes.
#[derive(Debug, Clone, Copy)]
pub(super) struct PassedPlace {
    /// Where on the line, metres.
    pub(super) on_line_m: f64,
    /// Where on the piece, metres in the order of its way.
    on_piece_m: f64,
    pub(super) distance_m: f64,
    turn_deg: f64,
}

/// A piece that the line may mean.
pub(super) struct Candidate<'i> {
    pub(super) piece: &'i RoadPiece,
    pub(super) name: Fit,
    /// The edges that would be meant; at least one.
    pub(super) edges: Vec<EdgeNo>,
    /// Sorted along the line; at least one.
    pub(super) samples: Vec<PassedPlace>,
    /// Share of the piece's length that the line covers.
    pub(super) covered: f64,
    /// Whether the line runs in the order of the piece's way.
    ahead: bool,
    length_m: f64,
}

impl<'i> Candidate<'i> {
    /// Measures a piece; `None` if the line does not run along it, or in a direction that the piece does not have.
    pub(super) fn measured(
        index: &MatchingIndex<'_>,
        piece: &'i RoadPiece,
        name: Fit,
        origin: LonLat,
        drawn: &MeasuredLine,
        along: Along,
    ) -> Option<Self> {
        let track = MeasuredLine::new(origin, index.line(piece).iter().copied());
        let length_m = track.length_m();
        let count = (length_m / STEP_M).ceil().max(2.0) as usize;
        let all = (0..count).map(|i| (i as f64 + 0.5) / count as f64 * length_m);
        let passed: Vec<PassedPlace> = all.filter_map(|on_piece_m| sample(&track, on_piece_m, drawn)).collect();
        let ahead = 2 * passed.iter().filter(|sample| sample.turn_deg.abs() < 90.0).count() >= passed.len();
        let mut samples: Vec<PassedPlace> = passed.into_iter().filter_map(|sample| sample.folded(ahead)).collect();
        samples.sort_by(|a, b| a.on_line_m.total_cmp(&b.on_line_m));
        let turn_deg = samples.iter().map(|sample| sample.turn_deg).sum::<f64>() / samples.len() as f64;
        let edges = directed(if ahead { piece.edges } else { [piece.edges[1], piece.edges[0]] }, along);
        // With no sample the mean is not a number, and the comparison false.
        let runs_along = turn_deg.abs() <= HEADING_DEG && !edges.is_empty();
        let covered = samples.len() as f64 / count as f64;
        runs_along.then_some(Self { piece, name, edges, samples, covered, ahead, length_m })
    }

    /// The part of the line beside the piece, metres.
    pub(super) fn stretch(&self) -> [f64; 2] {
        let ends = self.samples.first().zip(self.samples.last());
        ends.map_or([0.0; 2], |(first, last)| [first.on_line_m, last.on_line_m])
    }

    pub(super) fn mean_m(&self) -> f64 {
        self.samples.iter().map(|sample| sample.distance_m).sum::<f64>() / self.samples.len() as f64
    }

    /// Whether the line could pass the piece by chance.
    pub(super) fn by_chance(&self, line_m: f64) -> bool {
        let [from, to] = self.stretch();
        // The outermost samples are a quarter of a short piece from its ends, or farther.
        let end_m = self.length_m / 4.0;
        self.length_m < SHORT_M && (from - end_m < GOES_ON_M || to + end_m > line_m - GOES_ON_M)
    }

    /// Distance at a place of the line that the piece is beside: that of the nearest sample, metres.
    pub(super) fn distance_at(&self, on_line_m: f64) -> Option<f64> {
        let [from, to] = self.stretch();
        if !(from - STEP_M / 2.0..=to + STEP_M / 2.0).contains(&on_line_m) {
            return None;
        }
        let after = self.samples.partition_point(|sample| sample.on_line_m < on_line_m);
        let beside = [after.checked_sub(1), Some(after)].into_iter().flatten().filter_map(|i| self.samples.get(i));
        let gap = |sample: &&PassedPlace| (sample.on_line_m - on_line_m).abs();
        beside.min_by(|a, b| gap(a).total_cmp(&gap(b))).map(|sample| sample.distance_m)
    }

    /// Metres from the ends of the piece's covered part to the ends of the piece: where the line comes, and where it leaves.
    pub(super) fn left_open_m(&self) -> [f64; 2] {
        let on = |sample: &PassedPlace| sample.on_piece_m;
        let least = self.samples.iter().map(on).fold(f64::INFINITY, f64::min);
        let most = self.samples.iter().map(on).fold(0.0, f64::max);
        if self.ahead { [least, self.length_m - most] } else { [self.length_m - most, least] }
    }

    /// The nodes at which the line comes to the piece and leaves it.
    pub(super) fn nodes(&self) -> [NodeId; 2] {
        let [a, b] = self.piece.ends;
        if self.ahead { [a, b] } else { [b, a] }
    }

    /// For messages: `way 12 (edge 34), 5.6 m away`.
    pub(super) fn told(&self, index: &MatchingIndex<'_>) -> String {
        format!("{}, {:.1} m away", index.told(self.piece), self.mean_m())
    }
}

fn sample(track: &MeasuredLine, on_piece_m: f64, drawn: &MeasuredLine) -> Option<PassedPlace> {
    let foot = drawn.foot(track.at(on_piece_m));
    if foot.distance_m > REACH_M || foot.beyond_m > BEYOND_M {
        return None;
    }
    let turn_deg = turn_deg(drawn.chord(foot.along_m, CHORD_M), track.chord(on_piece_m, CHORD_M));
    Some(PassedPlace { on_line_m: foot.along_m, on_piece_m, distance_m: foot.distance_m, turn_deg })
}

impl PassedPlace {
    /// The sample with its turn from the line's direction, or from the opposite one; `None` if it turns off.
    fn folded(self, ahead: bool) -> Option<Self> {
        let opposite = if self.turn_deg > 0.0 { self.turn_deg - 180.0 } else { self.turn_deg + 180.0 };
        let turn_deg = if ahead { self.turn_deg } else { opposite };
        (turn_deg.abs() <= SAMPLE_HEADING_DEG).then_some(Self { turn_deg, ..self })
    }
}
