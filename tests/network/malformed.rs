//! Legal rarities and broken files: every file of `malformed/INDEX.tsv` in the shared extracts, with its outcome.
//!
//! The index says for each file whether it may be read (OK), read with counted losses (SKIP) or must be refused (ERR).
//! The table below gives the exact outcome.

use netcert_testing::accounts::assert_adds_up;
use netcert_testing::extracts::folder_with;

use std::{
    collections::BTreeMap,
    fmt::Write as _,
    path::{Path, PathBuf},
};

use netcert::osm::{
    Extract,
    pbf::{NodeTally, ReadError, read_extract},
};

const INDEX: &str = "malformed/INDEX.tsv";

/// The outcome of a way through four nodes.
const PLAIN: &str = "10: 1 2 3 4 | 4 nodes, 4 placed | 9.5,47.1 9.5,47.101 9.501,47.102 9.503,47.103";

/// File and outcome. An outcome lists kept ways with their nodes, ways left out, nodes, and their positions in the
/// order of ids; or the place and reason of a refusal.
#[rustfmt::skip]
const EXPECTED: [(&str, &str); 94] = [
    ("ok_plain", PLAIN),
    ("ok_blob_raw", PLAIN),
    ("ok_blob_lz4", PLAIN),
    ("ok_blob_zstd", PLAIN),
    ("ok_blob_lzma", "at 68: unsupported blob compression lzma"),
    ("err_blob_bzip2_obsolete", "at 68: unsupported blob compression bzip2"),
    ("ok_nondense", PLAIN),
    ("ok_granularity_1000_offsets", PLAIN),
    ("ok_way_before_node_blocks", PLAIN),
    ("ok_mixed_groups_one_block", PLAIN),
    ("ok_node_and_dense_in_one_group", PLAIN),
    ("ok_unknown_fields_everywhere", PLAIN),
    ("ok_unpacked_repeated", PLAIN),
    ("ok_split_packed_runs", PLAIN),
    ("ok_unknown_block_type", "10: 1 2 3 4 | 4 nodes, 4 placed | 9.5,47.1 9.5,47.101 9.501,47.102 9.503,47.103 | 1 blob passed over"),
    ("ok_indexdata", PLAIN),
    ("ok_two_headers", "10: 1 2 3 4 | 5 nodes, 4 placed, 1 unnamed | 9.5,47.1 9.5,47.101 9.501,47.102 9.503,47.103"),
    ("ok_empty_no_data", "no ways | 0 nodes"),
    ("ok_dense_no_keysvals_many", "no ways | 20000 nodes, 20000 unnamed"),
    ("ok_optional_feature_unknown", PLAIN),
    ("err_required_feature_unknown", "at 0: the file requires the feature \"Frobnicate\", which is not supported"),
    ("ok_history_visible_false", "at 0: a full-history file (HistoricalInformation), but a snapshot is needed"),
    ("skip_deleted_way_no_history_flag", "no ways, 1 deleted | 4 nodes, 4 unnamed"),
    ("ok_locations_on_ways", "10: 1 2 3 4 | 0 nodes, 4 missing, 4 placed_by_ways | 9.5,47.1 9.5,47.101 9.501,47.102 9.503,47.103"),
    ("ok_negative_ids", "-10: -1 -2 -3 -4 | 4 nodes, 4 placed | 9.503,47.103 9.501,47.102 9.5,47.101 9.5,47.1"),
    ("ok_ids_near_2_40_and_2_62", "1099511627785: 1099511627777 4611686018427387907 | 2 nodes, 2 placed | 9.5,47.1 9.5,47.101"),
    ("ok_utf8_4byte_and_long_value", "10 🚚 Straße: 1 2 | 4 nodes, 2 placed, 2 unnamed | 9.5,47.1 9.5,47.101"),
    ("ok_antimeridian_way", "10: 1 2 | 2 nodes, 2 placed | 179.9999,-18 -179.9999,-18"),
    ("ok_pole_and_bounds", "10: 1 2 | 2 nodes, 2 placed | 180,90 180,89.9999"),
    ("skip_way_missing_one_node", "10: 1 2 99 4 | 4 nodes, 3 placed, 1 unnamed, 1 missing | 9.5,47.1 9.5,47.101 9.503,47.103 nowhere"),
    ("skip_way_all_nodes_missing", "10: 91 92 | 4 nodes, 4 unnamed, 2 missing | nowhere nowhere"),
    ("skip_way_zero_nodes", "no ways, 1 too_few_nodes | 4 nodes, 4 unnamed"),
    ("skip_way_one_node", "no ways, 1 too_few_nodes | 4 nodes, 4 unnamed"),
    ("skip_way_repeated_node", "10: 1 2 3 | 4 nodes, 3 placed, 1 unnamed | 9.5,47.1 9.5,47.101 9.501,47.102"),
    ("skip_way_all_same_node", "no ways, 1 too_few_nodes | 4 nodes, 4 unnamed"),
    ("skip_two_nodes_same_place", "10: 1 2 3 | 3 nodes, 3 placed | 9.5,47.1 9.5,47.1 9.501,47.102"),
    ("skip_spike_backtrack", "10: 1 2 1 3 | 4 nodes, 3 placed, 1 unnamed | 9.5,47.1 9.5,47.101 9.501,47.102"),
    ("skip_closed_way_loop", "10: 1 2 3 1 | 4 nodes, 3 placed, 1 unnamed | 9.5,47.1 9.5,47.101 9.501,47.102"),
    ("skip_lat_out_of_range", "10: 1 2 3 | 3 nodes, 2 placed, 1 invalid | 9.5,47.1 nowhere 9.501,47.102"),
    ("skip_lonlat_int_max", "10: 1 2 3 | 3 nodes, 2 placed, 1 invalid | 9.5,47.1 nowhere 9.501,47.102"),
    ("skip_duplicate_node_id", "10: 1 2 3 4 | 5 nodes, 4 placed, 1 superseded | 9.5,47.1 9.505,47.105 9.501,47.102 9.503,47.103"),
    ("skip_duplicate_way_id", "10: 1 2 4 | 1 duplicate_id | 4 nodes, 3 placed, 1 unnamed | 9.5,47.1 9.5,47.101 9.503,47.103"),
    ("skip_bad_tag_values", "31 ways | 4 nodes, 4 placed | 9.5,47.1 9.5,47.101 9.501,47.102 9.503,47.103"),
    ("skip_relation_loop_and_bad_restriction", "10: 1 2, 11: 2 3 | 4 nodes, 3 placed, 1 unnamed | 9.5,47.1 9.5,47.101 9.501,47.102 | 5 relations, 5 restrictions, 1 broken, 1 off the road"),
    ("err_empty_file", "at -: empty file"),
    ("err_no_header", "at 0: no OSMHeader before the data"),
    ("err_trunc_in_length", "at 68: truncated: the file ends inside a blob's length"),
    ("err_trunc_in_blobheader", "at 68: truncated: the file ends inside a BlobHeader"),
    ("err_trunc_in_blob", "at 68: truncated: the file ends inside a blob"),
    ("err_trailing_garbage", "at 187: truncated: the file ends inside a blob's length"),
    ("err_trailing_zeros", "at 187: the length of a BlobHeader is 0, allowed is 1 byte to 64 KiB"),
    ("err_blobheader_len_huge", "at 68: the length of a BlobHeader is 4294967295, allowed is 1 byte to 64 KiB"),
    ("err_blob_datasize_huge", "at 68: datasize is 2147483647, allowed is 0 to 32 MiB"),
    ("err_blob_datasize_negative", "at 68: datasize is -1, allowed is 0 to 32 MiB"),
    ("err_raw_size_huge", "at 68: raw_size is 2147483647, allowed is 0 to 32 MiB"),
    ("err_raw_size_too_small", "at 68: raw_size says 10 bytes, but the data inflates to more"),
    ("err_raw_size_too_big", "at 68: raw_size says 202 bytes, but the data inflates to 102"),
    ("err_raw_size_negative", "at 68: raw_size is -5, allowed is 0 to 32 MiB"),
    ("err_zip_bomb_256MiB", "at 68: raw_size says 1000 bytes, but the data inflates to more"),
    ("err_zlib_flipped_byte", "at 68: raw_size says 102 bytes, but the data inflates to more"),
    ("err_zlib_bad_adler", "at 68: cannot inflate the zlib blob: incorrect data check"),
    ("err_zlib_truncated", "at 68: cannot inflate the zlib blob: the data ends too early"),
    ("err_blob_no_data_field", "at 68: the blob's data is missing"),
    ("err_blob_empty", "at 68: the blob's data is missing"),
    ("err_string_index_out_of_range", "at 68: way 10: string 500 of a table of 7"),
    ("err_dense_kv_index_out_of_range", "at 68: node 1: string 700 of a table of 7"),
    ("err_dense_kv_odd", "at 68: node 4: keys and values differ in number"),
    ("err_dense_kv_too_few", "at 68: node 2: nodes and their tag lists differ in number"),
    ("err_dense_array_lengths_differ", "at 68: dense nodes: ids, latitudes and longitudes differ in number"),
    ("err_way_keys_vals_differ", "at 68: way 10: keys and values differ in number"),
    ("err_no_stringtable", "at 68: way 10: string 1 of a table of 0"),
    ("err_invalid_utf8_in_tag", "at 68: way 10: a tag is not valid UTF-8"),
    ("err_length_past_end", "at 68: damaged message: a field runs past the end of its message"),
    ("err_varint_11_bytes", "at 68: damaged message: a number is longer than 10 bytes (varint too long)"),
    ("err_varint_unterminated", "at 68: damaged message: a number ends in the middle (unterminated varint)"),
    ("err_wire_type_group_6_7", "at 68: damaged message: field 2 has wire type 7, which the format does not have"),
    ("err_field_number_zero", "at 68: damaged message: a field number is out of range"),
    ("err_wrong_wire_type_for_field", "at 68: damaged message: field 1 has a wire type that does not belong to it"),
    ("err_granularity_zero", "at 68: granularity is 0, allowed is 1 to 2147483647 nanodegrees"),
    ("err_granularity_negative", "at 68: granularity is -100, allowed is 1 to 2147483647 nanodegrees"),
    ("err_id_delta_overflow", "at 68: dense nodes: an id beyond 64 bits"),
    ("err_latlon_overflow_with_offset", "10: 1 2 3 4 | 1 nodes, 1 invalid, 3 missing | nowhere nowhere nowhere nowhere"),
    ("err_header_block_corrupt", "at 0: damaged message: a number is longer than 10 bytes (varint too long)"),
    ("err_schema_version", "at 0: the file requires the feature \"OsmSchema-V0.7\", which is not supported"),
    ("err_is_xml", "at 0: not a PBF file, but XML"),
    ("err_is_gzip", "at 0: not a PBF file, but gzip-compressed data"),
    ("err_is_lfs_pointer", "at 0: not a PBF file, but a Git LFS pointer"),
    ("err_is_html", "at 0: not a PBF file, but an HTML page"),
    ("err_random_64KiB", "at 0: not a PBF file, but something else (no BlobHeader at its start)"),
    ("err_deep_nesting_64KiB", PLAIN),
    ("real_sydney_au_cut_at_60pct", "at 292574: truncated: the file ends inside a blob"),
    ("real_sydney_au_one_bit_flipped", "at 292574: cannot inflate the zlib blob: the data is damaged"),
    ("ok_real_sydney_au_blocks_reversed", "701 ways, 49 minor_service, 2385 no_highway, 2192 not_a_road, 8 not_in_use, 4 track | 31305 nodes, 3518 placed, 27787 unnamed | 292 relations, 55 restrictions, 0 broken"),
    ("skip_real_sydney_au_one_block_missing", "701 ways, 49 minor_service, 2385 no_highway, 2192 not_a_road, 8 not_in_use, 4 track | 27305 nodes, 2858 placed, 24447 unnamed, 660 missing | 292 relations, 55 restrictions, 0 broken, 7 off the road"),
];

