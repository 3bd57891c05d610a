//! Damaged files: cut anywhere, or changed anywhere. The reader never panics, never takes more memory than a few
//! blobs need, and what it accepts is sound. Overflow checks are on in a test build.
#![allow(unsafe_code)] // An allocator that counts.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stderr)]

use std::{
    alloc::{GlobalAlloc, Layout, System},
    fs::{self, OpenOptions},
    path::Path,
    sync::atomic::{AtomicUsize, Ordering},
};

use netcert::osm::{
    Extract, LonLat,
    pbf::{
        ReadError, read_extract,
        write::{self, NodeRecord, WayRecord},
    },
};
use netcert_testing::accounts::assert_adds_up;
use netcert_testing::extracts::extract;
use osmpbfreader::osmformat;
use protobuf::Message;

/// Counts what is allocated, so that a test can say how much it was at most.
struct Counting;

static NOW: AtomicUsize = AtomicUsize::new(0);
static PEAK: AtomicUsize = AtomicUsize::new(0);

// SAFETY: hands everything on to the system's allocator as it is.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let now = NOW.fetch_add(layout.size(), Ordering::Relaxed) + layout.size();
        PEAK.fetch_max(now, Ordering::Relaxed);
        // SAFETY: the caller's promises are those of `System`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        NOW.fetch_sub(layout.size(), Ordering::Relaxed);
        // SAFETY: the caller's promises are those of `System`.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[test]
fn a_file_cut_at_any_byte_is_refused_and_between_blobs_it_is_visibly_shorter() {
    let (nodes, ways) = small_region();
    let bytes = write::write_extract_in_blocks(&nodes, &ways, 10);
    let boundaries = boundaries(&bytes);
    assert!(boundaries.len() > 8, "several blobs of nodes and of ways");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cut.osm.pbf");
    fs::write(&path, &bytes).unwrap();
    let whole = read(&path).unwrap();
    let file = OpenOptions::new().write(true).open(&path).unwrap();
    for cut in (0..bytes.len()).rev() {
        file.set_len(cut as u64).unwrap();
        match read(&path) {
            Err(error) => assert!(!boundaries.contains(&cut), "cut at {cut}: {error}"),
            Ok(extract) => {
                assert!(boundaries.contains(&cut), "cut at {cut}, and it went unnoticed");
                let read = |x: &Extract| x.account.nodes.read + x.account.ways_read;
                assert!(read(&extract) < read(&whole));
                assert_eq!(extract.account.bytes, cut as u64);
                assert_ne!(extract.account.blake3, whole.account.blake3);
                assert!(!extract.account.warnings().is_empty());
                check_soundness(&extract);
            }
        }
    }
}

#[test]
fn a_real_file_cut_in_any_frame_is_refused() {
    let Some(real) = extract("sydney_au.osm.pbf") else { return };
    let bytes = fs::read(real).unwrap();
    let boundaries = boundaries(&bytes);
    let temporary = tempfile::tempdir().unwrap();
    let path = temporary.path().join("cut.osm.pbf");
    fs::write(&path, &bytes).unwrap();
    let file = OpenOptions::new().write(true).open(&path).unwrap();
    // Every byte of each frame's head, the first ones of its blob, some inside it and the last ones.
    let starts = [&[0], boundaries.as_slice()].concat();
    for (&start, &end) in starts.iter().zip(&boundaries).rev() {
        let inside = (1..8).map(|eighth| start + (end - start) * eighth / 8);
        let mut cuts: Vec<usize> = (start + 1..start + 40).chain(inside).chain(end - 10..end).collect();
        cuts.sort_unstable();
        for cut in cuts.into_iter().filter(|cut| (start + 1..end).contains(cut)).rev() {
            file.set_len(cut as u64).unwrap();
            let error = read(&path).expect_err("a cut file");
            assert_eq!(error.offset, Some(if cut < 4 { 0 } else { start as u64 }), "{error}");
        }
    }
}

