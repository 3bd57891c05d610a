//! The file: framing, inflating, index checks, two passes. See the folder's own files.

pub mod write;

/// The account of every object read: what was kept, and what was left out for which reason. Adds up.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ReadAccount {}
