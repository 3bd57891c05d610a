//! How values stand in the columns of rows: numbers and words for what they mean, and how they are read.

pub(crate) mod names;
pub(crate) mod read;
pub(crate) mod set_no;
pub(crate) mod uses;
