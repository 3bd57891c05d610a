//! Encodes layers and features as protobuf by <https://github.com/mapbox/vector-tile-spec/tree/master/2.1>. Comments name
//! the specification's fields.
//!
//! The same features in the same order give the same bytes. Each key and each value is written once per layer.

use rustc_hash::FxHashMap;

/// A value of a feature's tag.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Value<'v> {
    Text(&'v str),
    Whole(i64),
    Number(f64),
    Truth(bool),
}

/// A layer under construction.
pub(super) struct Layer {
    name: &'static str,
    /// Units per side of the tile.
    extent: u16,
    keys: Vec<&'static str>,
    /// Encoded values, in the order of their first use.
    values: Vec<u8>,
    places: FxHashMap<Vec<u8>, u32>,
    features: Vec<u8>,
}

/// The tags of one feature.
pub(super) struct Tags<'l> {
    layer: &'l mut Layer,
    pairs: Vec<u8>,
}

impl Tags<'_> {
    pub(super) fn add(&mut self, key: &'static str, value: Value<'_>) {
        let key = self.layer.key(key);
        let value = self.layer.value(value);
        varint(&mut self.pairs, key.into());
        varint(&mut self.pairs, value.into());
    }

    /// Adds a text, if there is one.
    pub(super) fn text(&mut self, key: &'static str, value: Option<&str>) {
        if let Some(text) = value {
            self.add(key, Value::Text(text));
        }
    }

    /// Adds a truth value, if there is one.
    pub(super) fn truth(&mut self, key: &'static str, value: Option<bool>) {
        if let Some(truth) = value {
            self.add(key, Value::Truth(truth));
        }
    }

    /// Adds a number, if there is one.
    pub(super) fn number(&mut self, key: &'static str, value: Option<f64>) {
        if let Some(number) = value {
            self.add(key, Value::Number(number));
        }
    }
}

impl Layer {
    pub(super) fn new(name: &'static str, extent: u16) -> Self {
        Self { name, extent, keys: Vec::new(), values: Vec::new(), places: FxHashMap::default(), features: Vec::new() }
    }

