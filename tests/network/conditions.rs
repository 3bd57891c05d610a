//! Routes under conditions over drawn junctions.

use netcert_testing::ascii_map;
use netcert_testing::extracts::extract;
use netcert_testing::routing;

use ascii_map::AsciiMap;
use netcert::evidence::Quantity;
use netcert::network::EdgeNo;
use netcert::osm::facts::Policy;
use netcert::route::{self, *};
use netcert::rows::{Attestation, AttestedBy};
use netcert::stop::Stop;
use netcert::turns::Kerbs;
use routing::TestRegion;

const TAGS: &str = "highway=tertiary width=7";

fn region(map: &AsciiMap, kerb_m: f64) -> TestRegion {
    let mut region = TestRegion::of(map.extract(), Policy::Carriageway);
    region.kerbs = Kerbs::everywhere(kerb_m);
    region
}

/// The middle of the first piece of an edge.
fn on(region: &TestRegion, ends: &str) -> Position {
    let edge = ascii_map::edge(&region.network, ends).index();
    let line: Vec<_> = region.network.positions(&region.network.edges[edge]).collect();
    let (a, b) = (line[0].degrees(), line[1].degrees());
    Position { lon: f64::midpoint(a.0, b.0), lat: f64::midpoint(a.1, b.1) }
}

struct Asked {
    answer: Answer,
    under: Result<Conditional, Hopeless>,
}

fn ask(region: &TestRegion, vehicle: &str, [from, to]: [&str; 2]) -> Asked {
    let driver = region.driver(vehicle);
    let mut planner = region.planner(&driver, Measure::Distance);
    let places = vec![on(region, from), on(region, to)];
    let question = Question { places, snap_m: 5.0, alternatives: 0, tries: 20 };
    // A place may be on no safe road.
    let answer = planner.answer(&question, &Stop::never()).unwrap_or_default();
    let under = planner.under_conditions(&question, &answer.refuted, &Stop::never()).unwrap();
    let again = planner.under_conditions(&question, &answer.refuted, &Stop::never()).unwrap();
    match (&under, &again) {
        (Ok(first), Ok(second)) => assert_eq!(
            (&first.conditions, &first.route.path),
            (&second.conditions, &second.route.path),
            "what was found before does not change an answer"
        ),
        (first, second) => assert_eq!(first.is_ok(), second.is_ok()),
    }
    Asked { answer, under }
}

/// A crossing of two roads at a right angle.
fn crossing() -> AsciiMap {
    AsciiMap::placed(&[
        ('W', [-300.0, 0.0]),
        ('a', [0.0, 0.0]),
        ('E', [300.0, 0.0]),
        ('N', [0.0, 300.0]),
        ('S', [0.0, -300.0]),
    ])
    .way("WaE", TAGS)
    .way("NaS", TAGS)
}

/// Two staggered arms: the way over them turns right and, `apart_m` later, left.
fn staggered(apart_m: f64) -> AsciiMap {
    let nodes = [
        ('W', [-300.0, 0.0]),
        ('N', [0.0, 300.0]),
        ('a', [0.0, 0.0]),
        ('b', [0.0, -apart_m]),
        ('S', [0.0, -300.0]),
        ('E', [300.0, -apart_m]),
    ];
    AsciiMap::placed(&nodes).way("Wa", TAGS).way("NabS", TAGS).way("bE", TAGS)
}

#[test]
fn a_corner_too_sharp_is_a_condition_and_a_round_one_is_none() {
    let asked = ask(&region(&crossing(), 3.0), "AU-SEMI19", ["Wa", "aS"]);
    assert!(asked.answer.routes.is_empty());
    let found = asked.under.unwrap();
    assert!(found.route.certificate.result.safe());
    assert!(!found.conditions.is_empty());
    assert!(found.conditions.iter().all(|condition| condition.assumed_m.is_none_or(|m| m < condition.needed_m)));

    let asked = ask(&region(&crossing(), 25.0), "AU-SEMI19", ["Wa", "aS"]);
    assert_eq!(asked.answer.routes.len(), 1);
    assert_eq!(asked.under.unwrap().conditions, [], "a way that passes as it is has no condition");
}

