//! Routes over drawn junctions: roundabouts as one movement and leg by leg, turns that share a stretch of road, whole
//! routes that are refuted although their parts passed, alternatives, and obstacles.

#![allow(clippy::single_range_in_vec_init)]

use netcert_testing::ascii_map;
use netcert_testing::roundabout;
use netcert_testing::routing;

use ascii_map::AsciiMap;
use netcert::network::{EdgeNo, Movement, PassageKind};
use netcert::osm::facts::{Policy, TrafficSide};
use netcert::route::*;
use netcert::stet::certify_planned;
use netcert::stop::Stop;
use netcert::turns::Kerbs;
use netcert::verdict::{UnsafeReason, Verdict};
use netcert_testing::oracle::whole;
use routing::{TestDriver, TestRegion};

fn region(map: &AsciiMap, kerb_m: f64) -> TestRegion {
    let mut region = TestRegion::of(map.extract(), Policy::Carriageway);
    region.kerbs = Kerbs::everywhere(kerb_m);
    region
}

/// A ring of 20 m radius with four arms at right angles.
fn roundabout() -> AsciiMap {
    let tags = "highway=secondary width=8";
    roundabout::map(20.0, tags, tags, TrafficSide::Right)
}

fn edge(region: &TestRegion, ends: &str) -> EdgeNo {
    ascii_map::edge(&region.network, ends)
}

/// The middle of the first piece of an edge.
fn on(region: &TestRegion, ends: &str) -> Position {
    let line: Vec<_> = region.network.positions(&region.network.edges[edge(region, ends).index()]).collect();
    let (a, b) = (line[0].degrees(), line[1].degrees());
    Position { lon: f64::midpoint(a.0, b.0), lat: f64::midpoint(a.1, b.1) }
}

fn ask(region: &TestRegion, driver: &TestDriver, [from, to]: [&str; 2], alternatives: usize) -> Answer {
    let mut planner = region.planner(driver, Measure::Distance);
    let places = vec![on(region, from), on(region, to)];
    planner.answer(&Question { places, snap_m: 5.0, alternatives, tries: 20 }, &Stop::never()).unwrap()
}

fn turn(region: &TestRegion, from: &str, to: &str) -> PartKind {
    PartKind::Turn { from: edge(region, from), to: edge(region, to) }
}

/// Asserts one line without a jump or a kink: station by station, with headings as the curvature implies.
fn assert_smooth(route: &Route) {
    let c = &route.path.corridor;
    for k in 1..c.len() {
        let step_m = (c.x[k] - c.x[k - 1]).hypot(c.y[k] - c.y[k - 1]);
        assert!((step_m - c.spacing_m).abs() < 0.05 * c.spacing_m, "{step_m} at {k}");
        let bend = c.spacing_m * 0.5 * (c.curvature[k] + c.curvature[k - 1]);
        let turned = (c.heading[k] - c.heading[k - 1]).rem_euclid(std::f64::consts::TAU);
        let off = (turned - bend).rem_euclid(std::f64::consts::TAU);
        assert!(off.min(std::f64::consts::TAU - off) < 0.02, "{off} at {k}");
    }
}

#[test]
fn a_long_vehicle_gets_over_a_roundabout_in_one_movement() {
    let region = region(&roundabout(), 12.0);
    let driver = region.driver("EU-SEMI16.5");
    let answer = ask(&region, &driver, ["Wa", "mE"], 0);
    let [route] = answer.routes.as_slice() else { panic!("{answer:?}") };
    let arcs = [edge(&region, "ag"), edge(&region, "gm")];
    assert_eq!(route.drive.edges, [edge(&region, "Wa"), arcs[0], arcs[1], edge(&region, "mE")]);
    assert_eq!(route.drive.over, [1..3]);
    let parts: Vec<PartKind> = route.path.parts.iter().map(|part| part.kind).collect();
    let over = turn(&region, "Wa", "mE");
    assert_eq!(parts, [PartKind::Edge(edge(&region, "Wa")), over, PartKind::Edge(edge(&region, "mE"))]);
    assert!(
        passes_over(&region.network, over) == Some(PassageKind::Roundabout)
            && title(&region.network, over).contains("over the roundabout")
    );
    assert!(route.certificate.result.safe());
    assert_smooth(route);
    whole::hold(&driver.model.vehicle, &route.path.corridor, &route.certificate, 1);
    // Half the ring and the rest of the arms.
    assert!((route.length_m - (2.0 * 75.0 + 63.0)).abs() < 8.0, "{}", route.length_m);
}

