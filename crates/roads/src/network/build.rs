//! From an extract to a network.

use super::{Ground, Network, NetworkAccount, StrokeOptions};
use crate::osm::facts::{CrossSection, Jurisdiction, WayFacts};
use crate::osm::{Extract, LonLat};

/// As [`build_with`], with default strokes.
pub fn build(
    extract: Extract,
    jurisdictions: &(impl Fn(LonLat) -> Jurisdiction + Sync),
    sections: &(impl Fn(&WayFacts, &Jurisdiction, Option<f64>) -> [CrossSection; 2] + Sync),
) -> (Network, NetworkAccount) {
    build_with(extract, jurisdictions, sections, &StrokeOptions::default())
}

/// Cuts an extract's ways into directed edges and chains them into strokes.
///
/// `places` returns the country rules at a position. It is called once per way, at the way's first located node.
/// `sections` returns a way's strips along its node order and against it. It also gets the radius (metres) of the ring
/// that a roundabout's way is part of.
pub fn build_with(
    extract: Extract,
    jurisdictions: &(impl Fn(LonLat) -> Jurisdiction + Sync),
    sections: &(impl Fn(&WayFacts, &Jurisdiction, Option<f64>) -> [CrossSection; 2] + Sync),
    options: &StrokeOptions,
) -> (Network, NetworkAccount) {
    let (portion, account) = Ground::new(extract, jurisdictions, sections, *options).whole();
    (portion.network, account)
}
