//! Routes that climb: each road and turn on the narrowest strip that is certified, one certificate over all, and bounds on how far the
//! vehicle stands beyond its lane. The simulator drives against these bounds, with lanes that are known from the drawing.

use std::sync::Arc;

use netcert::network::offset_m;
use netcert::osm::LonLat;
use netcert::osm::facts::{CrossSection, Policy, Strip, WidthSource};
use netcert::route::*;
use netcert::settings::Settings;
use netcert::stet::Side;
use netcert::stop::Stop;
use netcert::turns::Kerbs;
use netcert_testing::ascii_map::{self, AsciiMap};
use netcert_testing::oracle::draw::Draw;
use netcert_testing::oracle::whole;
use netcert_testing::routing::TestRegion;

const VEHICLE: &str = "EU-SEMI16.5";
const WIDE: &str = "highway=secondary lanes=2 width=7";
/// Each lane has 2.7 m, and the vehicle needs 2.78 m.
const NARROW: &str = "highway=secondary lanes=2 width=5.4";

/// The region under a policy. All share the roads, so permits belong to the same edges.
fn under(region: &TestRegion, policy: Policy) -> TestRegion {
    let settings = Settings { policy, ..region.settings.clone() };
    TestRegion { roads: Arc::clone(&region.roads), settings, kerbs: region.kerbs.clone() }
}

fn region(map: &AsciiMap, kerb_m: f64) -> TestRegion {
    let mut region = TestRegion::of(map.extract(), Policy::Lane);
    region.kerbs = Kerbs::everywhere(kerb_m);
    region
}

fn ladder(region: &TestRegion, policies: &[Policy]) -> Ladder {
    let drivers: Vec<Arc<Driver>> = policies.iter().map(|&policy| under(region, policy).driver(VEHICLE).0).collect();
    Ladder::new(&drivers, &region.movements).unwrap()
}

fn climber(region: &TestRegion, policies: &[Policy]) -> Planner {
    let (speeds, prices) = (Speeds::builtin().unwrap(), RungPrices::builtin().unwrap());
    Planner::climbing(&region.roads, &ladder(region, policies), &speeds, Measure::Time, &prices)
}

/// The middle of the first piece of an edge.
fn on(region: &TestRegion, ends: &str) -> Position {
    let edge = &region.network.edges[ascii_map::edge(&region.network, ends).index()];
    let line: Vec<_> = region.network.positions(edge).map(LonLat::degrees).collect();
    Position { lon: f64::midpoint(line[0].0, line[1].0), lat: f64::midpoint(line[0].1, line[1].1) }
}

fn ask(region: &TestRegion, planner: &mut Planner, [from, to]: [&str; 2]) -> Answer {
    let places = vec![on(region, from), on(region, to)];
    planner.answer(&Question { places, snap_m: 5.0, alternatives: 0, tries: 20 }, &Stop::never()).unwrap()
}

/// A straight road to the east, wide but for 120 m between `B` and `C`, with side roads at `M` and `N`.
fn bottleneck() -> AsciiMap {
    let nodes = [
        ('A', [0.0, 0.0]),
        ('M', [150.0, 0.0]),
        ('B', [300.0, 0.0]),
        ('C', [420.0, 0.0]),
        ('N', [570.0, 0.0]),
        ('D', [720.0, 0.0]),
        ('U', [150.0, -100.0]),
        ('V', [570.0, -100.0]),
    ];
    let side = "highway=residential";
    AsciiMap::placed(&nodes).way("AMB", WIDE).way("BC", NARROW).way("CND", WIDE).way("MU", side).way("NV", side)
}

