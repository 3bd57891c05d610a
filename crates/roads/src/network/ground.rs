//! An extract made ready for building networks: of all its roads at once, or of one block of cells after the other.
//!
//! Junctions, restrictions and areas are found in the whole extract, so a block's network is cut as the whole network is. The same extract
//! gives the same networks with any number of threads.

use std::collections::{BTreeMap, BTreeSet};

use rayon::prelude::*;
use rustc_hash::FxHashSet;

use super::blocks::{self, CellBlock};
use super::border::Border;
use super::edges::WaySource;
use super::extent::Extent;
use super::portion::{Portion, PortionIndices};
use super::restrictions::{self, Resolved, RuleReading};
use super::stroke::{self, Chained};
use super::vertices::{MISSING, Vertices};
use super::ways::Ways;
use super::{Crossings, EdgeNo, MappedArea, Network, NetworkAccount, Splits, StrokeOptions, areas, edge_id};
use crate::osm::facts::{AreaKind, CrossSection, Jurisdiction, WayFacts};
use crate::osm::{self, Extract, LonLat, NodeTable, StringPool};

/// An extract made ready. `places` and `sections` are those of [`super::build_with`].
pub struct Ground<P, S> {
    ways: Ways,
    nodes: NodeTable,
    vertices: Vertices,
    restrictions: Vec<osm::Restriction>,
    /// Those with a usable ring, sorted by way id.
    areas: Vec<MappedArea>,
    strings: StringPool,
    bbox_deg: Option<[f64; 4]>,
    /// What is counted of the extract as a whole.
    account: NetworkAccount,
    jurisdictions: P,
    sections: S,
    options: StrokeOptions,
}

/// How the network of an extract is divided into blocks, and what is known of the whole network without it.
pub struct Division {
    blocks: Vec<CellBlock>,
    /// By way, and one more: number of edges and roads of all ways before.
    edges_before: Vec<u32>,
    roads_before: Vec<u32>,
    /// By way.
    extents: Vec<Option<Extent>>,
    /// Ids that are not those of the edge's way and nodes, by edge.
    changed_ids: Vec<(EdgeNo, i64)>,
    border: Option<Border>,
    countries: BTreeMap<[u8; 2], usize>,
    /// Grows with each portion.
    account: NetworkAccount,
    on_network: BTreeSet<u32>,
    forbidding: Forbidding,
    kept_areas: BTreeSet<i64>,
}

