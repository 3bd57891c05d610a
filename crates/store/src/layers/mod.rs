//! What other programs list and show: layers with their styles, tables without geometry, and what columns mean. They find it in tables of
//! the GeoPackage standard and of QGIS.

pub(crate) mod contents;
pub(crate) mod descriptions;
pub(crate) mod styles;
