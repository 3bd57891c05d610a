//! Cuts a way's vertices into pieces: at junctions, at sharp corners, at borders of cells, at reversals, and where the file lacks a node.
//!
//! A piece has at least two vertices. Consecutive vertices differ, and no inner vertex is a junction.

use std::ops::Range;

use super::vertices::MISSING;

/// A piece of road: what lies between two cuts of a way. It stands for both directed edges, before it is known which of them exist.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct RoadPiece {
    /// The piece's vertices in [`CutWay::line`]. Neighbouring pieces share a vertex.
    pub(super) vertices: Range<usize>,
    /// Whether a node is missing just before the first or just after the last vertex.
    pub(super) cut: bool,
}

/// Why a way gives no piece.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Unusable {
    /// The file has none of the way's nodes.
    NoNodeInFile,
    /// The file has some of the way's nodes, but no two consecutive ones.
    NodesApart,
    /// All remaining vertices are at one place.
    OnePlace,
}

/// The pieces of one way. The buffers are reused from way to way.
#[derive(Debug, Default)]
pub(super) struct CutWay {
    /// The way's vertices without repetitions and without those of no piece.
    pub(super) line: Vec<u32>,
    /// Pieces in way order.
    pub(super) pieces: Vec<RoadPiece>,
}

impl CutWay {
    /// Cuts the way with these vertices, which may include [`MISSING`]. `ends_at` tells whether a piece ends at the inner vertex of an
    /// index of a line that is no junction.
    pub(super) fn cut(
        &mut self,
        vertices: &[u32],
        is_junction: impl Fn(u32) -> bool,
        ends_at: impl Fn(&[u32], usize) -> bool,
    ) -> Result<(), Unusable> {
        self.line.clear();
        self.pieces.clear();
        let mut from = 0;
        let (mut located, mut consecutive) = (false, false);
        for run in vertices.split(|&v| v == MISSING) {
            let cut = [from > 0, from + run.len() < vertices.len()];
            from += run.len() + 1;
            located |= !run.is_empty();
            consecutive |= run.len() > 1;
            self.cut_run(run, cut, &|line, i| is_junction(line[i]) || ends_at(line, i));
        }
        match (self.pieces.is_empty(), located, consecutive) {
            (false, ..) => Ok(()),
            (true, false, _) => Err(Unusable::NoNodeInFile),
            (true, true, false) => Err(Unusable::NodesApart),
            (true, true, true) => Err(Unusable::OnePlace),
        }
    }

    /// Cuts a run of located vertices. `cut` says whether a node is missing before it and after it, `ends_at` whether pieces end
    /// at an inner vertex.
    fn cut_run(&mut self, run: &[u32], cut: [bool; 2], ends_at: &impl Fn(&[u32], usize) -> bool) {
        let start = self.line.len();
        for &v in run {
            if self.line.len() == start || self.line.last() != Some(&v) {
                self.line.push(v);
            }
        }
        let last = self.line.len().saturating_sub(1);
        if last <= start {
            self.line.truncate(start);
            return;
        }
        let mut from = start;
        for i in start + 1..=last {
            let reverses = i < last && self.line[i - 1] == self.line[i + 1];
            if i == last || reverses || ends_at(&self.line[start..], i - start) {
                let at_file_end = (cut[0] && from == start) || (cut[1] && i == last);
                self.pieces.push(RoadPiece { vertices: from..i + 1, cut: at_file_end });
                from = i;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pieces(vertices: &[u32], junctions: &[u32]) -> Vec<(Vec<u32>, bool)> {
        let mut way = CutWay::default();
        way.cut(vertices, |v| junctions.contains(&v), |_, _| false).map_or(Vec::new(), |()| {
            way.pieces.iter().map(|p| (way.line[p.vertices.clone()].to_vec(), p.cut)).collect()
        })
    }

    #[test]
    fn a_way_is_cut_at_junctions_and_reversals_only() {
        assert_eq!(pieces(&[1, 2, 3, 4], &[3]), [(vec![1, 2, 3], false), (vec![3, 4], false)]);
        assert_eq!(pieces(&[1, 2, 1, 3], &[1]), [(vec![1, 2], false), (vec![2, 1], false), (vec![1, 3], false)]);
        assert_eq!(pieces(&[1, 1, 2, 2], &[]), [(vec![1, 2], false)]);
    }

    #[test]
    fn only_the_pieces_next_to_a_missing_node_end_with_the_file() {
        let m = MISSING;
        assert_eq!(
            pieces(&[1, 2, 3, m, 4, m, 5, 6], &[2]),
            [(vec![1, 2], false), (vec![2, 3], true), (vec![5, 6], true)]
        );
        assert_eq!(pieces(&[m, 1, 2, m], &[]), [(vec![1, 2], true)]);
    }

    #[test]
    fn a_way_without_a_piece_says_why() {
        let why = |vertices: &[u32]| CutWay::default().cut(vertices, |_| false, |_, _| false);
        assert_eq!(why(&[MISSING, MISSING]), Err(Unusable::NoNodeInFile));
        assert_eq!(why(&[]), Err(Unusable::NoNodeInFile));
        assert_eq!(why(&[1, MISSING, 2]), Err(Unusable::NodesApart));
        assert_eq!(why(&[7, 7]), Err(Unusable::OnePlace));
        assert_eq!(why(&[7]), Err(Unusable::NodesApart));
    }
}
