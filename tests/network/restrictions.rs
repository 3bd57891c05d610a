//! Turn restrictions drawn in ASCII: the movements that they forbid, and the sequences over ways.
//!
//! A movement is written by its nodes: `ABC` from A over B to C. `!` marks a movement that a restriction over a node
//! forbids, `-` a straight continuation, `*` a U-turn.

use netcert_testing::ascii_map;
use netcert_testing::extracts::extract;

use ascii_map::{AsciiMap, built, id_of, no_sections, node_of, somewhere};
use netcert::network::{EdgeNo, MovementKind, Network, build};
use netcert::osm::Via;
use netcert::osm::pbf::read_extract;

const ROAD: &str = "highway=residential";
const ONE_WAY: &str = "highway=residential oneway=yes";

fn nodes(network: &Network, edges: &[EdgeNo]) -> String {
    let edge = |e: &EdgeNo| &network.edges[e.index()];
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
    assert_eq!(movements(&network), "ABA*! ABC- ABE! CBA- CBC*! CBE! EBA EBC");
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

/// A crossing where way 2 runs on from A over B to C. Way 1 comes from E in the south, way 3 from D.
fn runs_on() -> AsciiMap {
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
    .way("EB", ROAD)
    .way("ABC", ROAD)
    .way("DB", ROAD)
}

/// The forbidden movements over nodes, sorted.
fn forbidden(network: &Network) -> String {
    let barred = |m: &&netcert::network::Movement| m.forbidden.is_some();
    let mut all: Vec<String> =
        network.movements().all().iter().filter(barred).map(|m| nodes(network, &[m.from, m.to])).collect();
    all.sort();
    all.join(" ")
}

#[test]
fn where_a_way_runs_on_the_side_decides() {
    let all = "EBA EBC EBD EBE";
    let table: [(&[i64], &[i64], &str, &str); 33] = [
        (&[1], &[2], "only_left_turn", "EBC EBD EBE"),
        (&[1], &[2], "only_right_turn", "EBA EBD EBE"),
        (&[1], &[2], "Only_Left_Turn", "EBC EBD EBE"),
        (&[1], &[2], "only_straight_on", all),
        (&[1], &[2], "only_u_turn", all),
        (&[1], &[2], "only_turn", all),
        (&[1], &[2], "only_entry", all),
        (&[1], &[2], "no_left_turn", "EBA"),
        (&[1], &[2], "no_right_turn", "EBC"),
        (&[1], &[2], "NO_LEFT_TURN", "EBA"),
        (&[1], &[2], "no_left_turn;no_right_turn", "EBA EBC"),
        (&[1], &[2], "no_straight_on", "EBA EBC"),
        (&[1], &[2], "no_u_turn", "EBA EBC"),
        (&[1], &[2], "no_turn", "EBA EBC"),
        (&[1], &[2], "no_entry", "EBA EBC"),
        (&[1], &[2], "no_exit", "EBA EBC"),
        (&[1], &[2], "no_something", "EBA EBC"),
        (&[2], &[1], "no_left_turn", "CBE"),
        (&[2], &[1], "no_right_turn", "ABE"),
        (&[2], &[1], "no_turn", "ABE CBE"),
        (&[2], &[1], "no_entry", "ABE CBE"),
        (&[2], &[1], "no_straight_on", "ABE CBE"),
        (&[2], &[1], "only_right_turn", "ABA ABC ABD"),
        (&[2], &[1], "only_left_turn", "CBA CBC CBD"),
        (&[2], &[1], "only_straight_on", "ABA ABC ABD CBA CBC CBD"),
        (&[2], &[2], "no_u_turn", "ABA CBC"),
        (&[2], &[2], "only_u_turn", "ABC ABD ABE CBA CBD CBE"),
        (&[2], &[2], "only_straight_on", "ABA ABD ABE CBC CBD CBE"),
        (&[2], &[2], "no_straight_on", "ABC CBA"),
        (&[1], &[2, 3], "no_left_turn", "EBA EBD"),
        (&[1, 3], &[2], "no_left_turn", "DBC EBA"),
        (&[1, 3], &[2], "only_right_turn", "DBC DBD DBE EBA EBD EBE"),
        (&[1], &[2, 3], "only_right_turn", "EBA EBE"),
    ];
    for (from, to, value, expected) in table {
        let (network, account) = built(&runs_on().restriction(from, at('B'), to, &format!("restriction={value}")));
        assert_eq!(forbidden(&network), expected, "{value} from {from:?} to {to:?}");
        assert_eq!((account.restrictions_kept, account.restrictions_read), (1, 1));
    }
}

#[test]
fn how_a_restriction_was_read_is_counted() {
    let reading = |value: &str| {
        let (_, account) = built(&runs_on().restriction(&[1], at('B'), &[2], &format!("restriction={value}")));
        (account.restrictions_by_side, account.restrictions_any_side)
    };
    assert_eq!(reading("no_left_turn"), (1, 0));
    assert_eq!(reading("only_right_turn"), (1, 0));
    assert_eq!(reading("no_turn"), (0, 1));
    assert_eq!(reading("only_straight_on"), (0, 1));
    let (_, plain) = built(&runs_on().restriction(&[1], at('B'), &[3], "restriction=no_left_turn"));
    assert_eq!((plain.restrictions_by_side, plain.restrictions_any_side), (0, 0));
}

/// Angles of 60° and 120° to the left, so that the side decides nothing.
#[test]
fn two_ways_on_one_side_are_both_meant() {
    let map = || {
        AsciiMap::placed(&[
            ('E', [0.0, -50.0]),
            ('B', [0.0, 0.0]),
            ('A', [-43.0, 25.0]),
            ('C', [-43.0, -25.0]),
            ('D', [0.0, 50.0]),
        ])
        .way("EB", ROAD)
        .way("ABC", ROAD)
        .way("DB", ROAD)
    };
    for (value, expected) in
        [("no_left_turn", "EBA EBC"), ("no_right_turn", "EBA EBC"), ("only_left_turn", "EBA EBC EBD EBE")]
    {
        let (network, _) = built(&map().restriction(&[1], at('B'), &[2], &format!("restriction={value}")));
        assert_eq!(forbidden(&network), expected, "{value}");
    }
}

/// The road from A to F was split at B: ways 1 and 2. Way 3 comes from D, way 4 leads to E.
fn split_road(tags: &str) -> AsciiMap {
    AsciiMap::drawn(
        20.0,
        "
        S       D
        |       |
    A---B---G---C---F
                |
                E
        ",
    )
    .way("AB", &format!("{ROAD} {tags}"))
    .way("BGC", &format!("{ROAD} {tags}"))
    .way("DC", ROAD)
    .way("CE", ROAD)
    .way("CF", &format!("{ROAD} {tags}"))
    .way("SB", ROAD)
}

#[test]
fn a_member_beyond_a_split_stands_for_the_rest_of_its_road() {
    let named = "name=Long_Road";
    type Case = (&'static [i64], &'static [i64], &'static str, &'static str, &'static str);
    let table: [Case; 6] = [
        (&[1], &[3], "no_left_turn", named, "BCD"),
        (&[1], &[3], "only_left_turn", named, "BCB BCE BCF"),
        (&[3], &[1], "no_right_turn", named, "DCB"),
        (&[3], &[1], "only_right_turn", named, "DCD DCE DCF"),
        (&[1], &[5], "no_straight_on", "ref=7", "BCF"),
        // Another road leaves the split, so nobody knows which one is meant.
        (&[1], &[3], "no_left_turn", "", ""),
    ];
    for (from, to, value, tags, expected) in table {
        let (network, account) =
            built(&split_road(tags).restriction(from, at('C'), to, &format!("restriction={value}")));
        assert_eq!(forbidden(&network), expected, "{value} from {from:?} to {to:?}");
        let found = u64::from(!expected.is_empty());
        assert_eq!((account.restrictions_beyond_split, account.restrictions_off_network), (found, 1 - found));
    }
    // Without a side road, the unnamed road goes on as well.
    let alone = split_road("").without_way(6).restriction(&[1], at('C'), &[3], "restriction=no_left_turn");
    assert_eq!(forbidden(&built(&alone).0), "BCD");
}

#[test]
fn an_only_that_has_no_place_is_counted() {
    let (network, account) = built(&split_road("").restriction(&[1], at('C'), &[3], "restriction=only_left_turn"));
    assert_eq!(forbidden(&network), "");
    assert_eq!((account.restrictions_off_network, account.only_not_placed), (1, 1));
    let (network, account) = built(&crossing().restriction(&[1], at('B'), &[99], "restriction=only_left_turn"));
    assert_eq!(forbidden(&network), "ABA ABC ABD ABE");
    assert_eq!((account.restrictions_no_destination, account.only_not_placed), (1, 0));
}

#[test]
fn missing_members_are_found_or_all_meant() {
    let nowhere = || Via::Nodes(Vec::new());
    type Case = (&'static [i64], Via, &'static [i64], &'static str, &'static str);
    let table: [Case; 8] = [
        (&[1], nowhere(), &[3], "no_left_turn", "ABD"),
        (&[1], nowhere(), &[3], "only_left_turn", "ABA ABC ABE"),
        (&[1], at('B'), &[], "no_left_turn", "ABD"),
        (&[1], at('B'), &[], "no_u_turn", "ABA"),
        (&[1], at('B'), &[], "only_straight_on", "ABA ABD ABE"),
        (&[1], at('B'), &[], "only_turn", "ABA ABC ABD ABE"),
        (&[], at('B'), &[3], "no_left_turn", "ABD"),
        (&[], at('B'), &[3], "no_entry", "ABD CBD EBD"),
    ];
    for (from, via, to, value, expected) in table {
        let (network, account) = built(&crossing().restriction(from, via, to, &format!("restriction={value}")));
        assert_eq!(forbidden(&network), expected, "{value} from {from:?} to {to:?}");
        assert_eq!(account.restrictions_kept, 1);
    }
}

/// Two carriageways, joined by ways 3 and 4 from C over G to D.
fn joined_by_two() -> AsciiMap {
    AsciiMap::drawn(
        20.0,
        "
        F---D---E
            |
            G
            |
        A---C---B
        ",
    )
    .way("ACB", ONE_WAY)
    .way("EDF", ONE_WAY)
    .way("CG", ROAD)
    .way("GD", ROAD)
}

#[test]
fn via_ways_are_found_in_another_order_and_beyond_a_split() {
    let table: [(&[i64], &str, (u64, u64)); 4] =
        [(&[3, 4], "ACGDF", (0, 0)), (&[4, 3], "ACGDF", (1, 0)), (&[3], "ACGD", (0, 1)), (&[4], "CGDF", (0, 1))];
    for (via, expected, found) in table {
        let (network, account) =
            built(&joined_by_two().restriction(&[1], Via::Ways(via.to_vec()), &[2], "restriction=no_u_turn"));
        assert_eq!(long_sequences(&network), expected, "{via:?}");
        assert_eq!((account.restrictions_via_found, account.restrictions_beyond_split), found, "{via:?}");
    }
}

#[test]
fn an_only_over_ways_whose_destination_is_elsewhere_forbids_every_way_on() {
    let (network, account) =
        built(&carriageways().restriction(&[1], Via::Ways(vec![3]), &[99], "restriction=only_straight_on"));
    assert_eq!((forbidden(&network).as_str(), long_sequences(&network).as_str()), ("ACB", "ACDF ACDC"));
    assert_eq!(account.restrictions_no_destination, 1);
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
        let joined = |w: &[EdgeNo]| network.edges[w[0].index()].to_node == network.edges[w[1].index()].from_node;
        assert!(edges.windows(2).all(joined), "{restriction:?}");
    }
}

/// Over 40 edges of a way that is named twenty times, 10¹¹ ways of driving it lead nowhere.
#[test]
fn a_way_that_is_named_often_takes_few_steps_and_leaves_nothing_open() {
    let along: Vec<char> = (0..41).filter_map(|i| char::from_u32(u32::from('\u{4e00}') + i)).collect();
    let crossing: Vec<char> = (0..41).filter_map(|i| char::from_u32(u32::from('\u{5e00}') + i)).collect();
    let mut places = vec![('A', [-20.0, 0.0])];
    for (i, (&c, &d)) in (0..).zip(along.iter().zip(&crossing)) {
        let east_m = 20.0 * f64::from(i);
        places.extend([(c, [east_m, 0.0]), (d, [east_m, 30.0])]);
    }
    let mut map =
        AsciiMap::placed(&places).way(&format!("A{}", along[0]), ROAD).way(&along.iter().collect::<String>(), ONE_WAY);
    for (c, d) in along.iter().zip(&crossing) {
        map = map.way(&format!("{c}{d}"), ROAD);
    }
    // The way `to` is not there.
    let no_turn = map.clone().restriction(&[1], Via::Ways(vec![2; 20]), &[99], "restriction=no_left_turn");
    let (network, _) = built(&no_turn);
    // Nothing is known of the destination: the movement onto the way is closed rather than left open.
    let onto = |network: &Network| {
        let first = network.edges.iter().position(|e| e.from_node == id_of('A')).map(EdgeNo::at).unwrap();
        network.movements().all().iter().find(|m| m.from == first && m.forbidden.is_some()).is_some()
    };
    assert!(onto(&network));
    assert!(!onto(&built(&map).0));
}
