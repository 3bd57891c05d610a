//! Reference systems of GeoPackages.

use super::super::{Place, read};
use super::write::{Drawn, Table, geopackage, refusal, temporary};

fn point(at: [f64; 2]) -> Table {
    let cells = ["lane_width", "3.5", "office"].map(str::to_owned).to_vec();
    Table { columns: vec!["quantity", "value", "source"], rows: vec![(cells, Drawn::Point(at))] }
}

#[test]
fn systems_that_are_much_used_are_transformed() {
    // Computed with `cs2cs` of PROJ 9 from longitude 8.69, latitude 49.41; in the south 144.96, −37.81.
    for (srs, x, y, lon, lat) in [
        (4326, 8.69, 49.41, 8.69, 49.41),
        (3857, 967_366.375_178, 6_345_945.353_893, 8.69, 49.41),
        (25832, 477_513.0, 5_473_054.0, 8.69, 49.41),
        (32632, 477_513.0, 5_473_054.0, 8.69, 49.41),
    ] {
        let (_folder, path) = temporary("rows.gpkg");
        geopackage(&point([x, y]), &path, srs, "");
        let rows = read(&path).unwrap();
        let Place::Point(at) = rows[0].place else { panic!("{:?}", rows[0].place) };
        let (found_lon, found_lat) = at.degrees();
        assert!((found_lon - lon).abs() < 2e-4 && (found_lat - lat).abs() < 2e-4, "{srs}: {found_lon} {found_lat}");
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