#[test]
fn a_road_that_is_too_narrow_for_its_lane_is_used_on_the_carriageway_and_nowhere_else() {
    let region = region(&bottleneck(), 6.0);
    let mut level = under(&region, Policy::Lane).planner(&under(&region, Policy::Lane).driver(VEHICLE), Measure::Time);
    let answer = ask(&region, &mut level, ["AM", "ND"]);
    assert!(answer.routes.is_empty() && answer.obstacles.is_some(), "{answer:?}");

    let mut planner = climber(&region, &[Policy::Lane, Policy::Direction, Policy::Carriageway]);
    let answer = ask(&region, &mut planner, ["AM", "ND"]);
    let [route] = answer.routes.as_slice() else { panic!("{answer:?}") };
    assert!(route.certificate.result.safe());
    assert_eq!(route.rung(), Policy::Carriageway);
    // The route begins in the middle of `AM`, so the narrow road is 225 to 345 m from its beginning.
    for used in &route.uses {
        assert_eq!((used.strip, used.place, used.side), (Policy::Carriageway, UsePlace::Road, Side::Left), "{used:?}");
        assert!(used.from_m > 225.0 - 60.0 && used.to_m < 345.0 + 60.0, "{used:?}");
        // The lane lacks 8 cm, and gets twice as much and 10 cm more.
        assert!(used.beyond_m > 0.0 && used.beyond_m < 0.5, "{used:?}");
    }
    let length_m: f64 = route.uses.iter().map(|used| used.to_m - used.from_m).sum();
    assert!((80.0..240.0).contains(&length_m), "{length_m}");
    whole::hold(&planner.driver().model.vehicle, &route.path.corridor, &route.certificate, 1);
    // The same question gives the same answer, whatever was asked before.
    let again = ask(&region, &mut planner, ["AM", "ND"]);
    assert_eq!(again.routes[0].uses, route.uses);
    assert_eq!(again.routes[0].certificate, route.certificate);
    // Two rungs are not enough.
    let answer = ask(&region, &mut climber(&region, &[Policy::Lane, Policy::Direction]), ["AM", "ND"]);
    assert!(answer.routes.is_empty() && answer.obstacles.is_some());
}

#[test]
fn no_simulated_body_stands_farther_beyond_its_lane_than_the_route_says() {
    let region = region(&bottleneck(), 6.0);
    let mut planner = climber(&region, &[Policy::Lane, Policy::Direction, Policy::Carriageway]);
    let answer = ask(&region, &mut planner, ["AM", "ND"]);
    let [route] = answer.routes.as_slice() else { panic!("{answer:?}") };
    let vehicle = &planner.driver().model.vehicle;
    let begins =
        region.network.positions(&region.network.edges[ascii_map::edge(&region.network, "AM").index()]).next().unwrap();
    let from = begins.degrees();
    let a_tenth = LonLat { lon_e7: begins.lon_e7 + 1_000_000, lat_e7: begins.lat_e7 + 1_000_000 };
    let degree_m = offset_m(begins, a_tenth).map(|m| 10.0 * m);
    let last_m = 640.0;
    let (mut farthest_m, mut least_spare_m) = (0.0_f64, f64::INFINITY);
    for seed in 0..40 {
        let places = whole::driven(vehicle, &route.path.corridor, &route.certificate, &mut Draw(0x00c1_1e5b + seed));
        let lonlat = route.path.frame.inverse(&places).unwrap();
        for [lon, lat] in lonlat {
            // The road runs east along the drawing's line. Traffic keeps to the right: the lane is south of the line.
            let [east_m, north_m] = [(lon - from.0) * degree_m[0], (lat - from.1) * degree_m[1]];
            if !(75.0..last_m).contains(&east_m) || north_m <= 0.02 {
                continue;
            }
            let along_m = east_m - 75.0;
            let stated = route.uses.iter().filter(|used| (used.from_m..=used.to_m).contains(&along_m));
            let stated_m = stated.map(|used| used.beyond_m).fold(0.0, f64::max);
            assert!(north_m <= stated_m + 0.02, "{north_m:.3} m beyond at {along_m:.1} m, {stated_m:.3} m stated");
            farthest_m = farthest_m.max(north_m);
            least_spare_m = least_spare_m.min(stated_m - north_m);
        }
    }
    println!("farthest {farthest_m:.3} m, nearest to what is stated {least_spare_m:.3} m, stated {:?}", route.uses);
    // The bound is no empty one: something came near it.
    assert!(farthest_m > 0.0 && least_spare_m < 0.35, "{farthest_m} {least_spare_m}");
}

