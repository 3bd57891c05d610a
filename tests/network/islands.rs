//! Mapped traffic islands: a turn that they close is not safe, before and after a round trip through the database. Islands,
//! nodes and crossings that no map should have end in a verdict, too.

use netcert::osm::NodeId;
use std::collections::BTreeMap;

use geo::{Area as _, BooleanOps as _};
use netcert::network::{Network, Portion, build};
use netcert::osm::facts::{AreaKind, Policy, RoadClass, TrafficSide};
use netcert::rows::TurnCertificate;
use netcert::settings::Settings;
use netcert::store::{Database, Run};
use netcert::turns::{LengthClass, TurnCorridors, TurnNo};
use netcert::verdict::{UnsafeReason, Verdict};

use netcert_testing::ascii_map::{AsciiMap, built, id_of, no_sections, somewhere};
use netcert_testing::junctions::DrawnNetwork;

const LORRY: &str = "EU-SEMI16.5";
const ISLAND: &str = "traffic_calming=island";
/// In the way of every lorry from E to C.
const IN_THE_WAY: [[f64; 2]; 4] = [[-4.0, -24.0], [4.0, -24.0], [4.0, -19.0], [-4.0, -19.0]];
const KERB_M: f64 = 15.0;

/// Two roads of 7.3 m.
fn cross() -> AsciiMap {
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
    .way("ABC", "highway=secondary width=7.3")
    .way("DBE", "highway=secondary width=7.3")
}

fn with(island: &[[f64; 2]]) -> DrawnNetwork {
    DrawnNetwork::new(&cross().area('B', island, ISLAND), TrafficSide::Right, KERB_M)
}

fn made(drawn: &DrawnNetwork) -> TurnCorridors {
    drawn.corridors("EBC", Policy::Carriageway, LengthClass::Short).unwrap()
}

fn rsc_m(drawn: &DrawnNetwork) -> Option<f64> {
    drawn.best("EBC", Policy::Carriageway, LORRY)?.rsc_m
}

fn verdicts(drawn: &DrawnNetwork) -> Vec<Verdict> {
    let edges = vec![Verdict::Safe; drawn.network.edges.len()];
    let (rows, _) = drawn.certified(&[LORRY], &edges, Policy::Carriageway, 1);
    let by_turn: BTreeMap<TurnNo, TurnCertificate> = rows.into_iter().map(|(_, row)| (row.turn, row)).collect();
    by_turn.into_values().map(|row| row.conclusion.verdict).collect()
}

/// The network after it was written and read.
fn stored(network: &Network) -> Network {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("region.gpkg");
    let mut writer = Database::create(&path, &Settings::default()).unwrap();
    writer.portion(&Portion::whole(network.clone()), &[]).unwrap();
    writer.areas(network.areas.all().to_vec());
    let time = || "2026-11-21T08:00:00.000Z".to_owned();
    let run = Run {
        command: "ingest".to_owned(),
        input_name: "drawn".to_owned(),
        input_blake3: None,
        replication_timestamp: None,
        netcert_version: "0".to_owned(),
        started: time(),
        finished: time(),
        parameters: "{}".to_owned(),
    };
    writer.finish(&run).unwrap();
    Database::open(&path).unwrap().load_network().unwrap()
}

#[test]
fn an_island_closes_a_turn_before_and_after_a_reload() {
    let free = DrawnNetwork::new(&cross(), TrafficSide::Right, KERB_M);
    let closed = with(&IN_THE_WAY);
    assert!(
        rsc_m(&free).unwrap() > 0.3 && rsc_m(&closed).unwrap_or(-1.0) < 0.0,
        "{:?} {:?}",
        rsc_m(&free),
        rsc_m(&closed)
    );
    let area = made(&free).area.difference(&made(&closed).area);
    assert!((area.unsigned_area() - 36.5).abs() < 1.0, "{}", area.unsigned_area());
    assert_eq!((made(&free).islands.len(), made(&closed).islands.len()), (0, 1));
    let again = DrawnNetwork { network: stored(&closed.network), params: closed.params.clone() };
    assert_eq!(again.network.areas, closed.network.areas);
    assert_eq!((made(&again), rsc_m(&again)), (made(&closed), rsc_m(&closed)));
    assert!(verdicts(&free).contains(&Verdict::Safe));
    assert_eq!(verdicts(&again), verdicts(&closed));
}

