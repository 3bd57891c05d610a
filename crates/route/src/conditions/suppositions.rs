//! Widths and kerb radii that are supposed along a way, and the conditions that they are.

use std::collections::BTreeMap;
use std::sync::Arc;

use rustc_hash::FxHashSet;

use super::way_roads::roads;
use super::{Condition, ConditionAt, width_of};
use crate::certify::KERBS_M;
use crate::evidence::Quantity;
use crate::network::{self, Edge, EdgeNo, Network};
use crate::osm::facts::{CrossSection, Policy, WidthSource};
use crate::osm::{LonLat, NodeId};
use crate::turns::Kerbs;

/// How far around its nodes a junction is supposed to be paved, metres.
pub(super) const PAVED_M: [f64; 10] = [6.0, 8.0, 10.0, 12.0, 14.0, 16.0, 18.0, 20.0, 25.0, 30.0];
/// Less than what a road lacks, as shares of it.
const WIDTH_SHARES: [f64; 3] = [0.25, 0.5, 0.75];
/// Widths are supposed in these parts of a metre, and kerb radii in these.
const WIDTHS: f64 = 20.0;
const RADII: f64 = 2.0;

/// What single precision may take of a measured width at most, metres.
const ROUNDING_M: f64 = 1e-5;

/// What is supposed. Every value is a whole number of its parts.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Suppositions {
    /// What is known of places anyway.
    base: Arc<network::Site>,
    /// By edge and strip, metres.
    pub(super) widths_m: BTreeMap<(EdgeNo, Policy), f64>,
    /// By node, edge that ends and edge that begins there, metres.
    kerbs_m: BTreeMap<(NodeId, [EdgeNo; 2]), f64>,
    /// By node: the position of the node, and how far around it everything is paved, metres.
    paved_m: BTreeMap<NodeId, (LonLat, f64)>,
}

impl Suppositions {
    /// Nothing is supposed beyond what is known.
    pub(crate) fn new(base: Arc<network::Site>) -> Self {
        Self { base, widths_m: BTreeMap::new(), kerbs_m: BTreeMap::new(), paved_m: BTreeMap::new() }
    }

    /// Supposes that an edge's strip is at least so wide. Returns whether that is more than before.
    pub(crate) fn widen(&mut self, network: &Network, edge: EdgeNo, strip: Policy, width_m: f64) -> bool {
        let width_m = in_steps(width_m);
        if self.width_m(network, edge, strip).is_none_or(|has_m| has_m >= width_m - ROUNDING_M) {
            return false;
        }
        self.widths_m.insert((edge, strip), width_m);
        true
    }

    /// The width of an edge's strip under the suppositions, metres. `None` if it is not known at all.
    pub(crate) fn width_m(&self, network: &Network, edge: EdgeNo, strip: Policy) -> Option<f64> {
        let supposed_m = self.widths_m.get(&(edge, strip)).copied();
        supposed_m.or_else(|| self.known_width_m(network, edge, strip))
    }

    /// Supposes that a corner has at least this radius.
    pub(crate) fn round(&mut self, node: NodeId, between: [EdgeNo; 2], radius_m: f64) {
        let radius_m = (radius_m * RADII - 1e-6).ceil() / RADII;
        let known_m = self.kerbs_m.entry((node, between)).or_insert(radius_m);
        *known_m = known_m.max(radius_m);
    }

    /// Supposes that everything is paved up to this distance from a node.
    pub(crate) fn pave(&mut self, node: NodeId, at: LonLat, radius_m: f64) {
        let paved = self.paved_m.entry(node).or_insert((at, radius_m));
        paved.1 = paved.1.max(radius_m);
    }

    /// How far around a node everything is supposed to be paved, metres.
    pub(crate) fn paved_m(&self, node: NodeId) -> Option<f64> {
        self.paved_m.get(&node).map(|paved| paved.1)
    }

    /// The radius supposed for a corner, metres.
    pub(crate) fn radius_m(&self, node: NodeId, between: [EdgeNo; 2]) -> Option<f64> {
        self.kerbs_m.get(&(node, between)).copied()
    }

    /// The width of an edge's strip without the suppositions, metres.
    pub(crate) fn known_width_m(&self, network: &Network, edge: EdgeNo, strip: Policy) -> Option<f64> {
        let edge = network.edges.get(edge.index())?;
        let section = self.base.section(edge).unwrap_or_else(|| network.mapped_section(edge));
        Some(f64::from(section.strip(strip)?.width_m()))
    }