/// From `AJ` into `JS` the carriageway is enough, and no lane is.
fn corner() -> AsciiMap {
    let nodes =
        [('A', [-400.0, 0.0]), ('J', [0.0, 0.0]), ('E', [400.0, 0.0]), ('S', [0.0, -400.0]), ('N', [0.0, 400.0])];
    let tags = "highway=secondary lanes=2 width=9";
    AsciiMap::placed(&nodes).way("AJE", tags).way("SJN", tags)
}

#[test]
fn a_turn_that_needs_the_oncoming_lane_says_where_and_the_roads_keep_their_lanes() {
    let region = region(&corner(), 10.0);
    let mut level = under(&region, Policy::Lane).planner(&under(&region, Policy::Lane).driver(VEHICLE), Measure::Time);
    assert!(ask(&region, &mut level, ["AJ", "JS"]).routes.is_empty());
    let mut planner = climber(&region, &[Policy::Lane, Policy::Direction, Policy::Carriageway]);
    let answer = ask(&region, &mut planner, ["AJ", "JS"]);
    let [route] = answer.routes.as_slice() else { panic!("{answer:?}") };
    assert_eq!(route.rung(), Policy::Carriageway);
    let beside: Vec<&StripUse> = route.uses.iter().filter(|used| used.place == UsePlace::Turn).collect();
    let edges = ["AJ", "JS"].map(|ends| ascii_map::edge(&region.network, ends));
    for used in &beside {
        assert_eq!(used.at, PartKind::Turn { from: edges[0], to: edges[1] });
        // The other lane is 4.5 m wide. Before and after the crossing the vehicle needs a few decimetres of it, a few metres long.
        assert!((0.1..1.0).contains(&used.beyond_m) && used.to_m - used.from_m < 20.0, "{used:?}");
        // The node is 200 m from the beginning. The kerb's arc begins 14.5 m from it.
        assert!(used.from_m > 200.0 - 70.0 && used.to_m < 200.0 + 70.0, "{used:?}");
    }
    assert!(!beside.is_empty(), "{:?}", route.uses);
    let beside_m: f64 =
        route.uses.iter().filter(|used| used.place == UsePlace::Road).map(|used| used.to_m - used.from_m).sum();
    assert!(beside_m < 120.0, "{:?}", route.uses);
    whole::hold(&planner.driver().model.vehicle, &route.path.corridor, &route.certificate, 2);
}

#[test]
fn a_ladder_of_one_rung_answers_as_a_planner_without_one() {
    let region = region(&corner(), 14.0);
    let carriageway = under(&region, Policy::Carriageway);
    let answer = ask(&region, &mut carriageway.planner(&carriageway.driver(VEHICLE), Measure::Time), ["AJ", "JS"]);
    let climbed = ask(&region, &mut climber(&region, &[Policy::Carriageway]), ["AJ", "JS"]);
    let [route] = answer.routes.as_slice() else { panic!("{answer:?}") };
    assert_eq!(climbed.routes[0].path, route.path);
    assert_eq!(climbed.routes[0].certificate, route.certificate);
    assert_eq!(climbed.routes[0].cost, route.cost);
}

