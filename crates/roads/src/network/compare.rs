//! Where two networks of the same region differ, as far as certificates depend on it.

use rustc_hash::{FxHashMap, FxHashSet};

use super::areas::MappedArea;
use super::geometry::EARTH_RADIUS_M;
use super::{Edge, EdgeNo, Network, Road, Stroke};
use crate::osm::{LonLat, NodeId};

/// Nodes within this distance of an area that changed are named, metres.
const NEAR_M: f64 = 150.0;

/// What differs between an older network and a newer one. In doubt more is named.
#[derive(Debug, Clone, Default)]
pub struct Differences {
    /// Ids of edges of the newer network that the older one does not have in the same form, or that are on another stroke there.
    pub edges: Vec<i64>,
    /// Ids of nodes at which an edge is gone, or a surface, an island or a kerb may differ.
    pub nodes: Vec<NodeId>,
    /// By edge of the newer network: the same edge in the older one.
    pub older: Vec<Option<EdgeNo>>,
}

impl Differences {
    /// Compares two networks.
    #[must_use]
    pub fn find(old: &Network, new: &Network) -> Self {
        let by_id: FxHashMap<i64, EdgeNo> = old.numbered_edges().map(|(index, edge)| (edge.id, index)).collect();
        let older: Vec<Option<EdgeNo>> = new
            .numbered_edges()
            .map(|(index, edge)| {
                let there = *by_id.get(&edge.id)?;
                same_edge(old, there, new, index).then_some(there)
            })
            .collect();
        let mut edges: FxHashSet<i64> =
            new.edges.iter().zip(&older).filter(|(_, older)| older.is_none()).map(|(edge, _)| edge.id).collect();
        other_strokes(old, new, &mut edges);
        let mut nodes: FxHashSet<NodeId> = FxHashSet::default();
        let there: FxHashSet<EdgeNo> = older.iter().flatten().copied().collect();
        for (_, gone) in old.numbered_edges().filter(|(index, _)| !there.contains(index)) {
            nodes.extend([gone.from_node, gone.to_node]);
        }
        near_changed_areas(old, new, &mut nodes);
        nodes.extend(old.site.junctions().chain(new.site.junctions()));
        Self { edges: sorted(edges), nodes: sorted(nodes), older }
    }
}

fn sorted<T: Ord>(set: FxHashSet<T>) -> Vec<T> {
    let mut all: Vec<T> = set.into_iter().collect();
    all.sort_unstable();
    all
}

/// Whether two edges of one id have the same line, strips, limits and road.
fn same_edge(old: &Network, a: EdgeNo, new: &Network, b: EdgeNo) -> bool {
    let (Some(x), Some(y)) = (old.edges.get(a.index()), new.edges.get(b.index())) else { return false };
    // The patterns have no `..`, so a new field does not compile until it is compared or left out here.
    let Edge { id, road: _, from_node, to_node, direction, shape: _, narrowings: _, legal: _, barred, cut: _ } = x;
    let (road, other) = (old.road(x), new.road(y));
    // Names, lanes and speeds are for display and for pairing, and strokes are compared by themselves.
    let Road {
        way_id,
        class,
        link,
        roundabout,
        oneway,
        name: _,
        reference: _,
        lanes: _,
        country,
        left_hand_traffic,
        sections,
        legal,
        max_speed_km_h: _,
        width_tags: _,
    } = road;
    let narrow = |network: &Network, edge: &Edge| {
        let range = edge.narrowings.start as usize..edge.narrowings.end as usize;
        network.narrowings.get(range).unwrap_or_default().to_vec()
    };
    (*id, *from_node, *to_node, *direction, *barred) == (y.id, y.from_node, y.to_node, y.direction, y.barred)
        && old.positions(x).eq(new.positions(y))
        && old.section(x) == new.section(y)
        && old.legal(x) == new.legal(y)
        && narrow(old, x) == narrow(new, y)
        && (way_id, class, link) == (&other.way_id, &other.class, &other.link)
        && (roundabout, oneway) == (&other.roundabout, &other.oneway)
        && (country, left_hand_traffic) == (&other.country, &other.left_hand_traffic)
        && (sections, legal) == (&other.sections, &other.legal)
        && [old.splits.parts_after(a), old.splits.joined_before(a)]
            == [new.splits.parts_after(b), new.splits.joined_before(b)]
}

/// Adds the edges of strokes that the older network does not have in the same form.
fn other_strokes(old: &Network, new: &Network, edges: &mut FxHashSet<i64>) {
    let ids = |network: &Network, range: &std::ops::Range<u32>| -> Vec<i64> {
        let chain = network.stroke_edges.get(range.start as usize..range.end as usize).unwrap_or_default();
        chain.iter().filter_map(|&edge| Some(network.edges.get(edge.index())?.id)).collect()
    };
    let form = |network: &Network, stroke: &Stroke| {
        let Stroke { approach, edges, closed } = stroke;
        (ids(network, approach), ids(network, edges), *closed)
    };
    let first = |network: &Network, stroke: &Stroke| ids(network, &stroke.edges).first().copied();
    let known: FxHashMap<i64, &Stroke> =
        old.strokes.iter().filter_map(|stroke| Some((first(old, stroke)?, stroke))).collect();
    for stroke in &new.strokes {
        let there = first(new, stroke).and_then(|id| known.get(&id));
        if there.is_none_or(|there| form(old, there) != form(new, stroke)) {
            edges.extend(ids(new, &stroke.edges));
        }
    }
}

/// Adds the nodes near areas that only one network has in their form.
fn near_changed_areas(old: &Network, new: &Network, nodes: &mut FxHashSet<NodeId>) {
    let of = |network: &Network| -> FxHashMap<i64, MappedArea> {
        network.areas.all().iter().map(|area| (area.way_id, area.clone())).collect()
    };
    let (before, after) = (of(old), of(new));
    let only = |all: &FxHashMap<i64, MappedArea>, others: &FxHashMap<i64, MappedArea>| -> Vec<MappedArea> {
        all.values().filter(|area| others.get(&area.way_id) != Some(area)).cloned().collect()
    };
    let changed = [only(&before, &after), only(&after, &before)].concat();
    if changed.is_empty() {
        return;
    }
    let north = (NEAR_M / EARTH_RADIUS_M).to_degrees();
    let near = |area: &MappedArea, place: LonLat| {
        let (lon, lat) = place.degrees();
        let east = north / lat.to_radians().cos().abs().max(1e-6);
        let corners = || area.ring.iter().map(|corner| corner.degrees());
        let within = |at: f64, of: fn((f64, f64)) -> f64, reach: f64| {
            let (least, most) = corners().map(of).fold((f64::MAX, f64::MIN), |(a, b), x| (a.min(x), b.max(x)));
            (least - reach..=most + reach).contains(&at)
        };
        within(lon, |at| at.0, east) && within(lat, |at| at.1, north)
    };
    for edge in &new.edges {
        let mut line = new.positions(edge);
        for (node, place) in [(edge.from_node, line.next()), (edge.to_node, line.next_back())] {
            if place.is_some_and(|place| changed.iter().any(|area| near(area, place))) {
                nodes.insert(node);
            }
        }
    }
}