#[test]
fn a_short_vehicle_that_may_not_pass_in_one_goes_round_by_its_arcs_past_the_seam() {
    let region = region(&roundabout(), 12.0);
    let mut driver = region.driver("AGV-TUG4");
    driver.permits.passages.fill(Permit::UNKNOWN);
    for (from, to) in [("Sg", "aW"), ("Em", "gS"), ("Ns", "mE")] {
        let answer = ask(&region, &driver, [from, to], 0);
        let [route] = answer.routes.as_slice() else { panic!("{from} {to}: {answer:?}") };
        assert!(route.drive.over.is_empty());
        assert_eq!(route.drive.edges.len(), 5, "three arcs");
        let turns = route.path.parts.iter().filter(|part| matches!(part.kind, PartKind::Turn { .. })).count();
        assert_eq!(turns, 2);
        assert_smooth(route);
        // Three quarters of the ring and half of both arms.
        assert!((route.length_m - (2.0 * 75.0 + 94.0)).abs() < 15.0, "{from} {to}: {}", route.length_m);
    }
}

#[test]
fn a_restriction_over_the_ring_is_obeyed_by_the_passage() {
    let map = roundabout().restriction(&[2], netcert::osm::Via::Ways(vec![1]), &[4], "restriction=no_straight_on");
    let region = region(&map, 12.0);
    assert!(!region.network.restrictions.is_empty());
    let driver = region.driver("AGV-TUG4");
    let forbidden = ["Wa", "ag", "gm", "mE"].map(|ends| edge(&region, ends));
    let answer = ask(&region, &driver, ["Wa", "mE"], 0);
    // Another circle round the ring is another way, and a legal one.
    assert!(
        answer.routes.iter().all(|route| route.drive.edges.len() == forbidden.len() + 4 && route.drive.over.is_empty())
    );
    assert_eq!(ask(&region, &driver, ["Wa", "gS"], 0).routes.len(), 1);
}

/// One-way: left into a street, and right out of it after `between_m` metres. With `way_round`, a wide way round leaves
/// the road before and joins it after.
fn s_bend(width_m: f64, between_m: f64, way_round: bool) -> AsciiMap {
    const ROUND: &str = "abcdefghijklmnopqrs";
    let mut nodes = vec![
        ('A', [-450.0, 0.0]),
        ('W', [-300.0, 0.0]),
        ('J', [0.0, 0.0]),
        ('K', [0.0, between_m]),
        ('E', [300.0, between_m]),
        ('D', [450.0, between_m]),
        ('S', [0.0, -150.0]),
        ('N', [0.0, between_m + 150.0]),
    ];
    nodes.extend(ROUND.chars().zip(1..).map(|(c, i)| {
        let share = f64::from(i) / 20.0;
        (c, [600.0 * share - 300.0, between_m * share + 150.0 * (std::f64::consts::PI * share).sin()])
    }));
    let tags = format!("highway=secondary oneway=yes width={width_m}");
    let map = AsciiMap::placed(&nodes).way("SJKN", &tags).way("AWJ", &tags).way("KED", &tags);
    if way_round { map.way(&format!("W{ROUND}E"), "highway=secondary oneway=yes width=20") } else { map }
}

