//! The paper's figures.
use super::simulate::Simulated;
use super::timing::Timing;
pub(super) fn all(_s: &[Simulated], _t: Option<&Timing>) -> Vec<(&'static str, String)> { Vec::new() }
