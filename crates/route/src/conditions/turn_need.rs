//! What a turn on a way needs: kerb radii, or wider roads before and after it.

use std::sync::Arc;

use super::suppositions::{PAVED_M, Suppositions};
use crate::certify::{KERBS_M, best_of, fits, flares, least_of};
use crate::drive::{Drive, Join};
use crate::driver::Driver;
use crate::network::{EdgeNo, Movement, Network};
use crate::osm::facts::Policy;
use crate::osm::{LonLat, NodeId};
use crate::settings::Settings;
use crate::stet::Model;
use crate::turns::{LengthClass, StrokeLine, TurnCorridors, TurnEdges, TurnPlanner, turn_on};
use crate::verdict::UnknownReason;

/// The kerb radius that is supposed together with wider roads, if neither alone is enough, metres.
const KERB_WITH_FLARE_M: f64 = 12.0;
/// How far around its nodes a junction is supposed to be paved together with wider roads, metres.
const PAVED_WITH_FLARE_M: f64 = 20.0;
/// If the best simple path lacks more than this where everything is as wide as it may be, no other is looked for, metres.
const HOPELESS_M: f64 = 1.0;

/// A turn or passage of a way, on a network of its own.
pub(crate) struct Turning<'a> {
    pub(crate) driver: Arc<Driver>,
    pub(crate) drive: &'a Drive,
    pub(crate) join: Join<'a>,
    pub(crate) movement: Movement,
    /// The strokes of edges, by index.
    pub(crate) stroke_of: Arc<[u32]>,
}

/// How hard to look for a path.
#[derive(Clone, Copy)]
enum Look {
    Cheap,
    Thorough,
}

