//! Encodes and decodes geometries as GeoPackage blobs: `GP`, version 0, no envelope, WGS 84, then a geometry as WKB, all little endian
//! (GeoPackage 1.3, clause 2.1.3). Positions are multiples of 1e-7 degree and are preserved exactly.

use crate::osm::{BackdropShape, LonLat};
use netcert_rows::Bounds;

/// The flags: no envelope (code 0 in bits 1 to 3), little endian (bit 0). An envelope would take 32 bytes of each geometry.
const FLAGS: u8 = 0b0000_0001;
const SRS: i32 = 4326;
const WKB_POINT: u32 = 1;
const WKB_LINESTRING: u32 = 2;
const WKB_POLYGON: u32 = 3;
const WKB_MULTILINESTRING: u32 = 5;
const WKB_MULTIPOLYGON: u32 = 6;
const HEADER_BYTES: usize = 8;
const WKB_BYTES: usize = 1 + 4 + 4;
const POSITION_BYTES: usize = 16;

/// How many positions a line has whose blob takes this many bytes; `None` if no blob of a line takes so many.
pub(crate) fn positions_of(blob_bytes: usize) -> Option<u32> {
    let bytes = blob_bytes.checked_sub(HEADER_BYTES + WKB_BYTES)?;
    u32::try_from(bytes / POSITION_BYTES).ok().filter(|_| bytes.is_multiple_of(POSITION_BYTES))
}

/// The blob of a line, and the box around the line. An empty line has no blob.
pub(crate) fn encode(positions: impl ExactSizeIterator<Item = LonLat> + Clone) -> Option<(Vec<u8>, Bounds)> {
    let bounds = Bounds::around(positions.clone())?;
    let mut blob = Vec::with_capacity(HEADER_BYTES + WKB_BYTES + POSITION_BYTES * positions.len());
    header(&mut blob);
    begin(&mut blob, WKB_LINESTRING);
    put_line(&mut blob, positions);
    Some((blob, bounds))
}

/// The blob of polygons, each with its outer ring first, and the box around them. Without a position there is no blob.
pub(crate) fn encode_polygons(polygons: &[Vec<Vec<LonLat>>]) -> Option<(Vec<u8>, Bounds)> {
    let rings = || polygons.iter().flatten();
    let bounds = rings().filter_map(|ring| Bounds::around(ring.iter().copied())).reduce(Bounds::union)?;
    let vertices: usize = rings().map(Vec::len).sum();
    let mut blob = Vec::with_capacity(
        HEADER_BYTES + WKB_BYTES * (1 + polygons.len()) + 4 * rings().count() + POSITION_BYTES * vertices,
    );
    header(&mut blob);
    begin(&mut blob, WKB_MULTIPOLYGON);
    blob.extend((polygons.len() as u32).to_le_bytes());
    for rings in polygons {
        begin(&mut blob, WKB_POLYGON);
        blob.extend((rings.len() as u32).to_le_bytes());
        rings.iter().for_each(|ring| put_line(&mut blob, ring.iter().copied()));
    }
    Some((blob, bounds))
}

/// The blob of a shape of the backdrop, and the box around it. Without a position there is no blob.
pub(crate) fn encode_shape(shape: &BackdropShape) -> Option<(Vec<u8>, Bounds)> {
    let mut blob = Vec::new();
    header(&mut blob);
    match shape {
        BackdropShape::Areas(polygons) => encode_polygons(polygons),
        BackdropShape::Lines(lines) => {
            begin(&mut blob, WKB_MULTILINESTRING);
            blob.extend((lines.len() as u32).to_le_bytes());
            for line in lines {
                begin(&mut blob, WKB_LINESTRING);
                put_line(&mut blob, line.iter().copied());
            }
            let bounds = lines.iter().filter_map(|line| Bounds::around(line.iter().copied())).reduce(Bounds::union)?;
            Some((blob, bounds))
        }
        BackdropShape::Place(place) => {
            begin(&mut blob, WKB_POINT);
            put_position(&mut blob, *place);
            Some((blob, Bounds::around(std::iter::once(*place))?))
        }
    }
}

