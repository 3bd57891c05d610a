//! The reader's rules on small files made here: order, duplicates, a wrong header, and paths that are not files.

use netcert::osm::NodeId;
use std::{fs, path::PathBuf, sync::Mutex};

use netcert::osm::{
    Extract, LonLat,
    pbf::{
        Progress, ReadError, ReadingStage, read_extract,
        write::{self, NodeRecord, WayRecord},
    },
};

const ROAD: &[(&str, &str)] = &[("highway", "primary"), ("name", "Long Road")];
const FENCE: &[(&str, &str)] = &[("barrier", "fence")];

fn tags(pairs: &[(&str, &str)]) -> Vec<(String, String)> {
    pairs.iter().map(|&(key, value)| (key.to_owned(), value.to_owned())).collect()
}

fn node(id: i64) -> NodeRecord {
    NodeRecord { id, place: LonLat { lon_e7: 87_000_000 + id as i32, lat_e7: 494_000_000 }, tags: vec![] }
}

fn way(id: i64, refs: &[i64], pairs: &[(&str, &str)]) -> WayRecord {
    WayRecord { id, refs: refs.to_vec(), tags: tags(pairs) }
}

fn read(bytes: &[u8]) -> Result<Extract, ReadError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("region.osm.pbf");
    fs::write(&path, bytes).unwrap();
    read_extract(&path, &|_| ())
}

fn refs_of(extract: &Extract) -> Vec<(i64, Vec<i64>)> {
    let refs = |range: &std::ops::Range<u32>| extract.refs[range.start as usize..range.end as usize].iter();
    let refs = |range| refs(range).map(|node| node.get()).collect();
    extract.ways.iter().map(|way| (way.id, refs(&way.refs))).collect()
}

/// The blobs of a written file, header first.
fn blobs(bytes: &[u8]) -> Vec<Vec<u8>> {
    let mut rest = bytes;
    let mut blobs = Vec::new();
    while !rest.is_empty() {
        let header = 4 + u32::from_be_bytes(rest[..4].try_into().unwrap()) as usize;
        let message: osmpbfreader::fileformat::BlobHeader =
            protobuf::Message::parse_from_bytes(&rest[4..header]).unwrap();
        let (blob, after) = rest.split_at(header + message.datasize() as usize);
        blobs.push(blob.to_vec());
        rest = after;
    }
    blobs
}

#[test]
fn what_the_writer_writes_comes_back() {
    let mut tagged = node(2);
    tagged.tags = tags(&[("barrier", "bollard"), ("access", "no")]);
    let nodes = [node(-7), node(1), tagged, node(1 << 40)];
    let ways = [way(5, &[1, 2, -7], ROAD), way(9, &[2, 1 << 40], &[("highway", "motorway"), ("ref", "A 5")])];
    let bytes = write::write_extract(&nodes, &ways);
    assert_eq!(bytes, write::write_extract(&nodes, &ways));
    let extract = read(&bytes).unwrap();
    assert!(extract.account.header.sorted);
    assert_eq!(refs_of(&extract), [(5, vec![1, 2, -7]), (9, vec![2, 1 << 40])]);
    assert!(nodes.iter().all(|node| extract.nodes.place(NodeId::new(node.id)) == Some(node.place)));
    assert_eq!(extract.points.iter().map(|(id, _)| id.get()).collect::<Vec<_>>(), [2]);
    let name = extract.ways[0].facts.name.map(|id| extract.strings.text(id));
    let reference = extract.ways[1].facts.reference.map(|id| extract.strings.text(id));
    assert_eq!((name, reference), (Some("Long Road"), Some("A 5")));
}

#[test]
fn speeds_that_are_not_read_are_counted_and_end_nothing() {
    let tagged = |id, key, value| way(id, &[1, 2], &[("highway", "primary"), (key, value)]);
    let ways = [
        tagged(1, "maxspeed", "50"),
        tagged(2, "maxspeed", "50;70"),
        tagged(3, "maxspeed:hgv", "fast"),
        tagged(4, "maxspeed", "DE:rural"),
        tagged(5, "maxspeed:conditional", "30 @ wet"),
    ];
    let extract = read(&write::write_extract(&[node(1), node(2)], &ways)).unwrap();
    let limits = extract.ways.iter().map(|way| way.facts.max_speed_km_h[0].map_or(0, std::num::NonZeroU8::get));
    assert_eq!(limits.collect::<Vec<_>>(), [50, 0, 0, 0, 0]);
    let rows = extract.account.rows();
    let notes = rows.iter().filter(|row| row.item == "tag").map(|row| (row.reason.as_str(), row.count));
    assert_eq!(notes.collect::<Vec<_>>(), [("bad_speed", 2), ("national_speed", 1)]);
}

#[test]
fn a_header_that_says_sorted_is_not_believed() {
    let nodes: Vec<_> = (1..=90).map(node).collect();
    let ways: Vec<_> = (1..=40).map(|id| way(id, &[id, id + 50], ROAD)).collect();
    let good = write::write_extract_in_blocks(&nodes, &ways, 10);
    let expected = read(&good).unwrap();
    let blobs = blobs(&good);
    assert_eq!(blobs.len(), 1 + 9 + 4);
    // Each block of ways in turn moves in among the nodes, where a sorted file would have none.
    for moved in 10..14 {
        for to in 1..9 {
            let mut blobs = blobs.clone();
            let way_block = blobs.remove(moved);
            blobs.insert(to, way_block);
            let extract = read(&blobs.concat()).unwrap();
            assert_eq!(refs_of(&extract), refs_of(&expected), "block {moved} at {to}");
            assert_eq!(extract.nodes.places, expected.nodes.places);
            assert_eq!(extract.account.rows(), expected.account.rows());
        }
    }
}