/// The road before the corner needs more than its lane, and goes on beyond the corner, where the way does not.
#[test]
fn a_road_that_the_way_leaves_does_not_bend_the_way_before() {
    let nodes =
        [('A', [-400.0, 0.0]), ('J', [0.0, 0.0]), ('E', [400.0, 0.0]), ('S', [0.0, -400.0]), ('N', [0.0, 400.0])];
    let tags = "highway=secondary lanes=2 width=8";
    let region = region(&AsciiMap::placed(&nodes).way("AJE", tags).way("NJS", tags), 1.0);
    let mut planner = climber(&region, &[Policy::Lane, Policy::Direction, Policy::Carriageway]);
    let answer = ask(&region, &mut planner, ["AJ", "JS"]);
    let [route] = answer.routes.as_slice() else { panic!("{answer:?}") };
    let length_m: f64 = route.uses.iter().map(|used| used.to_m - used.from_m).sum();
    // With a narrow road behind the corner, the line of the road before it would bend, and the way would need 168 m.
    assert!(length_m < 140.0, "{:?}", route.uses);
    whole::hold(&planner.driver().model.vehicle, &route.path.corridor, &route.certificate, 3);
}

/// The corner has too small a kerb even for the whole carriageway. The roads before and after it are wide enough for their lanes.
#[test]
fn a_way_under_conditions_keeps_to_its_lane_away_from_them() {
    let nodes = [
        ('A', [-900.0, 0.0]),
        ('B', [-200.0, 0.0]),
        ('J', [0.0, 0.0]),
        ('E', [400.0, 0.0]),
        ('S', [0.0, -900.0]),
        ('C', [0.0, -200.0]),
        ('N', [0.0, 400.0]),
        ('u', [-200.0, 100.0]),
        ('v', [100.0, -200.0]),
    ];
    let (tags, side) = ("highway=secondary lanes=2 width=6.6", "highway=residential");
    let map = AsciiMap::placed(&nodes).way("ABJE", tags).way("SCJN", tags).way("Bu", side).way("Cv", side);
    let region = region(&map, 2.0);
    let places = vec![on(&region, "AB"), on(&region, "CS")];
    let question = Question { places, snap_m: 5.0, alternatives: 0, tries: 20 };
    let under_conditions = |planner: &mut Planner| {
        let answer = planner.best_answer(&question, Conditions::Anywhere, &Stop::never(), || ()).unwrap();
        assert!(answer.routes.is_empty());
        answer.conditional.unwrap()
    };
    let carriageway = under(&region, Policy::Carriageway);
    let widest = under_conditions(&mut carriageway.planner(&carriageway.driver(VEHICLE), Measure::Time));
    let mut planner = climber(&region, &[Policy::Lane, Policy::Direction, Policy::Carriageway]);
    let climbed = under_conditions(&mut planner);
    assert_eq!(climbed.conditions, widest.conditions, "what has to hold is the same");
    assert!(!climbed.conditions.is_empty() && climbed.route.certificate.result.safe());
    // The way begins 550 m before the node and ends 550 m behind it.
    for used in &climbed.route.uses {
        assert!(used.from_m > 550.0 - 260.0 && used.to_m < 550.0 + 260.0, "{used:?}");
    }
    let beyond_m = |route: &Route| route.uses.iter().map(|used| used.to_m - used.from_m).sum::<f64>();
    assert!(beyond_m(&widest.route) > 800.0 && beyond_m(&climbed.route) > 20.0, "{:?}", climbed.route.uses);
    whole::hold(&planner.driver().model.vehicle, &climbed.route.path.corridor, &climbed.route.certificate, 4);
}