#[test]
fn turns_that_share_a_stretch_of_road_are_blended_or_refused() {
    let (mut blended, mut refused) = (0, 0);
    for between_m in [4.0, 7.0, 10.0, 17.0, 24.0, 33.0, 42.0] {
        let region = region(&s_bend(8.0, between_m, false), 12.0);
        let mut driver = region.driver("AGV-TUG4");
        // Up to 30 m the two turns are one movement, too, which would need no blending.
        driver.permits.passages.fill(Permit::UNKNOWN);
        let driver = driver;
        let (mut strokes, mut menu) = (region.strokes(), Menu::new(Box::new(TestRegion::turns(&driver))));
        let mut piece = |from: &str, to: &str| {
            let movement: Movement = *region.movements.between(edge(&region, from), edge(&region, to)).unwrap();
            menu.chosen(&mut strokes, &movement, &[]).unwrap()
        };
        let (first, second) = (piece("AJ", "JK"), piece("JK", "KD"));
        let shared = first.departure.station > second.approach.station;
        let answer = ask(&region, &driver, ["AJ", "KD"], 0);
        println!("{between_m} m: shared {shared}, {} routes, {} refuted", answer.routes.len(), answer.refuted.len());
        if !answer.refuted.is_empty() {
            let overlap = |r: &Refutation| matches!(r.assembly, Some(AssemblyError::Overlap { .. }));
            refused += usize::from(answer.refuted.iter().all(overlap));
            continue;
        }
        let [route] = answer.routes.as_slice() else { panic!("{answer:?}") };
        assert_smooth(route);
        let parts: Vec<PartKind> = route.path.parts.iter().map(|part| part.kind).collect();
        let between = [turn(&region, "AJ", "JK"), PartKind::Edge(edge(&region, "JK")), turn(&region, "JK", "KD")];
        assert!(!shared || parts.windows(3).any(|three| three == between), "{parts:?}");
        blended += usize::from(shared);
    }
    assert!(blended > 0 && refused > 0, "{blended} blended, {refused} refused");
}

/// A part of a route has no more leeway than the certificate of its stations, wherever in the area the least leeway is noted.
#[test]
fn no_part_of_a_route_has_more_leeway_than_its_own_stations() {
    let mut turns = 0;
    for width_m in [6.0, 8.0, 12.0] {
        let region = region(&s_bend(width_m, 120.0, false), 12.0);
        let driver = region.driver("EU-SEMI16.5");
        let answer = ask(&region, &driver, ["AJ", "KD"], 0);
        for route in &answer.routes {
            let spans: Vec<_> = route.path.parts.iter().map(|part| part.stations.clone()).collect();
            let options = &driver.permits.settings.stet;
            let corridor = &route.path.corridor;
            let (_, own) = certify_planned(corridor, &driver.model, &spans, options, &Stop::never()).unwrap().unwrap();
            for (part, own) in route.parts().iter().zip(own) {
                if own.shrink != route.certificate.result.shrink {
                    continue;
                }
                assert!(part.rsc_m.unwrap() <= own.rsc_m.unwrap() + 1e-9, "{width_m}: {part:?} {own:?}");
                turns += usize::from(matches!(part.kind, PartKind::Turn { .. }));
            }
        }
    }
    assert!(turns > 3, "{turns}");
}

/// From W to E by an arc in the north, or by a longer one in the south that a side street divides.
fn two_ways() -> AsciiMap {
    let arc = |names: &str, across_m: f64| -> Vec<(char, [f64; 2])> {
        let angle = |i: u32| std::f64::consts::PI * f64::from(i + 1) / 12.0;
        names.chars().zip(0..).map(|(c, i)| (c, [-100.0 * angle(i).cos(), across_m * angle(i).sin()])).collect()
    };
    let mut nodes = [arc("abcdefghijk", 100.0), arc("lmnopqrstuv", -115.0)].concat();
    nodes.extend([('W', [-300.0, 0.0]), ('A', [-100.0, 0.0]), ('B', [100.0, 0.0]), ('E', [300.0, 0.0])]);
    nodes.push(('X', [0.0, -250.0]));
    let tags = "highway=secondary width=12";
    let map = AsciiMap::placed(&nodes).way("WA", tags).way("BE", tags).way("qX", tags);
    map.way("AabcdefghijkB", tags).way("AlmnopqrstuvB", tags)
}