#[test]
fn an_island_beside_the_road_changes_nothing() {
    let beside = with(&[[14.0, -14.0], [18.0, -14.0], [18.0, -10.0], [14.0, -10.0]]);
    assert_eq!(beside.network.areas.all().len(), 1);
    assert_eq!(made(&beside), made(&DrawnNetwork::new(&cross(), TrafficSide::Right, KERB_M)));
}

#[test]
fn an_island_at_the_end_of_a_road_is_not_undone_by_the_road_beyond() {
    // The areas near the end of the way out have the straight road beyond it beside them.
    let half = |end_m: f64| [[end_m - 1.0, -4.0], [end_m, -4.0], [end_m, 4.0], [end_m - 1.0, 4.0]];
    let short = |map: AsciiMap| {
        DrawnNetwork::new(
            &map.way("ABC", "highway=secondary width=7.3").way("DBE", "highway=secondary width=7.3"),
            TrafficSide::Right,
            KERB_M,
        )
    };
    let places = [('A', [-90.0, 0.0]), ('B', [0.0, 0.0]), ('C', [34.0, 0.0]), ('D', [0.0, 90.0]), ('E', [0.0, -90.0])];
    let free = short(AsciiMap::placed(&places));
    let closed = short(AsciiMap::placed(&places).area('B', &half(30.0), ISLAND));
    assert!(rsc_m(&free).unwrap() > 0.0, "{:?}", rsc_m(&free));
    assert!(rsc_m(&closed).is_none_or(|m| m < 0.0), "{:?}", rsc_m(&closed));
}

#[test]
fn islands_that_leave_no_road_make_every_turn_unsafe() {
    let all = [[-300.0, -300.0], [300.0, -300.0], [300.0, 300.0], [-300.0, 300.0]];
    // A median over the whole road, with a mouth left at the node.
    let median = [[2.0, -6.0], [300.0, -6.0], [300.0, 6.0], [2.0, 6.0]];
    let nothing = with(&all);
    assert!(made(&nothing).area.unsigned_area() < 1e-6 && made(&nothing).on_road().is_empty());
    assert!(verdicts(&nothing).iter().all(|verdict| *verdict == Verdict::Unsafe(UnsafeReason::Width)));
    let drawn = with(&median);
    let into_c = |verdict: &Verdict| matches!(verdict, Verdict::Unsafe(_));
    assert!(into_c(&verdicts(&drawn)[drawn.facts().iter().position(|t| t.id == drawn.turn("EBC").id).unwrap()]));
}

#[test]
fn an_island_that_is_not_whole_counts_as_the_hull_of_what_is_known() {
    let bow = [[-4.0, -24.0], [4.0, -19.0], [4.0, -24.0], [-4.0, -19.0]];
    let (network, account) = built(&cross().area('B', &bow, ISLAND));
    assert_eq!(
        [account.areas_kept, account.islands_kept, account.islands_widened, account.areas_invalid],
        [1, 1, 1, 0]
    );
    assert_eq!(network.areas.all()[0].ring.len(), 5);
    assert_eq!(rsc_m(&with(&bow)), rsc_m(&with(&IN_THE_WAY)));
    // One node of an island is missing, three of another one; a third one encloses nothing.
    let map = cross().area('B', &IN_THE_WAY, ISLAND).area('B', &IN_THE_WAY, ISLAND);
    let mut extract = map.area('B', &[[0.0, 0.0], [5.0, 0.0], [9.0, 0.0]], ISLAND).extract();
    extract.areas[0].refs[2] = NodeId::new(7);
    for lost in 1..4 {
        extract.areas[1].refs[lost] = NodeId::new(7);
    }
    let (network, account) = build(extract, &somewhere, &no_sections);
    let kinds: Vec<(AreaKind, usize)> = network.areas.all().iter().map(|area| (area.kind, area.ring.len())).collect();
    assert_eq!(kinds, [(AreaKind::Island, 4)]);
    assert_eq!([account.areas_read, account.areas_kept, account.areas_cut, account.areas_invalid], [3, 1, 1, 1]);
    // A surface that is not whole is none: it would add road.
    let (network, _) = built(&cross().area('B', &bow, "area:highway=secondary"));
    assert!(network.areas.all().iter().all(|area| area.kind != AreaKind::Road(RoadClass::Secondary)));
}

