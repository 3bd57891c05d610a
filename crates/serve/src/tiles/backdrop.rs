//! Vector tiles of what lies behind the roads, the same for every vehicle: layers `area`, `line` and `place`.
//!
//! A tile holds what a zoom shows: areas of at least four pixels, lines and places by their kind. From [`MOST_ZOOM`] on, clients enlarge
//! the tiles.

use geo::{Coord, LineString, MultiPolygon, Polygon};

use crate::osm::facts::{BackdropForm, BackdropKind};
use crate::osm::{BackdropShape, LonLat};
use crate::rows::MapBackdrop;
use crate::words::Named as _;

use super::super::answer::StoredAnswer;
use super::super::ask::DecodedRequest;
use super::super::problem::Problem;
use super::super::region::RegionState;
use super::encode::{TagValue, TileLayer};
use super::grid::{EXTENT, TileAddress};
use super::{KIND, drawn, shape};

/// The deepest zoom with tiles of its own. Shapes are within two metres of the map, three units of these tiles.
pub(in super::super) const MOST_ZOOM: u8 = 14;
/// The least side of an area, in units of a tile: four pixels of a tile of 512 pixels.
const LEAST_UNITS: f64 = 32.0;

/// The first zoom that shows a kind.
fn first_zoom(kind: BackdropKind) -> u8 {
    match kind {
        BackdropKind::City => 5,
        BackdropKind::Water | BackdropKind::Coast => 6,
        BackdropKind::Wood | BackdropKind::Town => 8,
        BackdropKind::River => 9,
        BackdropKind::Village | BackdropKind::Suburb => 11,
        BackdropKind::Canal => 12,
        BackdropKind::Hamlet => 13,
    }
}

/// `/backdrop/{z}/{x}/{y}.mvt`
pub(in super::super) fn tile(region: &RegionState, ask: &DecodedRequest) -> Result<StoredAnswer, Problem> {
    ask.only(&[])?;
    let tile = TileAddress::read(ask.name("z")?, ask.name("x")?, ask.name("y")?)?;
    if tile.z > MOST_ZOOM {
        return Err(Problem::not_found(format!("there are tiles of the backdrop of zoom 0 to {MOST_ZOOM}")));
    }
    Ok(StoredAnswer::new(KIND, bytes(region, tile)?))
}

fn bytes(region: &RegionState, tile: TileAddress) -> Result<Vec<u8>, Problem> {
    let mut bytes = Vec::new();
    for (name, form) in [("area", BackdropForm::Area), ("line", BackdropForm::Line), ("place", BackdropForm::Place)] {
        let shown = |kind: &&BackdropKind| kind.form() == form && tile.z >= first_zoom(**kind);
        let kinds: Vec<BackdropKind> = BackdropKind::ALL.iter().filter(shown).copied().collect();
        if kinds.is_empty() {
            continue;
        }
        let least_deg = if form == BackdropForm::Area { tile.degrees_of(LEAST_UNITS) } else { 0.0 };
        let things = region.read(|database| database.map_backdrop(tile.bounds(), &kinds, least_deg))?;
        let mut layer = TileLayer::new(name, EXTENT as u16);
        for thing in &things {
            add(&mut layer, thing, tile);
        }
        layer.finish(&mut bytes);
    }
    Ok(bytes)
}

fn add(layer: &mut TileLayer, thing: &MapBackdrop, tile: TileAddress) {
    let id = u64::try_from(thing.number).ok();
    let kind = TagValue::Text(thing.kind.name());
    match &thing.shape {
        BackdropShape::Areas(polygons) => {
            let polygons: MultiPolygon = polygons.iter().filter_map(|rings| outline(rings, tile)).collect();
            layer.polygons(id, &shape::drawn_polygons(&polygons), |tags| tags.add("kind", kind));
        }
        BackdropShape::Lines(lines) => {
            let lines: Vec<_> = lines.iter().flat_map(|line| drawn(line, tile)).collect();
            layer.feature(id, &lines, |tags| tags.add("kind", kind));
        }
        BackdropShape::Place(at) => {
            let [x, y] = tile.units(*at).map(f64::floor);
            // Each place is in one tile, so that its name is drawn once.
            if (0.0..EXTENT).contains(&x) && (0.0..EXTENT).contains(&y) {
                layer.point(id, [x as i32, y as i32], |tags| {
                    tags.add("kind", kind);
                    tags.text("name", thing.name.as_deref());
                });
            }
        }
    }
}

/// A polygon in tile units, without the vertices that nobody would see. `None` if nothing is left of its outline.
fn outline(rings: &[Vec<LonLat>], tile: TileAddress) -> Option<Polygon> {
    let ring = |ring: &Vec<LonLat>| {
        let units: Vec<[f64; 2]> = ring.iter().map(|&position| tile.units(position)).collect();
        let units = shape::simplified(&units, shape::TOLERANCE);
        (units.len() >= 4).then(|| units.into_iter().map(Coord::from).collect::<LineString>())
    };
    let (outer, holes) = rings.split_first()?;
    Some(Polygon::new(ring(outer)?, holes.iter().filter_map(ring).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_is_shown_at_some_zoom() {
        assert!(BackdropKind::ALL.iter().all(|&kind| first_zoom(kind) <= MOST_ZOOM));
    }
}