    /// Makes everything supposed hold on a network.
    pub(crate) fn apply(&self, network: &mut Network) {
        network.site = self.site(network);
    }

    fn site(&self, network: &Network) -> network::Site {
        let mut site = network::Site::clone(&self.base);
        let mut widths_m = self.widths_m.iter().peekable();
        while let Some((&(edge, _), _)) = widths_m.peek().copied() {
            let mut of_edge = [None; 3];
            while let Some((&(_, strip), &width_m)) = widths_m.next_if(|((other, _), _)| *other == edge) {
                of_edge[strip as usize] = Some(width_m);
            }
            let Some(edge) = network.edges.get(edge.index()) else { continue };
            site.set_section(edge, self.section(network, edge, of_edge));
        }
        for (&(node, [from, to]), &radius_m) in &self.kerbs_m {
            if let (Some(from), Some(to)) = (network.edges.get(from.index()), network.edges.get(to.index())) {
                site.set_kerb(node, Some([from, to]), radius_m);
            }
        }
        for (&node, &(at, radius_m)) in &self.paved_m {
            site.add_surface(node, disc(at, radius_m));
        }
        site
    }

    /// The cross section of an edge with the widths supposed, metres, in the order of [`Policy`]: what the register makes of measurements with
    /// these values beside those that it has.
    fn section(&self, network: &Network, edge: &Edge, supposed_m: [Option<f64>; 3]) -> CrossSection {
        let mapped = network.mapped_section(edge);
        let known = self.base.section(edge).unwrap_or(mapped);
        let mut widths_m = [None; 3];
        for strip in [Policy::Lane, Policy::Direction, Policy::Carriageway] {
            let has = known.strip(strip);
            let has_m = has.map(|strip| f64::from(strip.width_m()));
            let measured_m = has_m.filter(|_| has.is_some_and(|strip| strip.source == WidthSource::Surveyed));
            // What is as wide anyway is no condition, and nobody measures it.
            let beyond = |m: &f64| has_m.is_some_and(|has_m| has_m < m - ROUNDING_M);
            widths_m[strip as usize] = supposed_m[strip as usize].filter(beyond).or(measured_m);
        }
        mapped.with_widths(widths_m, WidthSource::Surveyed)
    }

    /// The widths alone that are supposed for some edges.
    pub(super) fn widths_of(&self, edges: &[EdgeNo]) -> Self {
        let mut own = Self::new(Arc::clone(&self.base));
        own.widths_m =
            self.widths_m.iter().filter(|((edge, _), _)| edges.contains(edge)).map(|(k, v)| (*k, *v)).collect();
        own
    }

    /// The same with less supposed for a condition, from little to little less than it asks.
    pub(super) fn less(&self, condition: &Condition) -> impl Iterator<Item = Self> {
        let (most_m, least_m) = (condition.needed_m, condition.assumed_m.unwrap_or(0.0));
        let fewer: Vec<f64> = match condition.at {
            ConditionAt::Junction(_) => PAVED_M.to_vec(),
            ConditionAt::Corner { .. } => KERBS_M.to_vec(),
            ConditionAt::Road(_) => WIDTH_SHARES.map(|share| least_m + share * (most_m - least_m)).to_vec(),
        };
        let fewer = fewer.into_iter().filter(move |&m| least_m < m && m < most_m);
        fewer.map(|m| self.with_only(condition, m))
    }

    /// The same with another value for a condition; 0: without it.
    pub(super) fn with_only(&self, condition: &Condition, value_m: f64) -> Self {
        let mut other = self.clone();
        let some = value_m > 0.0;
        match &condition.at {
            ConditionAt::Road(edges) => other.widths_m.retain(|(edge, strip), width_m| {
                let meant = edges.contains(edge) && width_of(*strip) == condition.quantity;
                if meant {
                    *width_m = in_steps(value_m);
                }
                !meant || some
            }),
            ConditionAt::Corner { node, between } => {
                other.kerbs_m.remove(&(*node, *between));
                if some {
                    other.round(*node, *between, value_m);
                }
            }
            ConditionAt::Junction(node) if some => {
                if let Some(paved) = other.paved_m.get_mut(node) {
                    paved.1 = value_m;
                }
            }
            ConditionAt::Junction(node) => {
                other.paved_m.remove(node);
            }
        }
        other
    }