#[test]
fn an_alternative_differs_and_costs_what_it_costs() {
    let region = region(&two_ways(), 12.0);
    let mut driver = region.driver("AGV-TUG4");
    let answer = ask(&region, &driver, ["WA", "BE"], 2);
    let [first, second] = answer.routes.as_slice() else { panic!("{} routes", answer.routes.len()) };
    let north = edge(&region, "AB");
    assert!(first.drive.edges.contains(&north) && !second.drive.edges.contains(&north));
    assert!(answer.routes.iter().all(|route| route.certificate.result.safe()));
    driver.permits.edges[north.index()] = Permit::UNKNOWN;
    let [only] = ask(&region, &driver, ["WA", "BE"], 0).routes.try_into().unwrap();
    assert_eq!((only.cost, &only.drive), (second.cost, &second.drive), "no dearer than if it were the first");
    assert!(second.cost > first.cost && second.cost < 2 * first.cost);
    assert_eq!(ask(&region, &driver, ["WA", "BE"], 2).routes.len(), 1, "there is no other");
}

#[test]
fn what_blocks_is_few_places_or_few_metres_whichever_is_less() {
    let region = region(&two_ways(), 12.0);
    let mut driver = region.driver("AGV-TUG4");
    let north = edge(&region, "AB");
    let south = [edge(&region, "Aq"), edge(&region, "qB")];
    let mut obstacles = |north_m: Option<f64>, south_m: f64| {
        let narrow = |rsc_m| Permit { verdict: Verdict::Unsafe(UnsafeReason::Width), rsc_m };
        driver.permits.edges[north.index()] = narrow(north_m.map(|m| -m));
        south.iter().for_each(|&edge| driver.permits.edges[edge.index()] = narrow(Some(-south_m)));
        let answer = ask(&region, &driver, ["WA", "BE"], 0);
        assert!(answer.routes.is_empty() && answer.refuted.is_empty());
        let obstacles = answer.obstacles.unwrap();
        obstacles.into_iter().map(|o| (o.at, o.missing_m, o.refuted)).collect::<Vec<_>>()
    };
    let both: Vec<_> = south.iter().map(|&edge| (PartKind::Edge(edge), Some(0.1), false)).collect();
    assert_eq!(obstacles(Some(3.0), 0.1), both, "2 places and 0.2 m against 1 and 3 m");
    assert_eq!(obstacles(Some(1.0), 0.1), [(PartKind::Edge(north), Some(1.0), false)], "1 place and 1 m");
    assert_eq!(obstacles(None, 0.1), both, "nobody knows how much");
    assert_eq!(obstacles(None, 3.0), [(PartKind::Edge(north), None, false)]);
}

/// Whether the turn is safe by itself.
fn passes(region: &TestRegion, driver: &TestDriver, from: &str, to: &str) -> bool {
    let place = region.movements.index(edge(region, from), edge(region, to)).unwrap();
    driver.permits.movements[place].verdict == Verdict::Safe
}