#[test]
fn every_file_of_the_index_is_read_or_refused_as_stated() {
    let Some(folder) = extracts() else { return };
    let index = std::fs::read_to_string(folder.join(INDEX)).unwrap();
    let classes: BTreeMap<&str, &str> = index.lines().skip(1).map(|line| file_and_class(line).unwrap()).collect();
    let expected: BTreeMap<&str, &str> = EXPECTED.into_iter().collect();
    assert_eq!(classes.keys().collect::<Vec<_>>(), expected.keys().collect::<Vec<_>>(), "files without an expectation");
    let mut wrong = String::new();
    for (file, class) in classes {
        let path = folder.join(format!("malformed/{file}.osm.pbf"));
        let outcome = read(&path);
        let found = describe(&outcome);
        if found != expected[file] {
            writeln!(wrong, "{file}\n  expected {}\n     found {found}", expected[file]).unwrap();
        }
        let allowed = class.split('|').any(|class| if class == "ERR" { outcome.is_err() } else { outcome.is_ok() });
        assert!(allowed, "{file} is {class}, but: {found}");
        check_account_or_message(&path, outcome);
    }
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn blocks_in_reverse_order_give_the_original() {
    let Some(folder) = extracts() else { return };
    let original = read(&folder.join("sydney_au.osm.pbf")).unwrap();
    let reversed = read(&folder.join("malformed/ok_real_sydney_au_blocks_reversed.osm.pbf")).unwrap();
    assert_eq!(contents(&original), contents(&reversed));
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let Some(folder) = extracts() else { return };
    for file in ["columbus_oh_us", "sydney_au", "victoria_au", "malformed/skip_duplicate_way_id"] {
        let path = folder.join(format!("{file}.osm.pbf"));
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let extract = pool.install(|| read(&path)).unwrap();
            (contents(&extract), extract.account)
        };
        let one = with(1);
        assert_eq!(one, with(2), "{file}");
        assert_eq!(one, with(5), "{file}");
    }
}