    /// What is supposed here and not in `less`.
    pub(crate) fn beyond(&self, less: &Self) -> Self {
        let mut own = self.clone();
        own.widths_m.retain(|key, value| less.widths_m.get(key) != Some(value));
        own.kerbs_m.retain(|key, value| less.kerbs_m.get(key) != Some(value));
        own.paved_m.retain(|key, value| less.paved_m.get(key) != Some(value));
        own
    }

    /// Supposes what others suppose, too. The greater value counts.
    pub(crate) fn add(&mut self, other: &Self) {
        for (&key, &m) in &other.widths_m {
            let known_m = self.widths_m.entry(key).or_insert(m);
            *known_m = known_m.max(m);
        }
        for (&(node, between), &m) in &other.kerbs_m {
            self.round(node, between, m);
        }
        for (&node, &(at, m)) in &other.paved_m {
            self.pave(node, at, m);
        }
    }

    /// The same with what others suppose, too.
    pub(super) fn with(&self, other: &Self) -> Self {
        let mut both = self.clone();
        both.add(other);
        both
    }

    /// Gives both ways round a corner the greater of their radii: there is one kerb.
    pub(crate) fn level_corners(&mut self, network: &Network) {
        let kerb = |&(node, between): &(NodeId, [EdgeNo; 2])| {
            let [from, to] = between.map(|edge| network.edges.get(edge.index()));
            Some((node, network::pieces([from?, to?])))
        };
        let mut most: BTreeMap<_, f64> = BTreeMap::new();
        for (key, &radius_m) in &self.kerbs_m {
            let known_m = most.entry(kerb(key)).or_insert(radius_m);
            *known_m = known_m.max(radius_m);
        }
        for (key, radius_m) in &mut self.kerbs_m {
            *radius_m = most.get(&kerb(key)).copied().unwrap_or(*radius_m);
        }
    }

    /// Whether another value than in `other` is supposed for a place that `other` supposes something for.
    pub(crate) fn raises(&self, other: &Self) -> bool {
        other.widths_m.iter().any(|(key, value)| self.widths_m.get(key) != Some(value))
            || other.kerbs_m.iter().any(|(key, value)| self.kerbs_m.get(key) != Some(value))
            || other.paved_m.iter().any(|(key, value)| self.paved_m.get(key) != Some(value))
    }

    /// The edges of a way whose width is supposed.
    pub(super) fn wider_edges<'w>(&'w self, way: &'w [EdgeNo]) -> impl Iterator<Item = EdgeNo> + 'w {
        let wider = |edge: EdgeNo| self.widths_m.range((edge, Policy::Lane)..=(edge, Policy::Carriageway)).next();
        way.iter().copied().filter(move |&edge| wider(edge).is_some())
    }

