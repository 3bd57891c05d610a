//! Buses may drive against a one-way street. For everybody else the street stays as it is without them.

use netcert::certify::{Job, certify_network};
use netcert::corridor::{Params, stroke_corridor};
use netcert::network::Network;
use netcert::osm::facts::{Policy, TrafficSide};
use netcert::reporter::Silent;
use netcert::settings::{Needs, Settings};
use netcert::stet::Model;
use netcert::verdict::{ForbiddenReason, Verdict};

use netcert_testing::ascii_map::{AsciiMap, edge};
use netcert_testing::catalogue::catalogued;
use netcert_testing::junctions::DrawnNetwork;

const POLICIES: [Policy; 3] = [Policy::Lane, Policy::Direction, Policy::Carriageway];

/// A two-way road that goes on as a one-way street, with side roads where they meet and farther on.
fn street(tags: &str) -> DrawnNetwork {
    let map = AsciiMap::placed(&[
        ('A', [-200.0, 0.0]),
        ('B', [0.0, 0.0]),
        ('C', [80.0, 3.0]),
        ('D', [260.0, 3.0]),
        ('E', [0.0, -120.0]),
        ('F', [80.0, 130.0]),
    ])
    .way("AB", "highway=secondary")
    .way("BCD", &format!("highway=secondary oneway=yes {tags}"))
    .way("BE", "highway=residential")
    .way("CF", "highway=residential");
    DrawnNetwork::new(&map, TrafficSide::Right, 6.0)
}

/// The widths along the stroke of an edge.
fn widths(network: &Network, ends: &str, policy: Policy) -> Vec<(f64, f64)> {
    let wanted = edge(network, ends);
    let edges = |range: &std::ops::Range<u32>| &network.stroke_edges[range.start as usize..range.end as usize];
    let stroke = network.strokes.iter().find(|stroke| edges(&stroke.edges).contains(&wanted)).unwrap();
    let made = stroke_corridor(network, stroke, policy, &Params::default()).unwrap().corridor;
    made.left_m.iter().copied().zip(made.right_m.iter().copied()).collect()
}

#[test]
fn a_street_is_no_wider_where_buses_may_come_against_it() {
    let plain = street("").network;
    for tags in ["oneway:bus=no", "oneway:psv=no", "oneway:bus=no lanes=1"] {
        let with_buses = street(tags).network;
        assert_eq!(with_buses.edges.len(), plain.edges.len() + 2, "{tags}: the edges of buses");
        for policy in POLICIES {
            for ends in ["AB", "BC", "CD", "BA", "EB", "CF"] {
                let same = widths(&with_buses, ends, policy) == widths(&plain, ends, policy);
                assert!(same, "{tags}, {policy:?}, {ends}: other widths, or a stroke of another length");
            }
        }
        assert!(with_buses.section(&with_buses.edges[edge(&with_buses, "CB").index()]).lane.is_none());
    }
}

#[test]
fn only_buses_may_drive_against_it_and_no_width_is_known_there() {
    let DrawnNetwork { network, .. } = street("oneway:bus=no");
    let models = ["EU-SEMI16.5", "BUS-ART18-EU"].map(|id| Model::new(&catalogued(id)).unwrap());
    let settings = Settings { needs: Needs::Off, ..Settings::default() };
    let job = Job { network: &network, models: &models, settings: &settings };
    let against = edge(&network, "CB");
    let mut found = Vec::new();
    certify_network(&job, &Silent, |vehicle, made| {
        if made.edge == against {
            found.push((vehicle, made.conclusion.verdict));
        }
        Ok::<(), ()>(())
    })
    .unwrap();
    found.sort_by_key(|(vehicle, _)| *vehicle);
    assert_eq!(found[0], (0, Verdict::Forbidden(ForbiddenReason::Oneway)));
    assert!(matches!(found[1], (1, Verdict::Unknown(_))), "{found:?}");
}
