//! Turn restrictions drawn in ASCII: the movements that they forbid, and the sequences over ways.
//!
//! A movement is written by its nodes: `ABC` from A over B to C. `!` marks a movement that a restriction over a node
//! forbids, `-` a straight continuation, `*` a U-turn.

use crate::support::ascii_map;
use crate::support::extracts::extract;

use ascii_map::{AsciiMap, built, id_of, no_sections, node_of, somewhere};
use netcert::network::{MovementKind, Network, build};
use netcert::osm::Via;
use netcert::osm::pbf::read_extract;

const ROAD: &str = "highway=residential";
const ONE_WAY: &str = "highway=residential oneway=yes";

fn nodes(network: &Network, edges: &[u32]) -> String {
    let edge = |e: &u32| &network.edges[*e as usize];
    let first = node_of(edge(&edges[0]).from_node);
    std::iter::once(first).chain(edges.iter().map(|e| node_of(edge(e).to_node))).collect()
}

/// All movements except U-turns that nothing forbids, sorted.
fn movements(network: &Network) -> String {
    let mut all = Vec::new();
    for m in network.movements().all() {
        let mut text = nodes(network, &[m.from, m.to]);
        text.push_str(match m.kind {
            MovementKind::StraightOn => "-",
            MovementKind::Turn => "",
            MovementKind::UTurn => "*",
        });
        text.extend(m.forbidden.map(|_| '!'));
        all.extend((m.kind != MovementKind::UTurn || m.forbidden.is_some()).then_some(text));
    }
    all.sort();
    all.join(" ")
}

/// Forbidden sequences of more than two edges, in order.
fn long_sequences(network: &Network) -> String {
    let all = network.restrictions.iter().map(|r| network.sequence(r)).filter(|edges| edges.len() > 2);
    all.map(|edges| nodes(network, edges)).collect::<Vec<_>>().join(" ")
}

fn at(node: char) -> Via {
    Via::Nodes(vec![id_of(node)])
}

/// A crossing. The road from A over B to C is two ways (1 and 2), way 3 goes from D to B, and way 4 from B to E.
fn crossing() -> AsciiMap {
    AsciiMap::drawn(
        20.0,
        "
            D
            |
        A---B---C
            |
            E
        ",
    )
    .way("AB", ROAD)
    .way("BC", ROAD)
    .way("DB", ROAD)
    .way("BE", ROAD)
}

#[test]
fn without_restrictions_every_way_on_is_there() {
    let (network, _) = built(&crossing());
    assert_eq!(movements(&network), "ABC- ABD ABE CBA- CBD CBE DBA DBC DBE- EBA EBC EBD-");
}

#[test]
fn no_forbids_the_one_movement_and_only_all_others() {
    let (network, _) = built(&crossing().restriction(&[1], at('B'), &[3], "restriction=no_left_turn"));
    assert_eq!(movements(&network), "ABC- ABD! ABE CBA- CBD CBE DBA DBC DBE- EBA EBC EBD-");
    let (network, account) = built(&crossing().restriction(&[1], at('B'), &[2], "restriction=only_straight_on"));
    assert_eq!(movements(&network), "ABA*! ABC- ABD! ABE! CBA- CBD CBE DBA DBC DBE- EBA EBC EBD-");
    assert_eq!((account.restrictions_read, account.restrictions_kept, account.forbidden_sequences), (1, 1, 3));
}

#[test]
fn several_ways_from_and_to_are_all_meant() {
    let (network, _) = built(&crossing().restriction(&[1, 2], at('B'), &[3], "restriction=no_entry"));
    assert_eq!(movements(&network), "ABC- ABD! ABE CBA- CBD! CBE DBA DBC DBE- EBA EBC EBD-");
    let (network, _) = built(&crossing().restriction(&[3], at('B'), &[1, 2], "restriction=no_exit"));
    assert_eq!(movements(&network), "ABC- ABD ABE CBA- CBD CBE DBA! DBC! DBE- EBA EBC EBD-");
}

#[test]
fn a_u_turn_on_a_way_that_runs_on_is_not_the_way_straight_on() {
    let map = AsciiMap::drawn(
        20.0,
        "
        A---B---C
            |
            E
        ",
    )
    .way("ABC", ROAD)
    .way("BE", ROAD)
    .restriction(&[1], at('B'), &[1], "restriction=no_u_turn");
    let (network, _) = built(&map);
    assert_eq!(movements(&network), "ABA*! ABC- ABE CBA- CBC*! CBE EBA EBC");
}

#[test]
fn straight_on_over_a_way_that_runs_on_closes_the_side_road() {
    let map = AsciiMap::drawn(
        20.0,
        "
        A---B---C
            |
            E
        ",
    )
    .way("ABC", ROAD)
    .way("BE", ROAD)
    .restriction(&[1], at('B'), &[1], "restriction=only_straight_on");
    let (network, _) = built(&map);
    assert_eq!(movements(&network), "ABC- ABE! CBA- CBE! EBA EBC");
}