/// Wide enough for each turn, but too narrow for both in succession. The width is found by widening the roads step by
/// step.
#[test]
fn a_route_whose_parts_passed_is_refuted_as_a_whole_and_the_search_goes_on() {
    let made = |between_m: f64, eighths: u32| {
        let region = region(&s_bend(0.125 * f64::from(eighths), between_m, false), 12.0);
        let driver = region.driver("EU-SEMI16.5");
        let parts = passes(&region, &driver, "AJ", "JK") && passes(&region, &driver, "JK", "KD");
        (region, driver, parts)
    };
    let widths: Vec<u32> = (26..80).collect();
    // The same with a way round.
    let opened = |width_m: f64, between_m: f64| {
        let open = region(&s_bend(width_m, between_m, true), 12.0);
        let driver = open.driver("EU-SEMI16.5");
        let answer = ask(&open, &driver, ["AW", "ED"], 0);
        (open, driver, answer)
    };
    // From the least width at which both parts pass (all wider ones are taken to pass) to the first at which the whole
    // passes too.
    let tight = |between_m: f64| {
        let least = widths.partition_point(|&eighths| !made(between_m, eighths).2);
        for &eighths in &widths[least..] {
            let (region, driver, parts) = made(between_m, eighths);
            if !parts {
                continue;
            }
            let answer = ask(&region, &driver, ["AJ", "KD"], 0);
            println!("{between_m} m apart, {eighths}/8 m wide: {}, {:?}", answer.routes.len(), answer.refuted);
            if !answer.routes.is_empty() {
                return None;
            }
            let width_m = 0.125 * f64::from(eighths);
            // With a way round the approach has one more node, so the whole may pass by a hair.
            if answer.refuted.iter().any(|r| r.result.is_some()) && !opened(width_m, between_m).2.refuted.is_empty() {
                return Some((between_m, width_m, region, answer));
            }
        }
        None
    };
    let (between_m, width_m, blocked, answer) = (0..8).find_map(|i| tight(34.0 - 3.0 * f64::from(i))).unwrap();
    // The route is too narrow, or a hinge or the lock exceeds its limit; in the latter case no metres are missing.
    let missing = answer.refuted.iter().filter_map(|r| Some(-r.result?.0)).filter(|m| *m > 0.0);
    let least_m = missing.min_by(f64::total_cmp);
    let [obstacle] = answer.obstacles.as_deref().unwrap() else { panic!("{:?}", answer.obstacles) };
    assert_eq!(answer.refuted.iter().filter(|refutation| refutation.left_out).count(), 1);
    assert!(obstacle.refuted && obstacle.permit.verdict == Verdict::Safe);
    let turns = [turn(&blocked, "AJ", "JK"), turn(&blocked, "JK", "KD")];
    assert!(turns.contains(&obstacle.at), "{obstacle:?}");
    assert_eq!(obstacle.missing_m, least_m);
    assert!(place(&blocked.network, obstacle.at).is_some());

    let (open, driver, answer) = opened(width_m, between_m);
    assert!(passes(&open, &driver, "WJ", "JK") && passes(&open, &driver, "JK", "KE"));
    let [route] = answer.routes.as_slice() else { panic!("{answer:?}") };
    assert!(!answer.refuted.is_empty() && !answer.gave_up && answer.obstacles.is_none());
    assert!(route.drive.edges.contains(&edge(&open, "WE")) && !route.drive.edges.contains(&edge(&open, "JK")));
    assert!(route.certificate.result.safe());
}

/// In its own lane, over a corner for which it uses the other lanes of its direction, too.
#[test]
fn a_route_in_the_lane_has_the_turns_strip_around_a_turn() {
    let nodes =
        [('A', [-450.0, 0.0]), ('J', [0.0, 0.0]), ('E', [450.0, 0.0]), ('S', [0.0, -450.0]), ('N', [0.0, 450.0])];
    let tags = "highway=primary lanes=6 width=21";
    let map = AsciiMap::placed(&nodes).way("AJE", tags).way("SJN", tags);
    let mut region = TestRegion::of(map.extract(), Policy::Lane);
    region.kerbs = Kerbs::everywhere(12.0);
    let driver = region.driver("EU-SEMI16.5");
    let answer = ask(&region, &driver, ["AJ", "JS"], 0);
    let [route] = answer.routes.as_slice() else { panic!("{answer:?}") };
    assert_smooth(route);
    let c = &route.path.corridor;
    let width = |k: usize| c.left_m[k] + c.right_m[k];
    let turn = route.path.parts.iter().find(|part| matches!(part.kind, PartKind::Turn { .. })).unwrap();
    // Five centimetres a metre on each side over the 20 m that count before the path, and all of the strip round the corner.
    assert!(
        (0.9..2.1).contains(&(width(turn.stations.start) - width(0))),
        "{} {}",
        width(turn.stations.start),
        width(0)
    );
    assert!(turn.stations.clone().any(|k| width(k) > 2.0 * width(0)));
    // Nowhere does the width jump.
    assert!((1..c.len()).all(|k| (width(k) - width(k - 1)).abs() < 1.0 * c.spacing_m));
    whole::hold(&driver.model.vehicle, c, &route.certificate, 3);
}