#[test]
fn the_last_way_of_an_id_counts_whatever_it_is() {
    let nodes: Vec<_> = (1..=6).map(node).collect();
    let fenced = [way(8, &[1, 2], ROAD), way(9, &[3, 4], ROAD), way(8, &[5, 6], FENCE)];
    let reopened = [way(8, &[5, 6], FENCE), way(9, &[3, 4], ROAD), way(8, &[1, 2], ROAD)];
    for block_objects in [1, 2, 100] {
        let read = |ways: &[WayRecord]| read(&write::write_extract_in_blocks(&nodes, ways, block_objects)).unwrap();
        let extract = read(&fenced);
        assert_eq!(refs_of(&extract), [(9, vec![3, 4])]);
        assert_eq!(extract.account.ways_left_out["duplicate_id"], 1);
        assert_eq!(extract.nodes.ids, [3, 4].map(NodeId::new));
        assert_eq!(extract.account.ways_left_out.values().sum::<u64>() + extract.account.ways_kept, 3);

        let extract = read(&reopened);
        assert_eq!(refs_of(&extract), [(8, vec![1, 2]), (9, vec![3, 4])]);
        assert!(!extract.account.ways_left_out.contains_key("duplicate_id"));
    }
}

#[test]
fn the_last_node_of_an_id_counts_with_its_tags() {
    let bollard = |id: i64, lat_e7: i32| {
        let place = LonLat { lon_e7: 0, lat_e7 };
        NodeRecord { id, place, tags: tags(&[("barrier", "bollard")]) }
    };
    let ways = [way(1, &[1, 2, 3], ROAD)];
    for block_objects in [1, 2, 100] {
        let nodes = [node(1), bollard(2, 5), node(3), node(2), bollard(3, 7)];
        let extract = read(&write::write_extract_in_blocks(&nodes, &ways, block_objects)).unwrap();
        assert_eq!(extract.nodes.place(NodeId::new(2)), Some(node(2).place));
        assert_eq!(extract.nodes.place(NodeId::new(3)), Some(LonLat { lon_e7: 0, lat_e7: 7 }));
        assert_eq!(extract.points.iter().map(|(id, _)| id.get()).collect::<Vec<_>>(), [3]);
        assert_eq!(extract.account.nodes.superseded, 2);
    }
}

#[test]
fn the_account_names_every_loss_and_its_rows_add_up() {
    let nodes: Vec<_> = (1..=4).map(node).collect();
    let ways = [way(1, &[1, 2, 77], ROAD), way(2, &[3], ROAD), way(3, &[3, 3], ROAD), way(4, &[3, 4], FENCE)];
    let account = read(&write::write_extract(&nodes, &ways)).unwrap().account;
    let rows = account.rows();
    let count = |item: &str, outcome: &str| {
        rows.iter().filter(|row| row.item == item && row.outcome == outcome).map(|row| row.count).sum::<u64>()
    };
    for item in ["way", "node", "relation"] {
        assert_eq!(count(item, "read"), count(item, "kept") + count(item, "left_out"), "{item}");
    }
    assert_eq!(account.ways_left_out["too_few_nodes"], 2);
    assert_eq!((account.nodes.missing, account.nodes.unnamed), (1, 2));
    assert!(account.warnings().iter().any(|warning| warning.contains("1 of the 3 nodes")));
}

#[test]
fn progress_goes_through_the_stages_and_ends_at_the_end() {
    let nodes: Vec<_> = (1..=90).map(node).collect();
    let bytes = write::write_extract_in_blocks(&nodes, &[way(1, &[1, 2], ROAD)], 10);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("region.osm.pbf");
    fs::write(&path, bytes).unwrap();
    let seen: Mutex<Vec<Progress>> = Mutex::default();
    read_extract(&path, &|progress| seen.lock().unwrap().push(progress)).unwrap();
    let seen = seen.into_inner().unwrap();
    for stage in [ReadingStage::Check, ReadingStage::Ways, ReadingStage::Nodes] {
        let last = seen.iter().rfind(|progress| progress.stage == stage).unwrap();
        assert_eq!(last.done, last.total, "{stage:?}");
    }
}

#[test]
fn what_is_no_file_is_refused_with_a_way_out() {
    let folder = tempfile::tempdir().unwrap();
    let message = |path: PathBuf| read_extract(&path, &|_| ()).unwrap_err().to_string();
    let absent = message(folder.path().join("absent.osm.pbf"));
    assert!(absent.contains("absent.osm.pbf: cannot read") && absent.contains("check that the path"), "{absent}");
    let directory = message(folder.path().to_owned());
    assert!(directory.contains("not a regular file"), "{directory}");
    for (content, says) in [("BZh91AY", "bunzip2"), ("PK\u{3}\u{4}zip", "unzip"), ("ab", "no BlobHeader")] {
        let path = folder.path().join("other.osm.pbf");
        fs::write(&path, content).unwrap();
        let text = message(path);
        assert!(text.contains("not a PBF file") && text.contains(says), "{text}");
    }
}