/// Two carriageways, joined by way 3 from C to D.
fn carriageways() -> AsciiMap {
    AsciiMap::drawn(
        20.0,
        "
        F---D---E
            |
        A---C---B
        ",
    )
    .way("ACB", ONE_WAY)
    .way("EDF", ONE_WAY)
    .way("CD", ROAD)
}

#[test]
fn over_a_way_the_sequence_is_forbidden_and_its_parts_are_not() {
    let no_u_turn = carriageways().restriction(&[1], Via::Ways(vec![3]), &[2], "restriction=no_u_turn");
    let (network, account) = built(&no_u_turn);
    assert_eq!(movements(&network), "ACB- ACD CDF DCB EDC EDF-");
    assert_eq!(long_sequences(&network), "ACDF");
    assert_eq!((account.restrictions_kept, account.long_sequences), (1, 1));
}

#[test]
fn over_a_way_only_is_read_strictly() {
    let map = AsciiMap::drawn(
        20.0,
        "
            G
            |
        F---D---E
            |
        A---C---B
        ",
    )
    .way("ACB", ONE_WAY)
    .way("EDF", ONE_WAY)
    .way("CD", ROAD)
    .way("DG", ROAD);
    let (network, _) = built(&map.restriction(&[1], Via::Ways(vec![3]), &[4], "restriction=only_straight_on"));
    assert_eq!(movements(&network), "ACB-! ACD CDF CDG- DCB EDC EDF- EDG GDC- GDF");
    assert_eq!(long_sequences(&network), "ACDF ACDC");
}

#[test]
fn a_way_of_several_edges_is_followed_to_its_end() {
    let map = AsciiMap::drawn(
        20.0,
        "
        F---D---E
            |
        H---G
            |
        A---C---B
        ",
    )
    .way("ACB", ONE_WAY)
    .way("EDF", ONE_WAY)
    .way("CGD", ROAD)
    .way("GH", ROAD)
    .restriction(&[1], Via::Ways(vec![3]), &[2], "restriction=no_u_turn");
    assert_eq!(long_sequences(&built(&map).0), "ACGDF");
}

#[test]
fn what_is_not_on_the_network_is_counted() {
    let map = crossing()
        .restriction(&[77], at('B'), &[3], "restriction=no_left_turn")
        .restriction(&[1], at('B'), &[78], "restriction=no_left_turn")
        .restriction(&[1], at('E'), &[3], "restriction=no_left_turn")
        .restriction(&[1], at('C'), &[3], "restriction=only_left_turn")
        .restriction(&[1], Via::Ways(vec![79]), &[3], "restriction=no_u_turn")
        .restriction(&[1, 2, 3, 4], at('B'), &[1], "restriction=no_u_turn");
    let (_, account) = built(&map);
    let of_account = [account.restrictions_read, account.restrictions_kept, account.restrictions_off_network];
    assert_eq!(of_account, [6, 1, 5]);
    // The only permitted destination is no road here, so nothing is left.
    let (network_of_only, _) = built(&crossing().restriction(&[1], at('B'), &[78], "restriction=only_left_turn"));
    assert!(movements(&network_of_only).starts_with("ABA*! ABC-! ABD! ABE! CBA- "));
}

#[test]
fn two_nodes_at_one_place_are_one_to_a_restriction() {
    let map = AsciiMap::drawn(20.0, "A---B---C\n    b\n    |\n    E")
        .same_place('b', 'B')
        .way("ABb", ROAD)
        .way("bC", ROAD)
        .way("BE", ROAD)
        .restriction(&[1], at('b'), &[3], "restriction=no_right_turn");
    let (network, _) = built(&map);
    assert_eq!(movements(&network), "ABC- ABE! CBA- CBE EBA EBC");
}

#[test]
fn real_restrictions_are_all_accounted_for() {
    let Some(path) = extract("heidelberg_de.osm.pbf") else { return };
    let extract = read_extract(&path, &|_| ()).unwrap();
    let relations = extract.account.relations;
    assert_eq!(relations.kept(), extract.restrictions.len() as u64);
    let rows = extract.account.rows();
    let count = |outcome: &str| {
        rows.iter().filter(|r| r.item == "relation" && r.outcome == outcome).map(|r| r.count).sum::<u64>()
    };
    assert_eq!(count("read"), count("kept") + count("left_out"));
    let (network, account) = build(extract, &somewhere, &no_sections);
    let left_out = account.restrictions_off_network + account.restrictions_without_effect;
    assert_eq!(account.restrictions_read, account.restrictions_kept + left_out);
    println!("{relations:?}\n{account:?}");
    assert!(account.restrictions_kept * 10 > account.restrictions_read * 7, "{account:?}");
    assert_eq!(account.forbidden_sequences, network.restrictions.len() as u64);
    for restriction in &network.restrictions {
        let edges = network.sequence(restriction);
        assert!(edges.len() >= 2);
        let joined = |w: &[u32]| network.edges[w[0] as usize].to_node == network.edges[w[1] as usize].from_node;
        assert!(edges.windows(2).all(joined), "{restriction:?}");
    }
}