    /// Adds a feature of lines. Adds nothing if `lines` is empty.
    pub(super) fn feature(&mut self, id: Option<u64>, lines: &[Vec<[i32; 2]>], tag: impl FnOnce(&mut Tags<'_>)) {
        if !lines.is_empty() {
            self.any(id, LINESTRING, &geometry(lines, false), tag);
        }
    }

    /// Adds a feature of polygons, given as open rings: outer rings run clockwise on the screen, holes counter-clockwise and after
    /// their outer ring. Adds nothing if `rings` is empty.
    pub(super) fn polygons(&mut self, id: Option<u64>, rings: &[Vec<[i32; 2]>], tag: impl FnOnce(&mut Tags<'_>)) {
        if !rings.is_empty() {
            self.any(id, POLYGON, &geometry(rings, true), tag);
        }
    }

    fn any(&mut self, id: Option<u64>, kind: u64, geometry: &[u8], tag: impl FnOnce(&mut Tags<'_>)) {
        let mut tags = Tags { layer: self, pairs: Vec::new() };
        tag(&mut tags);
        let pairs = tags.pairs;
        let mut feature = Vec::with_capacity(pairs.len() + 40);
        if let Some(id) = id {
            varint(&mut feature, field(1, VARINT)); // id
            varint(&mut feature, id);
        }
        bytes(&mut feature, 2, &pairs); // tags
        varint(&mut feature, field(3, VARINT)); // type
        varint(&mut feature, kind);
        bytes(&mut feature, 4, geometry); // geometry
        bytes(&mut self.features, 2, &feature);
    }

    /// Appends the layer to a tile. An empty layer is left out, as the specification requires.
    pub(super) fn finish(self, tile: &mut Vec<u8>) {
        if self.features.is_empty() {
            return;
        }
        let mut layer = Vec::with_capacity(self.features.len() + self.values.len() + 300);
        varint(&mut layer, field(15, VARINT)); // version
        varint(&mut layer, 2);
        bytes(&mut layer, 1, self.name.as_bytes());
        layer.extend(self.features);
        for key in self.keys {
            bytes(&mut layer, 3, key.as_bytes());
        }
        layer.extend(self.values);
        varint(&mut layer, field(5, VARINT)); // extent
        varint(&mut layer, self.extent.into());
        bytes(tile, 3, &layer);
    }

    fn key(&mut self, key: &'static str) -> u32 {
        let place = self.keys.iter().position(|other| *other == key);
        place.unwrap_or_else(|| {
            self.keys.push(key);
            self.keys.len() - 1
        }) as u32
    }

    fn value(&mut self, value: Value<'_>) -> u32 {
        let mut message = Vec::with_capacity(24);
        match value {
            Value::Text(text) => bytes(&mut message, 1, text.as_bytes()), // string_value
            Value::Number(number) => {
                varint(&mut message, field(3, FIXED_64)); // double_value
                message.extend(number.to_le_bytes());
            }
            Value::Whole(whole) => {
                varint(&mut message, field(6, VARINT)); // sint_value
                varint(&mut message, zigzag(whole));
            }
            Value::Truth(truth) => {
                varint(&mut message, field(7, VARINT)); // bool_value
                varint(&mut message, truth.into());
            }
        }
        let next = self.places.len() as u32;
        if let Some(&place) = self.places.get(&message) {
            return place;
        }
        bytes(&mut self.values, 4, &message);
        self.places.insert(message, next);
        next
    }
}

const VARINT: u64 = 0;
const FIXED_64: u64 = 1;
const LENGTH: u64 = 2;
/// Types of geometries.
const LINESTRING: u64 = 2;
const POLYGON: u64 = 3;

fn field(number: u64, wire: u64) -> u64 {
    number << 3 | wire
}

fn bytes(out: &mut Vec<u8>, number: u64, content: &[u8]) {
    varint(out, field(number, LENGTH));
    varint(out, content.len() as u64);
    out.extend(content);
}

fn varint(out: &mut Vec<u8>, mut value: u64) {
    while value > 0x7f {
        out.push(value as u8 | 0x80);
        value >>= 7;
    }
    out.push(value as u8);
}

fn zigzag(value: i64) -> u64 {
    (value << 1 ^ value >> 63) as u64
}

/// The commands of the lines: for each line one `MoveTo` (1), then one `LineTo` (2) for the other points, then `ClosePath` (7) for
/// rings. Parameters are differences between points (section 4.3).
fn geometry(lines: &[Vec<[i32; 2]>], closed: bool) -> Vec<u8> {
    let mut out = Vec::new();
    let mut cursor = [0_i32; 2];
    let mut go = |out: &mut Vec<u8>, point: [i32; 2]| {
        for axis in 0..2 {
            varint(out, zigzag(i64::from(point[axis] - cursor[axis])));
        }
        cursor = point;
    };
    for line in lines {
        let Some((first, rest)) = line.split_first() else { continue };
        varint(&mut out, 1 << 3 | 1);
        go(&mut out, *first);
        varint(&mut out, (rest.len() as u64) << 3 | 2);
        rest.iter().for_each(|&point| go(&mut out, point));
        if closed {
            varint(&mut out, 1 << 3 | 7);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use fast_mvt::{MvtReaderRef, MvtValueRef};

    /// The example in section 4.3.5.3 of the specification: (2,2) (2,10) (10,10), then (1,1) (3,5).
    #[test]
    fn geometry_is_the_specifications_example() {
        let lines = [vec![[2, 2], [2, 10], [10, 10]], vec![[1, 1], [3, 5]]];
        assert_eq!(geometry(&lines, false), [9, 4, 4, 18, 0, 16, 16, 0, 9, 17, 17, 10, 4, 8]);
    }

    /// The example in section 4.3.5.5 of the specification: two polygons, the second one with a hole.
    #[test]
    fn rings_are_the_specifications_example() {
        let rings = [
            vec![[0, 0], [10, 0], [10, 10], [0, 10]],
            vec![[11, 11], [20, 11], [20, 20], [11, 20]],
            vec![[13, 13], [13, 17], [17, 17], [17, 13]],
        ];
        let expected = [
            9, 0, 0, 26, 20, 0, 0, 20, 19, 0, 15, 9, 22, 2, 26, 18, 0, 0, 18, 17, 0, 15, 9, 4, 13, 26, 0, 8, 8, 0, 0,
            7, 15,
        ];
        assert_eq!(geometry(&rings, true), expected);
    }

    #[test]
    fn a_reader_of_others_reads_what_was_written() {
        let mut layer = Layer::new("edge", 4096);
        for id in [7_u64, 1 << 40] {
            layer.feature(Some(id), &[vec![[-64, 0], [4160, 4096]]], |tags| {
                tags.add("name", Value::Text("Großer Weg"));
                tags.number("rsc_m", Some(-0.125));
                tags.add("way", Value::Whole(-5_000_000_000));
                tags.number("nothing", None);
            });
        }
        layer.feature(None, &[], |_| {});
        let mut tile = Vec::new();
        layer.finish(&mut tile);
        let reader = MvtReaderRef::new(&tile).unwrap();
        let layers: Vec<_> = reader.layers().collect();
        assert_eq!(layers.len(), 1);
        let features: Vec<_> = layers[0].features().collect();
        assert_eq!(features.iter().map(|f| f.id()).collect::<Vec<_>>(), [Some(7), Some(1 << 40)]);
        for feature in features {
            let properties: Vec<_> = feature.properties().map(Result::unwrap).collect();
            assert_eq!(properties.len(), 3);
            assert!(matches!(properties[0], ("name", MvtValueRef::String("Großer Weg"))), "{properties:?}");
            assert!(matches!(properties[1], ("rsc_m", MvtValueRef::Double(m)) if m == -0.125), "{properties:?}");
            assert!(matches!(properties[2], ("way", MvtValueRef::SInt(-5_000_000_000))), "{properties:?}");
        }
    }
}