/// From `A` to `D` there is a narrow road straight on, and a wide one that is a little longer and needs the oncoming lane at its two turns
/// alone.
#[test]
fn a_detour_in_the_own_lane_is_better_than_the_oncoming_lane() {
    let wide = "highway=secondary lanes=2 width=9";
    let nodes = [
        ('Z', [-300.0, 0.0]),
        ('A', [0.0, 0.0]),
        ('B', [300.0, 0.0]),
        ('D', [600.0, 0.0]),
        ('Y', [900.0, 0.0]),
        ('U', [100.0, -30.0]),
        ('V', [500.0, -30.0]),
    ];
    let map = AsciiMap::placed(&nodes).way("ZA", wide).way("ABD", NARROW).way("AUVD", wide).way("DY", wide);
    let region = region(&map, 4.5);
    let ladder = ladder(&region, &[Policy::Lane, Policy::Direction, Policy::Carriageway]);
    // The width of the narrowest road of the route, metres.
    let narrowest_m = |prices: &RungPrices| {
        let speeds = Speeds::builtin().unwrap();
        let mut planner = Planner::climbing(&region.roads, &ladder, &speeds, Measure::Time, prices);
        let answer = ask(&region, &mut planner, ["ZA", "DY"]);
        let [route] = answer.routes.as_slice() else { panic!("{answer:?}") };
        let roads = route.drive.edges.iter().map(|edge| region.network.section(&region.network.edges[edge.index()]));
        roads.map(|section| section.carriageway.unwrap().width_m()).fold(f32::INFINITY, f32::min)
    };
    // 600 m of the oncoming lane cost more than it costs at two turns. Where it costs nothing, the shorter way wins.
    let free = include_str!("../../data/rungs.toml").lines().map(|line| match line.split_once(" = ") {
        Some((name, _)) if !line.starts_with('#') => format!("{name} = 0.0\n"),
        _ => format!("{line}\n"),
    });
    let free = RungPrices::from_toml(&free.collect::<String>()).unwrap();
    assert_eq!([narrowest_m(&RungPrices::builtin().unwrap()), narrowest_m(&free)], [9.0, 5.4]);
}

#[test]
fn sets_of_other_settings_are_no_ladder() {
    let region = region(&bottleneck(), 6.0);
    let mut other = under(&region, Policy::Carriageway);
    other.kerbs = Kerbs::everywhere(7.0);
    let drivers = [under(&region, Policy::Lane).driver(VEHICLE).0, other.driver(VEHICLE).0];
    let error = Ladder::new(&drivers, &region.movements).unwrap_err();
    assert_eq!(error, UnlikeSets::Settings { base: Policy::Lane, other: Policy::Carriageway });
    assert!(
        error.to_string().contains("the carriageway set was made with other settings than the lane set"),
        "{error}"
    );
    assert_eq!(Ladder::new(&[], &region.movements).unwrap_err(), UnlikeSets::Empty);
}

#[test]
fn a_section_becomes_wider_towards_the_greater_room_first_and_never_beyond_the_widest_strip() {
    let strip = |left_m, right_m, source| Some(Strip { left_m, right_m, source });
    // Two lanes of 3 m, and 0.5 m of road beyond the own one.
    let section = CrossSection {
        lane: strip(0.0, -3.0, WidthSource::Tagged),
        direction: strip(0.0, -3.0, WidthSource::Tagged),
        carriageway: strip(3.0, -3.5, WidthSource::FromLanes),
    };
    let lane = |section: CrossSection| section.lane.map(|strip| [strip.left_m, strip.right_m]).unwrap();
    assert!((section.room_m(Policy::Lane, Policy::Carriageway) - 3.5).abs() < 1e-6);
    assert!(section.room_m(Policy::Lane, Policy::Direction).abs() < 1e-6);
    for (more_m, edges) in
        [(0.0, [0.0, -3.0]), (0.4, [0.4, -3.0]), (3.0, [3.0, -3.0]), (3.2, [3.0, -3.2]), (9.0, [3.0, -3.5])]
    {
        let wider = section.widened(Policy::Lane, Policy::Carriageway, more_m);
        assert!(lane(wider).iter().zip(edges).all(|(a, b)| (a - b).abs() < 1e-5), "{more_m}: {wider:?}");
        // Whatever may shift within the direction has the lane within it, and a width is worth no more than the least of its sources.
        assert_eq!(wider.direction.map(|strip| [strip.left_m, strip.right_m]), Some(lane(wider)));
        assert_eq!(wider.lane.map(|strip| strip.source), Some(WidthSource::FromLanes));
        assert_eq!(wider.carriageway, section.carriageway);
    }
    let without = CrossSection { carriageway: None, ..section };
    assert_eq!(without.widened(Policy::Lane, Policy::Carriageway, 1.0), without);
}