#[test]
fn two_turns_on_too_short_a_road_pass_under_conditions() {
    for apart_m in [14.0, 24.0, 36.0] {
        let region = region(&staggered(apart_m), 3.0);
        let asked = ask(&region, "AU-SEMI19", ["Wa", "bE"]);
        assert!(asked.answer.routes.is_empty());
        let found = asked.under.unwrap_or_else(|hopeless| panic!("{apart_m} m apart: {hopeless:?}"));
        let driven = ["Wa", "ab", "bE"].map(|ends| ascii_map::edge(&region.network, ends));
        assert_eq!(found.route.drive.edges, driven);
        assert!(found.route.certificate.result.safe());
        let places = [Quantity::KerbRadius, Quantity::Surface, Quantity::CarriagewayWidth];
        assert!(found.conditions.iter().all(|condition| places.contains(&condition.quantity)));
    }
}

/// On the first ways of these pairs some places are open to nothing; on others, with other roads before and behind them, they are.
#[test]
fn a_place_that_nothing_opens_on_one_way_may_be_open_on_another() {
    let Some(sydney) = extract("sydney_au.osm.pbf") else { return };
    let region = TestRegion::read(&sydney, Policy::Carriageway);
    let driver = region.driver("AU-SEMI19");
    let mut planner = region.planner(&driver, Measure::Time);
    for [from, to] in [
        [[151.213_306_4, -33.849_571_9], [151.211_924_2, -33.863_356_9]],
        [[151.212_766_6, -33.865_693_7], [151.210_053_5, -33.869_134_4]],
    ] {
        let places = [from, to].map(|[lon, lat]| Position { lon, lat }).to_vec();
        let question = Question { places, snap_m: 100.0, alternatives: 0, tries: 30 };
        let answer = planner.best_answer(&question, Conditions::Anywhere, &Stop::never(), || ()).unwrap();
        let found = answer.conditional.unwrap_or_else(|| panic!("{:?}", answer.nothing_helps));
        assert!(found.route.certificate.result.safe() && !found.conditions.is_empty());
        assert_eq!(answer.nothing_helps, []);
    }
}

#[test]
fn a_place_that_nothing_opens_is_named() {
    // A bend of 172°: no radius, width or paving that is tried leaves room to turn back.
    let nodes = [('W', [-300.0, 0.0]), ('a', [0.0, 0.0]), ('S', [-300.0, -40.0])];
    let region = region(&AsciiMap::placed(&nodes).way("Wa", TAGS).way("aS", TAGS), 3.0);
    let driver = region.driver("AU-ATRIPLE53");
    let places = vec![on(&region, "Wa"), on(&region, "aS")];
    let question = Question { places, snap_m: 5.0, alternatives: 0, tries: 20 };
    let mut planner = region.planner(&driver, Measure::Distance);
    let answer = planner.best_answer(&question, Conditions::Anywhere, &Stop::never(), || ()).unwrap();
    let edges = ["Wa", "aS"].map(|ends| ascii_map::edge(&region.network, ends));
    assert!(answer.routes.is_empty() && answer.conditional.is_none());
    assert_eq!(answer.nothing_helps, [PartKind::Turn { from: edges[0], to: edges[1] }]);
    let json = route::json(&region.network, &planner.driver().model, &answer);
    assert_eq!(json["nothing_helps"][0]["kind"], "turn");
    assert!(json["nothing_helps"][0]["place"].is_array(), "{json}");
}

/// Two crossings of one road, far apart, with a corner to turn at each.
fn two_crossings() -> AsciiMap {
    let nodes = [
        ('W', [-300.0, 0.0]),
        ('a', [0.0, 0.0]),
        ('b', [0.0, -500.0]),
        ('E', [300.0, -500.0]),
        ('N', [0.0, 300.0]),
        ('S', [0.0, -800.0]),
    ];
    AsciiMap::placed(&nodes).way("Wa", TAGS).way("NabS", TAGS).way("bE", TAGS)
}