impl Turning<'_> {
    /// The corners of the turn: node, edge that ends, edge that begins there.
    pub(crate) fn corners(&self, network: &Network) -> Vec<(NodeId, [EdgeNo; 2])> {
        let Join { from, arcs, to, .. } = self.join;
        let node = |edge: EdgeNo, end: bool| {
            network
                .edges
                .get(edge.index())
                .map_or(NodeId::new(0), |edge| if end { edge.to_node } else { edge.from_node })
        };
        match (arcs.first(), arcs.last()) {
            (Some(&first), Some(&last)) => vec![(node(from, true), [from, first]), (node(to, false), [last, to])],
            _ => vec![(node(from, true), [from, to])],
        }
    }

    /// The edges of the way before and after the turn on which its corridor lies.
    pub(crate) fn near(&self, network: &Network) -> Vec<EdgeNo> {
        let Some(reach) = LengthClass::of(&self.driver.model.vehicle) else { return Vec::new() };
        let edges = &self.drive.edges;
        let stroke = |edge: EdgeNo| self.stroke_of.get(edge.index());
        let length_m = |edge: EdgeNo| network.edges.get(edge.index()).map_or(0.0, |edge| network.length_m(edge));
        let within = |found: &mut Vec<EdgeNo>, all: &mut dyn Iterator<Item = EdgeNo>, most_m: f64, of: EdgeNo| {
            let mut sum_m = 0.0;
            for edge in all.take_while(|&edge| stroke(edge) == stroke(of)) {
                found.push(edge);
                sum_m += length_m(edge);
                if sum_m >= most_m {
                    break;
                }
            }
        };
        let mut found = Vec::new();
        let before = self.join.at - self.join.arcs.len();
        within(&mut found, &mut edges[..before].iter().rev().copied(), reach.counted_before_m(), self.join.from);
        within(&mut found, &mut edges[self.join.at..].iter().copied(), reach.counted_after_m(), self.join.to);
        found
    }

    /// Of suppositions, those that are widths of the roads beside the turn.
    pub(super) fn widths(&self, network: &Network, supposed: &Suppositions) -> Suppositions {
        supposed.widths_of(&self.near(network))
    }

    /// The widths of the roads beside the turn in centimetres, under suppositions.
    pub(crate) fn widths_cm(&self, network: &Network, supposed: &Suppositions) -> Vec<i64> {
        let policies = [self.settings().policy, self.strip()];
        let width =
            |edge: EdgeNo, strip: Policy| supposed.width_m(network, edge, strip).map_or(-1, |m| (100.0 * m) as i64);
        self.near(network).into_iter().flat_map(|edge| policies.map(|strip| width(edge, strip))).collect()
    }

    /// Whether the turn is safe on the network as it is.
    pub(crate) fn is_safe(&self, network: &Network) -> bool {
        self.passes(network, Look::Thorough)
    }

    fn passes(&self, network: &Network, look: Look) -> bool {
        let Some(made) = self.made(network) else { return false };
        let (model, options): (&Model, _) = (&self.driver.model, &self.settings().stet);
        fits(&made, model, options)
            || matches!(look, Look::Thorough)
                && best_of(&made, &[model], options).pop().flatten().is_some_and(|(_, result)| result.safe())
    }

    fn settings(&self) -> &Settings {
        &self.driver.permits.settings
    }

    fn made(&self, network: &Network) -> Option<TurnCorridors> {
        let settings = self.settings();
        let reach = LengthClass::of(&self.driver.model.vehicle)?;
        let driven = [self.join.from, self.join.to].into_iter().chain(self.join.arcs.iter().copied());
        let mut lines: Vec<StrokeLine> = Vec::new();
        for edge in driven {
            let stroke = *self.stroke_of.get(edge.index())?;
            if lines.iter().all(|line| line.stroke != stroke) {
                lines.push(StrokeLine::new(network, stroke, settings.policy, &settings.corridor).ok()?);
            }
        }
        let line = |edge: EdgeNo| {
            let stroke = self.stroke_of.get(edge.index()).copied();
            lines.iter().find(|line| Some(line.stroke) == stroke).ok_or(UnknownReason::Geometry)
        };
        let turn = TurnEdges { movement: self.movement, through: self.join.arcs };
        turn_on(network, turn, &line, settings.policy, &settings.turn_params(), reach).ok()
    }

    /// Adds to `supposed` the least that makes the turn safe: a kerb radius, else a paved junction, else wider roads beside it, else all
    /// of that. Returns whether something does. The site of `network` changes.
    pub(crate) fn meet(&self, network: &mut Network, supposed: &mut Suppositions) -> bool {
        let generous = self.generous(network, supposed);
        generous.apply(network);
        let Some(look) = self.look(network) else { return false };
        // What has to be checked at one place comes before what has to be checked along a road.
        self.by_kerb(network, supposed, look)
            || self.by_paving(network, supposed, look)
            || self.by_flare(network, supposed, look)
            || {
                // Between the steps that are tried and all of them at once.
                *supposed = generous;
                true
            }
    }

    /// Supposes everything at its greatest, if a path can then be driven. Its own certificate need not be safe: the whole way decides.
    pub(super) fn hope(&self, network: &mut Network, supposed: &mut Suppositions) -> bool {
        let generous = self.generous(network, supposed);
        generous.apply(network);
        let seeds = |made: TurnCorridors| TurnPlanner::new(&made).best_seeds(&self.driver.model.vehicle, 1);
        let driven = self.made(network).is_some_and(|made| !seeds(made).is_empty());
        *supposed = generous;
        driven
    }

    /// The suppositions with everything at its greatest.
    fn generous(&self, network: &Network, supposed: &Suppositions) -> Suppositions {
        let mut generous = self.rounded(&self.corners(network), supposed, KERB_WITH_FLARE_M);
        for (node, at) in self.nodes(network) {
            generous.pave(node, at, PAVED_WITH_FLARE_M);
        }
        if let Some(width_m) = self.flares(network, supposed).and_then(|widths| widths.last().copied()) {
            for edge in self.near(network) {
                generous.widen(network, edge, self.strip(), width_m);
            }
        }
        generous
    }

    /// How hard one has to look to find a path. `None` if none is found.
    fn look(&self, network: &Network) -> Option<Look> {
        let made = self.made(network)?;
        let (model, options): (&Model, _) = (&self.driver.model, &self.settings().stet);
        if fits(&made, model, options) {
            return Some(Look::Cheap);
        }
        let seeds = TurnPlanner::new(&made).best_seeds(&model.vehicle, 1);
        let near = seeds.first().is_some_and(|seed| seed.score_m >= -HOPELESS_M);
        (near && self.passes(network, Look::Thorough)).then_some(Look::Thorough)
    }

    fn by_kerb(&self, network: &mut Network, supposed: &mut Suppositions, look: Look) -> bool {
        supposed.apply(network);
        let corners = self.corners(network);
        let has_m = corners.iter().filter_map(|&(node, between)| self.radius_m(network, node, between));
        let has_m = has_m.fold(f64::INFINITY, f64::min);
        let radii: Vec<f64> = KERBS_M.iter().copied().filter(|&radius_m| radius_m > has_m).collect();
        let does = |&radius_m: &f64| self.holds(network, &self.rounded(&corners, supposed, radius_m), look);
        let Some(radius_m) = least_of(&radii, does) else { return false };
        *supposed = self.rounded(&corners, supposed, radius_m);
        true
    }

    fn by_flare(&self, network: &mut Network, supposed: &mut Suppositions, look: Look) -> bool {
        let corners = self.corners(network);
        let Some(widths) = self.flares(network, supposed) else { return false };
        let mut paved = supposed.clone();
        self.nodes(network).into_iter().for_each(|(node, at)| paved.pave(node, at, PAVED_WITH_FLARE_M));
        for base_of in [supposed.clone(), self.rounded(&corners, supposed, KERB_WITH_FLARE_M), paved] {
            if let Some(wider) = self.flared(network, &base_of, &widths, look) {
                *supposed = wider;
                return true;
            }
        }
        false
    }

    /// The least of some widths of the roads beside the turn, added to suppositions.
    fn flared(
        &self,
        network: &mut Network,
        base_of: &Suppositions,
        widths: &[f64],
        look: Look,
    ) -> Option<Suppositions> {
        let (near, strip) = (self.near(network), self.strip());
        let wide = |network: &Network, width_m: f64| {
            let mut wider = base_of.clone();
            for &edge in &near {
                wider.widen(network, edge, strip, width_m);
            }
            wider
        };
        let does = |&width_m: &f64| {
            let wider = wide(network, width_m);
            self.holds(network, &wider, look)
        };
        let width_m = least_of(widths, does)?;
        Some(wide(network, width_m))
    }

    fn by_paving(&self, network: &mut Network, supposed: &mut Suppositions, look: Look) -> bool {
        let nodes = self.nodes(network);
        let paved = |supposed: &Suppositions, radius_m: f64| {
            let mut paved = supposed.clone();
            nodes.iter().for_each(|&(node, at)| paved.pave(node, at, radius_m));
            paved
        };
        let does = |&radius_m: &f64| self.holds(network, &paved(supposed, radius_m), look);
        let Some(radius_m) = least_of(&PAVED_M, does) else { return false };
        *supposed = paved(supposed, radius_m);
        true
    }

    /// The nodes at which the vehicle turns, with their positions.
    pub(crate) fn nodes(&self, network: &Network) -> Vec<(NodeId, LonLat)> {
        let end = |edge: EdgeNo, end: bool| {
            let edge = network.edges.get(edge.index())?;
            let mut line = network.positions(edge);
            let at = if end { line.next_back()? } else { line.next()? };
            Some((if end { edge.to_node } else { edge.from_node }, at))
        };
        let mut nodes: Vec<(NodeId, LonLat)> =
            [end(self.join.from, true), end(self.join.to, false)].into_iter().flatten().collect();
        nodes.dedup_by_key(|(node, _)| *node);
        nodes
    }

    /// Widths to try for the roads beside the turn, metres.
    fn flares(&self, network: &Network, supposed: &Suppositions) -> Option<Vec<f64>> {
        let ends = [self.join.from, self.join.to];
        let has_m = ends.into_iter().map(|edge| supposed.width_m(network, edge, self.strip()));
        let has_m = has_m.collect::<Option<Vec<f64>>>()?.into_iter().fold(f64::INFINITY, f64::min);
        Some(flares(has_m))
    }

    /// The strip that counts near turns.
    pub(crate) fn strip(&self) -> Policy {
        let settings = self.settings();
        settings.turn_policy.max(settings.policy)
    }

    fn rounded(&self, corners: &[(NodeId, [EdgeNo; 2])], supposed: &Suppositions, radius_m: f64) -> Suppositions {
        let mut rounded = supposed.clone();
        for &(node, between) in corners {
            rounded.round(node, between, radius_m);
        }
        rounded
    }

    fn radius_m(&self, network: &Network, node: NodeId, [from, to]: [EdgeNo; 2]) -> Option<f64> {
        let (from, to) = (network.edges.get(from.index())?, network.edges.get(to.index())?);
        Some(self.settings().kerbs.at(network, node, [from, to]))
    }

    /// Whether the turn is safe under suppositions.
    fn holds(&self, network: &mut Network, supposed: &Suppositions, look: Look) -> bool {
        supposed.apply(network);
        self.passes(network, look)
    }
}