/// Characters for many nodes.
fn many(count: u32) -> Vec<char> {
    (0..count).filter_map(|i| char::from_u32(0x4e00 + i)).collect()
}

#[test]
fn a_crossing_of_hundreds_of_nodes_has_an_area_of_a_few() {
    // A road with a side road every quarter of a metre.
    let (on, off) = (many(400)[..200].to_vec(), many(400)[200..].to_vec());
    let mut nodes = vec![('A', [-90.0, 0.0]), ('C', [140.0, 0.0]), ('E', [25.0, -90.0])];
    nodes.extend(on.iter().zip(0..).map(|(&c, i)| (c, [0.25 * f64::from(i), 0.0])));
    nodes.extend(off.iter().zip(0..).map(|(&c, i)| (c, [0.25 * f64::from(i), 40.0])));
    let road = "highway=secondary width=7.3";
    let line: String = on.iter().collect();
    let mut map = AsciiMap::placed(&nodes).way(&format!("A{line}C"), road).way(&format!("E{}", on[100]), road);
    for (a, b) in on.iter().zip(&off) {
        map = map.way(&format!("{a}{b}"), road);
    }
    let drawn = DrawnNetwork::new(&map, TrafficSide::Right, KERB_M);
    let turn = drawn.facts().into_iter().find(|turn| {
        let [from, to] = [turn.movement.from, turn.movement.to].map(|edge| &drawn.network.edges[edge.index()]);
        from.from_node == id_of('E') && to.to_node == id_of(on[101])
    });
    let made = netcert::turns::corridors_of(
        &drawn.network,
        &turn.unwrap(),
        Policy::Carriageway,
        &drawn.params,
        LengthClass::Short,
    );
    let area = made.unwrap().area.unsigned_area();
    // Strips, and mouths of 15 m at some of the nodes.
    assert!((1000.0..6000.0).contains(&area), "{area}");
}

#[test]
fn a_node_of_forty_roads_has_turns_without_its_other_roads() {
    let ends = many(40);
    let spoke = |i: u32| [90.0 * (f64::from(i) * 0.157).cos(), 90.0 * (f64::from(i) * 0.157).sin()];
    let mut nodes = vec![('B', [0.0, 0.0])];
    nodes.extend(ends.iter().zip(0..).map(|(&c, i)| (c, spoke(i))));
    let map = ends
        .iter()
        .fold(AsciiMap::placed(&nodes), |map, end| map.way(&format!("B{end}"), "highway=secondary width=7.3"));
    let drawn = DrawnNetwork::new(&map, TrafficSide::Right, KERB_M);
    let area =
        |name: String| drawn.corridors(&name, Policy::Carriageway, LengthClass::Short).unwrap().area.unsigned_area();
    let across = area(format!("{}B{}", ends[0], ends[12]));
    // Both roads go straight on. The mouths of the others would add more than 300.
    assert!((2300.0..2700.0).contains(&across), "{across}");
}

#[test]
fn hundreds_of_equal_islands_are_one() {
    let map = (0..300).fold(cross(), |map, _| map.area('B', &IN_THE_WAY, ISLAND));
    let drawn = DrawnNetwork::new(&map, TrafficSide::Right, KERB_M);
    let (one, all) = (made(&with(&IN_THE_WAY)).area, made(&drawn).area);
    assert_eq!(drawn.network.areas.all().len(), 300);
    assert!((one.unsigned_area() - all.unsigned_area()).abs() < 1e-3);
}
