//! Rows whose place is a drawn line.

use super::super::{Along, MeasurementRow};
use super::drawing::{Drawing, line, row, told};
use crate::network::Network;

fn named(row: MeasurementRow, name: &str) -> MeasurementRow {
    MeasurementRow { name: Some(name.to_owned()), ..row }
}

/// A road of three edges with side roads, to the east.
fn avenue() -> Network {
    Drawing::default()
        .node(1, [0.0, 0.0])
        .node(2, [100.0, 0.0])
        .node(3, [200.0, 0.0])
        .node(4, [300.0, 0.0])
        .node(5, [100.0, 80.0])
        .node(6, [200.0, -80.0])
        .way(1, &[1, 2, 3, 4], "name=Bahnhofstraße")
        .way(2, &[2, 5], "")
        .way(3, &[3, 6], "")
        .network()
}

#[test]
fn a_line_means_the_edges_that_it_covers() {
    let network = avenue();
    let along = line(&[[5.0, 2.0], [150.0, -2.0], [205.0, 1.0]]);
    assert_eq!(told(&network, &along), "1:1-2 1:2-1 1:2-3 1:3-2");
    // 70 m of the last edge are enough, 50 m are not.
    assert_eq!(told(&network, &line(&[[100.0, 1.0], [270.0, 1.0]])), "1:2-3 1:3-2 1:3-4 1:4-3");
    assert_eq!(told(&network, &line(&[[100.0, 1.0], [250.0, 1.0]])), "1:2-3 1:3-2");
    let half = told(&network, &line(&[[20.0, 1.0], [70.0, 1.0]]));
    assert!(
        half.starts_with("unmatched: covers 52 % of an edge, and one is meant from 60 % on: way 1 (edges "),
        "{half}"
    );
}

#[test]
fn a_direction_is_that_of_the_drawn_line() {
    let network = avenue();
    let against = line(&[[205.0, 1.0], [98.0, 1.0]]);
    assert_eq!(told(&network, &MeasurementRow { along: Along::Forward, ..against.clone() }), "1:3-2");
    assert_eq!(told(&network, &MeasurementRow { along: Along::Backward, ..against }), "1:2-3");
}

#[test]
fn roads_across_or_away_are_not_meant() {
    let network = avenue();
    let away = told(&network, &line(&[[0.0, 30.0], [100.0, 30.0]]));
    assert_eq!(away, "unmatched: no road runs along the line within 15 m, in this direction");
    let leaves = told(&network, &line(&[[0.0, 0.0], [100.0, 0.0], [100.0, -300.0]]));
    assert!(leaves.starts_with("unmatched: only "), "{leaves}");
    assert_eq!(told(&network, &line(&[[100.0, 2.0], [100.0, 79.0]])), "2:2-5 2:5-2");
}

#[test]
fn names_are_compared_and_a_different_one_is_reported() {
    let network = avenue();
    let along = || line(&[[0.0, 2.0], [100.0, 2.0]]);
    assert_eq!(told(&network, &named(along(), "bahnhof-str.")), "1:1-2 1:2-1");
    let other = told(&network, &named(along(), "Marktplatz"));
    assert!(other.starts_with("unmatched: the road has another name: way 1 (edges "), "{other}");
    assert!(other.ends_with("2.0 m away is Bahnhofstraße"), "{other}");
}

/// Two roads side by side.
fn beside(apart_m: f64, names: [&str; 2]) -> Network {
    Drawing::default()
        .road(1, &[[0.0, 0.0], [200.0, 0.0]], names[0])
        .road(2, &[[0.0, apart_m], [200.0, apart_m]], names[1])
        .network()
}

#[test]
fn of_two_roads_side_by_side_only_a_name_decides() {
    let along = || line(&[[0.0, 0.5], [200.0, 0.5]]);
    let without = told(&beside(8.0, ["", ""]), &along());
    assert!(without.starts_with("ambiguous: could be way 1 (edges "), "{without}");
    assert!(without.contains("0.5 m away or way 2 (edges ") && without.ends_with("7.5 m away"), "{without}");
    let named_roads = beside(8.0, ["North", "South"]);
    assert!(told(&named_roads, &along()).starts_with("ambiguous"));
    assert_eq!(told(&named_roads, &named(along(), "South")), "2:2000-2001 2:2001-2000");
    assert_eq!(told(&beside(8.0, ["", "South"]), &named(along(), "south")), "2:2000-2001 2:2001-2000");
    // Neither has the name, and the one without a name is no more probable than the other.
    assert!(told(&beside(8.0, ["", "South"]), &named(along(), "West")).starts_with("ambiguous"));
    assert_eq!(told(&beside(20.0, ["", ""]), &along()), "1:1000-1001 1:1001-1000");
}

