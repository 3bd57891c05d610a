//! Cells: squares of a fixed grid over the world, each of which owns the edges that begin in it.
//!
//! Ways are cut, and strokes end, where they leave a cell. An edge and its stroke therefore depend on the roads of their cell and on
//! those within a halo, wherever a file ends beyond it.

use std::f64::consts::PI;

use crate::osm::LonLat;

/// Zoom of the grid: 2^zoom cells span the world from west to east (20 km at the equator, 12 km at 50° north).
pub(super) const ZOOM: u8 = 11;

/// A square of the grid: a tile of zoom 11 in web Mercator, as maps on the web have it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct GridCell {
    /// Row, from the north.
    pub y: u32,
    /// Column, from the 180th meridian eastwards.
    pub x: u32,
}

impl GridCell {
    /// The cell of a position. Positions beyond the grid's northern and southern borders (85.05°) are in its outermost cells.
    #[must_use]
    pub fn of(position: LonLat) -> Self {
        let (lon, lat) = position.degrees();
        let cells = f64::from(1_u32 << ZOOM);
        // The cast saturates: NaN does not occur, as latitudes are within ±90°.
        let index = |share: f64| (share * cells).floor().clamp(0.0, cells - 1.0) as u32;
        Self { y: index(0.5 - lat.to_radians().tan().asinh() / (2.0 * PI)), x: index((lon + 180.0) / 360.0) }
    }
}

/// The place of the grid's line between a cell and its neighbours to the west or north, degrees: longitude of a column, latitude of a row.
/// Columns count on beyond the 180th meridian.
pub(super) fn corner_deg(x: i64, y: u32) -> (f64, f64) {
    let cells = f64::from(1_u32 << ZOOM);
    ((x as f64 / cells - 0.5) * 360.0, (PI * (1.0 - 2.0 * f64::from(y) / cells)).sinh().atan().to_degrees())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cell(lon: f64, lat: f64) -> GridCell {
        GridCell::of(LonLat { lon_e7: (lon * 1e7).round() as i32, lat_e7: (lat * 1e7).round() as i32 })
    }

    #[test]
    fn cells_are_the_tiles_of_web_maps() {
        // Heidelberg's old bridge, by the formulas of the OpenStreetMap wiki, "Slippy map tilenames".
        assert_eq!(cell(8.7096, 49.4144), GridCell { y: 699, x: 1073 });
        assert_eq!(cell(0.0, 0.0), GridCell { y: 1024, x: 1024 });
        assert_eq!(cell(-1e-7, 1e-7), GridCell { y: 1023, x: 1023 });
    }

    #[test]
    fn a_cell_lies_between_its_corners() {
        let ((west, north), (east, south)) = (corner_deg(1073, 699), corner_deg(1074, 700));
        assert_eq!(cell(west + 1e-6, north - 1e-6), GridCell { y: 699, x: 1073 });
        assert_eq!(cell(east - 1e-6, south + 1e-6), GridCell { y: 699, x: 1073 });
        assert_eq!(cell(east + 1e-6, south - 1e-6), GridCell { y: 700, x: 1074 });
    }

    #[test]
    fn every_position_has_a_cell() {
        assert_eq!(cell(-180.0, 90.0), GridCell { y: 0, x: 0 });
        assert_eq!(cell(180.0, -90.0), GridCell { y: 2047, x: 2047 });
    }
}
