//! The two layers of map formats: directed edges and turns, each row with its cells and its line.

use super::{EDGE_COLUMNS, Layer, Options, TURN_COLUMNS, edge_cells, turn_cells};
use crate::osm::LonLat;
use crate::rows::{Cell, CertificateStanding, Column, Relative};
use crate::store::ReferenceReader;
use crate::{ExportError, PermitRefusal, Source};

/// One row of a layer.
pub(super) struct Row<'r> {
    /// The `edge_id` or `turn_id`, which is stable from extract to extract.
    pub(super) id: i64,
    /// The values in the order of [`Layer::columns`].
    pub(super) cells: &'r [Cell<'r>],
    /// The line in direction of travel, with at least two positions.
    pub(super) line: &'r [LonLat],
}

impl Layer {
    /// The layer's name, as in file names.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Edges => "edges",
            Self::Turns => "turns",
        }
    }

    /// The layer's columns. Those of a comparison come last.
    #[must_use]
    pub fn columns(self, source: &Source<'_>) -> Vec<Column> {
        let own = match self {
            Self::Edges => &EDGE_COLUMNS[..],
            Self::Turns => &TURN_COLUMNS[..],
        };
        let more = if source.reference.is_some() { &Relative::COLUMNS[..] } else { &[] };
        [own, more].concat()
    }

    /// Number of rows in the layer.
    #[must_use]
    pub fn rows(self, source: &Source<'_>) -> u64 {
        let bits = match self {
            Self::Edges => &source.permitted.edges,
            Self::Turns => &source.permitted.turns,
        };
        bits.len() as u64
    }

    /// Calls the function with every row, in order of the network.
    pub(super) fn each(
        self,
        source: &Source<'_>,
        mut put: impl FnMut(&Row<'_>) -> Result<(), ExportError>,
    ) -> Result<(), ExportError> {
        let mut database = source.database()?;
        let reference =
            source.reference.clone().map(|reference| ReferenceReader::open(&source.ask.db, reference, source.ask.at));
        let mut reference = reference.transpose()?;
        match self {
            Self::Edges => {
                let mut beside = reference.as_mut().map(ReferenceReader::edges).transpose()?;
                for edge in source.edges(&mut database)? {
                    let edge = edge?;
                    let refusal = edge.refusal.map_or_else(String::new, PermitRefusal::words);
                    let own = CertificateStanding::of(&edge.row.certificate);
                    let relative =
                        beside.as_mut().map(|other| other.relative(edge.row.edge.index.get(), own)).transpose()?;
                    let cells = with_relative(&edge_cells(source, &edge, &refusal), relative);
                    put(&Row { id: edge.row.edge.id, cells: &cells, line: &edge.row.line })?;
                }
            }
            Self::Turns => {
                let mut beside = reference.as_mut().map(ReferenceReader::turns).transpose()?;
                for turn in source.turns(&mut database)? {
                    let turn = turn?;
                    let refusal = turn.refusal.map_or_else(String::new, PermitRefusal::words);
                    let own = CertificateStanding::of(&turn.row.certificate);
                    let relative =
                        beside.as_mut().map(|other| other.relative(turn.row.turn.index.get(), own)).transpose()?;
                    let cells = with_relative(&turn_cells(source, &turn, &refusal), relative);
                    put(&Row { id: turn.row.turn.id, cells: &cells, line: &turn.row.line })?;
                }
            }
        }
        Ok(())
    }
}

fn with_relative<'r>(cells: &[Cell<'r>], relative: Option<Relative>) -> Vec<Cell<'r>> {
    let more = relative.into_iter().flat_map(|relative| -> [Cell<'r>; 2] { relative.cells() });
    cells.iter().copied().chain(more).collect()
}

/// The layers to write.
pub(super) fn asked(options: &Options) -> impl Iterator<Item = Layer> {
    let only = options.layer;
    [Layer::Edges, Layer::Turns].into_iter().filter(move |&layer| only.is_none_or(|only| only == layer))
}
