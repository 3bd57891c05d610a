//! Soundness: the swept path of an independent simulator, disturbed by an adversary within the bounds, never comes
//! closer to an edge than RSC. The test uses 1,000 random corridors and vehicles, and named hard cases.
//!
//! Numerical allowance: RK4 at 0.1 m is within 2e-6 m, and the plan's cubic is within 1e-5 m of a 12.5 m circle;
//! together 2e-5 m.

use netcert::corridor::Corridor;
use netcert::vehicle::Vehicle;
use netcert_testing::oracle::attack::{self, Attack, AttackOutcome};
use netcert_testing::oracle::claim::{Claim, certify};
use netcert_testing::oracle::draw::{self, Bends, Draw};
use netcert_testing::oracle::fleet;
use rayon::prelude::*;

const ALLOWANCE_M: f64 = 2e-5;

struct Case {
    name: String,
    radius_m: f64,
    /// Whether ε is 0.15 m and σ is 0.2°.
    as_catalogued: bool,
    vehicle: Vehicle,
    corridor: Corridor,
    seed: u64,
}

struct Verdict {
    name: String,
    radius_m: f64,
    as_catalogued: bool,
    claim: Claim,
    outcome: AttackOutcome,
}

impl Case {
    fn run(&self) -> Option<Verdict> {
        let claim = certify(&self.corridor, &self.vehicle)?;
        let path = attack::path(&self.corridor, &self.vehicle, &claim);
        let attack = Attack::new(&self.corridor, &self.vehicle, &path, claim.shrink);
        let outcome = attack.fight(&claim, &mut Draw(self.seed), 1);
        Some(Verdict {
            name: self.name.clone(),
            radius_m: self.radius_m,
            as_catalogued: self.as_catalogued,
            claim,
            outcome,
        })
    }
}

impl Verdict {
    fn gap_m(&self) -> f64 {
        self.outcome.least.clearance_m - self.claim.rsc_m
    }

    fn line(&self) -> String {
        format!(
            "{}: RSC {:.4} m at s {:.0} unit {} point {:.2} (γ {:.2}), clearance {}; gap {:.1} mm, first order {:.1} mm",
            self.name,
            self.claim.rsc_m,
            self.claim.limiting.foot_m,
            self.claim.limiting.unit,
            self.claim.limiting.ahead_m,
            self.claim.shrink,
            attack::describe(&self.outcome),
            1e3 * self.gap_m(),
            1e3 * (self.outcome.first_order_m - self.claim.rsc_m),
        )
    }
}

/// The tightest circle that a vehicle can follow for ever: √(ΣL² − Σd²), with d² over all but the last hitch.
fn tightest_m(vehicle: &Vehicle) -> f64 {
    let last = vehicle.units.len() - 1;
    let squares = |(i, u): (usize, &netcert::vehicle::Unit)| {
        u.coupling_to_axle_m.powi(2) - if i < last { u.hitch_offset_m.powi(2) } else { 0.0 }
    };
    vehicle.units.iter().enumerate().map(squares).sum::<f64>().sqrt()
}

fn random_case(index: u64) -> Case {
    let mut draw = Draw(0x5eed_0000 + index * 7919);
    let fleet = fleet::all();
    let mut vehicle = fleet[draw.below(fleet.len())].clone();
    let as_catalogued = draw.one_in(2);
    if !as_catalogued {
        vehicle.tracking_tolerance_m = draw.between(0.0, 0.4);
        vehicle.units.iter_mut().for_each(|unit| unit.sway_rad = draw.between(0.0, 0.8).to_radians());
    }
    let radius = match index % 4 {
        0 | 1 => draw.log_between(150.0, 600.0),
        2 => draw.log_between(60.0, 150.0),
        _ => draw.log_between(15.0f64.max(1.25 * tightest_m(&vehicle) + 3.0), 60.0),
    };
    let mut bends = draw::bends(&mut draw, radius, (2.0 * vehicle.length_m).clamp(80.0, 160.0) + radius.min(100.0));
    // Both ends are straight over the length of the vehicle, so the plan has no slope where it stops: a certificate
    // says nothing beyond the plan's ends.
    bends.insert(0, (25.0, 0.0));
    bends.push((vehicle.length_m + 20.0, 0.0));
    let low = 0.5 * vehicle.width_m() + 0.3;
    let high = low + 1.5 + tightest_m(&vehicle).powi(2) / (2.0 * radius);
    let corridor = draw::corridor(&mut draw, &bends, low, high);
    Case {
        name: format!("random {index}: {} at {radius:.0} m", vehicle.id),
        radius_m: radius,
        as_catalogued,
        vehicle,
        corridor,
        seed: index,
    }
}

