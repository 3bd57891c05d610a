//! Files of drawn rows: what a reader of a box has to read, and what programs are told.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::path::Path;

use parquet::basic::{LogicalType, Type as Physical};
use parquet::file::metadata::RowGroupMetaData;
use parquet::file::reader::{FileReader as _, SerializedFileReader};
use parquet::file::statistics::Statistics;
use parquet::record::Field;

use super::*;
use crate::scratch::Scratch;
use crate::{Destination, Layout, Out, Unfinished};

const COLUMNS: [rows::Column; 3] =
    [("id", ColumnKind::Integer), ("name", ColumnKind::Text), ("safe", ColumnKind::Flag)];

/// Roads of 100 m, in 16,000 places that no order of theirs brings together. The place is longitude and latitude in 1e-4 degree, 0 to 199.
fn place(number: u32) -> [u32; 2] {
    let mixed = number.wrapping_mul(2_654_435_761);
    [(mixed >> 8) % 200, (mixed >> 20) % 200]
}

fn line(number: u32) -> [LonLat; 2] {
    let [x, y] = place(number).map(|cell| cell as i32 * 1000);
    [LonLat { lon_e7: x, lat_e7: y }, LonLat { lon_e7: x + 900, lat_e7: y }]
}

/// Writes the rows, along the curve or as they come.
fn write(path: &Path, version: GeoParquetVersion, along_the_curve: bool) {
    let mut destination = Destination::begin(Out::Path(path.to_owned()), Layout::File, Unfinished::default()).unwrap();
    let sink = destination.create("").unwrap();
    let mut file = GroupedFile::open("edges", &COLUMNS, version, sink).unwrap();
    let mut rows = Sorter::new(Scratch::create(path.with_extension("rows")).unwrap());
    for number in 0..16_000_u32 {
        let name = format!("Road {number}");
        let cells = [
            Cell::Integer(Some(number.into())),
            Cell::Text((!number.is_multiple_of(3)).then_some(&*name)),
            Cell::Flag(number.is_multiple_of(2)),
        ];
        let line = line(number);
        let key = if along_the_curve { curve::of_line(&line) } else { 0 };
        rows.push((key, u64::from(number)), &OwnedRow::of(&Row { id: 0, cells: &cells, line: &line })).unwrap();
    }
    rows.sorted().unwrap().for_each(|row| file.add(&row.unwrap().1).unwrap());
    file.close([("netcert", "{}".to_owned()), ("pandas", metadata::pandas(&COLUMNS))]).unwrap();
    destination.finish().unwrap();
}

/// Groups of rows whose bounds meet the 20 × 20 cells in the middle: their number and their bytes.
fn met(reader: &SerializedFileReader<std::fs::File>) -> (usize, i64) {
    let groups = reader.metadata().row_groups().iter().filter(|group| {
        let bounds = |side: &str| {
            let column = group.columns().iter().find(|column| column.column_path().parts() == ["bbox", side]).unwrap();
            let Some(Statistics::Double(bounds)) = column.statistics() else { panic!("no bounds of {side}") };
            [*bounds.min_opt().unwrap(), *bounds.max_opt().unwrap()]
        };
        let around = |low: &str, high: &str| bounds(low)[0] < 0.011 && bounds(high)[1] > 0.009;
        around("xmin", "xmax") && around("ymin", "ymax")
    });
    groups.fold((0, 0), |(count, bytes), group| (count + 1, bytes + group.compressed_size()))
}

#[test]
fn a_reader_of_a_box_reads_a_part_of_the_file_and_every_row_is_there() {
    let folder = tempfile::tempdir().unwrap();
    let open = |path: &Path| SerializedFileReader::new(std::fs::File::open(path).unwrap()).unwrap();
    let (along, as_they_come) = (folder.path().join("along.parquet"), folder.path().join("come.parquet"));
    write(&along, GeoParquetVersion::V1_1, true);
    write(&as_they_come, GeoParquetVersion::V1_1, false);
    // 16,000 rows are 8 groups of at most 2,048. Along the curve two of them lie in the middle of the square; as the rows come, all of them do.
    let reader = open(&along);
    assert_eq!(reader.num_row_groups(), 8);
    let ((count, bytes), (all, all_bytes)) = (met(&reader), met(&open(&as_they_come)));
    assert_eq!((count, all), (2, 8));
    assert!(bytes * 3 < all_bytes, "{bytes} of {all_bytes} bytes");
    let mut ids = Vec::new();
    for row in reader.get_row_iter(None).unwrap() {
        let columns: Vec<_> = row.unwrap().into_columns();
        let Field::Long(id) = columns[0].1 else { panic!("{columns:?}") };
        let number = u32::try_from(id).unwrap();
        assert_eq!(columns[1].1, if id % 3 == 0 { Field::Null } else { Field::Str(format!("Road {id}")) });
        assert_eq!(columns[2].1, Field::Bool(id % 2 == 0));
        assert_eq!(columns[3].1, Field::Bytes(wkb(&line(number)).into()));
        ids.push(number);
    }
    ids.sort_unstable();
    assert!(ids.into_iter().eq(0..16_000));
    for column in reader.metadata().row_groups().iter().flat_map(RowGroupMetaData::columns) {
        assert!(matches!(column.compression(), Compression::ZSTD(_)));
        assert_eq!(column.statistics().is_some(), column.column_path().string() != GEOMETRY);
        assert_eq!(column.offset_index_offset(), None);
    }
}

#[test]
fn a_version_names_itself_and_2_has_the_type_of_the_format() {
    let folder = tempfile::tempdir().unwrap();
    for version in GeoParquetVersion::ALL.iter().copied() {
        let path = folder.path().join(version.name());
        write(&path, version, true);
        let reader = SerializedFileReader::new(std::fs::File::open(&path).unwrap()).unwrap();
        let metadata = reader.metadata().file_metadata();
        let geo = metadata.key_value_metadata().unwrap().iter().find(|entry| entry.key == "geo").unwrap();
        let geo: serde_json::Value = serde_json::from_str(geo.value.as_ref().unwrap()).unwrap();
        assert_eq!(geo["version"], format!("{}.0", version.name()));
        let column = &geo["columns"]["geometry"];
        assert_eq!((&column["encoding"], &column["crs"]["id"]["code"]), (&"WKB".into(), &4326.into()));
        assert_eq!(column["covering"]["bbox"]["xmin"], serde_json::json!(["bbox", "xmin"]));
        let field = metadata.schema().get_fields().iter().find(|field| field.name() == GEOMETRY).unwrap();
        assert_eq!(field.get_physical_type(), Physical::BYTE_ARRAY);
        match (version, field.get_basic_info().logical_type_ref()) {
            (GeoParquetVersion::V1_1, None) => {}
            (GeoParquetVersion::V2_0, Some(LogicalType::Geometry(line))) => {
                // Both places name the same system, as 2.0 asks for.
                let crs: serde_json::Value = serde_json::from_str(line.crs.as_ref().unwrap()).unwrap();
                assert_eq!(crs, column["crs"]);
            }
            (_, other) => panic!("{version:?}: {other:?}"),
        }
    }
}
