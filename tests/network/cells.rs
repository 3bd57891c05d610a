//! However the world is cut into files, what a cell owns is the same: edges, strokes, turns and certificates, byte for byte.
//!
//! Drawn roads are at 80° north, where cells are small (3.4 km). Each file holds some cells, their neighbours and 1 km more, with complete
//! ways.

use std::collections::{BTreeMap, BTreeSet};

use netcert::certify::{Job, TurnJob, certify_network, certify_turns};
use netcert::network::{EdgeNo, GridCell, Network, build};
use netcert::osm::facts::{Countries, Policy, cross_sections};
use netcert::osm::pbf::read_extract;
use netcert::osm::{Extract, LonLat, NodeId, NodeTable, Way};
use netcert::reporter::Silent;
use netcert::rows::{EdgeCertificate, TurnCertificate};
use netcert::settings::{Needs, Settings};
use netcert::stet::Model;
use netcert::turns::{TurnFacts, turn_facts};
use netcert::verdict::{UnknownReason, Verdict};

use netcert_testing::ascii_map::{offset, way_facts};
use netcert_testing::catalogue::catalogued;
use netcert_testing::extracts;
use netcert_testing::thorough::{cases, thorough};

/// The halo beyond a file's cells and their neighbours, metres.
const HALO_M: f64 = 1000.0;

/// Where drawn roads begin: the south-western corner of a cell.
pub(crate) const ORIGIN: LonLat = LonLat { lon_e7: 10_546_875, lat_e7: 800_094_900 };
/// Roads cross about this far apart, metres; and how many there are each way.
const MESH_M: f64 = 3400.0;
const ROADS: usize = 6;
/// Nodes of a road from one crossing to the next.
const STEPS: usize = 14;

/// The generator of Park and Miller (1988): the same numbers everywhere.
struct Drawn(u64);

impl Drawn {
    fn below(&mut self, end: usize) -> usize {
        self.0 = self.0 * 48_271 % 0x7fff_ffff;
        (self.0 / 8) as usize % end
    }

    fn metres(&mut self, most: usize) -> f64 {
        self.below(2 * most + 1) as f64 - most as f64
    }
}

/// A mesh of winding roads with short cuts, a roundabout and roads that end.
pub(crate) fn drawn(seed: u64) -> Extract {
    let mut rng = Drawn(seed);
    let mut nodes: BTreeMap<i64, LonLat> = BTreeMap::new();
    let crossing = |i: usize, j: usize| (1000 * (i + 1) + j) as i64;
    for (i, j) in (0..ROADS).flat_map(|i| (0..ROADS).map(move |j| (i, j))) {
        let by = [rng.metres(400), rng.metres(400)];
        nodes.insert(crossing(i, j), offset(ORIGIN, MESH_M * i as f64 + by[0], MESH_M * j as f64 + by[1]));
    }
    let mut ways: Vec<(Vec<i64>, &str)> = Vec::new();
    let tags = [
        "highway=primary width=9 lanes=2",
        "highway=secondary lanes=2",
        "highway=residential width=6",
        "highway=tertiary name=Main",
        "highway=primary width=8 lanes=2 oneway=yes",
    ];
    let mut next = 1_000_000;
    for (along_x, road) in [true, false].into_iter().flat_map(|x| (0..ROADS).map(move |road| (x, road))) {
        let mut refs: Vec<i64> = Vec::new();
        let mut tag = tags[rng.below(tags.len())];
        for step in 0..ROADS {
            let at = if along_x { crossing(step, road) } else { crossing(road, step) };
            if let Some(&last) = refs.last() {
                let [from, to] = [nodes[&last], nodes[&at]];
                let wave = rng.metres(60);
                for k in 1..STEPS {
                    let share = k as f64 / STEPS as f64;
                    let between = |a: i32, b: i32| a + (share * f64::from(b - a)).round() as i32;
                    let straight =
                        LonLat { lon_e7: between(from.lon_e7, to.lon_e7), lat_e7: between(from.lat_e7, to.lat_e7) };
                    let aside = wave * (share * std::f64::consts::TAU).sin();
                    next += 1;
                    nodes.insert(
                        next,
                        if along_x { offset(straight, 0.0, aside) } else { offset(straight, aside, 0.0) },
                    );
                    refs.push(next);
                }
            }
            refs.push(at);
            // A way ends, another one begins, or there is a gap.
            if refs.len() > 1 && rng.below(10) < 3 {
                ways.push((std::mem::take(&mut refs), tag));
                tag = tags[rng.below(tags.len())];
                if rng.below(10) < 8 {
                    refs.push(at);
                }
            }
        }
        if refs.len() > 1 {
            ways.push((refs, tag));
        }
    }
    // A roundabout around a crossing's neighbour, on its road.
    for _ in 0..6 {
        let (i, j) = (1 + rng.below(ROADS - 2), 1 + rng.below(ROADS - 2));
        let centre = nodes[&crossing(i, j)];
        let ring: Vec<i64> = (0..12)
            .map(|k| {
                let angle = std::f64::consts::TAU * f64::from(k) / 12.0;
                next += 1;
                nodes.insert(next, offset(centre, 700.0 + 20.0 * angle.cos(), 20.0 * angle.sin()));
                next
            })
            .collect();
        let arms = [(ring[6], crossing(i, j)), (ring[0], crossing(i + 1, j)), (ring[3], crossing(i, j + 1))];
        ways.extend(arms.map(|(a, b)| (vec![a, b], "highway=tertiary width=7.5")));
        ways.push(([&ring[..], &ring[..1]].concat(), "highway=tertiary junction=roundabout width=9"));
    }
    extract_of(&nodes, ways)
}

