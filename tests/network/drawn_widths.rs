//! Drawn networks with random widths, as maps have them: metres, feet, decimals, lists of lanes. What is certified of them is bounded work.
//! `tools/soak` draws more and larger ones.

use netcert::certify::{Job, TurnJob, certify_network, certify_turns};
use netcert::osm::facts::{Policy, TrafficSide};
use netcert::reporter::Silent;
use netcert::settings::{Needs, Settings};
use netcert::stet::Model;
use netcert::verdict::Verdict;
use netcert::watch;

use netcert_testing::ascii_map::AsciiMap;
use netcert_testing::catalogue::catalogued;
use netcert_testing::junctions::DrawnNetwork;

/// Networks that are drawn, and polls of the guard that each certificate of an edge or turn may take. Measured: 1,950 at most.
const NETWORKS: u64 = 24;
const POLLS: u64 = 60_000;

/// A fixed sequence that looks random (xorshift).
struct Draw(u64);

impl Draw {
    fn below(&mut self, n: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) % n
    }

    /// Centimetres between two bounds, as metres.
    fn metres(&mut self, from: u64, to: u64) -> f64 {
        (from + self.below(to - from)) as f64 / 100.0
    }

    /// Tags of a road's width.
    fn width(&mut self) -> String {
        let (whole, lane, other) = (self.metres(450, 1400), self.metres(240, 420), self.metres(240, 420));
        match self.below(8) {
            0 => String::new(),
            1 => format!("lanes=2 width={whole}"),
            2 => format!("lanes=2 width={}'", (whole / 0.3048).round()),
            3 => format!("lanes=2 width={}'{}\"", (whole / 0.3048).floor(), self.below(12)),
            4 => format!("lanes=2 width:lanes={lane}|{other}"),
            5 => format!("lanes=2 width:lanes:forward={lane} width:lanes:backward={other}"),
            6 => format!("est_width={whole}"),
            _ => format!("lanes=3 lanes:forward=2 lanes:backward=1 width={whole}"),
        }
    }

    /// A crossing of a through road and two others, each with widths of its own.
    fn network(&mut self) -> AsciiMap {
        let mut at = |east: f64, north: f64| [east + self.metres(0, 2000) - 10.0, north + self.metres(0, 2000) - 10.0];
        let nodes = [
            ('A', at(-180.0, 0.0)),
            ('B', [0.0, 0.0]),
            ('C', at(180.0, 0.0)),
            ('D', at(0.0, 150.0)),
            ('E', at(20.0, -160.0)),
            ('F', at(330.0, 60.0)),
        ];
        let class = |draw: &mut Self| {
            ["primary", "secondary", "tertiary", "unclassified", "residential"][draw.below(5) as usize].to_owned()
        };
        let mut map = AsciiMap::placed(&nodes);
        for way in ["ABC", "DB", "BE", "CF"] {
            let tags = format!("highway={} {}", class(self), self.width());
            map = map.way(way, &tags);
        }
        map
    }
}

#[test]
fn networks_of_any_widths_are_certified_with_bounded_work() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let mut draw = Draw(0x2545_f491_4f6c_dd1d);
    let mut safe = 0;
    for number in 0..NETWORKS {
        let drawn = DrawnNetwork::new(
            &draw.network(),
            if draw.below(2) == 0 { TrafficSide::Left } else { TrafficSide::Right },
            draw.metres(300, 1200),
        );
        let network = &drawn.network;
        let policy = [Policy::Lane, Policy::Direction, Policy::Carriageway][draw.below(3) as usize];
        let vehicle = ["EU-SEMI16.5", "US-WB40", "AU-SEMI19", "BUS-ART18-EU"][draw.below(4) as usize];
        let settings = Settings { policy, kerbs: drawn.params.kerbs.clone(), needs: Needs::All, ..Settings::default() };
        let models = [Model::new(&catalogued(vehicle)).unwrap()];
        let (polls, certificates) = pool.install(|| {
            let before = watch::counted();
            let job = Job { network, models: &models, settings: &settings };
            let mut edges = vec![vec![Verdict::Safe; network.edges.len()]];
            let mut certificates = 0;
            certify_network(&job, &Silent, |_, made| {
                certificates += 1;
                safe += u64::from(made.conclusion.verdict == Verdict::Safe);
                edges[0][made.edge.index()] = made.conclusion.verdict;
                Ok::<(), ()>(())
            })
            .unwrap();
            let turns = drawn.facts();
            let job = TurnJob { network, turns: &turns, models: &models, edges: &edges, settings: &settings };
            certify_turns(&job, &Silent, |_, _| {
                certificates += 1;
                Ok::<(), ()>(())
            })
            .unwrap();
            (watch::counted() - before, certificates)
        });
        assert!(
            polls <= POLLS * certificates,
            "network {number}, {vehicle}, {policy:?}: {polls} polls, {certificates}"
        );
    }
    assert!(safe > NETWORKS, "{safe} edges are safe: the test looks at nothing");
}
