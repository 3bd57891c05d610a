//! The segment that a way was made from.

/// A row of `segment`: a way of a database that was made from Overture's files.
#[derive(Debug, Clone, PartialEq)]
pub struct SegmentRow {
    /// The way's number in this database.
    pub way_id: i64,
    /// The segment's GERS id.
    pub segment_id: String,
    /// The part of the segment, as shares of its length.
    pub share: [f64; 2],
}