/// The extract of ways, given as their nodes and tags.
fn extract_of(nodes: &BTreeMap<i64, LonLat>, ways: Vec<(Vec<i64>, &str)>) -> Extract {
    let mut extract = Extract::default();
    for (id, (refs, tags)) in (1..).zip(ways) {
        let start = extract.refs.len() as u32;
        extract.refs.extend(refs.into_iter().map(NodeId::new));
        let facts = way_facts(tags, &mut extract.strings);
        extract.ways.push(Way { id, refs: start..extract.refs.len() as u32, facts });
    }
    extract.nodes = NodeTable {
        ids: nodes.keys().copied().map(NodeId::new).collect(),
        places: nodes.values().copied().map(Some).collect(),
    };
    extract
}

/// The ways of an extract that have a node for which `here` is true.
fn complete_ways(extract: &Extract, here: impl Fn(LonLat) -> bool) -> Extract {
    let refs = |way: &Way| extract.refs[way.refs.start as usize..way.refs.end as usize].iter();
    let touches = |way: &&Way| refs(way).filter_map(|&id| extract.nodes.place(id)).any(&here);
    Extract { ways: extract.ways.iter().filter(touches).cloned().collect(), ..extract.clone() }
}

/// The cells of an extract's nodes on ways.
fn cells_of(extract: &Extract) -> BTreeSet<GridCell> {
    extract.refs.iter().filter_map(|&id| extract.nodes.place(id)).map(GridCell::of).collect()
}

/// Whether a place is in one of these cells, beside one, or within the halo around those.
fn near(own: &BTreeSet<GridCell>, place: LonLat) -> bool {
    let cell = |east: f64, north: f64| GridCell::of(offset(place, east * HALO_M, north * HALO_M));
    let around = [-1.0, 0.0, 1.0].into_iter().flat_map(|x| [-1.0, 0.0, 1.0].map(|y| cell(x, y)));
    around.into_iter().any(|at| own.iter().any(|own| own.x.abs_diff(at.x) <= 1 && own.y.abs_diff(at.y) <= 1))
}

fn network(extract: Extract) -> Network {
    let countries = Countries::load().unwrap();
    let rules = countries.rules();
    build(extract, &|position| countries.jurisdiction(position), &|way, place, ring| {
        cross_sections(way, place, ring, rules)
    })
    .0
}

/// All that is said of what some cells own, by the ids of edges and turns. Names, not indices, so that files compare.
#[derive(Debug, Default, PartialEq)]
struct Owned {
    /// Edges: where they lead, the strip, the chain that drives over them.
    edges: BTreeMap<i64, String>,
    turns: BTreeMap<i64, String>,
    certificates: BTreeMap<i64, String>,
    turn_certificates: BTreeMap<i64, String>,
}