fn extracts() -> Option<PathBuf> {
    folder_with(INDEX)
}

fn file_and_class(line: &str) -> Option<(&str, &str)> {
    let mut columns = line.split('\t');
    Some((columns.next()?.strip_suffix(".osm.pbf")?, columns.next()?))
}

fn read(path: &Path) -> Result<Extract, ReadError> {
    read_extract(path, &|_| ())
}

/// Tests that an account adds up, and that an error names its place.
fn check_account_or_message(path: &Path, outcome: Result<Extract, ReadError>) {
    match outcome {
        Ok(Extract { account, .. }) => assert_adds_up(&account),
        Err(error) => {
            let message = error.to_string();
            assert!(message.starts_with(&path.display().to_string()), "{message}");
            assert!(error.offset.is_none() || message.contains(" at byte "), "{message}");
            assert!(message.ends_with(error.problem.way_out()), "{message}");
        }
    }
}

/// All data of an extract except the account.
fn contents(extract: &Extract) -> String {
    let Extract { ways, refs, nodes, points, strings, .. } = extract;
    let texts: Vec<_> = strings.texts().collect();
    format!("{ways:?} {refs:?} {nodes:?} {points:?} {texts:?}")
}

fn describe(outcome: &Result<Extract, ReadError>) -> String {
    match outcome {
        Ok(extract) => describe_extract(extract),
        Err(error) => {
            let offset = error.offset.map_or("-".to_owned(), |offset| offset.to_string());
            format!("at {offset}: {}", error.problem)
        }
    }
}

