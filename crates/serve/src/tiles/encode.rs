//! Encodes layers and features as protobuf by <https://github.com/mapbox/vector-tile-spec/tree/master/2.1>. Comments name
//! the specification's fields.
//!
//! The same features in the same order give the same bytes. Each key is written once per layer, and so is each value that several
//! features may have.

use rustc_hash::FxHashMap;

/// A value of a feature's tag.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum TagValue<'v> {
    Text(&'v str),
    Whole(i64),
    Number(f64),
    Truth(bool),
}

/// A layer under construction.
pub(super) struct TileLayer {
    name: &'static str,
    /// Units per side of the tile.
    extent: u16,
    keys: Vec<&'static str>,
    /// Encoded values, in the order of their first use.
    values: Vec<u8>,
    /// Number of `values`.
    count: u32,
    places: FxHashMap<Vec<u8>, u32>,
    features: Vec<u8>,
    scratch: Scratch,
}

/// Buffers for parts of messages, whose lengths must be known before they are written. All features share them.
#[derive(Default)]
struct Scratch {
    pairs: Vec<u8>,
    geometry: Vec<u8>,
    feature: Vec<u8>,
    value: Vec<u8>,
}

/// The tags of one feature.
pub(super) struct FeatureTags<'l> {
    layer: &'l mut TileLayer,
}

impl FeatureTags<'_> {
    pub(super) fn add(&mut self, key: &'static str, value: TagValue<'_>) {
        let value = self.layer.value(value);
        self.pair(key, value);
    }

    /// Adds a value that no other feature has. The layer does not look for it.
    pub(super) fn only(&mut self, key: &'static str, value: TagValue<'_>) {
        let value = self.layer.new_value(value);
        self.pair(key, value);
    }

    fn pair(&mut self, key: &'static str, value: u32) {
        let key = self.layer.key(key);
        varint(&mut self.layer.scratch.pairs, key.into());
        varint(&mut self.layer.scratch.pairs, value.into());
    }

    /// Adds a text, if there is one.
    pub(super) fn text(&mut self, key: &'static str, value: Option<&str>) {
        if let Some(text) = value {
            self.add(key, TagValue::Text(text));
        }
    }

    /// Adds a truth value, if there is one.
    pub(super) fn truth(&mut self, key: &'static str, value: Option<bool>) {
        if let Some(truth) = value {
            self.add(key, TagValue::Truth(truth));
        }
    }

    /// Adds a number, if there is one.
    pub(super) fn number(&mut self, key: &'static str, value: Option<f64>) {
        if let Some(number) = value {
            self.add(key, TagValue::Number(number));
        }
    }
}

impl TileLayer {
    pub(super) fn new(name: &'static str, extent: u16) -> Self {
        Self {
            name,
            extent,
            keys: Vec::new(),
            values: Vec::new(),
            count: 0,
            places: FxHashMap::default(),
            features: Vec::new(),
            scratch: Scratch::default(),
        }
    }