    /// The edges of a way at which something is supposed.
    pub(super) fn edges_of<'w>(&'w self, network: &'w Network, way: &'w [EdgeNo]) -> impl Iterator<Item = EdgeNo> + 'w {
        let paved = |edge: &Edge| [edge.from_node, edge.to_node].iter().any(|node| self.paved_m.contains_key(node));
        way.iter().copied().filter(move |&edge| {
            self.widths_m.range((edge, Policy::Lane)..=(edge, Policy::Carriageway)).next().is_some()
                || self.kerbs_m.keys().any(|(_, between)| between.contains(&edge))
                || network.edges.get(edge.index()).is_some_and(paved)
        })
    }

    /// The edges whose widths differ from other suppositions.
    pub(crate) fn differing_edges(&self, other: &Self) -> FxHashSet<EdgeNo> {
        differing(&self.widths_m, &other.widths_m).map(|(edge, _)| edge).collect()
    }

    /// The positions of the nodes at which something else than a width differs from other suppositions.
    pub(super) fn differing_nodes(&self, other: &Self, network: &Network) -> Vec<LonLat> {
        let end = |edge: EdgeNo| network.edges.get(edge.index()).and_then(|edge| network.positions(edge).next_back());
        let corners = differing(&self.kerbs_m, &other.kerbs_m).filter_map(|(_, [from, _])| end(from));
        let paved = differing(&self.paved_m, &other.paved_m);
        let paved = paved.filter_map(|node| self.paved_m.get(&node).or(other.paved_m.get(&node)).map(|paved| paved.0));
        corners.chain(paved).collect()
    }

    /// The conditions in the order of a way, on a network on which nothing is supposed. Edges of one road that need the same are one
    /// condition, also where edges between them need nothing.
    pub(crate) fn conditions(&self, network: &Network, kerbs: &Kerbs, way: &[EdgeNo]) -> Vec<Condition> {
        let mut found: Vec<(usize, Condition)> = Vec::new();
        // By road, strip and width: the place of its condition.
        let mut of_road: BTreeMap<(usize, Policy, u64), usize> = BTreeMap::new();
        for ((i, edge), road) in way.iter().enumerate().zip(roads(network, way)) {
            for (&(_, strip), &needed_m) in self.widths_m.range((*edge, Policy::Lane)..=(*edge, Policy::Carriageway)) {
                // What is as wide anyway need not be measured.
                let known_m = self.known_width_m(network, *edge, strip);
                let Some(assumed_m) = known_m.filter(|has_m| *has_m < needed_m - ROUNDING_M) else { continue };
                let place = *of_road.entry((road, strip, needed_m.to_bits())).or_insert(found.len());
                if let Some((_, condition)) = found.get_mut(place) {
                    condition.assumed_m = condition.assumed_m.map(|known_m| known_m.min(assumed_m));
                    if let ConditionAt::Road(edges) = &mut condition.at
                        && !edges.contains(edge)
                    {
                        edges.push(*edge);
                    }
                    continue;
                }
                let at = ConditionAt::Road(vec![*edge]);
                let quantity = width_of(strip);
                found.push((i, Condition { quantity, at, assumed_m: Some(assumed_m), needed_m, attested_by: None }));
            }
        }
        for (&(node, between), &needed_m) in &self.kerbs_m {
            let edges = between.map(|edge| network.edges.get(edge.index()));
            let [Some(from), Some(to)] = edges else { continue };
            let assumed_m = kerbs.at(network, node, [from, to]);
            let place = way.iter().position(|edge| between.contains(edge)).unwrap_or(way.len());
            let at = ConditionAt::Corner { node, between };
            let (quantity, assumed_m) = (Quantity::KerbRadius, Some(assumed_m));
            found.push((place, Condition { quantity, at, assumed_m, needed_m, attested_by: None }));
        }
        for (&node, &(_, needed_m)) in &self.paved_m {
            let meets = |edge: &EdgeNo| network.edges.get(edge.index()).is_some_and(|edge| edge.to_node == node);
            let place = way.iter().position(meets).unwrap_or(way.len());
            let at = ConditionAt::Junction(node);
            let quantity = Quantity::Surface;
            found.push((place, Condition { quantity, at, assumed_m: None, needed_m, attested_by: None }));
        }
        found.sort_by_key(|(place, _)| *place);
        found.into_iter().map(|(_, condition)| condition).collect()
    }
}

/// A width, rounded up to a whole number of its parts.
fn in_steps(width_m: f64) -> f64 {
    (width_m * WIDTHS - 1e-6).ceil() / WIDTHS
}

/// The keys whose values differ, or that only one of both has.
fn differing<K: Copy + Ord, V: PartialEq>(a: &BTreeMap<K, V>, b: &BTreeMap<K, V>) -> impl Iterator<Item = K> {
    let of_a = a.iter().filter(|(key, value)| b.get(*key) != Some(*value)).map(|(key, _)| *key);
    let of_b = b.keys().filter(|key| !a.contains_key(*key)).copied();
    of_a.chain(of_b)
}

/// A closed polygon within a circle around a position.
pub(crate) fn disc(at: LonLat, radius_m: f64) -> Vec<LonLat> {
    const CORNERS: u32 = 48;
    /// A degree of latitude is nowhere shorter, metres. The sphere that it belongs to makes no circle too large by a hundredth.
    const DEGREE_M: f64 = 110_574.0;
    const WITHIN: f64 = 0.985;
    let (lon, lat) = at.degrees();
    let corner = |k: u32| {
        let (sin, cos) = (f64::from(k % CORNERS) / f64::from(CORNERS) * std::f64::consts::TAU).sin_cos();
        let degrees = WITHIN * radius_m / (1.01 * DEGREE_M);
        let east = degrees * cos / lat.to_radians().cos().max(0.01);
        let e7 = |degrees: f64| (degrees * 1e7).round() as i32;
        LonLat { lon_e7: e7(lon + east), lat_e7: e7(lat + degrees * sin) }
    };
    (0..=CORNERS).map(corner).collect()
}