fn owned(network: &Network, own: &BTreeSet<GridCell>, vehicle: Option<&Model>) -> Owned {
    let mut owned = Owned::default();
    let id = |edge: EdgeNo| network.edges[edge.index()].id;
    let mut stroke_of = BTreeMap::new();
    for stroke in &network.strokes {
        let ids = |range: &std::ops::Range<u32>| -> Vec<i64> {
            network.stroke_edges[range.start as usize..range.end as usize].iter().map(|&edge| id(edge)).collect()
        };
        // Of an approach only the end is driven, and the halo may lack its beginning.
        let last = ids(&stroke.approach).last().copied();
        ids(&stroke.edges).iter().for_each(|&edge| {
            stroke_of.insert(edge, format!("{last:?} {:?} {}", ids(&stroke.edges), stroke.closed));
        });
    }
    let here = |edge: EdgeNo| own.contains(&network.cell(&network.edges[edge.index()]));
    for (edge, e) in network.numbered_edges().filter(|(edge, _)| here(*edge)) {
        let line: Vec<LonLat> = network.positions(e).collect();
        let text = format!(
            "{} {} {:?} {:?} {:?} {} {}",
            e.from_node,
            e.to_node,
            line,
            network.section(e),
            network.legal(e),
            e.barred,
            stroke_of[&id(edge)]
        );
        owned.edges.insert(id(edge), text);
    }
    let settings = Settings { policy: Policy::Carriageway, needs: Needs::Off, ..Settings::default() };
    let turns = turn_facts(network, &settings.kerbs);
    let of_turn = |turn: &TurnFacts| here(turn.movement.from) || here(turn.movement.to);
    for turn in turns.iter().filter(|turn| of_turn(turn)) {
        let TurnFacts { movement, through, angle_deg, kerb_radius_m, kerb_source, line, .. } = turn;
        let through: Vec<i64> = through.iter().map(|&edge| id(edge)).collect();
        let text = format!(
            "{} {} {:?} {} {through:?} {angle_deg} {kerb_radius_m:?} {kerb_source:?} {line:?}",
            id(movement.from),
            id(movement.to),
            movement.kind,
            movement.forbidden.is_some()
        );
        owned.turns.insert(turn.id, text);
    }
    let Some(model) = vehicle else { return owned };
    let models = std::slice::from_ref(model);
    let mut verdicts = vec![vec![Verdict::Unknown(UnknownReason::Geometry); network.edges.len()]];
    let job = Job { network, models, settings: &settings };
    let outcome = certify_network(&job, &Silent, |_, made: &EdgeCertificate| {
        verdicts[0][made.edge.index()] = made.conclusion.verdict;
        if here(made.edge) {
            owned.certificates.insert(id(made.edge), format!("{:?}", made.conclusion));
        }
        Ok::<(), ()>(())
    })
    .unwrap();
    for (edge, measure) in EdgeNo::all().zip(&outcome.measures).filter(|(edge, _)| here(*edge)) {
        owned.certificates.get_mut(&id(edge)).unwrap().push_str(&format!("{measure:?}"));
    }
    let job = TurnJob { network, turns: &turns, models, edges: &verdicts, settings: &settings };
    certify_turns(&job, &Silent, |_, made: &TurnCertificate| {
        let turn = &turns[made.turn.index()];
        if of_turn(turn) {
            let plan = made.plan.as_ref().map(|plan| format!("{plan:?}").split_once("packed").unwrap().1.to_owned());
            owned.turn_certificates.insert(turn.id, format!("{:?} {:?} {plan:?}", made.conclusion, made.path));
        }
        Ok::<(), ()>(())
    })
    .unwrap();
    owned
}

/// The cells of an extract in `parts` × `parts` groups of columns and rows.
fn divided(all: &BTreeSet<GridCell>, parts: u32) -> Vec<BTreeSet<GridCell>> {
    let range = |of: fn(&GridCell) -> u32| (all.iter().map(of).min().unwrap(), all.iter().map(of).max().unwrap() + 1);
    let (columns, rows) = (range(|c| c.x), range(|c| c.y));
    let part = |at: u32, (from, to): (u32, u32)| (at - from) * parts / (to - from);
    let mut groups: BTreeMap<(u32, u32), BTreeSet<GridCell>> = BTreeMap::new();
    for &cell in all {
        groups.entry((part(cell.y, rows), part(cell.x, columns))).or_default().insert(cell);
    }
    groups.into_values().collect()
}

fn same(whole: &Owned, part: &Owned, what: &str) -> usize {
    let compare = |a: &BTreeMap<i64, String>, b: &BTreeMap<i64, String>| {
        assert!(
            a.keys().eq(b.keys()),
            "{what}: {:?} | {:?}",
            a.keys().collect::<Vec<_>>(),
            b.keys().collect::<Vec<_>>()
        );
        for (id, text) in a {
            assert_eq!(text, &b[id], "{what}: {id}");
        }
        a.len()
    };
    compare(&whole.turns, &part.turns);
    compare(&whole.certificates, &part.certificates);
    compare(&whole.turn_certificates, &part.turn_certificates);
    compare(&whole.edges, &part.edges)
}

