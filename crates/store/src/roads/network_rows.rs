//! Rows of the network as portions bring them, kept outside memory until they can be written in the order of the whole network.

use std::io;
use std::ops::Range;
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::network::{Edge, EdgeNo, MappedArea, Narrowing, Portion, PortionRestriction, Road};
use crate::osm::changes::ObjectKind;
use crate::osm::facts::{BackdropKind, CrossSection};
use crate::osm::{Backdrop, LonLat};
use netcert_rows::EdgeMeasure;

use crate::file::companions::sorter;
use netcert_files::sorter::Sorter;

/// A road with its texts. `road` has none of them.
#[derive(PartialEq, Serialize, Deserialize)]
pub(crate) struct RoadRow {
    pub(crate) road: Road,
    pub(crate) name: Option<String>,
    pub(crate) reference: Option<String>,
}

/// A directed edge. `edge` has no road and no ranges.
#[derive(PartialEq, Serialize, Deserialize)]
pub(crate) struct MapEdgeRow {
    pub(crate) edge: Edge,
    /// The edge's road, as an index into the whole network.
    pub(crate) road: u32,
    /// Positions of its way before the edge's shape.
    pub(crate) place: u32,
    /// Positions in way order.
    pub(crate) shape: Vec<LonLat>,
    pub(crate) narrowings: Vec<Narrowing>,
    pub(crate) section: CrossSection,
    pub(crate) measure: EdgeMeasure,
}

/// A stroke: edges of the whole network, in driving order.
#[derive(PartialEq, Serialize, Deserialize)]
pub(crate) struct StrokeRow {
    pub(crate) approach: Vec<EdgeNo>,
    pub(crate) edges: Vec<EdgeNo>,
    pub(crate) closed: bool,
}

/// The rows of a network by their indices in it; strokes by their first edge.
pub(crate) struct NetworkRows {
    pub(crate) roads: Sorter<u32, RoadRow>,
    pub(crate) edges: Sorter<EdgeNo, MapEdgeRow>,
    pub(crate) strokes: Sorter<EdgeNo, StrokeRow>,
}

impl NetworkRows {
    /// No rows yet. Temporary files are made beside `path`.
    pub(crate) fn create(path: &Path) -> io::Result<Self> {
        Ok(Self { roads: sorter(path, "-roads")?, edges: sorter(path, "-edges")?, strokes: sorter(path, "-strokes")? })
    }

    /// Adds what a portion owns. `measures` has one entry per edge of its network, or is empty.
    pub(crate) fn add(&mut self, portion: &Portion, measures: &[EdgeMeasure]) -> io::Result<()> {
        for (index, row) in edge_rows(portion, measures) {
            let NetworkRow { road, edge } = row;
            if let Some(road) = road {
                self.roads.push(edge.road, &road)?;
            }
            self.edges.push(index, &edge)?;
        }
        for row in stroke_rows(portion) {
            if let Some(&first) = row.edges.first() {
                self.strokes.push(first, &row)?;
            }
        }
        Ok(())
    }
}

/// What portions and the reader bring beside the network.
pub(crate) struct MapRows {
    pub(crate) restrictions: Vec<PortionRestriction>,
    pub(crate) areas: Vec<MappedArea>,
    /// By kind and object, the order of drawing.
    pub(crate) backdrop: Sorter<(BackdropKind, (ObjectKind, i64)), Backdrop>,
}

impl MapRows {
    /// No rows yet. Temporary files are made beside `path`.
    pub(crate) fn create(path: &Path) -> io::Result<Self> {
        Ok(Self { restrictions: Vec::new(), areas: Vec::new(), backdrop: sorter(path, "-backdrop")? })
    }

    /// Adds what lies behind the roads.
    pub(crate) fn add_backdrop(&mut self, things: &[Backdrop]) -> io::Result<()> {
        things.iter().try_for_each(|thing| self.backdrop.push((thing.kind, thing.object), thing))
    }
}

/// An edge, with its road at the first edge of it.
pub(crate) struct NetworkRow {
    pub(crate) road: Option<RoadRow>,
    pub(crate) edge: MapEdgeRow,
}

/// The edges that a portion owns with their numbers in the whole network, in order. `measures` has one entry per edge of the portion's
/// network, or is empty.
pub(crate) fn edge_rows(portion: &Portion, measures: &[EdgeMeasure]) -> impl Iterator<Item = (EdgeNo, NetworkRow)> {
    let network = &portion.network;
    let mut begin = 0;
    let chunks = network.edges.chunk_by(|a, b| a.road == b.road).map(move |of_road| {
        let first = begin;
        begin += of_road.len() as u32;
        (first, of_road)
    });
    let rows = chunks.filter_map(move |(first_index, of_road)| {
        let first = of_road.first()?;
        let place = |edge: &Edge| edge.shape.start - first.shape.start;
        let road = || {
            let text = |id: Option<_>| id.map(|id| network.strings.text(id).to_owned());
            let road = network.road(first);
            RoadRow {
                name: text(road.name),
                reference: text(road.reference),
                road: Road { name: None, reference: None, ..road.clone() },
            }
        };
        let owned = (first_index..).map(EdgeNo::new).zip(of_road).filter(|(index, _)| portion.owns(*index));
        Some(owned.map(move |(index, edge)| {
            let row = MapEdgeRow {
                edge: Edge { road: 0, shape: 0..0, narrowings: 0..0, ..edge.clone() },
                road: portion.road(edge.road),
                place: place(edge),
                shape: network.shapes[edge.shape.start as usize..edge.shape.end as usize].to_vec(),
                narrowings: network.narrowings[edge.narrowings.start as usize..edge.narrowings.end as usize].to_vec(),
                section: network.section(edge),
                measure: measures.get(index.index()).copied().unwrap_or_default(),
            };
            let road = (index.get() == first_index).then(&road);
            (portion.edge(index), NetworkRow { road, edge: row })
        }))
    });
    rows.flatten()
}

/// The strokes that a portion owns.
pub(crate) fn stroke_rows(portion: &Portion) -> impl Iterator<Item = StrokeRow> {
    let network = &portion.network;
    portion.strokes().map(|stroke| {
        let stroke = &network.strokes[stroke as usize];
        let edges = |range: &Range<u32>| -> Vec<EdgeNo> {
            let edges = &network.stroke_edges[range.start as usize..range.end as usize];
            edges.iter().map(|&edge| portion.edge(edge)).collect()
        };
        StrokeRow { approach: edges(&stroke.approach), edges: edges(&stroke.edges), closed: stroke.closed }
    })
}
