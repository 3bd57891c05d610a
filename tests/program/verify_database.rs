//! A database is confirmed as it was made, and every column of its certificates, changed in the unsafe direction with plain SQL, is
//! refuted.

use netcert_testing::program;

use program::WorkFolder;

const VERIFY: &str = "verify --db demo.gpkg --vehicle AU-SEMI19 --sample 60 --input {demo}";

/// The statements after which `verify` confirms an honest database all the same.
pub(crate) fn survivors<'s>(changes: &'s [String], verify: &str, honest: impl Fn() -> WorkFolder) -> Vec<&'s String> {
    let survives = |sql: &&String| {
        let place = honest();
        assert!(place.sql(sql) > 0, "{sql}: nothing to change");
        place.command(verify).output().unwrap().status.success()
    };
    changes.iter().filter(survives).collect()
}

#[test]
fn every_column_changed_in_the_unsafe_direction_is_refuted() {
    let honest = WorkFolder::with_demo().netcert(VERIFY).succeeds();
    println!("{}", honest.out());
    let safe = "verdict_no = 0";
    let changes = [
        format!("UPDATE certificate_compact SET rsc_mm = rsc_mm + 60 WHERE {safe}"),
        format!("UPDATE certificate_compact SET hinge_margin_cdeg = hinge_margin_cdeg + 500 WHERE {safe}"),
        "UPDATE certificate_compact SET rsc_published_mm = rsc_published_mm + 9000".to_owned(),
        "UPDATE certificate_compact SET verdict_no = 0 WHERE verdict_no BETWEEN 10 AND 19".to_owned(),
        "UPDATE certificate_compact SET verdict_no = 0 WHERE verdict_no BETWEEN 20 AND 29".to_owned(),
        "UPDATE section SET lane_left_m = NULL, lane_right_m = NULL, lane_source = NULL".to_owned(),
        "UPDATE certificate_compact SET shrink_milli = NULL WHERE shrink_milli < 700".to_owned(),
        format!("UPDATE certificate_compact SET limiting_at = 40 WHERE {safe}"),
        format!("UPDATE certificate_compact SET limiting_s_dm = limiting_s_dm + 200000 WHERE {safe}"),
        "DELETE FROM plan".to_owned(),
        "UPDATE plan SET coefficients = x'0000'".to_owned(),
        "UPDATE section SET lane_left_m = lane_left_m - 0.3".to_owned(),
        "UPDATE edge SET max_width_m = 2.0".to_owned(),
        "UPDATE vehicle SET definition = replace(definition, '\"width_m\":2.5', '\"width_m\":2.4')".to_owned(),
        "UPDATE certified_set SET settings = json_set(settings, '$.map_tolerance_m', 0.4)".to_owned(),
        "UPDATE account SET count = count + 1 WHERE account_no = (SELECT min(account_no) FROM account)".to_owned(),
        "UPDATE run SET input_blake3 = '0'".to_owned(),
        "UPDATE certificate_compact SET verdict_no = 0, rsc_mm = 0, hinge_margin_cdeg = 0, shrink_milli = 1, limiting_at = 0 \
         WHERE verdict_no = 10"
            .to_owned(),
        "DELETE FROM certificate_compact WHERE fid = 7".to_owned(),
        "UPDATE certified_set SET settings = json_set(settings, '$.max_shift_m', 0.0)".to_owned(),
        "UPDATE edge SET lane_width_m = lane_width_m + 0.5 WHERE fid = 9".to_owned(),
        "UPDATE edge SET width_source = 'surveyed' WHERE fid = 9".to_owned(),
        "UPDATE edge SET hgv = 'yes', motor_vehicle = 'yes'".to_owned(),
        "UPDATE edge SET name = 'Elsewhere' WHERE fid = 9".to_owned(),
    ];
    let survivors = survivors(&changes, VERIFY, || {
        let place = WorkFolder::with_demo();
        // The spatial triggers call functions that plain SQLite lacks; certificates do not rest on them.
        for trigger in ["insert", "update1", "update2", "update3", "update4", "delete"] {
            place.sql(&format!("DROP TRIGGER rtree_edge_geom_{trigger}"));
        }
        place
    });
    // The demo region has nothing unknown.
    let sql = "UPDATE certificate_compact SET verdict_no = 0, rsc_mm = 100, hinge_margin_cdeg = 100, limiting_at = 0 \
               WHERE verdict_no BETWEEN 30 AND 39";
    let place = WorkFolder::with_unknown_road();
    let verify = "verify --db demo.gpkg --vehicle AU-SEMI19 --input unknown.osm.pbf";
    place.netcert(verify).succeeds();
    assert!(place.sql(sql) > 0, "{sql}: nothing to change");
    place.netcert(verify).fails();
    println!("database mutation score: {} of {}", changes.len() - survivors.len(), changes.len());
    assert!(survivors.is_empty(), "{survivors:#?}");
}