#[test]
fn a_way_needs_what_its_sections_need() {
    let region = region(&two_crossings(), 3.0);
    let conditions = |ends: [&str; 2]| {
        let found = ask(&region, "AU-SEMI19", ends).under.unwrap();
        assert!(found.route.certificate.result.safe());
        found.conditions
    };
    let [first, second, whole] = [["Wa", "ab"], ["ab", "bE"], ["Wa", "bE"]].map(conditions);
    assert!(!first.is_empty() && !second.is_empty(), "{first:?} {second:?}");
    assert!(whole.len() <= first.len() + second.len(), "{whole:?}");
    let places = |conditions: &[Condition]| -> Vec<ConditionAt> {
        conditions
            .iter()
            .map(|condition| condition.at.clone())
            .filter(|at| !matches!(at, ConditionAt::Road(_)))
            .collect()
    };
    let parts = [places(&first), places(&second)].concat();
    assert!(places(&whole).iter().all(|at| parts.contains(at)), "{whole:?}: {first:?}, {second:?}");
}

/// Sections are fitted on several threads.
#[test]
fn the_number_of_threads_changes_no_condition() {
    let region = region(&two_crossings(), 3.0);
    let on_threads = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| ask(&region, "AU-SEMI19", ["Wa", "bE"]).under.unwrap())
    };
    let [one, three] = [1, 3].map(on_threads);
    assert!(!one.conditions.is_empty());
    assert_eq!((one.conditions, one.suffices, one.route.path), (three.conditions, three.suffices, three.route.path));
    assert_eq!(one.route.certificate, three.route.certificate);
}

#[test]
fn the_widths_along_one_road_are_one_condition() {
    // Three pieces of one road, narrower and narrower.
    let nodes =
        [('W', [-300.0, 0.0]), ('a', [-150.0, 0.0]), ('b', [0.0, 0.0]), ('c', [150.0, 0.0]), ('E', [300.0, 0.0])];
    let narrow = |width_m: f64| format!("highway=tertiary name=High_Street width={width_m}");
    let map = AsciiMap::placed(&nodes)
        .way("Wa", &narrow(7.0))
        .way("ab", &narrow(2.4))
        .way("bc", &narrow(2.3))
        .way("cE", &narrow(7.0));
    let region = region(&map, 3.0);
    let found = ask(&region, "AU-SEMI19", ["Wa", "cE"]).under.unwrap();
    let [condition] = found.conditions.as_slice() else { panic!("{:?}", found.conditions) };
    assert_eq!(condition.quantity, Quantity::CarriagewayWidth);
    let ConditionAt::Road(edges) = &condition.at else { panic!("{condition:?}") };
    assert!(["ab", "bc"].iter().all(|ends| edges.contains(&ascii_map::edge(&region.network, ends))), "{condition:?}");
    assert_eq!(condition.assumed_m.map(|m| (10.0 * m).round()), Some(23.0), "the least of them");
}

#[test]
fn a_road_that_is_narrow_twice_is_one_condition() {
    let nodes = [
        ('W', [-260.0, 0.0]),
        ('a', [-180.0, 0.0]),
        ('b', [-100.0, 0.0]),
        ('c', [100.0, 0.0]),
        ('d', [180.0, 0.0]),
        ('E', [260.0, 0.0]),
    ];
    let map = AsciiMap::placed(&nodes)
        .way("Wa", "highway=tertiary width=7")
        .way("ab", "highway=tertiary ref=7 name=High_Street width=2.4")
        .way("bc", "highway=tertiary ref=7 width=7")
        .way("cd", "highway=tertiary ref=7 name=Low_Street width=2.3")
        .way("dE", "highway=tertiary width=7");
    let region = region(&map, 3.0);
    let found = ask(&region, "AU-SEMI19", ["Wa", "dE"]).under.unwrap();
    let [condition] = found.conditions.as_slice() else { panic!("{:?}", found.conditions) };
    let ConditionAt::Road(edges) = &condition.at else { panic!("{condition:?}") };
    let over = |ends: &str| edges.contains(&ascii_map::edge(&region.network, ends));
    assert_eq!(["ab", "bc", "cd"].map(over), [true, false, true], "the wide piece between needs nothing");
}

#[test]
fn a_corner_where_no_other_road_meets_is_a_condition() {
    let nodes = [('W', [-300.0, 0.0]), ('a', [0.0, 0.0]), ('S', [0.0, -300.0])];
    let region = region(&AsciiMap::placed(&nodes).way("WaS", TAGS), 3.0);
    let found = ask(&region, "AU-SEMI19", ["Wa", "aS"]).under.unwrap_or_else(|hopeless| panic!("{hopeless:?}"));
    assert!(found.route.certificate.result.safe());
    let corner = found.conditions.iter().find(|condition| condition.quantity == Quantity::KerbRadius);
    assert!(corner.is_some_and(|corner| corner.assumed_m == Some(3.0)), "{:?}", found.conditions);
}

