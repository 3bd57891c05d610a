//! A certified route, and what its parts are: their leeway, and the roads that are not open to every journey.

use std::ops::Range;

use super::assemble::{PartKind, RoutePart, RoutePath};
use super::drive::Drive;
use super::strip_use::StripUse;
use super::title::title;
use crate::network::{Edge, Network, destination_tag};
use crate::osm::facts::{At, Policy};
use crate::stet::{Certificate, known_m};
use crate::vehicle::Vehicle;
use crate::verdict::{UnknownReason, Verdict};

/// A certified route.
#[derive(Debug, Clone)]
pub struct Route {
    /// The edges.
    pub drive: Drive,
    /// The share of the first edge before the route's beginning, 0..=1.
    pub start: f64,
    /// The share of the last edge up to the route's end, 0..=1.
    pub end: f64,
    /// The cost in the planner's measure, milliseconds or millimetres.
    pub cost: u64,
    /// The time by the table of speeds, seconds.
    pub time_s: f64,
    /// The length along the corridor, metres.
    pub length_m: f64,
    /// Length of the vehicle when straight, metres.
    pub vehicle_length_m: f64,
    /// The whole corridor.
    pub path: RoutePath,
    /// The certificate of the whole corridor. It is safe.
    pub certificate: Certificate,
    /// Where the vehicle may use more of the road than its own lane, in driving order.
    pub uses: Vec<StripUse>,
}

/// A stretch of a route with its least leeway.
#[derive(Debug, Clone, PartialEq)]
pub struct PartResult {
    /// The kind of part.
    pub kind: PartKind,
    /// Beginning of the part, metres from the route's beginning.
    pub from_m: f64,
    /// End of the part, metres from the route's beginning.
    pub to_m: f64,
    /// The least leeway of any body on the part, metres, after all bounds are deducted, with at most the tracking tolerance of
    /// the whole route's certificate. It is never below the whole route's RSC. `None` if no body passes the part.
    pub rsc_m: Option<f64>,
}

/// A stretch of a route on a road that is not open to every journey at any time.
#[derive(Debug, Clone, PartialEq)]
pub struct LimitedStretch {
    /// The road.
    pub title: String,
    /// The tag that says so.
    pub tag: String,
    /// Beginning, metres from the route's beginning.
    pub from_m: f64,
    /// End, metres from the route's beginning.
    pub to_m: f64,
}

impl Route {
    /// The widest strip that the vehicle may use anywhere on the route.
    #[must_use]
    pub fn rung(&self) -> Policy {
        self.uses.iter().map(|used| used.strip).max().unwrap_or(Policy::Lane)
    }

    /// The parts in driving order.
    #[must_use]
    pub fn parts(&self) -> Vec<PartResult> {
        let spacing_m = self.path.corridor.spacing_m;
        let certificate = &self.certificate;
        let part = |part: &RoutePart| {
            let stations = self.noted(&part.stations);
            let own = |column: &[f64]| column.get(stations.clone()).unwrap_or_default().to_vec();
            let both = own(&certificate.left_m).into_iter().chain(own(&certificate.right_m));
            let least = both.filter_map(known_m).min_by(f64::total_cmp);
            PartResult {
                kind: part.kind,
                from_m: part.stations.start as f64 * spacing_m,
                to_m: part.stations.end.saturating_sub(1) as f64 * spacing_m,
                rsc_m: least.map(|least| certificate.result.rsc_m.map_or(least, |rsc_m| least.max(rsc_m))),
            }
        };
        self.path.parts.iter().map(part).collect()
    }

    /// The parts in driving order with their titles. Consecutive edges of one road are one part.
    #[must_use]
    pub fn titled_parts(&self, network: &Network) -> Vec<(PartResult, String)> {
        let mut rows: Vec<(PartResult, String)> = Vec::new();
        for part in self.parts() {
            let title = title(network, part.kind);
            match rows.last_mut() {
                Some((last, known)) if !last.kind.is_turn() && !part.kind.is_turn() && *known == title => {
                    last.to_m = part.to_m;
                    last.rsc_m = last.rsc_m.into_iter().chain(part.rsc_m).reduce(f64::min);
                }
                _ => rows.push((part, title)),
            }
        }
        rows
    }

    /// The stations at which the certificate notes leeways of a part. In areas it notes the least leeway of a vehicle's place at one
    /// station under the vehicle, which may belong to the part beside. Feet are at most twice the vehicle's length apart.
    fn noted(&self, part: &Range<usize>) -> Range<usize> {
        let corridor = &self.path.corridor;
        let near = (2.0 * self.vehicle_length_m / corridor.spacing_m).ceil() as usize;
        let wider = part.start.saturating_sub(near)..(part.end + near).min(corridor.len());
        let meets = |heads: &Range<usize>| heads.start < wider.end && heads.end > wider.start;
        if corridor.areas.iter().any(|span| meets(&span.heads)) { wider } else { part.clone() }
    }

    /// At how many places the route stands beyond all lanes of its direction, and for how many metres.
    #[must_use]
    pub fn beyond_all_lanes(&self) -> (usize, f64) {
        let oncoming = self.uses.iter().filter(|used| used.strip == Policy::Carriageway);
        oncoming.fold((0, 0.0), |(places, metres), used| (places + 1, metres + used.to_m - used.from_m))
    }

    /// The stretches on roads that are open to a destination only ([`destination_tag`]).
    #[must_use]
    pub fn destination_only(&self, network: &Network, vehicle: &Vehicle) -> Vec<LimitedStretch> {
        self.stretches(network, |edge| destination_tag(network, edge, vehicle))
    }

    /// The stretches on roads that are closed to the vehicle at some times. A route has them only if it was asked for a time.
    #[must_use]
    pub fn only_at_times(&self, network: &Network, vehicle: &Vehicle) -> Vec<LimitedStretch> {
        self.stretches(network, |edge| {
            let judged = network.legal(edge).judge(vehicle, At::Always);
            judged.rule.filter(|_| judged.verdict == Some(Verdict::Unknown(UnknownReason::Time)))
        })
    }

    /// The stretches on edges that have a tag of this kind.
    fn stretches(&self, network: &Network, tag_of: impl Fn(&Edge) -> Option<String>) -> Vec<LimitedStretch> {
        let spacing_m = self.path.corridor.spacing_m;
        let mut stretches: Vec<LimitedStretch> = Vec::new();
        for part in &self.path.parts {
            let PartKind::Edge(no) = part.kind else { continue };
            let Some(edge) = network.edges.get(no.index()) else { continue };
            let Some(tag) = tag_of(edge) else { continue };
            let from_m = part.stations.start as f64 * spacing_m;
            let to_m = part.stations.end.saturating_sub(1) as f64 * spacing_m;
            let title = network.title(edge);
            match stretches.last_mut() {
                Some(last) if last.title == title && last.tag == tag && from_m - last.to_m <= spacing_m => {
                    last.to_m = to_m;
                }
                _ => stretches.push(LimitedStretch { title, tag, from_m, to_m }),
            }
        }
        stretches
    }

    /// The part with the least leeway of the whole route.
    #[must_use]
    pub fn limiting(&self) -> Option<PartKind> {
        let station = self.certificate.result.limiting.station;
        self.path.parts.iter().find(|part| part.stations.contains(&station)).map(|part| part.kind)
    }

    /// The place of the least leeway, metres from the route's beginning.
    #[must_use]
    pub fn limiting_m(&self) -> f64 {
        self.certificate.result.limiting.station as f64 * self.path.corridor.spacing_m
    }
}
