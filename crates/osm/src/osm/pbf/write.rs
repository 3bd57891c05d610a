//! A small `.osm.pbf` writer for the demo region, tests and benchmarks.
//!
//! The same objects give the same bytes, in the given order: dense nodes, zlib blobs, no metadata. It writes neither
//! relations nor metadata, and no resolution but 1e-7 degree.

use std::io::Write as _;

use flate2::{Compression, write::ZlibEncoder};
use osmpbfreader::{fileformat, osmformat};
use protobuf::Message;
use rustc_hash::FxHashMap;

use crate::osm::LonLat;
use crate::osm::changes::{Changes, Object, ObjectKind};

/// Most objects of a block, as in other writers.
const BLOCK_OBJECTS: usize = 8000;

/// A node to write.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NodeRecord {
    /// OSM node id.
    pub id: i64,
    /// Position.
    pub place: LonLat,
    /// Keys and values, in the order of the file.
    pub tags: Vec<(String, String)>,
}

/// A way to write.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WayRecord {
    /// OSM way id.
    pub id: i64,
    /// Node ids along it.
    pub refs: Vec<i64>,
    /// Keys and values, in the order of the file.
    pub tags: Vec<(String, String)>,
}

/// The bytes of a `.osm.pbf` with these objects, nodes first, in the given order. The header says `Sort.Type_then_ID`
/// if the ids ascend.
#[must_use]
pub fn write_extract(nodes: &[NodeRecord], ways: &[WayRecord]) -> Vec<u8> {
    write_extract_in_blocks(nodes, ways, BLOCK_OBJECTS)
}

/// As [`write_extract`], with at most `block_objects` objects per block (at least one).
#[must_use]
pub fn write_extract_in_blocks(nodes: &[NodeRecord], ways: &[WayRecord], block_objects: usize) -> Vec<u8> {
    let block_objects = block_objects.max(1);
    let mut header = osmformat::HeaderBlock::new();
    header.required_features = vec!["OsmSchema-V0.6".to_owned(), "DenseNodes".to_owned()];
    if nodes.is_sorted_by_key(|n| n.id) && ways.is_sorted_by_key(|w| w.id) {
        header.optional_features = vec!["Sort.Type_then_ID".to_owned()];
    }
    header.set_writingprogram("netcert".to_owned());
    let mut out = Vec::new();
    frame(&mut out, "OSMHeader", &zlib_blob(&bytes_of(&header)));
    for chunk in nodes.chunks(block_objects) {
        frame(&mut out, "OSMData", &zlib_blob(&bytes_of(&node_block(chunk))));
    }
    for chunk in ways.chunks(block_objects) {
        frame(&mut out, "OSMData", &zlib_blob(&bytes_of(&way_block(chunk))));
    }
    out
}

/// Appends one framed blob: length, `BlobHeader`, and the blob's bytes as given.
pub fn frame(out: &mut Vec<u8>, kind: &str, blob: &[u8]) {
    let mut header = fileformat::BlobHeader::new();
    header.set_type(kind.to_owned());
    header.set_datasize(i32::try_from(blob.len()).unwrap_or(i32::MAX));
    let header = bytes_of(&header);
    out.extend_from_slice(&(header.len() as u32).to_be_bytes());
    out.extend_from_slice(&header);
    out.extend_from_slice(blob);
}

/// A `Blob` message holding `payload` uncompressed.
#[must_use]
pub fn raw_blob(payload: &[u8]) -> Vec<u8> {
    let mut blob = fileformat::Blob::new();
    blob.set_raw(payload.to_vec());
    bytes_of(&blob)
}

/// A `Blob` message holding `payload` deflated.
#[must_use]
pub fn zlib_blob(payload: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    let deflated = encoder.write_all(payload).and_then(|()| encoder.finish());
    // Writing to memory cannot fail. If it did, a raw blob would hold the same data.
    let Ok(deflated) = deflated else { return raw_blob(payload) };
    let mut blob = fileformat::Blob::new();
    blob.set_raw_size(i32::try_from(payload.len()).unwrap_or(i32::MAX));
    blob.set_zlib_data(deflated);
    bytes_of(&blob)
}

fn bytes_of(message: &impl Message) -> Vec<u8> {
    // This fails only for a message that lacks a required field; none does here.
    message.write_to_bytes().unwrap_or_default()
}

/// A block's strings, numbered by first use. 0 is the delimiter.
#[derive(Default)]
struct Strings<'t> {
    texts: Vec<&'t str>,
    numbers: FxHashMap<&'t str, u32>,
}