fn describe_extract(extract: &Extract) -> String {
    let account = &extract.account;
    let few = extract.ways.len() <= 2;
    let ways = match extract.ways.len() {
        0 => "no ways".to_owned(),
        _ if few => extract.ways.iter().map(|way| describe_way(extract, way)).collect::<Vec<_>>().join(", "),
        count => format!("{count} ways"),
    };
    let left_out: String = account.ways_left_out.iter().map(|(reason, count)| format!(", {count} {reason}")).collect();
    let mut parts = vec![ways];
    if few && !extract.ways.is_empty() {
        parts.extend(left_out.strip_prefix(", ").map(str::to_owned));
    } else {
        parts[0] += &left_out;
    }
    parts.push(describe_nodes(&account.nodes));
    if (1..=4).contains(&extract.nodes.places.len()) {
        let places = extract.nodes.places.iter().map(|place| match place {
            Some(place) => format!("{},{}", f64::from(place.lon_e7) / 1e7, f64::from(place.lat_e7) / 1e7),
            None => "nowhere".to_owned(),
        });
        parts.push(places.collect::<Vec<_>>().join(" "));
    }
    let r = account.relations;
    if r.read > 0 {
        let mut relations = format!("{} relations, {} restrictions", r.read, r.restrictions);
        relations += &format!(", {} broken", r.broken_restrictions);
        if r.restrictions_off_road > 0 {
            relations += &format!(", {} off the road", r.restrictions_off_road);
        }
        parts.push(relations);
    }
    if account.blobs_passed_over > 0 {
        parts.push(format!("{} blob passed over", account.blobs_passed_over));
    }
    parts.join(" | ")
}

fn describe_way(extract: &Extract, way: &netcert::osm::Way) -> String {
    let refs = &extract.refs[way.refs.start as usize..way.refs.end as usize];
    let name = way.facts.name.map_or_else(String::new, |name| format!(" {}", extract.strings.text(name)));
    let refs: String = refs.iter().map(|node| format!(" {node}")).collect();
    format!("{}{name}:{refs}", way.id)
}

fn describe_nodes(n: &NodeTally) -> String {
    let counts = [
        (n.placed, "placed"),
        (n.unnamed, "unnamed"),
        (n.deleted, "deleted"),
        (n.invalid, "invalid"),
        (n.superseded, "superseded"),
        (n.missing, "missing"),
        (n.placed_by_ways, "placed_by_ways"),
    ];
    let counts = counts.iter().filter(|(count, _)| *count > 0).map(|(count, what)| format!(", {count} {what}"));
    format!("{} nodes{}", n.read, counts.collect::<String>())
}