impl<P, S> Ground<P, S>
where
    P: Fn(LonLat) -> Jurisdiction + Sync,
    S: Fn(&WayFacts, &Jurisdiction, Option<f64>) -> [CrossSection; 2] + Sync,
{
    /// Makes an extract ready.
    pub fn new(extract: Extract, jurisdictions: P, sections: S, options: StrokeOptions) -> Self {
        let Extract { ways, refs, nodes, points, restrictions, areas, backdrop: _, strings, account: read } = extract;
        let vertices = Vertices::resolve(&ways, &refs, &nodes, &points);
        drop((refs, points));
        let ways = Ways::new(ways);
        let mut account = NetworkAccount {
            missing_references: vertices.missing,
            same_place_nodes: vertices.merged,
            restrictions_read: restrictions.len() as u64,
            ..NetworkAccount::default()
        };
        let areas = areas::usable(areas, &nodes, &mut account);
        let bbox_deg = read.header.bbox_deg();
        Self {
            ways,
            nodes,
            vertices,
            restrictions,
            areas,
            strings,
            bbox_deg,
            account,
            jurisdictions,
            sections,
            options,
        }
    }

    /// The number of node references of all ways: about twice that of directed edges.
    #[must_use]
    pub fn references(&self) -> usize {
        self.vertices.of_refs.len()
    }

    /// The network of all roads, as the only portion.
    #[must_use]
    pub fn whole(mut self) -> (Portion, NetworkAccount) {
        let mut account = std::mem::take(&mut self.account);
        let mut network = Network { strings: std::mem::take(&mut self.strings), ..Network::default() };
        let all: Vec<u32> = (0..self.ways.len() as u32).collect();
        self.source().build(&all, &mut network, &mut account);
        drop(all);
        self.ways = Ways::default();
        let mut border = Border::of(self.bbox_deg);
        if let Some(border) = &mut border {
            border.count(&network);
            border.mark(&mut network);
        }
        account.id_collisions = edge_id::resolve_collisions(&mut network.edges);
        let areas = std::mem::take(&mut self.areas);
        let (chained, resolved) = self.complete(&mut network, |_| true, areas);
        let portion = Portion::new(network, None, chained, resolved);
        account.cut_edges = 0;
        portion.count(&mut account);
        let mut forbidding = Forbidding::default();
        note_readings(&mut forbidding, &portion);
        self.count_restrictions(&mut account, &portion.on_network().iter().copied().collect(), &forbidding);
        count_areas(&mut account, portion.network.areas.all().iter());
        (portion, account)
    }

    /// Divides the network into blocks of at most `most` directed edges each, except where a single cell has more.
    pub fn divide(&self, most: u64) -> Division {
        let mut account = self.account.clone();
        let mut border = Border::of(self.bbox_deg);
        let (mut ids, mut countries, mut cells) = (Vec::new(), BTreeMap::new(), BTreeMap::new());
        let mut numbers = Numbers::new(&self.ways);
        self.source().look_through(|network, part| {
            account.add_part(part);
            if let Some(border) = &mut border {
                border.count(network);
            }
            network.roads.iter().for_each(|road| *countries.entry(road.country).or_default() += 1);
            for edge in &network.edges {
                ids.push(edge.id);
                *cells.entry(network.cell(edge)).or_default() += 1;
            }
            numbers.add(network);
        });
        let (edges_before, roads_before) = numbers.finish();
        let changed_ids = edge_id::changed_ids(ids.into_par_iter());
        account.id_collisions = changed_ids.len() as u64;
        account.cut_edges = 0;
        let position = |&vertex: &u32| if vertex == MISSING { None } else { self.nodes.places[vertex as usize] };
        let extent = |way| Extent::of(self.vertices.of_refs[self.ways.refs(way)].iter().filter_map(position));
        let extents = (0..self.ways.len() as u32).into_par_iter().map(extent).collect();
        Division {
            blocks: blocks::divide(&cells, most),
            edges_before,
            roads_before,
            extents,
            changed_ids,
            border,
            countries,
            account,
            on_network: BTreeSet::new(),
            forbidding: Forbidding::default(),
            kept_areas: BTreeSet::new(),
        }
    }

    /// The network of a block and what surrounds it.
    #[must_use]
    pub fn portion(&self, division: &Division, block: usize) -> Portion {
        let block = division.blocks[block].clone();
        let around = block.surroundings();
        let near = |extent: &Option<Extent>| extent.is_some_and(|extent| extent.meets(around));
        let ways: Vec<u32> =
            (0..).zip(&division.extents).filter(|(_, extent)| near(extent)).map(|(way, _)| way).collect();
        let mut network = Network::default();
        self.source().build(&ways, &mut network, &mut NetworkAccount::default());
        self.take_names(&mut network);
        let (roads, edges) = division.numbers(&self.ways, &network);
        for (edge, &number) in network.edges.iter_mut().zip(&edges) {
            if let Ok(at) = division.changed_ids.binary_search_by_key(&number, |&(edge, _)| edge) {
                edge.id = division.changed_ids[at].1;
            }
        }
        if let Some(border) = &division.border {
            border.mark(&mut network);
        }
        let known: FxHashSet<i64> = network.roads.iter().map(|road| road.way_id).collect();
        let takes = |restriction: &osm::Restriction| {
            let ways = if restriction.from.is_empty() { &restriction.to } else { &restriction.from };
            ways.iter().any(|way| known.contains(way))
        };
        let meets =
            |area: &&MappedArea| Extent::of(area.ring.iter().copied()).is_some_and(|extent| extent.meets(around));
        let areas = self.areas.iter().filter(meets).cloned().collect();
        let (chained, resolved) = self.complete(&mut network, takes, areas);
        let owned = owned(&network, &block);
        Portion::new(network, Some(PortionIndices { block, roads, edges, owned }), chained, resolved)
    }

    /// The areas that any portion keeps, sorted by way id.
    #[must_use]
    pub fn kept_areas(&self, division: &Division) -> Vec<MappedArea> {
        self.areas.iter().filter(|area| division.kept_areas.contains(&area.way_id)).cloned().collect()
    }

    /// The account of the whole network, once all portions are added.
    #[must_use]
    pub fn account(&self, division: &Division) -> NetworkAccount {
        let mut account = division.account.clone();
        self.count_restrictions(&mut account, &division.on_network, &division.forbidding);
        count_areas(&mut account, self.areas.iter().filter(|area| division.kept_areas.contains(&area.way_id)));
        account
    }

    fn source(&self) -> WaySource<'_, P, S> {
        let Self { ways, nodes, vertices, jurisdictions, sections, .. } = self;
        WaySource { ways, nodes, vertices, jurisdictions, sections }
    }

    /// The steps from edges to a network.
    fn complete(
        &self,
        network: &mut Network,
        takes: impl Fn(&osm::Restriction) -> bool,
        areas: Vec<MappedArea>,
    ) -> (Chained, Resolved) {
        let resolved = restrictions::resolve(network, &self.restrictions, &self.nodes, &self.vertices, takes);
        areas::keep(network, areas);
        let chained = stroke::chain(network, &self.options);
        network.splits = Splits::find(network);
        network.crossings = Crossings::find(network);
        (chained, resolved)
    }

    /// Gives a network names of its own, in the order of its roads.
    fn take_names(&self, network: &mut Network) {
        let Network { roads, strings, .. } = network;
        for name in roads.iter_mut().flat_map(|road| [&mut road.name, &mut road.reference]) {
            *name = name.map(|name| strings.intern(self.strings.text(name)));
        }
    }

    fn count_restrictions(&self, account: &mut NetworkAccount, on_network: &BTreeSet<u32>, forbidding: &Forbidding) {
        for (no, restriction) in (0_u32..).zip(&self.restrictions) {
            let only = restriction.rules.iter().any(|rule| rule.kind.only);
            account.count_restriction(on_network.contains(&no), only, forbidding.get(&no));
        }
    }
}