#[test]
fn changed_messages_never_panic_and_what_is_accepted_is_sound() {
    let payloads = [header(), full_block(), full_block()];
    let frame = |payloads: &[Vec<u8>]| {
        let mut bytes = Vec::new();
        for (number, payload) in payloads.iter().enumerate() {
            write::frame(&mut bytes, if number == 0 { "OSMHeader" } else { "OSMData" }, &write::raw_blob(payload));
        }
        bytes
    };
    let (accepted, refused) = mutate(20_000, 1, |random| {
        let mut payloads = payloads.clone();
        let which = if random.below(20) == 0 { 0 } else { 1 };
        random.damage(&mut payloads[which]);
        frame(&payloads)
    });
    // Both must happen, or the changes are too timid or too wild to show anything.
    assert!(accepted > 1000 && refused > 5000, "{accepted} accepted, {refused} refused");
}

#[test]
fn changed_files_never_panic_and_what_is_accepted_is_sound() {
    let mut bytes = Vec::new();
    write::frame(&mut bytes, "OSMHeader", &write::zlib_blob(&header()));
    write::frame(&mut bytes, "OSMData", &write::zlib_blob(&full_block()));
    let (accepted, refused) = mutate(5_000, 2, |random| {
        let mut bytes = bytes.clone();
        random.damage(&mut bytes);
        bytes
    });
    assert!(refused > 4000, "{accepted} accepted, {refused} refused");
}

#[test]
fn a_block_of_millions_of_tiny_objects_is_refused_before_it_fills_memory() {
    // 30 million bytes of empty groups, and of empty ways: kilobytes when deflated.
    for piece in [&[0x12, 0][..], &[0x12, 4, 0x1a, 2, 8, 1]] {
        let mut bytes = Vec::new();
        write::frame(&mut bytes, "OSMHeader", &write::zlib_blob(&header()));
        write::frame(&mut bytes, "OSMData", &write::zlib_blob(&piece.repeat(30_000_000 / piece.len())));
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("bomb.osm.pbf");
        fs::write(&path, &bytes).unwrap();
        let message = read(&path).unwrap_err().to_string();
        assert!(message.contains("at most 1,000,000"), "{message}");
    }
    assert_memory_bounded();
}

#[test]
fn an_object_of_millions_of_tags_nodes_or_members_is_refused_before_it_fills_memory() {
    let bytes = |field: u8, content: &[u8]| {
        let mut out = vec![field << 3 | 2];
        let mut length = content.len();
        while length > 0x7f {
            out.push(length as u8 | 0x80);
            length >>= 7;
        }
        out.push(length as u8);
        out.extend_from_slice(content);
        out
    };
    let id = &[8, 1][..];
    let tags = || [bytes(2, &[1; 3_000_000]), bytes(3, &[1; 3_000_000])].concat();
    let way = |content: &[u8]| bytes(3, &[id, content].concat());
    // A road of two nodes, the first one millions of times, with a place for each.
    let places = || {
        let [nodes, lats, lons] = [8, 9, 10].map(|field| bytes(field, &[&[0; 3_000_000][..], &[2]].concat()));
        way(&[&[0x12, 1, 1, 0x1a, 1, 2][..], &nodes, &lats, &lons].concat())
    };
    let dense = || {
        let keys_values = [&[1; 5_999_998][..], &[0]].concat();
        bytes(2, &[bytes(1, &[2]), bytes(8, &[2]), bytes(9, &[2]), bytes(10, &keys_values)].concat())
    };
    let members = || [id, &[8, 9, 10].map(|field| bytes(field, &[0; 3_000_000])).concat()].concat();
    let bombs: [(&str, &dyn Fn() -> Vec<u8>); 7] = [
        ("tags of an object", &|| way(&tags())),
        ("nodes of a way", &|| way(&bytes(8, &[2; 3_000_000]))),
        ("nodes of a way", &places),
        ("tags of an object", &|| bytes(1, &[id, &[0x40, 0, 0x48, 0], &tags()].concat())),
        ("tags of an object", &dense),
        ("tags of an object", &|| bytes(4, &[id, &tags()].concat())),
        ("members of a relation", &|| bytes(4, &members())),
    ];
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bomb.osm.pbf");
    for (what, group) in bombs {
        let strings = bytes(1, b"\x0a\0\x0a\x07highway\x0a\x07primary");
        let mut file = Vec::new();
        write::frame(&mut file, "OSMHeader", &write::zlib_blob(&header()));
        write::frame(&mut file, "OSMData", &write::zlib_blob(&[strings, bytes(2, &group())].concat()));
        fs::write(&path, &file).unwrap();
        let message = read(&path).unwrap_err().to_string();
        assert!(message.contains(what) && message.contains("at most 1,000,000"), "{message}");
    }
    assert_memory_bounded();
}

