//! Towns, villages and other named places: found by their names, and told beside the roads that lie in them.

use rstar::RTree;
use rstar::primitives::GeomWithData;

use crate::osm::facts::BackdropKind;
use crate::osm::{BackdropShape, LonLat};
use crate::rows::MapBackdrop;

/// Kinds of named places, with how far from its point a road belongs to one, metres. Assumed; the map has no outlines of them.
pub(in super::super) const KINDS: [(BackdropKind, f64); 5] = [
    (BackdropKind::City, 15_000.0),
    (BackdropKind::Town, 6_000.0),
    (BackdropKind::Suburb, 2_500.0),
    (BackdropKind::Village, 3_000.0),
    (BackdropKind::Hamlet, 1_500.0),
];
const EARTH_RADIUS_M: f64 = 6_371_000.0;

/// A named place.
#[derive(Debug, Clone, PartialEq)]
pub(in super::super) struct Settlement {
    pub(in super::super) kind: BackdropKind,
    pub(in super::super) name: Box<str>,
    pub(in super::super) at: LonLat,
}

impl Settlement {
    /// How far from its point a road belongs to it, metres.
    pub(in super::super) fn reach_m(&self) -> f64 {
        KINDS.iter().find(|(kind, _)| *kind == self.kind).map_or(0.0, |(_, reach_m)| *reach_m)
    }
}

/// The named places of a region. Points on the unit sphere, so that distances hold everywhere.
#[derive(Debug, Default)]
pub(in super::super) struct Settlements {
    all: Vec<Settlement>,
    by_kind: Vec<RTree<GeomWithData<[f64; 3], u32>>>,
}

impl Settlements {
    /// Of things behind the roads, those that are named places.
    pub(in super::super) fn of(things: Vec<MapBackdrop>) -> Self {
        let named = |thing: MapBackdrop| match thing {
            MapBackdrop { kind, name: Some(name), shape: BackdropShape::Place(at), .. } => {
                Some(Settlement { kind, name: name.into(), at })
            }
            _ => None,
        };
        let all: Vec<Settlement> = things.into_iter().filter_map(named).collect();
        let of_kind = |kind: BackdropKind| {
            let numbered = (0..).zip(&all).filter(|(_, one)| one.kind == kind);
            RTree::bulk_load(numbered.map(|(no, one)| GeomWithData::new(on_sphere(one.at), no)).collect())
        };
        let by_kind = KINDS.iter().map(|(kind, _)| of_kind(*kind)).collect();
        Self { all, by_kind }
    }

    pub(super) fn all(&self) -> &[Settlement] {
        &self.all
    }

    /// The place that a position belongs to: the one that is nearest by its reach.
    pub(in super::super) fn around(&self, at: LonLat) -> Option<&Settlement> {
        let here = on_sphere(at);
        let near = self.by_kind.iter().filter_map(|tree| tree.nearest_neighbor(&here));
        let share = |found: &GeomWithData<[f64; 3], u32>| {
            let one = self.all.get(found.data as usize)?;
            let chord = found.geom().iter().zip(here).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt();
            Some((chord * EARTH_RADIUS_M / one.reach_m(), one))
        };
        let best = near.filter_map(share).min_by(|a, b| a.0.total_cmp(&b.0));
        best.filter(|(share, _)| *share <= 1.0).map(|(_, one)| one)
    }
}

fn on_sphere(at: LonLat) -> [f64; 3] {
    let (lon, lat) = at.degrees();
    let (lon, lat) = (lon.to_radians(), lat.to_radians());
    [lat.cos() * lon.cos(), lat.cos() * lon.sin(), lat.sin()]
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_road_belongs_to_the_place_that_is_nearest_by_its_reach() {
        let place = |number, kind, name: &str, lon: f64, lat: f64| {
            let at = LonLat { lon_e7: (lon * 1e7) as i32, lat_e7: (lat * 1e7) as i32 };
            MapBackdrop { number, kind, name: Some(name.to_owned()), shape: BackdropShape::Place(at) }
        };
        let all = Settlements::of(vec![
            place(1, BackdropKind::City, "City", 179.99, -17.0),
            place(2, BackdropKind::Village, "Village", -179.95, -17.0),
            place(3, BackdropKind::Hamlet, "Hamlet", 179.90, -17.0),
        ]);
        let around = |lon: f64| {
            let at = LonLat { lon_e7: (lon * 1e7) as i32, lat_e7: -170_000_000 };
            all.around(at).map(|one| &*one.name)
        };
        // A degree is 106 km there. The antimeridian is no border.
        assert_eq!(around(179.99), Some("City"));
        assert_eq!(around(-179.98), Some("City"), "4 km from a village that reaches 3 km, 3.2 km from the city");
        assert_eq!(around(-179.955), Some("Village"));
        assert_eq!(around(179.905), Some("Hamlet"));
        assert_eq!(around(179.88), Some("City"), "2 km from the hamlet");
        assert_eq!(around(178.0), None);
    }
}
