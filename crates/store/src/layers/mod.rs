//! What other programs list and show: layers with their styles, and tables without geometry. They find both in tables of the GeoPackage
//! standard and of QGIS.

pub(crate) mod contents;
pub(crate) mod styles;
