//! Mapped traffic islands are no road: they are taken out of every area of turns, passages and routes, whatever part they lie on.
//!
//! A measured surface does not undo a mapped island. Islands are taken out one after the other: the union of nearly equal
//! polygons can take very long.

use std::sync::Arc;

use geo::{BooleanOps, BoundingRect, Intersects, MultiPolygon, Polygon};

use super::area::{polygon, rings};
use crate::corridor::{AreaSpan, Frame, FrameError};
use crate::network::Network;
use crate::osm::LonLat;

/// Added around the box in which islands are sought, 1e-7 degree: more than its corners are rounded.
const AROUND_E7: i32 = 100;

/// The islands that touch an area, in its metric frame.
///
/// # Errors
/// An island or the area is too far from the frame's centre.
pub(super) fn touching(network: &Network, frame: Frame, area: &MultiPolygon) -> Result<Vec<Polygon>, FrameError> {
    let (false, Some(bounds)) = (network.areas.without_islands(), area.bounding_rect()) else {
        return Ok(Vec::new());
    };
    let (low, high) = (bounds.min(), bounds.max());
    let corners = frame.inverse(&[[low.x, low.y], [high.x, low.y], [high.x, high.y], [low.x, high.y]])?;
    let e7 = |degrees: f64, more: i32| ((degrees * 1e7).round() as i32).saturating_add(more);
    let around = |&[lon, lat]: &[f64; 2]| {
        [-AROUND_E7, AROUND_E7].map(|more| LonLat { lon_e7: e7(lon, more), lat_e7: e7(lat, more) })
    };
    let places: Vec<LonLat> = corners.iter().flat_map(around).collect();
    let mut touching = Vec::new();
    for island in network.areas.islands(&places) {
        let island = polygon(&frame.forward(&island.ring)?);
        if island.intersects(area) {
            touching.push(island);
        }
    }
    Ok(touching)
}

/// An area without some islands.
pub(super) fn without(area: MultiPolygon, islands: &[Polygon]) -> MultiPolygon {
    islands.iter().fold(area, |area, island| area.difference(island))
}

/// Takes islands out of the strips of open road that [`crate::corridor::open_ends`] adds. Areas of turns, which may have holes,
/// lack them already.
pub(super) fn cut_out(spans: &mut [AreaSpan], islands: &[Polygon]) {
    for span in spans.iter_mut().filter(|_| !islands.is_empty()) {
        if let [ring] = &span.area.rings[..] {
            let strip = MultiPolygon::from(polygon(ring));
            if islands.iter().any(|island| island.intersects(&strip)) {
                span.area = Arc::new(rings(&without(strip, islands)));
            }
        }
    }
}

/// The same for a whole route.
///
/// # Errors
/// The frame cannot transform a position.
pub fn cut_out_of_route(network: &Network, frame: Frame, spans: &mut [AreaSpan]) -> Result<(), FrameError> {
    for span in spans {
        let all: MultiPolygon = span.area.rings.iter().map(|ring| polygon(ring)).collect();
        cut_out(std::slice::from_mut(span), &touching(network, frame, &all)?);
    }
    Ok(())
}
