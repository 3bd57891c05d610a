//! Mapped surfaces of junctions: where they count, which corners they give, what is left out. Islands are in `islands.rs`.

use std::fs;

use geo::{Area as _, BooleanOps as _, Contains as _, Distance as _, Euclidean};
use netcert::network::build;
use netcert::osm::facts::{AreaKind, Policy, RoadClass, TrafficSide};
use netcert::osm::pbf::read_extract;
use netcert::osm::pbf::write::{self, NodeRecord, WayRecord};
use netcert::osm::{Extract, LonLat, NodeId};
use netcert::turns::{KerbSource, LengthClass, TurnCorridors, turn_corridors};

use netcert_testing::ascii_map::{AsciiMap, built, id_of, no_sections, offset, somewhere};
use netcert_testing::extracts::extract;
use netcert_testing::junctions::DrawnNetwork;

/// Two roads of 7.5 m. A lorry from E to C turns round the corner in the south-east.
fn cross() -> AsciiMap {
    cross_of("width=7.5")
}

fn cross_of(width: &str) -> AsciiMap {
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

const SURFACE: &str = "area:highway=secondary";

fn square(half_m: f64) -> Vec<[f64; 2]> {
    vec![[-half_m, -half_m], [half_m, -half_m], [half_m, half_m], [-half_m, half_m]]
}

fn corner(drawn: &DrawnNetwork) -> TurnCorridors {
    let turn = drawn.turn("EBC");
    turn_corridors(&drawn.network, turn.movement, Policy::Carriageway, &drawn.params, LengthClass::Short).unwrap()
}

fn rsc_m(map: &AsciiMap, kerb_m: f64) -> f64 {
    DrawnNetwork::new(map, TrafficSide::Right, kerb_m)
        .best("EBC", Policy::Carriageway, "EU-SEMI16.5")
        .unwrap()
        .rsc_m
        .unwrap()
}

#[test]
fn a_mapped_surface_stands_for_the_kerb() {
    // Without a kerb return the corner is too sharp for the lorry.
    let narrow = || cross_of("width=7.3");
    let (sharp, wide) = (rsc_m(&narrow(), 0.0), rsc_m(&narrow().area('B', &square(25.0), SURFACE), 0.0));
    assert!(sharp < 0.0 && wide > 0.5, "{sharp} {wide}");
    // As mapped, and no rounder, whatever is assumed elsewhere.
    let tight = narrow().area('B', &square(4.0), SURFACE);
    assert!((rsc_m(&tight, 15.0) - sharp).abs() < 0.2 && rsc_m(&narrow(), 15.0) > sharp + 0.5);
    let drawn = DrawnNetwork::new(&tight, TrafficSide::Right, 15.0);
    for turn in drawn.facts() {
        assert_eq!((turn.kerb_radius_m, turn.kerb_source), (None, Some(KerbSource::Mapped)));
    }
    assert_eq!(corner(&drawn).kerb_radius_m, None);
}

#[test]
fn nothing_counts_that_neither_a_road_nor_the_surface_covers() {
    // Cut off from 9 m east on in the south, so that the corner is lopsided.
    let ring = [[-20.0, -20.0], [9.0, -20.0], [9.0, -6.0], [20.0, -6.0], [20.0, 20.0], [-20.0, 20.0]];
    let bare = corner(&DrawnNetwork::new(&cross(), TrafficSide::Right, 0.0));
    let mapped = corner(&DrawnNetwork::new(&cross().area('B', &ring, SURFACE), TrafficSide::Right, 0.0));
    let added = mapped.area.difference(&bare.area);
    let node = node_of(&mapped);
    // All corners of the crossing count, as far as the surface covers them. The corner of this turn:
    let quadrant = geo::Rect::new((node[0], node[1] - 60.0), (node[0] + 60.0, node[1])).to_polygon();
    let in_the_corner = added.intersection(&geo::MultiPolygon::from(quadrant)).unsigned_area();
    assert!((40.0..120.0).contains(&in_the_corner), "{in_the_corner}");
    let surface: geo::Polygon = geo::Polygon::new(
        ring.iter().map(|p| (node_of(&mapped)[0] + p[0], node_of(&mapped)[1] + p[1])).collect(),
        Vec::new(),
    );
    let beyond = added.difference(&geo::MultiPolygon::from(surface));
    assert!(beyond.unsigned_area() < 2.0, "{} {beyond:?}", beyond.unsigned_area());
    let there = |[east, north]: [f64; 2]| mapped.area.contains(&geo::Point::new(node[0] + east, node[1] + north));
    assert!(there([8.5, -5.5]) && there([6.0, -10.0]) && there([11.0, -5.5]));
    assert!(!there([9.5, -6.5]) && !there([12.0, -12.0]));
    // No corridor leaves the surface either.
    let mut looked_at = 0;
    for path in &mapped.on_road() {
        let c = &path.corridor;
        for k in path.turn.clone() {
            let (sin, cos) = c.heading[k].sin_cos();
            for across in [c.left_m[k], -c.right_m[k]] {
                let at = geo::Point::new(c.x[k] - across * sin, c.y[k] + across * cos);
                assert!(Euclidean.distance(&at, &mapped.area) < 0.02, "path {} at {k}", path.code);
                looked_at += 1;
            }
        }
    }
    assert!(looked_at > 500, "{looked_at}");
}

fn node_of(made: &TurnCorridors) -> [f64; 2] {
    made.frame.forward(&[node_b()]).unwrap()[0]
}

fn node_b() -> LonLat {
    let (network, _) = built(&cross());
    let edge = network.edges.iter().find(|edge| edge.from_node == id_of('B')).unwrap();
    network.positions(edge).next().unwrap()
}

#[test]
fn islands_on_a_surface_are_no_road() {
    let wide = cross().area('B', &square(25.0), SURFACE);
    let island = [[4.5, -14.0], [14.0, -14.0], [14.0, -4.5], [4.5, -4.5]];
    let with_island = wide.clone().area('B', &island, "area:highway=traffic_island layer=1");
    let (free, round_it) = (rsc_m(&wide, 0.0), rsc_m(&with_island, 0.0));
    assert!(round_it < free - 0.5, "{free} {round_it}");
    let beyond = [[200.0, -206.0], [206.0, -206.0], [206.0, -200.0], [200.0, -200.0]];
    let (network, account) = built(&with_island.area('B', &beyond, "area:highway=traffic_island"));
    let kinds: Vec<AreaKind> = network.areas.all().iter().map(|area| area.kind).collect();
    assert_eq!(kinds, [AreaKind::Road(RoadClass::Secondary), AreaKind::Island]);
    assert_eq!((account.areas_read, account.areas_kept), (3, 2));
}

#[test]
fn a_surface_counts_for_the_roads_of_its_class_at_the_nodes_inside_it() {
    let source = |map: &AsciiMap| DrawnNetwork::new(map, TrafficSide::Right, 6.0).turn("EBC").kerb_source;
    assert_eq!(source(&cross()), Some(KerbSource::Assumed));
    assert_eq!(source(&cross().area('B', &square(10.0), "area:highway=secondary_link")), Some(KerbSource::Mapped));
    assert_eq!(source(&cross().area('B', &square(10.0), "area:highway=service")), Some(KerbSource::Assumed));
    let beside: Vec<[f64; 2]> = square(10.0).iter().map(|p| [p[0] + 11.0, p[1]]).collect();
    assert_eq!(source(&cross().area('B', &beside, SURFACE)), Some(KerbSource::Assumed));
}

#[test]
fn what_is_left_out_is_counted() {
    let bow = [[-10.0, -10.0], [10.0, 10.0], [10.0, -10.0], [-10.0, 10.0]];
    let nowhere: Vec<[f64; 2]> = square(10.0).iter().map(|p| [p[0] + 30.0, p[1] + 30.0]).collect();
    let map = cross().area('B', &bow, SURFACE).area('B', &nowhere, SURFACE).area('B', &square(10.0), SURFACE);
    let mut cut = map.extract();
    cut.areas.push({
        let mut area = cut.areas[2].clone();
        area.id += 1;
        area.refs[1] = NodeId::new(7);
        area
    });
    let (network, account) = build(cut, &somewhere, &no_sections);
    assert_eq!(network.areas.all().len(), 1);
    assert_eq!([account.areas_read, account.areas_kept, account.areas_cut, account.areas_invalid], [4, 1, 1, 1]);
    let left_out: u64 = account
        .rows()
        .iter()
        .filter(|row| (row.item.as_str(), row.outcome.as_str()) == ("area", "left_out"))
        .map(|row| row.count)
        .sum();
    assert_eq!(left_out, 3);
}

fn read(nodes: &[NodeRecord], ways: &[WayRecord]) -> Extract {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("region.osm.pbf");
    fs::write(&path, write::write_extract(nodes, ways)).unwrap();
    read_extract(&path, &|_| ()).unwrap()
}

#[test]
fn closed_ways_are_read_as_areas_and_still_counted_as_no_roads() {
    let at = LonLat { lon_e7: 87_000_000, lat_e7: 494_000_000 };
    let place = |id: i64| offset(at, (id % 3) as f64 * 9.0, (id / 3) as f64 * 7.0);
    let nodes: Vec<NodeRecord> = (1..8).map(|id| NodeRecord { id, place: place(id), tags: vec![] }).collect();
    let way = |id, refs: &[i64], tag: (&str, &str)| {
        let tags = vec![(tag.0.to_owned(), tag.1.to_owned())];
        WayRecord { id, refs: refs.to_vec(), tags }
    };
    let surface = ("area:highway", "primary");
    let ways = [
        way(1, &[1, 2], ("highway", "primary")),
        way(2, &[3, 4, 5, 3], surface),
        way(3, &[3, 4, 5], surface),
        way(4, &[3, 4, 3], surface),
        way(5, &[5, 6, 7, 5], ("area:highway", "footway")),
        way(6, &[3, 4, 6, 3], ("area:highway", "traffic_island")),
    ];
    let extract = read(&nodes, &ways);
    let refs = |area: &netcert::osm::RoadArea| area.refs.iter().map(|node| node.get()).collect::<Vec<_>>();
    let found: Vec<(i64, AreaKind, Vec<i64>)> =
        extract.areas.iter().map(|area| (area.id, area.kind, refs(area))).collect();
    let primary = AreaKind::Road(RoadClass::Primary);
    assert_eq!(found, [(2, primary, vec![3, 4, 5, 3]), (6, AreaKind::Island, vec![3, 4, 6, 3])]);
    assert!(
        (1..=6).all(|id| extract.nodes.place(NodeId::new(id)) == Some(place(id)))
            && extract.nodes.place(NodeId::new(7)).is_none()
    );
    let account = &extract.account;
    assert_eq!((account.ways_read, account.ways_kept, account.road_areas), (6, 1, 2));
    assert_eq!(account.ways_left_out.values().sum::<u64>(), 5);
    // In an unsorted file an id that occurs twice is not used.
    let ways = [way(6, &[3, 4, 6, 3], surface), way(2, &[3, 4, 5, 3], surface), way(6, &[3, 4], ("barrier", "fence"))];
    let areas: Vec<i64> = read(&nodes, &ways).areas.iter().map(|area| area.id).collect();
    assert_eq!(areas, [2]);
    // A road that follows with the id of an area.
    let ways = [way(6, &[3, 4, 6, 3], surface), way(2, &[3, 4], surface), way(6, &[3, 4], ("highway", "primary"))];
    let extract = read(&nodes, &ways);
    assert!(extract.areas.is_empty() && extract.ways.len() == 1);
}

#[test]
fn an_extract_has_the_areas_that_its_map_has() {
    let Some(path) = extract("heidelberg_de.osm.pbf") else { return };
    let extract = read_extract(&path, &|_| ()).unwrap();
    // `osmium tags-filter w/area:highway` finds eight closed ways: four of footways and one for buses.
    let ids: Vec<i64> = extract.areas.iter().map(|area| area.id).collect();
    assert_eq!(ids, [25_497_452, 27_638_566, 254_006_836]);
    assert_eq!(extract.account.road_areas, 3);
}
