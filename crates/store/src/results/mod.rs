//! Tables of certificates: how they are stored, written in order, and read again.

pub(crate) mod at_time;
pub(crate) mod carry_over;
pub(crate) mod checkpoint;
pub(crate) mod compact;
pub(crate) mod complete;
pub(crate) mod numbers;
pub(crate) mod pages;
pub(crate) mod plans;
pub(crate) mod predicate;
pub(crate) mod query;
pub(crate) mod relative;
pub(crate) mod sets;
pub(crate) mod settings;
pub(crate) mod stats;
pub(crate) mod stream;
pub(crate) mod turns;
pub(crate) mod verdicts;
pub(crate) mod write_order;
