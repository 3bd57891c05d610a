//! Well-known binary (ISO 19125, and the flags of PostGIS), and the blobs of a GeoPackage around it (clause 2.1.3).
//!
//! No count in the bytes is believed: memory grows only with bytes that are there.

use super::{Shape, Xy};

const CUT: &str = "the geometry ends too early; write the file again";

/// Bytes that are still to be read.
struct Bytes<'b> {
    rest: &'b [u8],
    little: bool,
}

impl Bytes<'_> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], String> {
        let (taken, rest) = self.rest.split_first_chunk::<N>().ok_or(CUT)?;
        self.rest = rest;
        Ok(*taken)
    }

    fn u32(&mut self) -> Result<u32, String> {
        let bytes = self.take()?;
        Ok(if self.little { u32::from_le_bytes(bytes) } else { u32::from_be_bytes(bytes) })
    }

    fn f64(&mut self) -> Result<f64, String> {
        let bytes = self.take()?;
        Ok(if self.little { f64::from_le_bytes(bytes) } else { f64::from_be_bytes(bytes) })
    }

    /// A geometry's type, 1 to 7, and the number of coordinates of its positions.
    fn header(&mut self) -> Result<(u32, usize), String> {
        self.little = match self.take::<1>()? {
            [0] => false,
            [1] => true,
            _ => return Err("the geometry is no well-known binary; write the file again".to_owned()),
        };
        let word = self.u32()?;
        let flag = |bit: u32| usize::from(word & bit != 0);
        let (kind, thousands) = ((word & 0x0fff_ffff) % 1000, (word & 0x0fff_ffff) / 1000);
        if word & 0x2000_0000 != 0 {
            match self.u32()? {
                0 | 4326 => {}
                srid => return Err(format!("its reference system is {srid}; transform it to WGS 84 (EPSG:4326)")),
            }
        }
        let iso = [0, 1, 1, 2].get(thousands as usize).copied().ok_or("the geometry is of an unknown type")?;
        Ok((kind, 2 + iso + flag(0x8000_0000) + flag(0x4000_0000)))
    }

    fn xy(&mut self, coordinates: usize) -> Result<Xy, String> {
        let at = [self.f64()?, self.f64()?];
        for _ in 2..coordinates {
            self.f64()?;
        }
        Ok(at)
    }

    /// A count, and so many items.
    fn list<T>(&mut self, item: impl Fn(&mut Self) -> Result<T, String>) -> Result<Vec<T>, String> {
        (0..self.u32()?).map(|_| item(self)).collect()
    }

    fn line(&mut self, coordinates: usize) -> Result<Vec<Xy>, String> {
        self.list(|bytes| bytes.xy(coordinates))
    }

    fn polygon(&mut self, coordinates: usize) -> Result<Vec<Vec<Xy>>, String> {
        self.list(|bytes| bytes.line(coordinates))
    }

    /// A point, a line or a polygon; `None` if it is empty.
    fn one(&mut self, kind: u32, coordinates: usize) -> Result<Option<Shape>, String> {
        let shape = match kind {
            1 => Shape::Point(self.xy(coordinates)?),
            2 => Shape::Line(self.line(coordinates)?),
            3 => Shape::Polygon(self.polygon(coordinates)?),
            _ => return Err("neither point nor line nor polygon; convert it to one".to_owned()),
        };
        // An empty point has no numbers (GeoPackage, clause 2.1.3.1.1).
        let nowhere = matches!(shape, Shape::Point(at) if at.iter().all(|x| x.is_nan()));
        Ok(Some(shape).filter(|shape| !nowhere && !shape.is_empty()))
    }

    /// Parts of a geometry that has several, without empty ones. Each has a header of its own.
    fn parts(&mut self, kind: u32) -> Result<Vec<Shape>, String> {
        let parts = self.list(|bytes| match bytes.header()? {
            (found, coordinates) if found == kind => bytes.one(kind, coordinates),
            _ => Err("a part of the geometry is of another type; write the file again".to_owned()),
        })?;
        Ok(parts.into_iter().flatten().collect())
    }

    fn shape(&mut self) -> Result<Option<Shape>, String> {
        match self.header()? {
            (several @ 4..=6, _) => Shape::only(self.parts(several - 3)?, |shape| shape),
            (kind, coordinates) => self.one(kind, coordinates),
        }
    }
}

/// The shape of well-known binary; `None` if it is empty.
pub fn from_wkb(wkb: &[u8]) -> Result<Option<Shape>, String> {
    let mut bytes = Bytes { rest: wkb, little: true };
    let shape = bytes.shape()?;
    if bytes.rest.is_empty() { Ok(shape) } else { Err("bytes follow the geometry; write the file again".to_owned()) }
}

/// The reference system and the shape of a GeoPackage's blob.
pub fn from_geopackage(blob: &[u8]) -> Result<(i32, Option<Shape>), String> {
    let mut bytes = Bytes { rest: blob, little: true };
    let [g, p, _, flags] = bytes.take()?;
    if [g, p] != *b"GP" || flags & 0x20 != 0 {
        return Err("the geometry is none of a GeoPackage; write the file again".to_owned());
    }
    bytes.little = flags & 1 == 1;
    let srs = bytes.u32()? as i32;
    let envelope = [0, 32, 48, 48, 64].get(usize::from(flags >> 1 & 7)).copied();
    let wkb = envelope.and_then(|length| bytes.rest.get(length..)).ok_or(CUT)?;
    Ok((srs, from_wkb(wkb)?))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn several(kind: u32, parts: &[&[u8]]) -> Vec<u8> {
        let head = [&[1][..], &kind.to_le_bytes(), &(parts.len() as u32).to_le_bytes()].concat();
        [head, parts.concat()].concat()
    }

    #[test]
    fn empty_parts_are_no_parts() {
        let [nothing, some] =
            [f64::NAN, 8.0].map(|x| [&[1, 1, 0, 0, 0][..], &x.to_le_bytes(), &x.to_le_bytes()].concat());
        let line = [1, 2, 0, 0, 0, 0, 0, 0, 0];
        let polygon = [1, 3, 0, 0, 0, 0, 0, 0, 0];
        let of_an_empty_ring = [&[1, 3, 0, 0, 0, 1, 0, 0, 0][..], &[0; 4]].concat();
        for (kind, part) in [(4, &nothing[..]), (5, &line), (6, &polygon), (6, &of_an_empty_ring)] {
            assert_eq!(from_wkb(part), Ok(None));
            assert_eq!(from_wkb(&several(kind, &[])), Ok(None));
            assert_eq!(from_wkb(&several(kind, &[part, part])), Ok(None));
        }
        assert_eq!(from_wkb(&several(4, &[&nothing, &some])), Ok(Some(Shape::Point([8.0, 8.0]))));
        assert!(from_wkb(&several(4, &[&some, &some])).unwrap_err().contains("2 parts"));
        assert!(from_wkb(&several(5, &[&some])).unwrap_err().contains("of another type"));
    }
}
