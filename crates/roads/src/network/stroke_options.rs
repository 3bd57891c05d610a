//! Settings by which edges become strokes.

/// Limits of straight continuations, and lengths of strokes and approaches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StrokeOptions {
    /// Length of an edge over which its heading at a node is taken, metres. Mapped junctions have bent ends.
    pub heading_reach_m: f64,
    /// Largest turn from one edge into the next, degrees.
    pub straight_limit_deg: f64,
    /// Largest turn within one way, degrees. Its mapper meant it to continue. On a hairpin of 12 m radius with a side
    /// road at its apex, two chords of 15 m stand at 72°.
    pub same_way_limit_deg: f64,
    /// Where only two ends of road meet, the road continues unless it has a sharp corner there or turns back by more than this,
    /// degrees.
    pub reversal_deg: f64,
    /// Largest bend at a node where other roads meet the stroke, degrees. Beyond it the stroke ends, and the way on is a turn.
    pub bend_limit_deg: f64,
    /// Largest turn from an approach into a stroke's first edge where no other road meets them, degrees.
    pub approach_limit_deg: f64,
    /// Least length of an approach, metres; it ends with the edge that reaches it. A type 2 road train needs about 200
    /// m until its entry no longer matters.
    pub approach_m: f64,
    /// Largest length of a stroke, metres. A stroke ends before the edge that would exceed it.
    pub max_length_m: f64,
}

impl Default for StrokeOptions {
    fn default() -> Self {
        Self {
            heading_reach_m: 15.0,
            straight_limit_deg: 45.0,
            same_way_limit_deg: 75.0,
            reversal_deg: 120.0,
            bend_limit_deg: 10.0,
            approach_limit_deg: 60.0,
            approach_m: 250.0,
            max_length_m: 40_000.0,
        }
    }
}