#[test]
fn two_carriageways_are_told_apart_by_direction() {
    let network = Drawing::default()
        .node(1, [0.0, 0.0])
        .node(2, [200.0, 0.0])
        .node(3, [200.0, 10.0])
        .node(4, [0.0, 10.0])
        .way(1, &[1, 2], "oneway=yes")
        .way(2, &[3, 4], "oneway=yes")
        .network();
    let along = line(&[[0.0, 4.0], [200.0, 4.0]]);
    assert!(told(&network, &along).starts_with("ambiguous"));
    assert_eq!(told(&network, &MeasurementRow { along: Along::Forward, ..along.clone() }), "1:1-2");
    assert_eq!(told(&network, &MeasurementRow { along: Along::Backward, ..along }), "2:3-4");
}

/// A ramp leaves a main road at a small angle, beside a short edge of it.
#[test]
fn a_road_that_leaves_the_line_is_no_rival() {
    let network = Drawing::default()
        .node(1, [0.0, 0.0])
        .node(2, [200.0, 0.0])
        .node(3, [240.0, 0.0])
        .node(4, [500.0, 0.0])
        .node(5, [240.0, 60.0])
        .node(6, [500.0, 75.0])
        .way(1, &[1, 2, 3, 4], "")
        .way(2, &[2, 6], "oneway=yes")
        .way(3, &[3, 5], "")
        .network();
    assert_eq!(told(&network, &line(&[[0.0, 1.0], [500.0, 1.0]])), "1:1-2 1:2-1 1:2-3 1:3-2 1:3-4 1:4-3");
    assert_eq!(told(&network, &line(&[[0.0, 0.0], [200.0, 0.0], [500.0, 75.0]])), "1:1-2 1:2-1 2:2-6");
}

#[test]
fn a_bend_and_short_edges_are_followed() {
    let bend: Vec<[f64; 2]> = (0..=18)
        .map(|i| f64::from(i) * 5.0)
        .map(|deg| [60.0 * deg.to_radians().sin(), 60.0 * (1.0 - deg.to_radians().cos())])
        .collect();
    let moved: Vec<[f64; 2]> = bend.iter().map(|[x, y]| [x + 1.5, y - 2.0]).collect();
    let network = Drawing::default().road(1, &bend, "").network();
    assert_eq!(told(&network, &line(&moved)), "1:1000-1018 1:1018-1000");
    let network = Drawing::default()
        .main_road([0.0, 50.0, 53.0, 100.0], [40.0, -40.0])
        .way(1, &[1, 2, 3, 4], "")
        .way(2, &[2, 5], "")
        .way(3, &[3, 6], "")
        .network();
    assert_eq!(told(&network, &line(&[[0.0, 2.0], [40.0, -1.0], [100.0, 2.0]])), "1:1-2 1:2-1 1:2-3 1:3-2 1:3-4 1:4-3");
}

#[test]
fn a_short_edge_at_the_end_of_a_line_is_passed_by_chance() {
    let network = Drawing::default()
        .road(1, &[[0.0, 0.0], [100.0, 0.0]], "")
        .road(2, &[[100.0, 0.0], [104.0, 0.0]], "")
        .network();
    assert_eq!(told(&network, &line(&[[0.0, 0.0], [104.0, 0.0]])), "1:1000-1001 1:1001-1000");
    let alone = told(&network, &line(&[[100.0, 0.0], [104.0, 0.0]]));
    assert!(
        alone.starts_with("unmatched: an edge of less than 10 m is meant only where the line goes on 5 m"),
        "{alone}"
    );
}

#[test]
fn the_antimeridian_is_no_border() {
    use super::super::Place;
    use crate::osm::LonLat;
    let mut network = beside(500.0, ["", ""]);
    let shift = 1_799_999_000 - network.shapes.iter().map(|at| at.lon_e7).min().unwrap();
    let over = |lon_e7: i32| {
        let lon_e7 = i64::from(lon_e7) + i64::from(shift);
        if lon_e7 > 1_800_000_000 { (lon_e7 - 3_600_000_000) as i32 } else { lon_e7 as i32 }
    };
    for at in &mut network.shapes {
        at.lon_e7 = over(at.lon_e7);
    }
    let ends: Vec<LonLat> = network.positions(&network.edges[0]).collect();
    assert!(ends[0].lon_e7 > 0 && ends[1].lon_e7 < 0, "{ends:?}");
    assert_eq!(told(&network, &row(Place::Line(ends.clone()))), "1:1000-1001 1:1001-1000");
    let west = LonLat { lon_e7: -1_799_999_990, ..ends[0] };
    assert_eq!(told(&network, &row(Place::Point(west))), "1:1000-1001 1:1001-1000");
}
