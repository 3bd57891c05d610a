//! The web Mercator grid of tiles `z/x/y`, with y southward (XYZ) and 4096 units per side of a tile.

use std::f64::consts::PI;

use super::super::ask::shortened;
use super::super::problem::Problem;
use crate::osm::LonLat;
use crate::rows::Bounds;

/// The deepest zoom, where a unit is 15 cm at the equator. Clients enlarge these tiles for deeper zooms.
pub(in super::super) const MOST_ZOOM: u8 = 16;
/// Units per side of a tile, as most clients expect.
pub(super) const EXTENT: f64 = 4096.0;
/// Units around a tile that the tile contains, too, so that wide lines end outside of it. 64 units are 8 pixels of a tile
/// of 512 pixels.
pub(super) const BUFFER: f64 = 64.0;

/// A tile's address.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct TileAddress {
    pub(super) z: u8,
    x: u32,
    y: u32,
}

impl TileAddress {
    /// Parses the address from the parts of the path. The last part ends in `.mvt`.
    pub(super) fn read(z: &str, x: &str, y: &str) -> Result<Self, Problem> {
        let y = y.strip_suffix(".mvt").ok_or_else(|| Problem::not_found("a tile's address ends in .mvt"))?;
        // No sign, leading zero or space is allowed, so that every tile has one address.
        let number = |name: &str, text: &str| -> Result<u32, Problem> {
            let plain = text.bytes().all(|b| b.is_ascii_digit()) && (text == "0" || !text.starts_with('0'));
            let value = text.parse().ok().filter(|_| plain);
            value.ok_or_else(|| Problem::not_found(format!("{name}: {:?} is no tile's number", shortened(text))))
        };
        let (z, x, y) = (number("z", z)?, number("x", x)?, number("y", y)?);
        let z = u8::try_from(z).ok().filter(|&z| z <= MOST_ZOOM);
        let z = z.ok_or_else(|| Problem::not_found(format!("there are tiles of zoom 0 to {MOST_ZOOM}")))?;
        let side = 1_u32 << z;
        if x >= side || y >= side {
            return Err(Problem::not_found(format!("at zoom {z}, x and y are less than {side}")));
        }
        Ok(Self { z, x, y })
    }

    fn side(self) -> f64 {
        f64::from(1_u32 << self.z)
    }

    /// The position in tile units, x east, y south; not rounded.
    pub(super) fn units(self, position: LonLat) -> [f64; 2] {
        self.units_of(world(position))
    }

    /// The point in tile units, x east, y south; not rounded.
    pub(super) fn units_of(self, [x, y]: World) -> [f64; 2] {
        [(x * self.side() - f64::from(self.x)) * EXTENT, (y * self.side() - f64::from(self.y)) * EXTENT]
    }

    /// The tile's north-western and south-eastern corners, each moved outwards by `beyond` units.
    pub(super) fn world(self, beyond: f64) -> [World; 2] {
        let corner = |x: f64, y: f64| [x / self.side(), y / self.side()];
        let (x, y, beyond) = (f64::from(self.x), f64::from(self.y), beyond / EXTENT);
        [corner(x - beyond, y - beyond), corner(x + 1.0 + beyond, y + 1.0 + beyond)]
    }

    /// So many units of the tile, in degrees of latitude.
    pub(super) fn degrees_of(self, units: f64) -> f64 {
        let Bounds { south, north, .. } = self.bounds();
        units / EXTENT * 360.0 / self.side() * (0.5 * (south + north)).to_radians().cos()
    }

    /// The box of the tile and its buffer, degrees. The box ends at the 180th meridian, because no edge crosses it.
    pub(super) fn bounds(self) -> Bounds {
        let lon = |x: f64| (x * 360.0 - 180.0).clamp(-180.0, 180.0);
        let lat = |y: f64| (PI * (1.0 - 2.0 * y)).sinh().atan().to_degrees();
        let [[west, north], [east, south]] = self.world(BUFFER);
        Bounds { west: lon(west), south: lat(south), east: lon(east), north: lat(north) }
    }
}

/// A point on the web Mercator square: x east, y south, each from 0 to 1.
pub(super) type World = [f64; 2];

/// The point of a position on the web Mercator square.
pub(super) fn world(position: LonLat) -> World {
    let (lon, lat) = position.degrees();
    [(lon + 180.0) / 360.0, 0.5 - lat.to_radians().tan().asinh() / (2.0 * PI)]
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn the_corners_of_a_tile_are_where_they_should_be() {
        let tile = TileAddress::read("14", "8588", "5597.mvt").unwrap();
        let Bounds { west, south, east, north } = tile.bounds();
        let at = |lon: f64, lat: f64| tile.units(LonLat { lon_e7: (lon * 1e7) as i32, lat_e7: (lat * 1e7) as i32 });
        let close = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).abs() < 0.1 && (a[1] - b[1]).abs() < 0.1;
        assert!(close(at(west, north), [-BUFFER, -BUFFER]));
        assert!(close(at(east, south), [EXTENT + BUFFER, EXTENT + BUFFER]));
        // The tile of Heidelberg's old bridge by the formulas of the OpenStreetMap wiki, "Slippy map tilenames".
        assert!(west < 8.7096 && 8.7096 < east && south < 49.4144 && 49.4144 < north, "{:?}", tile.bounds());
    }

    #[test]
    fn what_is_no_tile_is_refused() {
        for (z, x, y) in [
            ("17", "0", "0.mvt"),
            ("0", "1", "0.mvt"),
            ("1", "0", "2.mvt"),
            ("1", "-1", "0.mvt"),
            ("1", "+1", "0.mvt"),
            ("01", "0", "0.mvt"),
            ("1", "0", "0"),
            ("1", "0", "0.png"),
            ("", "", ".mvt"),
            ("99999999999", "0", "0.mvt"),
        ] {
            assert!(TileAddress::read(z, x, y).is_err(), "{z}/{x}/{y}");
        }
        assert!(TileAddress::read("0", "0", "0.mvt").is_ok() && TileAddress::read("16", "65535", "65535.mvt").is_ok());
    }
}
