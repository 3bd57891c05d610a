//! What a database says of edges and turns, as plain values: whoever explains, checks, exports or shows them takes these.
//!
//! Promises names and units of the columns as `docs/columns.md` has them. Nothing here knows how a database keeps its rows:
//! `store` fills them.

mod cell;
mod certificate;
mod edge;
mod turn;

pub use cell::{Cell, Column, Kind};
pub use certificate::CertificateRow;
pub use edge::EdgeRow;
pub use turn::TurnRow;