/// The shape of a blob that [`encode_shape`] wrote; `None` for anything else.
pub(crate) fn decode_shape(blob: &[u8]) -> Option<BackdropShape> {
    let (header, mut wkb) = blob.split_at_checked(HEADER_BYTES)?;
    if !header.starts_with(&[b'G', b'P', 0, FLAGS]) {
        return None;
    }
    match u32::from_le_bytes(wkb.get(1..5)?.try_into().ok()?) {
        WKB_MULTIPOLYGON => decode_polygons(blob).map(BackdropShape::Areas),
        WKB_MULTILINESTRING => {
            let lines = count_of(&mut wkb, Some(WKB_MULTILINESTRING))?;
            let mut all = Vec::new();
            for _ in 0..lines {
                let points = count_of(&mut wkb, Some(WKB_LINESTRING))? as usize;
                let (line, rest) = wkb.split_at_checked(points.checked_mul(POSITION_BYTES)?)?;
                wkb = rest;
                all.push(positions(line)?);
            }
            wkb.is_empty().then_some(BackdropShape::Lines(all))
        }
        WKB_POINT => {
            let point = wkb.strip_prefix(&[1, WKB_POINT as u8, 0, 0, 0])?;
            let [place] = positions(point)?.try_into().ok()?;
            Some(BackdropShape::Place(place))
        }
        _ => None,
    }
}

fn header(blob: &mut Vec<u8>) {
    blob.extend(b"GP");
    blob.extend([0, FLAGS]);
    blob.extend(SRS.to_le_bytes());
}

/// The byte order and the type of a geometry.
fn begin(blob: &mut Vec<u8>, wkb_type: u32) {
    blob.push(1);
    blob.extend(wkb_type.to_le_bytes());
}

fn put_line(blob: &mut Vec<u8>, positions: impl ExactSizeIterator<Item = LonLat>) {
    blob.extend((positions.len() as u32).to_le_bytes());
    positions.for_each(|position| put_position(blob, position));
}

fn put_position(blob: &mut Vec<u8>, position: LonLat) {
    let (lon, lat) = position.degrees();
    blob.extend(lon.to_le_bytes());
    blob.extend(lat.to_le_bytes());
}

/// The polygons of a blob that [`encode_polygons`] wrote; `None` for anything else.
pub(crate) fn decode_polygons(blob: &[u8]) -> Option<Vec<Vec<Vec<LonLat>>>> {
    let (header, mut wkb) = blob.split_at_checked(HEADER_BYTES)?;
    if !header.starts_with(&[b'G', b'P', 0, FLAGS]) {
        return None;
    }
    let polygons = count_of(&mut wkb, Some(WKB_MULTIPOLYGON))?;
    let mut all = Vec::new();
    for _ in 0..polygons {
        let rings = count_of(&mut wkb, Some(WKB_POLYGON))?;
        let mut polygon = Vec::new();
        for _ in 0..rings {
            let points = count_of(&mut wkb, None)? as usize;
            let (line, rest) = wkb.split_at_checked(points.checked_mul(POSITION_BYTES)?)?;
            wkb = rest;
            polygon.push(positions(line)?);
        }
        all.push(polygon);
    }
    wkb.is_empty().then_some(all)
}

/// Takes a count, after the byte order and this type if there is one, from the front of `wkb`.
fn count_of(wkb: &mut &[u8], wkb_type: Option<u32>) -> Option<u32> {
    if let Some(wkb_type) = wkb_type {
        let (first, rest) = wkb.split_first_chunk::<5>()?;
        if *first != [1, wkb_type as u8, 0, 0, 0] {
            return None;
        }
        *wkb = rest;
    }
    let (count, rest) = wkb.split_first_chunk::<4>()?;
    *wkb = rest;
    Some(u32::from_le_bytes(*count))
}

/// The positions of a blob that [`encode`] wrote; `None` for anything else.
pub(crate) fn decode(blob: &[u8]) -> Option<Vec<LonLat>> {
    let (header, wkb) = blob.split_at_checked(HEADER_BYTES)?;
    let (wkb, points) = wkb.split_at_checked(WKB_BYTES)?;
    let expected = header.starts_with(&[b'G', b'P', 0, FLAGS]) && wkb.starts_with(&[1, WKB_LINESTRING as u8, 0, 0, 0]);
    let count = u32::from_le_bytes(wkb.get(5..9)?.try_into().ok()?);
    if !expected || points.len() != (count as usize).checked_mul(POSITION_BYTES)? {
        return None;
    }
    positions(points)
}

