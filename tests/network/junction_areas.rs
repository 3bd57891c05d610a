//! The areas of junctions: their size by hand, that they hold what turns share, their holes, and a bend.

use std::f64::consts::PI;

use geo::{Area as _, BooleanOps as _, LineString, MultiPolygon, Polygon, Rect, Validation as _};
use netcert::corridor::Frame;
use netcert::osm::LonLat;
use netcert::osm::facts::{Policy, TrafficSide};
use netcert::turns::{JunctionArea, KerbSource, LengthClass, junction_areas, junction_nodes};

use netcert_testing::ascii_map::{AsciiMap, id_of};
use netcert_testing::junctions::DrawnNetwork;

fn cross(width: &str) -> AsciiMap {
    AsciiMap::drawn(
        60.0,
        "
            D
            |
        A---B---C
            |
            E
        ",
    )
    .way("ABC", &format!("highway=secondary {width}"))
    .way("DBE", &format!("highway=secondary {width}"))
}

fn areas(drawn: &DrawnNetwork) -> Vec<JunctionArea> {
    junction_areas(&drawn.network, &junction_nodes(&drawn.network, &drawn.facts()), &drawn.params)
}

/// An area in a metric frame.
fn within(area: &JunctionArea, frame: Frame) -> MultiPolygon {
    let ring =
        |ring: &Vec<LonLat>| frame.forward(ring).unwrap().into_iter().map(|[x, y]| (x, y)).collect::<LineString>();
    let polygon = |rings: &Vec<Vec<LonLat>>| Polygon::new(ring(&rings[0]), rings[1..].iter().map(ring).collect());
    area.polygons.iter().map(polygon).collect()
}

fn metres(area: &JunctionArea) -> MultiPolygon {
    within(area, Frame::around(&area.polygons[0][0]).unwrap())
}

#[test]
fn a_crossing_is_two_roads_and_four_rounded_corners() {
    for (width_m, kerb_m) in [(7.3, 6.0), (12.0, 10.0), (6.0, 0.0)] {
        let drawn = DrawnNetwork::new(&cross(&format!("width={width_m}")), TrafficSide::Right, kerb_m);
        let [area] = &areas(&drawn)[..] else { panic!("one junction") };
        assert_eq!((area.node, area.roads, area.kerb_source), (id_of('B'), 4, Some(KerbSource::Assumed)));
        // The mouths reach 15 m.
        let width_m = width_m - 2.0 * drawn.params.corridor.map_tolerance_m;
        let expected_m2 = 60.0 * width_m - width_m * width_m + 4.0 * (1.0 - PI / 4.0) * kerb_m * kerb_m;
        let made = metres(area);
        assert!(made.is_valid());
        let off = made.unsigned_area() / expected_m2 - 1.0;
        assert!(off.abs() < 0.015, "{width_m} {kerb_m}: {off}");
        let vertices: usize = area.polygons.iter().flatten().map(Vec::len).sum();
        assert!(vertices < 64, "compact: {vertices}");
    }
}

#[test]
fn what_any_turn_may_use_near_the_node_lies_in_the_junctions_area() {
    for kerb_m in [2.0, 6.0, 9.0] {
        let drawn = DrawnNetwork::new(&cross("width=8"), TrafficSide::Right, kerb_m);
        let [area] = &areas(&drawn)[..] else { panic!("one junction") };
        let mut edges = drawn.network.edges.iter().filter(|edge| edge.from_node == area.node);
        let node = drawn.network.positions(edges.next().unwrap()).next().unwrap();
        for turn in ["EBC", "EBA", "ABD", "CBE"] {
            let made = drawn.corridors(turn, Policy::Carriageway, LengthClass::Short).unwrap();
            let [x, y] = made.frame.forward(&[node]).unwrap()[0];
            let around = Rect::new((x - 12.0, y - 12.0), (x + 12.0, y + 12.0)).to_polygon();
            let near = made.area.intersection(&around);
            let beyond = near.difference(&within(area, made.frame)).unsigned_area();
            assert!(near.unsigned_area() > 150.0, "something is compared");
            assert!(beyond < 0.6, "{kerb_m} {turn}: {beyond} m2");
        }
    }
}

#[test]
fn an_island_is_a_hole_and_a_mapped_surface_gives_the_corners() {
    let island = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let with = |map: AsciiMap| DrawnNetwork::new(&map, TrafficSide::Right, 6.0);
    let [whole] = &areas(&with(cross("width=9")))[..] else { panic!() };
    let [holed] = &areas(&with(cross("width=9").area('B', &island, "traffic_calming=island")))[..] else { panic!() };
    assert_eq!((holed.polygons.len(), holed.polygons[0].len()), (1, 2));
    assert!((metres(whole).unsigned_area() - metres(holed).unsigned_area() - 4.0).abs() < 0.1);
    assert!(metres(holed).is_valid());
    let square = [[-12.0, -12.0], [12.0, -12.0], [12.0, 12.0], [-12.0, 12.0]];
    let [mapped] = &areas(&with(cross("width=9").area('B', &square, "area:highway=secondary")))[..] else { panic!() };
    assert_eq!(mapped.kerb_source, Some(KerbSource::Mapped));
    assert!(metres(mapped).unsigned_area() > metres(whole).unsigned_area() + 50.0);
}

#[test]
fn a_bend_has_two_mouths_and_an_inner_corner() {
    let bend = AsciiMap::placed(&[('A', [-80.0, 0.0]), ('B', [0.0, 0.0]), ('C', [0.0, 80.0])])
        .way("AB", "highway=secondary width=7")
        .way("BC", "highway=secondary width=7");
    let drawn = DrawnNetwork::new(&bend, TrafficSide::Right, 6.0);
    let [area] = &areas(&drawn)[..] else { panic!("one junction") };
    assert_eq!((area.node, area.roads), (id_of('B'), 2));
    // Two mouths of 15 m share a quarter of a square; the corner is rounded.
    let width_m = 7.0 - 2.0 * drawn.params.corridor.map_tolerance_m;
    let expected_m2 = 30.0 * width_m - 0.25 * width_m * width_m + (1.0 - PI / 4.0) * 36.0;
    let made_m2 = metres(area).unsigned_area();
    assert!((made_m2 / expected_m2 - 1.0).abs() < 0.015, "{made_m2} {expected_m2}");
}

#[test]
fn areas_are_the_same_for_any_number_of_threads_and_in_order_of_nodes() {
    let map = AsciiMap::drawn(
        60.0,
        "
        F   D   G
        |   |   |
        A---B---C
        |   |   |
        H   E   I
        ",
    )
    .way("ABC", "highway=secondary width=8")
    .way("FAH", "highway=tertiary width=7")
    .way("DBE", "highway=tertiary width=7")
    .way("GCI", "highway=tertiary width=7");
    let drawn = DrawnNetwork::new(&map, TrafficSide::Left, 6.0);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| areas(&drawn))
    };
    let made = on(1);
    assert_eq!(made, on(3));
    let mut nodes = ['A', 'B', 'C'].map(id_of);
    nodes.sort_unstable();
    assert_eq!(made.iter().map(|area| area.node).collect::<Vec<_>>(), nodes);
}