/// The relations that forbid something, as indices, each with how it was read.
type Forbidding = BTreeMap<u32, RuleReading>;

fn note_readings(forbidding: &mut Forbidding, portion: &Portion) {
    for restriction in portion.restrictions() {
        forbidding.entry(restriction.rule.0).or_default().and(restriction.reading);
    }
}

impl Division {
    /// Number of blocks.
    #[must_use]
    pub fn blocks(&self) -> usize {
        self.blocks.len()
    }

    /// The blocks that may own edges in a block's surroundings, without the block itself.
    #[must_use]
    pub fn needs(&self, block: usize) -> Vec<u32> {
        let own = &self.blocks[block];
        let needed = |(number, other): &(u32, &blocks::CellBlock)| *number as usize != block && own.needs(other);
        (0..).zip(&self.blocks).filter(needed).map(|(number, _)| number).collect()
    }

    /// Number of directed edges of the whole network.
    #[must_use]
    pub fn edges(&self) -> u32 {
        self.edges_before.last().copied().unwrap_or(0)
    }

    /// Roads of the whole network by country.
    #[must_use]
    pub fn countries(&self) -> &BTreeMap<[u8; 2], usize> {
        &self.countries
    }

    /// Adds a portion to the account of the whole network.
    pub fn add(&mut self, portion: &Portion) {
        portion.count(&mut self.account);
        self.on_network.extend(portion.on_network());
        note_readings(&mut self.forbidding, portion);
        self.kept_areas.extend(portion.network.areas.all().iter().map(|area| area.way_id));
    }

    /// By road and by edge of a portion's network: the number in the whole network.
    fn numbers(&self, ways: &Ways, network: &Network) -> (Vec<u32>, Vec<EdgeNo>) {
        let way = |road: &super::Road| ways.first_from(road.way_id);
        let of_road: Vec<usize> = network.roads.iter().map(way).collect();
        let roads = of_road.iter().map(|&way| self.roads_before[way]).collect();
        let mut edges = Vec::with_capacity(network.edges.len());
        for of_way in network.edges.chunk_by(|a, b| a.road == b.road) {
            let first = of_way.first().map_or(0, |edge| self.edges_before[of_road[edge.road as usize]]);
            edges.extend((first..).map(EdgeNo::new).take(of_way.len()));
        }
        (roads, edges)
    }
}

/// Numbers of edges and roads by way, found as networks of some ways after the other are looked through.
struct Numbers<'w> {
    ways: &'w Ways,
    edges_before: Vec<u32>,
    roads_before: Vec<u32>,
    edges: u32,
    roads: u32,
}

impl<'w> Numbers<'w> {
    fn new(ways: &'w Ways) -> Self {
        Self { ways, edges_before: Vec::new(), roads_before: Vec::new(), edges: 0, roads: 0 }
    }

    fn add(&mut self, network: &Network) {
        let mut edges = network.edges.chunk_by(|a, b| a.road == b.road);
        for road in &network.roads {
            self.up_to(Some(road.way_id));
            self.roads += 1;
            self.edges += edges.next().map_or(0, |edges| edges.len() as u32);
        }
    }

    /// Notes the numbers before each way up to one of this id, or before all that are left.
    fn up_to(&mut self, id: Option<i64>) {
        let end = id.map_or(self.ways.len(), |id| self.ways.first_from(id) + 1);
        let count = end - self.edges_before.len();
        self.edges_before.extend(std::iter::repeat_n(self.edges, count));
        self.roads_before.extend(std::iter::repeat_n(self.roads, count));
    }

    fn finish(mut self) -> (Vec<u32>, Vec<u32>) {
        self.up_to(None);
        self.edges_before.push(self.edges);
        self.roads_before.push(self.roads);
        (self.edges_before, self.roads_before)
    }
}

/// By edge: whether it is on a stroke that begins in the block.
fn owned(network: &Network, block: &CellBlock) -> Vec<bool> {
    let mut owned = vec![false; network.edges.len()];
    for stroke in &network.strokes {
        let edges = &network.stroke_edges[stroke.edges.start as usize..stroke.edges.end as usize];
        let first = edges.first().and_then(|&first| network.edges.get(first.index()));
        if first.is_some_and(|first| block.has(network.cell(first))) {
            edges.iter().for_each(|&edge| owned[edge.index()] = true);
        }
    }
    owned
}

fn count_areas<'a>(account: &mut NetworkAccount, kept: impl Iterator<Item = &'a MappedArea>) {
    for area in kept {
        account.areas_kept += 1;
        account.islands_kept += u64::from(area.kind == AreaKind::Island);
    }
}
