//! What roads without name and ref are called: by what they join.

use netcert_testing::ascii_map::{AsciiMap, built, edge};

/// A motorway M–N with a ramp of two ways from `a` over `b` to the road R–S, a link from it to a street, and a driveway.
fn interchange() -> AsciiMap {
    AsciiMap::placed(&[
        ('M', [-500.0, 0.0]),
        ('a', [0.0, 0.0]),
        ('N', [500.0, 0.0]),
        ('b', [100.0, -60.0]),
        ('c', [200.0, -200.0]),
        ('R', [-500.0, -200.0]),
        ('S', [500.0, -200.0]),
        ('d', [300.0, -200.0]),
        ('e', [320.0, -300.0]),
        ('T', [320.0, -500.0]),
        ('U', [600.0, -300.0]),
        ('f', [-300.0, -200.0]),
        ('g', [-300.0, -250.0]),
        ('x', [900.0, 900.0]),
        ('y', [950.0, 900.0]),
    ])
    .way("MaN", "highway=motorway ref=A5 oneway=yes")
    .way("ab", "highway=motorway_link oneway=yes")
    .way("bc", "highway=motorway_link oneway=yes")
    .way("RfcdS", "highway=primary ref=B3;B4 name=Bergweg")
    .way("de", "highway=primary_link")
    .way("TeU", "highway=residential name=Gasse")
    .way("fg", "highway=service")
    .way("xy", "highway=service")
}

#[test]
fn a_road_without_name_is_called_by_what_it_joins() {
    let (network, _) = built(&interchange());
    let title = |ends: &str| network.title(&network.edges[edge(&network, ends).index()]);
    assert_eq!(title("Ma"), "A5");
    assert_eq!(title("fc"), "B3;B4 Bergweg");
    assert_eq!(title("ab"), "ramp from A5 to B3/B4");
    assert_eq!(title("bc"), "ramp from A5 to B3/B4");
    assert_eq!(title("de"), "link B3/B4 – Gasse");
    assert_eq!(title("ed"), title("de"));
    assert_eq!(title("fg"), "service road at B3/B4");
    let lonely = network.edges[edge(&network, "xy").index()].clone();
    assert_eq!(network.title(&lonely), format!("service road (way {})", network.road(&lonely).way_id));
}