fn positions(bytes: &[u8]) -> Option<Vec<LonLat>> {
    let (points, []) = bytes.as_chunks::<POSITION_BYTES>() else { return None };
    points.iter().map(|point| Some(LonLat { lon_e7: e7(&point[..8])?, lat_e7: e7(&point[8..])? })).collect()
}

fn e7(degrees: &[u8]) -> Option<i32> {
    let e7 = (f64::from_le_bytes(degrees.try_into().ok()?) * 1e7).round();
    // A cast of a finite value in range is exact.
    (e7.abs() <= 1_800_000_000.0).then_some(e7 as i32)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn positions_come_back_exactly(
            places in prop::collection::vec((-1_800_000_000..=1_800_000_000, -900_000_000..=900_000_000), 1..40)
        ) {
            let line: Vec<LonLat> = places.into_iter().map(|(lon_e7, lat_e7)| LonLat { lon_e7, lat_e7 }).collect();
            let (blob, bounds) = encode(line.iter().copied()).unwrap();
            prop_assert_eq!(decode(&blob).unwrap(), line.clone());
            prop_assert_eq!(positions_of(blob.len()), Some(line.len() as u32));
            prop_assert_eq!(positions_of(blob.len() + 1), None);
            for place in line {
                let (lon, lat) = place.degrees();
                prop_assert!(bounds.west <= lon && lon <= bounds.east && bounds.south <= lat && lat <= bounds.north);
            }
        }

        #[test]
        fn polygons_come_back_exactly_and_cut_anywhere_are_none(
            places in prop::collection::vec(prop::collection::vec(prop::collection::vec(
                (-1_800_000_000..=1_800_000_000, -900_000_000..=900_000_000), 1..9), 1..4), 1..4)
        ) {
            let place = |&(lon_e7, lat_e7): &(i32, i32)| LonLat { lon_e7, lat_e7 };
            let ring = |ring: &Vec<(i32, i32)>| ring.iter().map(place).collect::<Vec<_>>();
            let polygons: Vec<Vec<Vec<LonLat>>> =
                places.iter().map(|rings| rings.iter().map(ring).collect()).collect();
            let (blob, _) = encode_polygons(&polygons).unwrap();
            prop_assert_eq!(decode_polygons(&blob).unwrap(), polygons);
            prop_assert!((0..blob.len()).all(|cut| decode_polygons(&blob[..cut]).is_none()));
            prop_assert!(decode(&blob).is_none());
        }

        #[test]
        fn shapes_come_back_exactly_and_cut_anywhere_are_none(
            places in prop::collection::vec(prop::collection::vec(
                (-1_800_000_000..=1_800_000_000, -900_000_000..=900_000_000), 1..9), 1..4)
        ) {
            let place = |&(lon_e7, lat_e7): &(i32, i32)| LonLat { lon_e7, lat_e7 };
            let lines: Vec<Vec<LonLat>> = places.iter().map(|line| line.iter().map(place).collect()).collect();
            let point = BackdropShape::Place(lines[0][0]);
            for shape in [point, BackdropShape::Areas(vec![lines.clone()]), BackdropShape::Lines(lines)] {
                let (blob, _) = encode_shape(&shape).unwrap();
                prop_assert_eq!(decode_shape(&blob), Some(shape));
                prop_assert!((0..blob.len()).all(|cut| decode_shape(&blob[..cut]).is_none()));
                prop_assert!(decode(&blob).is_none());
            }
        }

        #[test]
        fn anything_else_is_no_geometry(bytes in prop::collection::vec(any::<u8>(), 0..120)) {
            prop_assert!(decode(&bytes).is_none() && decode_polygons(&bytes).is_none() && decode_shape(&bytes).is_none());
        }
    }

    #[test]
    fn a_blob_cut_anywhere_is_no_geometry() {
        let line = [LonLat { lon_e7: 10, lat_e7: 20 }, LonLat { lon_e7: -30, lat_e7: 40 }];
        let (blob, _) = encode(line.into_iter()).unwrap();
        assert!((0..blob.len()).all(|cut| decode(&blob[..cut]).is_none()));
    }
}
