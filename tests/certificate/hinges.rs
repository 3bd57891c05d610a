//! Hinge margins where a bend begins and ends between two stations (docs/proof.md, section 10). Curvature that is linear from station to
//! station does not lead to the next station there. The course is then steepest between stations.

use netcert::check::{Chain, SpanClaim, StationReading, Subject, shift};
use netcert::corridor::Corridor;
use netcert::stet::{Model, Options, certify_spans};
use netcert::vehicle::Vehicle;
use netcert_testing::oracle::adversary::{AdversaryBounds, hinge_kernel};
use netcert_testing::oracle::attack;
use netcert_testing::oracle::claim::{Claim, claim};
use netcert_testing::oracle::draw::{Bends, curvature_at};
use netcert_testing::oracle::fleet;
use netcert_testing::oracle::path::{along, direction, dot, left_of, wrapped};
use netcert_testing::oracle::simulator::{Disturbance, SimulatedDrive};

/// Metres between stations, as on the map's turns.
const SPACING_M: f64 = 0.5;
/// Places between two stations at which hinges are looked at.
const PLACES: usize = 10;
/// Metres before the bend.
const STRAIGHT_M: f64 = 30.0;

/// A curve sampled at stations: places and headings are its own, not those to which the sampled curvatures lead.
fn sampled(bends: &Bends, spacing_m: f64) -> Corridor {
    const PARTS: usize = 500;
    let total: f64 = bends.iter().map(|bend| bend.0).sum();
    let stations = (total / spacing_m) as usize;
    let widths = vec![6.0; stations];
    let (mut x, mut y, mut heading) = (Vec::new(), Vec::new(), Vec::new());
    let (mut at, mut turned) = ([0.0; 2], 0.3);
    let part = spacing_m / PARTS as f64;
    for k in 0..stations {
        x.push(at[0]);
        y.push(at[1]);
        heading.push(turned);
        for j in 0..PARTS {
            let bend = curvature_at(bends, k as f64 * spacing_m + (j as f64 + 0.5) * part);
            at = along(at, part, direction(turned + 0.5 * bend * part));
            turned += bend * part;
        }
    }
    let curvature = (0..stations).map(|k| curvature_at(bends, k as f64 * spacing_m)).collect();
    let areas = Vec::new();
    Corridor { spacing_m, x, y, heading, curvature, left_m: widths.clone(), right_m: widths, areas }
}

/// A bend's name and its curve.
type Named = (String, Bends);

/// Bends of a few metres that begin and end within half a metre, at several places between two stations.
fn short_bends() -> Vec<Named> {
    let bend = |kappa: f64, length_m: f64, phase: i32| {
        let before_m = STRAIGHT_M + 0.1 * f64::from(phase);
        let bends = vec![(before_m, 0.0), (0.5, kappa), (length_m, kappa), (0.5, 0.0), (40.0, 0.0)];
        (format!("{kappa} 1/m over {length_m} m from {before_m} m"), bends)
    };
    (0..5).flat_map(|phase| [bend(0.15, 2.0, phase), bend(-0.13, 5.0, phase)]).collect()
}

/// Gentle bends of a few metres, each with a short sharp one to the other side at its end.
fn bends_back() -> Vec<Named> {
    let bend = |gentle: f64, length_m: f64, phase: i32| {
        let before_m = STRAIGHT_M + 0.1 * f64::from(phase);
        let bends = vec![(before_m, 0.0), (0.5, gentle), (length_m, gentle), (0.5, -0.12), (0.5, 0.0), (40.0, 0.0)];
        (format!("{gentle} 1/m over {length_m} m from {before_m} m, then back"), bends)
    };
    (0..5).flat_map(|phase| [bend(0.025, 1.5, phase), bend(0.032, 2.5, phase)]).collect()
}

#[test]
fn a_hinge_margin_is_confirmed_where_a_bend_ends_between_stations() {
    for id in ["US-WB40", "AU-BDOUBLE26", "EU-CAT18.75"] {
        let vehicle = fleet::vehicle(id);
        let (model, chain) = (Model::new(&vehicle).unwrap(), Chain::new(&vehicle));
        for (name, bends) in short_bends().into_iter().chain(bends_back()) {
            let corridor = sampled(&bends, SPACING_M);
            let whole = 0..corridor.len();
            let row = certify_spans(&corridor, &[&model], std::slice::from_ref(&whole), &Options::default()).remove(0);
            let result = &row.spans[0];
            assert!(result.hinge_margin_rad.is_some(), "{id}, {name}");
            let claim = SpanClaim {
                stations: whole,
                rsc_m: None,
                hinge_margin_rad: result.hinge_margin_rad,
                shrink: result.shrink,
                limiting: None,
            };
            let subject =
                Subject::new(&chain, &corridor, shift(&row.plan.coefficients), StationReading::Strict).unwrap();
            let found = subject.check(std::slice::from_ref(&claim)).remove(0);
            assert!(found.is_empty(), "{id}, {name}: {claim:?}: {found:?}");
            let more = SpanClaim { hinge_margin_rad: claim.hinge_margin_rad.map(|rad| rad + 0.03), ..claim };
            assert!(!subject.check(&[more]).remove(0).is_empty(), "{id}, {name}: a margin of 1.7° more is confirmed");
        }
    }
}

