//! Formats with one file a layer. A format says how its file begins, takes a row and ends ([`LayerFormat`]); the rest is the same
//! for all of them and stands here.

use std::marker::PhantomData;

use super::layers::{Row, asked};
use super::{Layer, Options, Target};
use crate::rows::Column;
use crate::{Destination, ExportError, Layout, Sink, Source};

/// A file of one layer that is being written.
pub(super) trait LayerFormat: Sized + 'static {
    /// The target's name on the command line.
    const NAME: &'static str;
    /// One line for the help text.
    const ABOUT: &'static str;
    /// The ending of the files' names.
    const ENDING: &'static str;

    /// Begins the file.
    fn open(table: &Table<'_>, sink: Sink) -> Result<Self, ExportError>;

    /// Takes a row. Rows come in order of the network.
    fn row(&mut self, table: &Table<'_>, row: &Row<'_>) -> Result<(), ExportError>;

    /// Ends the file, and closes its sink.
    fn close(self, table: &Table<'_>) -> Result<(), ExportError>;
}

/// What a file of a layer is made from, besides its rows.
pub(super) struct Table<'t> {
    pub(super) layer: Layer,
    /// The columns, in the order of [`Row::cells`].
    pub(super) columns: Vec<Column>,
    pub(super) source: &'t Source<'t>,
    pub(super) options: &'t Options,
    /// For temporary files.
    pub(super) destination: &'t Destination,
}

/// The target of a format: a file for one layer, a folder for both.
pub(super) struct LayerFiles<F>(PhantomData<fn() -> F>);

impl<F: LayerFormat> LayerFiles<F> {
    pub(super) const TARGET: &'static dyn Target = &Self(PhantomData);
}

impl<F: LayerFormat> Target for LayerFiles<F> {
    fn name(&self) -> &'static str {
        F::NAME
    }

    fn about(&self) -> &'static str {
        F::ABOUT
    }

    fn layout(&self, options: &Options) -> Layout {
        match options.layer {
            Some(_) => Layout::File,
            None => Layout::Folder { target: F::NAME, instead: ", or one of them with --layer edges or --layer turns" },
        }
    }

    fn has_columns(&self) -> bool {
        true
    }

    fn write(&self, source: &Source<'_>, options: &Options, destination: &mut Destination) -> Result<(), ExportError> {
        for layer in asked(options) {
            let sink = destination.create(&format!("{}.{}", layer.name(), F::ENDING))?;
            let table = Table { layer, columns: layer.columns(source), source, options, destination };
            let mut file = F::open(&table, sink)?;
            layer.each(source, |row| file.row(&table, row))?;
            file.close(&table)?;
        }
        Ok(())
    }
}