/// A straight, a turn of `degrees` at `radius`, a straight; with `bend_back` then the same to the other side.
fn turn(radius: f64, degrees: f64, transition: f64, bend_back: bool) -> Bends {
    let arc = (degrees.to_radians() * radius - transition).max(1.0);
    let mut bends = vec![(15.0, 0.0), (transition, 1.0 / radius), (arc, 1.0 / radius)];
    if bend_back {
        bends.extend([(2.0 * transition, -1.0 / radius), (arc, -1.0 / radius)]);
    }
    bends.extend([(transition, 0.0), (45.0, 0.0)]);
    bends
}

fn hard_cases() -> Vec<Case> {
    let kinds = [
        ("AU-BTRIPLE36", 20.0, 270.0),
        ("US-WB109D", 20.0, 90.0),
        ("US-WB109D", 20.0, 150.0),
        ("EU-EMS25-C", 12.5, 120.0),
        ("EU-EMS25-C", 12.5, 270.0),
        ("AU-ATRIPLE53", 25.0, 270.0),
        ("AIRPORT-TUG5", 12.0, 180.0),
        ("AIRPORT-TUG5", 9.0, 90.0),
        ("AGV-TUG4", 6.0, 180.0),
        ("BUS-BIART24", 15.0, 180.0),
        ("EU-CAT18.75", 12.5, 180.0),
    ];
    let tolerances = [(0.15, 0.2), (0.5, 1.0), (0.3, 0.0), (0.0, 1.0)];
    let mut cases = Vec::new();
    for (k, &(id, radius, degrees)) in kinds.iter().enumerate() {
        for (j, &(tolerance, sway)) in tolerances.iter().enumerate() {
            for (transition, bend_back) in [(1.0, false), (8.0, false), (5.0, true)] {
                let mut vehicle = fleet::vehicle(id);
                vehicle.tracking_tolerance_m = tolerance;
                vehicle.units.iter_mut().for_each(|u| u.sway_rad = f64::to_radians(sway));
                let seed = (100 * k + 10 * j) as u64;
                let mut draw = Draw(seed + 17);
                let bends = turn(radius, degrees, transition, bend_back);
                // Wide enough for the vehicle with its offtracking. If a vehicle does not fit even undisturbed, no
                // bound better than the filter's is sought.
                let low = 0.5 * vehicle.width_m() + 1.0 + tightest_m(&vehicle).powi(2) / (2.0 * radius);
                let corridor = draw::corridor(&mut draw, &bends, low, low + 3.0);
                let shape = if bend_back { "S-bend" } else { "turn" };
                let name = format!(
                    "{id}, {degrees}° {shape} at {radius} m, transition {transition} m, ε {tolerance} σ {sway}°"
                );
                cases.push(Case { name, radius_m: radius, as_catalogued: false, vehicle, corridor, seed });
            }
        }
    }
    cases
}

fn percentile(sorted: &[f64], p: f64) -> f64 {
    sorted[((sorted.len() - 1) as f64 * p).round() as usize]
}