/// Reads `count` changed files; how many were accepted and refused.
fn mutate(count: u64, seed: u64, change: impl Fn(&mut Random) -> Vec<u8>) -> (u64, u64) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("changed.osm.pbf");
    let (mut accepted, mut refused) = (0, 0);
    for number in 0..count {
        let mut random = Random(seed << 32 | (number + 1));
        fs::write(&path, change(&mut random)).unwrap();
        match std::panic::catch_unwind(|| read(&path)) {
            Ok(Ok(extract)) => {
                accepted += 1;
                check_soundness(&extract);
            }
            Ok(Err(_)) => refused += 1,
            Err(_) => panic!("panicked on mutation {number} of seed {seed}"),
        }
    }
    assert_memory_bounded();
    (accepted, refused)
}

/// Two threads with the largest blob each, its packed form, and the window: nothing a file says may take more.
fn assert_memory_bounded() {
    let peak = PEAK.load(Ordering::Relaxed) >> 20;
    assert!(peak < 400, "{peak} MiB");
}

fn check_soundness(extract: &Extract) {
    let account = &extract.account;
    assert_adds_up(account);
    assert_eq!(account.ways_kept, extract.ways.len() as u64);
    assert!(extract.ways.is_sorted_by(|a, b| a.id < b.id));
    for way in &extract.ways {
        let refs = &extract.refs[way.refs.start as usize..way.refs.end as usize];
        assert!(refs.len() >= 2 && refs.windows(2).all(|pair| pair[0] != pair[1]));
        assert!(refs.iter().all(|node| extract.nodes.index(*node).is_some()));
    }
    for place in extract.nodes.places.iter().flatten() {
        assert!(place.lon_e7.abs() <= 1_800_000_000 && place.lat_e7.abs() <= 900_000_000);
    }
}

fn read(path: &Path) -> Result<Extract, ReadError> {
    read_extract(path, &|_| ())
}

/// Where the blobs of a good file end.
fn boundaries(bytes: &[u8]) -> Vec<usize> {
    use osmpbfreader::fileformat::BlobHeader;
    let mut ends = Vec::new();
    let mut at = 0;
    while at < bytes.len() {
        let length = u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
        let header = BlobHeader::parse_from_bytes(&bytes[at + 4..at + 4 + length]).unwrap();
        at += 4 + length + usize::try_from(header.datasize()).unwrap();
        ends.push(at);
    }
    ends
}

fn small_region() -> (Vec<NodeRecord>, Vec<WayRecord>) {
    let tags = |pairs: &[(&str, &str)]| pairs.iter().map(|&(k, v)| (k.to_owned(), v.to_owned())).collect::<Vec<_>>();
    let node = |id: i64| {
        let place = LonLat { lon_e7: 87_000_000 + id as i32 * 1000, lat_e7: 494_000_000 + (id % 7) as i32 * 900 };
        NodeRecord { id, place, tags: if id % 5 == 0 { tags(&[("barrier", "bollard")]) } else { vec![] } }
    };
    let way = |id: i64| {
        let tags = tags(&[("highway", "primary"), ("lanes", "2"), ("name", ["East", "West"][id as usize % 2])]);
        WayRecord { id, refs: (id..id + 4).collect(), tags }
    };
    ((1..=60).map(node).collect(), (1..=50).map(way).collect())
}