/// How much more room than its margin the linearised chain leaves a hinge at the worst of ten places between stations, radians, and
/// where. The steer axle follows the curve itself and is free to jump.
fn spare(vehicle: &Vehicle, bends: &Bends) -> (f64, String) {
    let centred = Options { max_shift_m: 0.0, ..Options::default() };
    let claim = claim(&sampled(bends, SPACING_M), vehicle, &centred).unwrap();
    let fine_m = SPACING_M / PLACES as f64;
    let curve = sampled(bends, fine_m);
    let plan = curve.x.iter().zip(&curve.y).map(|(&x, &y)| [x, y]).collect();
    let path = attack::path(&curve, vehicle, &Claim { plan, ..claim });
    let drive = SimulatedDrive::new(vehicle, &path, 1);
    let calm = Disturbance::none(drive.steps());
    let nominal = drive.whole(&calm);
    let slip = std::array::from_fn(|i| vehicle.units.get(i).map_or(0.0, |unit| unit.sway_rad));
    let bounds = AdversaryBounds { steer_m: claim.shrink * vehicle.tracking_tolerance_m, change_m: 1.0, slip };
    let memory = (4.0 * vehicle.length_m / fine_m) as usize;
    let first = path.span_of_vertex(((STRAIGHT_M - 1.0) / fine_m) as usize);
    let mut least = (f64::INFINITY, String::new());
    for step in first..first + (8.0 / fine_m) as usize {
        let headings = nominal.at(step).1;
        let (moved, u) = (drive.guide_velocity(&calm, step, 0.0), direction(headings[0]));
        for (hinge, unit) in vehicle.units.iter().enumerate() {
            let (fold, course_rad) = match hinge.checked_sub(1) {
                Some(ahead) => (wrapped(headings[hinge] - headings[ahead]), 0.0),
                None => (-dot(moved, left_of(u)).atan2(dot(moved, u)), vehicle.tracking_heading_rad),
            };
            let reach = hinge_kernel(&drive, &nominal, &calm, step, memory, hinge, fold.signum()).reach_m(&bounds);
            let spare = unit.max_articulation_rad - (fold.abs() + course_rad + reach) - claim.hinge_margin_rad;
            if spare < least.0 {
                let at_m = (step - path.span_of_vertex(0)) as f64 * fine_m;
                least = (spare, format!("hinge {hinge} at {at_m:.2} m: {:.3}°", spare.to_degrees()));
            }
        }
    }
    least
}

/// The least room to spare of some vehicles on some curves, degrees. All of it must be positive.
fn least_spare_deg(ids: [&str; 3], (tolerance_m, sway_deg): (f64, f64), curves: &[Named]) -> f64 {
    let mut least = f64::INFINITY;
    for id in ids {
        let mut vehicle = fleet::vehicle(id);
        vehicle.tracking_tolerance_m = tolerance_m;
        vehicle.units.iter_mut().for_each(|unit| unit.sway_rad = sway_deg.to_radians());
        for (name, bends) in curves {
            let (spare, place) = spare(&vehicle, bends);
            assert!(spare >= 0.0, "{id}, {name}: {place}");
            least = least.min(spare.to_degrees());
        }
    }
    println!("at a tolerance of {tolerance_m} m the least room is {least:.3}° above the margin");
    least
}

#[test]
fn no_hinge_comes_closer_to_its_limit_between_stations() {
    let least = least_spare_deg(["US-WB40", "AU-BDOUBLE26", "EU-CAT18.75"], (0.15, 0.2), &short_bends());
    assert!(least < 1.5, "{least}");
}

/// Without any tolerance, bounds of deviations hide nothing of what is missing between stations. The checker's chords may hide more than its
/// own tolerance there, so the simulator judges.
#[test]
fn a_hinge_margin_holds_without_tolerances() {
    let curves: Vec<Named> = short_bends().into_iter().chain(bends_back()).collect();
    let least = least_spare_deg(["US-WB40", "AGV-TUG4", "EU-CAT18.75"], (0.0, 0.0), &curves);
    assert!(least < 0.3, "{least}");
}

/// The steering is farthest just before the gentle bend ends. Tolerances are small, because the second order of large ones would hide
/// what is missing.
#[test]
fn a_hinge_margin_counts_the_steering_before_the_road_bends_back() {
    let least = least_spare_deg(["BUS-ART18-AASHTO", "CA-SEMI23", "EU-CAT18.75"], (0.004, 0.004), &bends_back());
    assert!(least < 1.0, "{least}");
}