impl<'t> Strings<'t> {
    fn number(&mut self, text: &'t str) -> u32 {
        *self.numbers.entry(text).or_insert_with(|| {
            self.texts.push(text);
            self.texts.len() as u32
        })
    }

    fn block(self, group: osmformat::PrimitiveGroup) -> osmformat::PrimitiveBlock {
        let mut block = osmformat::PrimitiveBlock::new();
        let table = block.stringtable.mut_or_insert_default();
        table.s = std::iter::once("").chain(self.texts).map(|text| text.as_bytes().to_vec()).collect();
        block.primitivegroup.push(group);
        block
    }
}

fn node_block(nodes: &[NodeRecord]) -> osmformat::PrimitiveBlock {
    let mut strings = Strings::default();
    let mut group = osmformat::PrimitiveGroup::new();
    let dense = group.dense.mut_or_insert_default();
    let (mut id, mut lat, mut lon) = (0, 0, 0);
    let tagged = nodes.iter().any(|node| !node.tags.is_empty());
    for node in nodes {
        let place = node.place;
        dense.id.push(delta(&mut id, node.id));
        dense.lat.push(delta(&mut lat, i64::from(place.lat_e7)));
        dense.lon.push(delta(&mut lon, i64::from(place.lon_e7)));
        if tagged {
            for (key, value) in &node.tags {
                dense.keys_vals.push(strings.number(key) as i32);
                dense.keys_vals.push(strings.number(value) as i32);
            }
            dense.keys_vals.push(0);
        }
    }
    strings.block(group)
}

fn way_block(ways: &[WayRecord]) -> osmformat::PrimitiveBlock {
    let mut strings = Strings::default();
    let mut group = osmformat::PrimitiveGroup::new();
    for record in ways {
        let mut way = osmformat::Way::new();
        way.set_id(record.id);
        way.keys = record.tags.iter().map(|(key, _)| strings.number(key)).collect();
        way.vals = record.tags.iter().map(|(_, value)| strings.number(value)).collect();
        let mut last = 0;
        way.refs = record.refs.iter().map(|&node| delta(&mut last, node)).collect();
        group.ways.push(way);
    }
    strings.block(group)
}

/// The objects that exist after changes, as blocks without frames.
pub(super) fn blocks_of(changes: &Changes) -> Vec<Vec<u8>> {
    let objects: Vec<(i64, &Object)> = changes.objects().collect();
    objects.chunks(BLOCK_OBJECTS).map(|objects| bytes_of(&block_of(objects))).collect()
}

fn block_of(objects: &[(i64, &Object)]) -> osmformat::PrimitiveBlock {
    let mut strings = Strings::default();
    let mut group = osmformat::PrimitiveGroup::new();
    for &(id, object) in objects {
        let (Object::Node { tags, .. } | Object::Way { tags, .. } | Object::Relation { tags, .. }) = object;
        let keys: Vec<u32> = tags.iter().map(|(key, _)| strings.number(key)).collect();
        let vals: Vec<u32> = tags.iter().map(|(_, value)| strings.number(value)).collect();
        let mut last = 0;
        match object {
            Object::Node { place, .. } => {
                let mut node = osmformat::Node::new();
                node.set_id(id);
                node.set_lat(i64::from(place.lat_e7));
                node.set_lon(i64::from(place.lon_e7));
                (node.keys, node.vals) = (keys, vals);
                group.nodes.push(node);
            }
            Object::Way { refs, .. } => {
                let mut way = osmformat::Way::new();
                way.set_id(id);
                way.refs = refs.iter().map(|&node| delta(&mut last, node)).collect();
                (way.keys, way.vals) = (keys, vals);
                group.ways.push(way);
            }
            Object::Relation { members, .. } => {
                let mut relation = osmformat::Relation::new();
                relation.set_id(id);
                for (kind, member, role) in members {
                    let kind = match kind {
                        ObjectKind::Node => osmformat::relation::MemberType::NODE,
                        ObjectKind::Way => osmformat::relation::MemberType::WAY,
                        ObjectKind::Relation => osmformat::relation::MemberType::RELATION,
                    };
                    relation.types.push(kind.into());
                    relation.memids.push(delta(&mut last, *member));
                    relation.roles_sid.push(strings.number(role) as i32);
                }
                (relation.keys, relation.vals) = (keys, vals);
                group.relations.push(relation);
            }
        }
    }
    strings.block(group)
}

/// `value − last`. `last` becomes `value`. The difference wraps for ids 2⁶³ apart, which no map has.
fn delta(last: &mut i64, value: i64) -> i64 {
    let difference = value.wrapping_sub(*last);
    *last = value;
    difference
}
