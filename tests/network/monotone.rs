//! A larger measured width never takes a certificate away.

use netcert::certify::{TurnJob, certify_turns};
use netcert::osm::facts::{Policy, TrafficSide, WidthSource};
use netcert::reporter::Silent;
use netcert::settings::{Needs, Settings};
use netcert::stet::Model;
use netcert::verdict::Verdict;

use netcert_testing::ascii_map::AsciiMap;
use netcert_testing::catalogue::catalogued;
use netcert_testing::junctions::DrawnNetwork;
use netcert_testing::thorough::cases;

/// A crossing of two roads that meet at an angle, in degrees.
fn crossing(angle_deg: f64, kerb_m: f64, classes: [&str; 2]) -> DrawnNetwork {
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
    DrawnNetwork::new(&map, TrafficSide::Right, kerb_m)
}

/// For each turn: the RSC where it is safe, with all roads measured at the widths given.
fn turns(drawn: &DrawnNetwork, vehicle: &str, policy: Policy, widths_m: [f64; 2]) -> Vec<Option<f64>> {
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
        found[made.turn.index()] = made.conclusion.measured.filter(|_| safe).map(|measured| measured.rsc_m);
        Ok::<(), ()>(())
    })
    .unwrap();
    found
}

/// Turns that are safe at some width and not at the next larger one, of all that are safe and have a larger width to be tried.
fn lost(
    drawn: &DrawnNetwork,
    vehicle: &str,
    policy: Policy,
    widths_m: impl Iterator<Item = f64>,
) -> (Vec<String>, usize) {
    let (mut lost, mut all) = (Vec::new(), 0);
    let mut before: Option<Vec<Option<f64>>> = None;
    for width_m in widths_m {
        let now = turns(drawn, vehicle, policy, [width_m; 2]);
        for (turn, (then, now)) in before.iter().flatten().zip(&now).enumerate() {
            // Areas are drawn within 2 mm: a turn with less to spare may be lost by that.
            let safe = then.is_some_and(|rsc_m| rsc_m >= 0.002);
            all += usize::from(safe);
            if safe && now.is_none() {
                lost.push(format!("{vehicle}, {policy:?}, turn {turn}: {then:?}, but unsafe at {width_m:.2} m"));
            }
        }
        before = Some(now);
    }
    (lost, all)
}

#[test]
fn a_larger_measured_width_never_takes_a_certificate_away() {
    let (mut lost_all, mut all) = (Vec::new(), 0);
    let lanes = |from: f64, step: f64, count: u32| (0..count).map(move |i| from + step * f64::from(i));
    let mut look = |angle_deg: f64, kerb_m: f64, vehicle: &str, policy: Policy, widths_m: Vec<f64>| {
        let drawn = crossing(angle_deg, kerb_m, ["highway=secondary lanes=2", "highway=tertiary lanes=2"]);
        let (lost, some) = lost(&drawn, vehicle, policy, widths_m.into_iter());
        lost_all.extend(lost.into_iter().map(|lost| format!("{angle_deg}°, kerb {kerb_m} m: {lost}")));
        all += some;
    };
    for &(angle_deg, kerb_m) in cases(&[(90.0, 9.0)][..], &[(60.0, 9.0), (90.0, 9.0)]) {
        for vehicle in ["EU-SEMI16.5", "US-WB40"] {
            look(angle_deg, kerb_m, vehicle, Policy::Lane, lanes(2.95, 0.14, 12).collect());
            look(angle_deg, kerb_m, vehicle, Policy::Carriageway, lanes(5.9, 0.28, 12).collect());
        }
    }
    // Before plans of narrower roads were tried, nine of these steps lost a certificate.
    for &(angle_deg, kerb_m) in cases(&[(75.0, 6.0)][..], &[(60.0, 9.0), (75.0, 6.0)]) {
        look(angle_deg, kerb_m, "US-WB40", Policy::Lane, lanes(4.18, 0.02, 18).collect());
    }
    assert!(lost_all.is_empty(), "{} of {all}: {lost_all:#?}", lost_all.len());
    assert!(all > cases(75, 150), "{all}");
}