/// Two ways as long as each other around a block, each with two corners.
fn block() -> AsciiMap {
    AsciiMap::placed(&[
        ('W', [-300.0, 0.0]),
        ('a', [0.0, 0.0]),
        ('N', [0.0, 200.0]),
        ('n', [400.0, 200.0]),
        ('S', [0.0, -200.0]),
        ('s', [400.0, -200.0]),
        ('b', [400.0, 0.0]),
        ('E', [700.0, 0.0]),
    ])
    .way("Wa", TAGS)
    .way("NaS", TAGS)
    .way("Nn", TAGS)
    .way("Ss", TAGS)
    .way("nbs", TAGS)
    .way("bE", TAGS)
}

#[test]
fn a_way_under_conditions_prefers_what_is_attested_and_says_who_does() {
    let region = region(&block(), 3.0);
    let numbers =
        |ends: &[&str]| -> Vec<EdgeNo> { ends.iter().map(|ends| ascii_map::edge(&region.network, ends)).collect() };
    let (over_north, over_south) = (["Wa", "aN", "Nn", "nb", "bE"], ["Wa", "aS", "Ss", "sb", "bE"]);
    for way in [over_north, over_south] {
        let edges = numbers(&way);
        let turns = edges.windows(2).map(|pair| [pair[0].get(), pair[1].get()]).collect();
        let all =
            [Attestation { by: AttestedBy::Register, edges: edges.iter().map(|edge| edge.get()).collect(), turns }];
        let mut driver = region.driver("AU-SEMI19");
        driver.attested = Attested::new(&all);
        let mut planner = region.planner(&driver, Measure::Distance);
        let places = vec![on(&region, "Wa"), on(&region, "bE")];
        let question = Question { places, snap_m: 5.0, alternatives: 0, tries: 20 };
        let found = planner.under_conditions(&question, &[], &Stop::never()).unwrap().unwrap();
        assert_eq!(found.route.drive.edges, edges, "{way:?}");
        assert!(!found.conditions.is_empty());
        for condition in &found.conditions {
            assert_eq!(condition.attested_by, Some(AttestedBy::Register), "{:?}", condition.at);
        }
    }
}

#[test]
fn only_attested_places_may_lack_room_where_a_route_asks_for_that() {
    let region = region(&block(), 3.0);
    let numbers =
        |ends: &[&str]| -> Vec<EdgeNo> { ends.iter().map(|ends| ascii_map::edge(&region.network, ends)).collect() };
    let north = numbers(&["Wa", "aN", "Nn", "nb", "bE"]);
    let places = vec![on(&region, "Wa"), on(&region, "bE")];
    let question = Question { places, snap_m: 5.0, alternatives: 0, tries: 20 };
    // The turns that are attested, of the four on the way over the north.
    let answer = |turns: &[[EdgeNo; 2]]| {
        let edges = north.iter().map(|edge| edge.get()).collect();
        let turns = turns.iter().map(|ends| ends.map(EdgeNo::get)).collect();
        let mut driver = region.driver("AU-SEMI19");
        driver.attested = Attested::new(&[Attestation { by: AttestedBy::Register, edges, turns }]);
        let mut planner = region.planner(&driver, Measure::Distance);
        planner.best_answer(&question, Conditions::WhereAttested, &Stop::never(), || ()).unwrap()
    };
    let turns: Vec<[EdgeNo; 2]> = north.windows(2).map(|pair| [pair[0], pair[1]]).collect();
    let attested = answer(&turns).conditional.unwrap();
    assert_eq!(attested.route.drive.edges, north);
    assert!(!attested.conditions.is_empty() && attested.attested());
    // Both ways round have conditions at their first corner. Nobody attests it on either.
    let unattested = answer(&turns[1..]);
    assert!(unattested.conditional.is_none(), "{:?}", unattested.conditional);
    assert!(unattested.routes.is_empty() && !unattested.obstacles.unwrap().is_empty());
    let anywhere = region.planner(&region.driver("AU-SEMI19"), Measure::Distance).best_answer(
        &question,
        Conditions::Anywhere,
        &Stop::never(),
        || (),
    );
    assert!(!anywhere.unwrap().conditional.unwrap().attested());
}
