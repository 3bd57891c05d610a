//! A larger measured width never takes a certificate away.

use netcert::certify::{TurnJob, certify_turns};
use netcert::osm::facts::{Policy, WidthSource};
use netcert::reporter::Silent;
use netcert::settings::{Needs, Settings};
use netcert::stet::Model;
use netcert::verdict::Verdict;
use proptest::prelude::*;

use super::support::ascii_map::AsciiMap;
use super::support::catalogue::catalogued;
use super::support::junctions::Drawn;

/// A crossing of two roads that meet at an angle, in degrees.
fn crossing(angle_deg: f64, kerb_m: f64, classes: [&str; 2]) -> Drawn {
    let (sin, cos) = angle_deg.to_radians().sin_cos();
    let far = 160.0;
    let map = AsciiMap::placed(&[
        ('A', [-far, 0.0]),
        ('B', [0.0, 0.0]),
        ('C', [far, 0.0]),
        ('D', [far * cos, far * sin]),
        ('E', [-far * cos, -far * sin]),
    ])
    .way("ABC", classes[0])
    .way("EBD", classes[1]);
    Drawn::new(&map, false, kerb_m)
}

/// For each turn: the RSC where it is safe, with all roads measured at the widths given.
fn turns(drawn: &Drawn, vehicle: &str, policy: Policy, widths_m: [f64; 2]) -> Vec<Option<f64>> {
    let mut network = drawn.network.clone();
    for edge in drawn.network.edges.clone() {
        let width_m = widths_m[usize::from(network.road(&edge).way_id == 2)];
        let section = network.section(&edge).with_width(policy, width_m, WidthSource::Surveyed);
        network.site.set_section(&edge, section);
    }
    let models = [Model::new(&catalogued(vehicle)).unwrap()];
    let edges = [vec![Verdict::Safe; network.edges.len()]];
    let turns = drawn.facts();
    let settings = Settings { policy, kerbs: drawn.params.kerbs.clone(), needs: Needs::Off, ..Settings::default() };
    let job = TurnJob { network: &network, turns: &turns, models: &models, edges: &edges, settings: &settings };
    let mut found = vec![None; turns.len()];
    certify_turns(&job, &Silent, |_, made| {
        let safe = made.conclusion.verdict == Verdict::Safe;
        found[made.turn as usize] = made.conclusion.measured.filter(|_| safe).map(|measured| measured.rsc_m);
        Ok::<(), ()>(())
    })
    .unwrap();
    found
}

#[test]
fn probe() {
    let (mut n, mut lost) = (0, 0);
    for angle in [60.0, 75.0, 90.0, 105.0] {
        for kerb in [6.0, 9.0, 12.0] {
            let drawn = crossing(angle, kerb, ["highway=secondary lanes=2", "highway=tertiary lanes=2"]);
            for vehicle in ["EU-SEMI16.5", "US-WB40"] {
                for policy in [Policy::Lane, Policy::Carriageway] {
                    let mut before: Option<Vec<Option<f64>>> = None;
                    for step in 0..24 {
                        let w = 2.9 + 0.07 * f64::from(step);
                        let w = if policy == Policy::Carriageway { 2.0 * w } else { w };
                        let now = turns(&drawn, vehicle, policy, [w, w]);
                        if let Some(before) = &before {
                            for (i, (a, b)) in before.iter().zip(&now).enumerate() {
                                n += usize::from(a.is_some());
                                if a.is_some() && b.is_none() {
                                    lost += 1;
                                    println!("LOST {angle} {kerb} {vehicle} {policy:?} w {w:.2} turn {i}: {a:?}");
                                }
                            }
                        }
                        before = Some(now);
                    }
                }
            }
        }
    }
    println!("{lost} of {n}");
}