#[test]
fn drawn_roads_have_the_same_certificates_however_they_are_cut_into_files() {
    let model = Model::new(&catalogued("EU-SEMI16.5")).unwrap();
    let extract = drawn(1);
    let whole = network(extract.clone());
    let of_whole = owned(&whole, &cells_of(&extract), Some(&model));
    let safe = |made: &BTreeMap<i64, String>| made.values().filter(|text| text.contains("Safe")).count();
    assert!(safe(&of_whole.certificates) > 50 && safe(&of_whole.turn_certificates) > 20, "{of_whole:?}");
    let mut edges = 0;
    let groups = divided(&cells_of(&extract), 2);
    for own in &groups[..cases(2, groups.len())] {
        let part = complete_ways(&extract, |place| near(own, place));
        assert!(part.ways.len() < extract.ways.len(), "a file that holds everything proves nothing");
        let part = owned(&network(part), own, Some(&model));
        edges += same(&owned_of(&whole, &of_whole, own), &part, &format!("{own:?}"));
    }
    assert!(!thorough() || edges == whole.edges.len(), "every edge has one owner");
}

#[test]
fn drawn_roads_have_the_same_strokes_and_turns_however_they_are_cut_into_files() {
    for seed in 2..12 {
        let extract = drawn(seed);
        let whole = network(extract.clone());
        for own in divided(&cells_of(&extract), 3) {
            let part = network(complete_ways(&extract, |place| near(&own, place)));
            same(&owned(&whole, &own, None), &owned(&part, &own, None), &format!("{seed}: {own:?}"));
        }
    }
}

/// Without it, the files differ: the comparison sees what a file lacks.
#[test]
fn the_halo_is_needed() {
    let extract = drawn(2);
    let whole = network(extract.clone());
    let differs = divided(&cells_of(&extract), 3).into_iter().filter(|own| {
        let part = network(complete_ways(&extract, |place| own.contains(&GridCell::of(place))));
        owned(&whole, own, None) != owned(&part, own, None)
    });
    assert!(differs.count() > 0);
}

/// What some cells own of all that is said of a network.
fn owned_of(network: &Network, all: &Owned, own: &BTreeSet<GridCell>) -> Owned {
    let mine = owned(network, own, None);
    let of = |from: &BTreeMap<i64, String>, ids: &BTreeMap<i64, String>| {
        ids.keys().filter_map(|id| Some((*id, from.get(id)?.clone()))).collect()
    };
    Owned {
        certificates: of(&all.certificates, &mine.edges),
        turn_certificates: of(&all.turn_certificates, &mine.turns),
        ..mine
    }
}

/// Certificates depend on what is compared here alone: see the drawn roads above.
#[test]
fn a_real_region_has_the_same_edges_strokes_and_turns_however_it_is_cut_into_files() {
    let Some(path) = extracts::extract("rhein_neckar_de.osm.pbf") else { return };
    let extract = read_extract(&path, &|_| ()).unwrap();
    let whole = network(extract.clone());
    let all = cells_of(&extract);
    for &parts in cases(&[3][..], &[2, 3]) {
        let mut edges = 0;
        for own in divided(&all, parts) {
            let part = network(complete_ways(&extract, |place| near(&own, place)));
            edges += same(&owned(&whole, &own, None), &owned(&part, &own, None), &format!("{own:?}"));
        }
        assert_eq!(edges, whole.edges.len(), "every edge has one owner");
    }
}

#[test]
fn edges_near_the_border_of_their_file_are_marked() {
    let mut extract = drawn(1);
    let nano = |degrees: f64| (degrees * 1e9) as i64;
    let bbox = |near_m: f64, far_m: f64| {
        let [near, far] = [near_m, far_m].map(|metres| offset(ORIGIN, metres, metres).degrees());
        Some([nano(near.0), nano(near.1), nano(far.0), nano(far.1)])
    };
    extract.account.header.bbox_nanodegrees = bbox(-3000.0, 9000.0);
    extract = complete_ways(&extract, |p| {
        let end = offset(ORIGIN, 9000.0, 9000.0);
        p.lon_e7 < end.lon_e7 && p.lat_e7 < end.lat_e7
    });
    let mut small = extract.clone();
    let network_of = network;
    let network = network_of(extract);
    let limit = offset(ORIGIN, 9000.0 - 500.0, 9000.0 - 500.0);
    for edge in &network.edges {
        let beyond =
            network.positions(edge).any(|p| p.lon_e7 > limit.lon_e7 + 60_000 || p.lat_e7 > limit.lat_e7 + 3000);
        let within =
            network.positions(edge).all(|p| p.lon_e7 < limit.lon_e7 - 60_000 && p.lat_e7 < limit.lat_e7 - 3000);
        assert!(!beyond || edge.cut, "{edge:?}");
        assert!(!within || !edge.cut, "{edge:?}");
    }
    assert!(network.edges.iter().any(|edge| edge.cut) && network.edges.iter().any(|edge| !edge.cut));
    // A box that most roads lie outside of is not where the file ends.
    small.account.header.bbox_nanodegrees = bbox(0.0, 3000.0);
    assert!(network_of(small).edges.iter().all(|edge| !edge.cut));
}
