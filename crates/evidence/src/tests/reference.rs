//! Reference systems of GeoPackages.

use super::super::{Place, read};
use super::write::{Drawn, Table, geopackage, refusal, temporary};

fn point(at: [f64; 2]) -> Table {
    let cells = ["lane_width", "3.5", "office"].map(str::to_owned).to_vec();
    Table { columns: vec!["quantity", "value", "source"], rows: vec![(cells, Drawn::Point(at))] }
}

#[test]
fn systems_that_are_much_used_are_transformed() {
    // By cs2cs of PROJ 9.
    for (srs, x, y, lon, lat) in [
        (4326, 8.69, 49.41, 8.69, 49.41),
        (3857, 967_366.375_0, 6_344_718.335_7, 8.69, 49.41),
        (25832, 477_512.528_9, 5_473_081.359_0, 8.69, 49.41),
        (32632, 477_512.528_9, 5_473_081.359_0, 8.69, 49.41),
        (28355, 320_422.820_3, 5_813_305.222_6, 144.96, -37.81),
    ] {
        let (_folder, path) = temporary("rows.gpkg");
        geopackage(&point([x, y]), &path, srs, "");
        let rows = read(&path).unwrap();
        let Place::Point(at) = rows[0].place else { panic!("{:?}", rows[0].place) };
        let (found_lon, found_lat) = at.degrees();
        assert!((found_lon - lon).abs() < 2e-7 && (found_lat - lat).abs() < 2e-7, "{srs}: {found_lon} {found_lat}");
    }
}

/// Where PROJ has its database it knows Lambert-93; elsewhere the system is refused by name. The old German grid is shifted by
/// more than a hundred metres, with an accuracy of 3 m or better.
#[test]
fn other_systems_are_transformed_with_the_database_or_refused() {
    // By cs2cs of PROJ 9.
    for (srs, at, lon, lat, off) in [
        (2154, [652_301.564_8, 6_861_302.725_9], 2.35, 48.85, 1e-6),
        (31467, [3_477_578.843_7, 5_474_831.735_9], 8.69, 49.41, 1e-4),
    ] {
        let (_folder, path) = temporary("rows.gpkg");
        geopackage(&point(at), &path, srs, "");
        match read(&path) {
            Ok(rows) => {
                let Place::Point(at) = rows[0].place else { panic!("{:?}", rows[0].place) };
                let (found_lon, found_lat) = at.degrees();
                assert!(
                    (found_lon - lon).abs() < off && (found_lat - lat).abs() < off,
                    "{srs}: {found_lon} {found_lat}"
                );
            }
            Err(error) => {
                let text = error.to_string();
                assert!(
                    text.contains("cannot be transformed here") || text.contains("no accurate transformation"),
                    "{text}"
                );
            }
        }
    }
}

#[test]
fn a_system_without_a_transformation_is_refused_by_name() {
    let (_folder, path) = temporary("rows.gpkg");
    geopackage(&point([3.0, 4.0]), &path, 999_999, "LOCAL_CS[\"yard\"]");
    let found = refusal(read(&path));
    assert!(found.contains("its reference system EPSG:999999 cannot be transformed here"), "{found}");
    let (_folder, path) = temporary("rows.gpkg");
    geopackage(&point([3.0, 4.0]), &path, 0, "undefined");
    let found = refusal(read(&path));
    assert!(found.contains("the reference system of table `widths` is not given"), "{found}");
}