fn header() -> Vec<u8> {
    let mut header = osmformat::HeaderBlock::new();
    header.required_features = vec!["OsmSchema-V0.6".to_owned(), "DenseNodes".to_owned()];
    header.optional_features = vec!["Sort.Type_then_ID".to_owned()];
    let bbox = header.bbox.mut_or_insert_default();
    bbox.set_left(8_000_000_000);
    bbox.set_right(9_000_000_000);
    bbox.set_top(50_000_000_000);
    bbox.set_bottom(49_000_000_000);
    header.write_to_bytes().unwrap()
}

/// One block with every kind of object that the reader looks into.
fn full_block() -> Vec<u8> {
    let mut block = osmformat::PrimitiveBlock::new();
    let texts = ["", "highway", "primary", "name", "East", "type", "restriction", "no_u_turn", "from", "via", "to"];
    block.stringtable.mut_or_insert_default().s = texts.map(|text| text.as_bytes().to_vec()).to_vec();

    let mut dense_group = osmformat::PrimitiveGroup::new();
    let dense = dense_group.dense.mut_or_insert_default();
    dense.id = vec![1, 1, 1, 1];
    dense.lat = vec![494_000_000, 1000, 1000, 1000];
    dense.lon = vec![87_000_000, -1000, 1000, 3000];
    dense.keys_vals = vec![0, 3, 4, 0, 0, 0];
    dense.denseinfo.mut_or_insert_default().visible = vec![true, true, true, true];

    let mut plain_group = osmformat::PrimitiveGroup::new();
    let mut node = osmformat::Node::new();
    node.set_id(5);
    node.set_lat(494_004_000);
    node.set_lon(87_004_000);
    node.keys = vec![3];
    node.vals = vec![4];
    plain_group.nodes.push(node);

    let mut way_group = osmformat::PrimitiveGroup::new();
    for id in [10, 11] {
        let mut way = osmformat::Way::new();
        way.set_id(id);
        way.keys = vec![1, 3];
        way.vals = vec![2, 4];
        way.refs = vec![1, 1, 1, 1, 1];
        way.info.mut_or_insert_default().set_visible(true);
        way_group.ways.push(way);
    }

    let mut relation_group = osmformat::PrimitiveGroup::new();
    let mut relation = osmformat::Relation::new();
    relation.set_id(20);
    relation.keys = vec![5, 6];
    relation.vals = vec![6, 7];
    relation.roles_sid = vec![8, 9, 10];
    relation.memids = vec![10, -8, 9];
    use osmformat::relation::MemberType::{NODE, WAY};
    relation.types = [WAY, NODE, WAY].map(Into::into).to_vec();
    relation_group.relations.push(relation);

    block.primitivegroup = vec![dense_group, plain_group, way_group, relation_group];
    block.write_to_bytes().unwrap()
}

/// xorshift64*: small, seeded, the same everywhere.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d)
    }

    fn below(&mut self, bound: usize) -> usize {
        (self.next() >> 11) as usize % bound
    }

    /// One to three changes: a bit, a byte with a meaning, a byte more or less, a stretch doubled, the end cut.
    fn damage(&mut self, bytes: &mut Vec<u8>) {
        for _ in 0..=self.below(3) {
            if bytes.is_empty() {
                return;
            }
            let at = self.below(bytes.len());
            match self.below(8) {
                0..=2 => bytes[at] ^= 1 << self.below(8),
                3 => bytes[at] = [0, 1, 0x7f, 0x80, 0xff][self.below(5)],
                4 => bytes.insert(at, self.next() as u8),
                5 => {
                    bytes.remove(at);
                }
                6 => {
                    let end = (at + 1 + self.below(20)).min(bytes.len());
                    let stretch = bytes[at..end].to_vec();
                    bytes.splice(at..at, stretch);
                }
                // A huge number where one was small: all bits of a varint.
                _ => {
                    bytes.splice(at..=at, [0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 1]);
                }
            }
        }
    }
}