/// Prints the distribution of the gap in one class of radii and returns its median.
fn report(name: &str, verdicts: &[&Verdict]) -> f64 {
    let mut gaps: Vec<f64> = verdicts.iter().map(|v| v.gap_m()).collect();
    gaps.sort_by(f64::total_cmp);
    let mut first: Vec<f64> = verdicts.iter().map(|v| v.outcome.first_order_m - v.claim.rsc_m).collect();
    first.sort_by(f64::total_cmp);
    println!(
        "{name}: {} cases, gap median {:.1} mm, 5 % {:.1}, 95 % {:.1}, least {:.2}; to the first-order bound: median {:.1} mm",
        gaps.len(),
        1e3 * percentile(&gaps, 0.5),
        1e3 * percentile(&gaps, 0.05),
        1e3 * percentile(&gaps, 0.95),
        1e3 * gaps[0],
        1e3 * percentile(&first, 0.5),
    );
    percentile(&gaps, 0.5)
}

fn assert_sound(verdicts: &[Verdict]) {
    let broken: Vec<String> = verdicts.iter().filter(|v| v.gap_m() < -ALLOWANCE_M).map(Verdict::line).collect();
    assert!(broken.is_empty(), "{} of {} claims refuted:\n{}", broken.len(), verdicts.len(), broken.join("\n"));
    let hinges: Vec<String> = verdicts
        .iter()
        .filter(|v| v.outcome.hinge.0 < v.claim.hinge_margin_rad - 1e-6)
        .map(|v| format!("{}: margin {} met {:?}", v.name, v.claim.hinge_margin_rad, v.outcome.hinge))
        .collect();
    assert!(hinges.is_empty(), "{} hinge margins refuted:\n{}", hinges.len(), hinges.join("\n"));
}

#[test]
fn no_disturbance_within_the_bounds_comes_closer_than_rsc_on_random_corridors() {
    let cases = 1_040;
    let verdicts: Vec<Verdict> = (0..cases).into_par_iter().filter_map(|k| random_case(k).run()).collect();
    println!("{} of {cases} corridors have a finite RSC", verdicts.len());
    let class = |low: f64, high: f64, all: bool| -> Vec<&Verdict> {
        let wanted = |v: &&Verdict| (low..high).contains(&v.radius_m) && (all || v.as_catalogued);
        verdicts.iter().filter(wanted).collect()
    };
    report("150 m and more, any tolerances", &class(150.0, f64::INFINITY, true));
    report("60 to 150 m, any tolerances", &class(60.0, 150.0, true));
    report("under 60 m, any tolerances", &class(0.0, 60.0, true));
    let wide = report("150 m and more, the catalogue's tolerances", &class(150.0, f64::INFINITY, false));
    let middle = report("60 to 150 m, the catalogue's tolerances", &class(60.0, 150.0, false));
    report("under 60 m, the catalogue's tolerances", &class(0.0, 60.0, false));
    assert_sound(&verdicts);
    assert!(verdicts.len() >= 1_000, "only {} corridors could be tried", verdicts.len());
    assert!(wide < 0.02, "the median gap at 150 m and more is {wide} m");
    assert!(middle < 0.06, "the median gap at 60 to 150 m is {middle} m");
}

#[test]
fn no_disturbance_within_the_bounds_comes_closer_than_rsc_in_the_hard_cases() {
    let cases = hard_cases();
    let verdicts: Vec<Verdict> = cases.par_iter().filter_map(Case::run).collect();
    println!("{} of {} hard cases have a finite RSC", verdicts.len(), cases.len());
    for verdict in &verdicts {
        println!("{}", verdict.line());
    }
    report("hard cases", &verdicts.iter().collect::<Vec<_>>());
    assert_sound(&verdicts);
    // For the others (half a metre of tolerance with a degree of slip, round the tightest turns) the recursion of the
    // bounds does not close. The verdict is then `unsafe`, reason articulation, and there is no claim to refute. These
    // were one in five before the bound of a heading included R1.
    assert!(verdicts.len() * 5 >= cases.len() * 3, "only {} hard cases could be tried", verdicts.len());
}
