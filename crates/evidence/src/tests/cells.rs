//! Every column and every unit.

use super::super::{Along, Place, Quantity, Value};
use super::write::read_csv;
use crate::osm::{LonLat, NodeId};

const SOURCE: &str = "office";

#[test]
fn every_column_says_what_it_says() {
    let rows = read_csv(
        "id,quantity,value,unit,sigma,source,date,licence,way_id,from_node,to_node,direction,name,note,_extra,fid\n\
         a7,lane_width,325,cm,5,office,2026-05-31,CC0,12,34,56,backward,Main Street,\"wet, dark\",x,1\n",
    )
    .unwrap();
    let row = &rows[0];
    assert_eq!((rows.len(), row.number, row.id.as_deref()), (1, 2, Some("a7")));
    assert_eq!((row.quantity, &row.value), (Quantity::LaneWidth, &Value::Metres(3.25)));
    assert!((row.sigma - 0.05).abs() < 1e-12);
    assert_eq!(row.place, Place::Way { way_id: 12, nodes: Some([34, 56].map(NodeId::new)) });
    assert_eq!((row.along, row.way_id, row.at), (Along::Backward, Some(12), None));
    assert_eq!(
        (row.source.as_str(), row.date.as_deref(), row.licence.as_deref()),
        (SOURCE, Some("2026-05-31"), Some("CC0"))
    );
    assert_eq!((row.name.as_deref(), row.note.as_deref()), (Some("Main Street"), Some("wet, dark")));
    assert!((row.lower().unwrap() - (3.25 - 1.64 * 0.05)).abs() < 1e-12);
}

#[test]
fn every_quantity_has_its_place_and_value() {
    let rows = read_csv(
        "what,value,uncertainty,source,license,edge_id,junction,from_edge,to_edge,vehicle,lon,lat,geom\n\
         carriageway_width,7.5,,office,CC0,9,,,,,,,\n\
         direction_width,3.5,,office,,,,,,,8.5,49.5,\n\
         kerb_radius,4,0.5,office,,,77,5,6,,,,\n\
         kerb_radius,0,,office,,,77,,,,,,\n\
         max_height,4.1,0.1,office,,,,,,,,,\"LINESTRING (8 49, 8.1 49)\"\n\
         max_weight,7.5,,office,,9,,,,,,,\n\
         drivable_by,,,office,,9,,,,EU-SEMI16.5,,,\n\
         surface,,,office,,,,,,,,,\"POLYGON ((8 49, 8.1 49, 8.1 49.1, 8 49))\"\n",
    )
    .unwrap();
    let places: Vec<&Place> = rows.iter().map(|row| &row.place).collect();
    let at = |lon_e7, lat_e7| LonLat { lon_e7, lat_e7 };
    assert_eq!(places[0], &Place::Edge(9));
    assert_eq!(places[1], &Place::Point(at(85_000_000, 495_000_000)));
    assert_eq!(places[2], &Place::Junction { node: NodeId::new(77), edges: Some([5, 6]) });
    assert_eq!(places[3], &Place::Junction { node: NodeId::new(77), edges: None });
    assert_eq!(places[4], &Place::Line(vec![at(80_000_000, 490_000_000), at(81_000_000, 490_000_000)]));
    let ring =
        [(80_000_000, 490_000_000), (81_000_000, 490_000_000), (81_000_000, 491_000_000), (80_000_000, 490_000_000)];
    let ring: Vec<LonLat> = ring.map(|(lon, lat)| at(lon, lat)).to_vec();
    assert_eq!(places[7], &Place::Polygon(ring.clone()));
    assert_eq!(rows[7].value, Value::Polygon(vec![ring]));
    assert_eq!(rows[6].value, Value::Vehicle("EU-SEMI16.5".to_owned()));
    assert_eq!(rows[5].value, Value::Tonnes(7.5));
    assert_eq!(rows[0].licence.as_deref(), Some("CC0"));
    let lower: Vec<Option<f64>> = rows.iter().map(super::super::MeasurementRow::lower).collect();
    assert_eq!(
        lower,
        [Some(7.5), Some(3.5), Some(4.0 - 1.64 * 0.5), Some(0.0), Some(4.1 - 1.64 * 0.1), Some(7.5), None, None]
    );
}

#[test]
fn every_unit_is_metres_or_tonnes() {
    for (unit, value, metres) in [
        ("m", "3.5", 3.5),
        ("", "3.5", 3.5),
        ("cm", "350", 3.5),
        ("MM", "3500", 3.5),
        ("ft", "10", 3.048),
        ("in", "100", 2.54),
    ] {
        let rows =
            read_csv(&format!("quantity,value,unit,source,edge_id\nlane_width,{value},{unit},office,1\n")).unwrap();
        let Value::Metres(found) = rows[0].value else { panic!("{:?}", rows[0].value) };
        assert!((found - metres).abs() < 1e-12, "{unit}");
    }
    for (unit, value) in [("t", "3.5"), ("", "3.5"), ("kg", "3500")] {
        let rows =
            read_csv(&format!("quantity,value,unit,source,edge_id\nmax_weight,{value},{unit},office,1\n")).unwrap();
        assert_eq!(rows[0].value, Value::Tonnes(3.5));
    }
}

#[test]
fn separators_marks_and_line_ends_do_not_matter() {
    let plain = "quantity,value,source,edge_id\nlane_width,3.5,office,1\nlane_width,3.25,office,2\n";
    let rows = read_csv(plain).unwrap();
    for other in [
        plain.replace(',', ";"),
        plain.replace(',', "\t"),
        plain.replace('\n', "\r\n"),
        format!("\u{feff}{plain}"),
        plain.replace("office", "\"office\""),
    ] {
        assert_eq!(read_csv(&other).unwrap(), rows, "{other:?}");
    }
}

#[test]
fn a_row_is_counted_by_the_line_it_begins_on() {
    for end in ["\n", "\r\n"] {
        let text =
            ["quantity,value,source,edge_id,note", "lane_width,3.5,office,1,\"a\nb\"", "", "lane_width,3.5,office,2,"];
        let rows = read_csv(&(text.join(end) + end)).unwrap();
        assert_eq!(rows.iter().map(|row| row.number).collect::<Vec<_>>(), [2, 5], "{end:?}");
    }
}

#[test]
fn a_geometry_beside_ids_is_for_show() {
    let rows = read_csv("quantity,value,source,edge_id,lon,lat\nlane_width,3.5,office,1,8,49\n").unwrap();
    assert_eq!(rows[0].place, Place::Edge(1));
    assert_eq!(rows[0].at, Some(LonLat { lon_e7: 80_000_000, lat_e7: 490_000_000 }));
}

#[test]
fn well_known_text_has_many_forms() {
    for (text, point) in [
        ("POINT(8 49)", true),
        ("point z (8 49 3)", true),
        ("SRID=4326;POINT (8 49)", true),
        ("MULTIPOINT ((8 49))", true),
        ("MULTIPOINT (8 49)", true),
        ("010100000000000000000020400000000000804840", true),
        ("MULTILINESTRING ((8 49, 8.1 49))", false),
        ("LINESTRING ZM (8 49 1 2, 8.1 49 1 2)", false),
    ] {
        let rows = read_csv(&format!("quantity,value,source,WKT\nlane_width,3.5,office,\"{text}\"\n")).unwrap();
        assert_eq!(
            matches!(rows[0].place, Place::Point(LonLat { lon_e7: 80_000_000, lat_e7: 490_000_000 })),
            point,
            "{text}"
        );
    }
}