    /// Adds a feature of lines. Adds nothing if `lines` is empty.
    pub(super) fn feature(&mut self, id: Option<u64>, lines: &[Vec<[i32; 2]>], tag: impl FnOnce(&mut FeatureTags<'_>)) {
        if !lines.is_empty() {
            self.any(id, GeometryType::LineString, lines, tag);
        }
    }

    /// Adds a feature of one point.
    pub(super) fn point(&mut self, id: Option<u64>, point: [i32; 2], tag: impl FnOnce(&mut FeatureTags<'_>)) {
        self.any(id, GeometryType::Point, &[vec![point]], tag);
    }

    /// Adds a feature of polygons, given as open rings: outer rings run clockwise on the screen, holes counter-clockwise and after
    /// their outer ring. Adds nothing if `rings` is empty.
    pub(super) fn polygons(
        &mut self,
        id: Option<u64>,
        rings: &[Vec<[i32; 2]>],
        tag: impl FnOnce(&mut FeatureTags<'_>),
    ) {
        if !rings.is_empty() {
            self.any(id, GeometryType::Polygon, rings, tag);
        }
    }

    fn any(
        &mut self,
        id: Option<u64>,
        kind: GeometryType,
        lines: &[Vec<[i32; 2]>],
        tag: impl FnOnce(&mut FeatureTags<'_>),
    ) {
        self.scratch.pairs.clear();
        tag(&mut FeatureTags { layer: self });
        let Scratch { pairs, geometry: shape, feature, .. } = &mut self.scratch;
        feature.clear();
        if let Some(id) = id {
            varint(feature, field(1, VARINT)); // id
            varint(feature, id);
        }
        bytes(feature, 2, pairs); // tags
        varint(feature, field(3, VARINT)); // type
        varint(feature, kind as u64);
        shape.clear();
        geometry(shape, kind, lines);
        bytes(feature, 4, shape); // geometry
        bytes(&mut self.features, 2, feature);
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

    /// The place of a value, which is added if it is new.
    fn value(&mut self, value: TagValue<'_>) -> u32 {
        self.scratch.value.clear();
        message(&mut self.scratch.value, value);
        if let Some(&place) = self.places.get(&self.scratch.value) {
            return place;
        }
        let place = self.add_value();
        self.places.insert(self.scratch.value.clone(), place);
        place
    }

    /// Adds a value.
    fn new_value(&mut self, value: TagValue<'_>) -> u32 {
        self.scratch.value.clear();
        message(&mut self.scratch.value, value);
        self.add_value()
    }

    fn add_value(&mut self) -> u32 {
        bytes(&mut self.values, 4, &self.scratch.value);
        self.count += 1;
        self.count - 1
    }
}

fn message(out: &mut Vec<u8>, value: TagValue<'_>) {
    match value {
        TagValue::Text(text) => bytes(out, 1, text.as_bytes()), // string_value
        TagValue::Number(number) => {
            varint(out, field(3, FIXED_64)); // double_value
            out.extend(number.to_le_bytes());
        }
        TagValue::Whole(whole) => {
            varint(out, field(6, VARINT)); // sint_value
            varint(out, zigzag(whole));
        }
        TagValue::Truth(truth) => {
            varint(out, field(7, VARINT)); // bool_value
            varint(out, truth.into());
        }
    }
}

const VARINT: u64 = 0;
const FIXED_64: u64 = 1;
const LENGTH: u64 = 2;

/// The type of a geometry (`GeomType`).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum GeometryType {
    Point = 1,
    LineString = 2,
    Polygon = 3,
}

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

/// The commands of the lines: for each line one `MoveTo` (1), then one `LineTo` (2) for the other points, if any, then `ClosePath` (7) for
/// the rings of polygons. Parameters are differences between points (section 4.3).
fn geometry(out: &mut Vec<u8>, kind: GeometryType, lines: &[Vec<[i32; 2]>]) {
    let mut cursor = [0_i32; 2];
    let mut go = |out: &mut Vec<u8>, point: [i32; 2]| {
        for axis in 0..2 {
            varint(out, zigzag(i64::from(point[axis] - cursor[axis])));
        }
        cursor = point;
    };
    for line in lines {
        let Some((first, rest)) = line.split_first() else { continue };
        varint(out, 1 << 3 | 1);
        go(out, *first);
        if !rest.is_empty() {
            varint(out, (rest.len() as u64) << 3 | 2);
        }
        rest.iter().for_each(|&point| go(out, point));
        if kind == GeometryType::Polygon {
            varint(out, 1 << 3 | 7);
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use fast_mvt::{MvtReaderRef, MvtValueRef};

    fn geometry(kind: GeometryType, lines: &[Vec<[i32; 2]>]) -> Vec<u8> {
        let mut out = Vec::new();
        super::geometry(&mut out, kind, lines);
        out
    }

    /// The example in section 4.3.5.1 of the specification: (25,17).
    #[test]
    fn a_point_is_the_specifications_example() {
        assert_eq!(geometry(GeometryType::Point, &[vec![[25, 17]]]), [9, 50, 34]);
    }

    /// The example in section 4.3.5.3 of the specification: (2,2) (2,10) (10,10), then (1,1) (3,5).
    #[test]
    fn geometry_is_the_specifications_example() {
        let lines = [vec![[2, 2], [2, 10], [10, 10]], vec![[1, 1], [3, 5]]];
        assert_eq!(geometry(GeometryType::LineString, &lines), [9, 4, 4, 18, 0, 16, 16, 0, 9, 17, 17, 10, 4, 8]);
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
        assert_eq!(geometry(GeometryType::Polygon, &rings), expected);
    }

    #[test]
    fn a_reader_of_others_reads_what_was_written() {
        let mut layer = TileLayer::new("edge", 4096);
        for id in [7_u64, 1 << 40] {
            layer.feature(Some(id), &[vec![[-64, 0], [4160, 4096]]], |tags| {
                tags.only("edge_id", TagValue::Text(&id.to_string()));
                tags.add("name", TagValue::Text("Großer Weg"));
                tags.number("rsc_m", Some(-0.125));
                tags.add("way", TagValue::Whole(-5_000_000_000));
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
            assert_eq!(properties.len(), 4);
            let id = feature.id().unwrap().to_string();
            assert!(matches!(properties[0], ("edge_id", MvtValueRef::String(own)) if own == id), "{properties:?}");
            assert!(matches!(properties[1], ("name", MvtValueRef::String("Großer Weg"))), "{properties:?}");
            assert!(matches!(properties[2], ("rsc_m", MvtValueRef::Double(m)) if m == -0.125), "{properties:?}");
            assert!(matches!(properties[3], ("way", MvtValueRef::SInt(-5_000_000_000))), "{properties:?}");
        }
    }
}
