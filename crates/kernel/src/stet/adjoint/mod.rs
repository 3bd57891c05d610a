//! Tubes from the adjoint of the time-varying chain (docs/proof.md, section 6). It computes the L1 norm of the kernels
//! from every input to every body point, backwards from each station.
//!
//! The bounds hold to second order, as those of the filter in `step` do. To first order they are exact. The adjoint
//! costs about twenty times the filter, so the caller says where it is worth its time. It handles one vehicle at a
//! time, with body points in lanes.

mod backwards;
mod history;
mod outputs;
mod refine;
mod settle;
mod trail;
mod worth;

pub(super) use refine::{Refined, refine};
pub(super) use trail::{Histories, Trail, close};
pub(super) use worth::first_loose;
