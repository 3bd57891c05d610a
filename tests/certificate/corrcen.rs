//! CORRCEN compared with the best plan: how much RSC its two sweeps leave unused (docs/proof.md).
//!
//! The best plan is found by sequential linear programmes that start from the centreline and are independent of
//! CORRCEN.

mod cases;
mod optimum;
mod problem;

use cases::Case;
use netcert::corridor::Corridor;
use netcert::stet::{self, Certificate, Model, Options, Plan, STEP_M};
use netcert::stop::Stop;
use netcert::vehicle::Vehicle;
use optimum::{Merit, Nominal, optimum};
use problem::{Place, Problem};
use rayon::prelude::*;

use netcert_testing::demo::demo;
use netcert_testing::extracts::extract;

/// Merit by the RSC, with all bounds deducted.
struct Certified<'a> {
    problem: &'a Problem<'a>,
    model: &'a Model,
    /// By unit: deduction of the bounds on a straight, metres.
    straight_m: Vec<f64>,
    /// For the last plan: further deduction of the bounds, by side and station.
    bent_m: [Vec<f64>; 2],
}

impl<'a> Certified<'a> {
    fn new(problem: &'a Problem<'a>, model: &'a Model) -> Self {
        let units = problem.vehicle.units.len();
        let straight_m = (1..=units).map(|count| straight_m(problem.vehicle, count)).collect();
        let bent_m = [vec![0.0; problem.corridor.len()], vec![0.0; problem.corridor.len()]];
        Self { problem, model, straight_m, bent_m }
    }

    fn certificate(&self, coefficients: &[f64]) -> Certificate {
        stet::certify_plan(self.problem.corridor, self.model, &plan(coefficients)).unwrap()
    }
}

impl Merit for Certified<'_> {
    fn worth_m(&mut self, coefficients: &[f64]) -> f64 {
        let certificate = self.certificate(coefficients);
        let places = self.problem.places(&self.problem.drive(coefficients));
        for (side, certified) in [&certificate.left_m, &certificate.right_m].into_iter().enumerate() {
            let mut nominal = vec![f64::INFINITY; certified.len()];
            for place in places.iter().filter(|place| place.side == side) {
                let least = &mut nominal[place.station];
                *least = least.min(place.leeway_m - self.straight_m[place.unit]);
            }
            let off = nominal.iter().zip(certified).map(|(n, c)| if n.is_finite() && *c < 1e6 { n - c } else { 0.0 });
            self.bent_m[side] = off.collect();
        }
        certificate.result.rsc_m.unwrap_or(-1e3)
    }

    fn deducted_m(&self, places: &[Place]) -> Vec<f64> {
        places.iter().map(|p| self.straight_m[p.unit] + self.bent_m[p.side][p.station]).collect()
    }
}

/// Deduction of the bounds on a straight for the first `count` units, each computed as if none followed.
fn straight_m(vehicle: &Vehicle, count: usize) -> f64 {
    let mut ahead = vehicle.clone();
    ahead.units.truncate(count);
    let half_m = 5.0;
    let stations = 150;
    let corridor = Corridor {
        spacing_m: 1.0,
        x: (0..stations).map(f64::from).collect(),
        left_m: vec![half_m; stations as usize],
        right_m: vec![half_m; stations as usize],
        y: vec![0.0; stations as usize],
        heading: vec![0.0; stations as usize],
        curvature: vec![0.0; stations as usize],
        areas: Vec::new(),
    };
    let fixed = Options { max_shift_m: 0.0, correction_sweeps: 0 };
    let certificate = stet::certify(&corridor, &Model::new(&ahead).unwrap(), &fixed, &Stop::never()).unwrap().unwrap();
    half_m - 0.5 * ahead.width_m() - certificate.result.rsc_m.unwrap()
}

fn plan(coefficients: &[f64]) -> Plan {
    Plan { coefficients: coefficients.iter().map(|c| (c / STEP_M).round() as i32).collect() }
}

struct Compared {
    name: String,
    centred_m: f64,
    corrcen_m: f64,
    optimum_m: f64,
    nominal_corrcen_m: f64,
    nominal_optimum_m: f64,
}

/// The corridor widened or narrowed until CORRCEN just fits, where the steering matters. `None` if the vehicle cannot
/// follow the corridor at all.
fn as_needed(corridor: &Corridor, model: &Model, options: &Options) -> Option<Corridor> {
    let mut corridor = corridor.clone();
    for _ in 0..3 {
        let result = stet::certify(&corridor, model, options, &Stop::never()).unwrap().unwrap().result;
        let wider = -result.rsc_m?;
        corridor.left_m.iter_mut().chain(&mut corridor.right_m).for_each(|width| *width = (*width + wider).max(0.5));
    }
    Some(corridor)
}

fn compare(case: &Case) -> Option<Compared> {
    let model = Model::new(&case.vehicle).unwrap();
    let options =
        Options { correction_sweeps: std::env::var("SWEEPS").map_or(2, |s| s.parse().unwrap()), ..Options::default() };
    let corridor = &as_needed(&case.corridor, &model, &options)?;
    let certificate = stet::certify(corridor, &model, &options, &Stop::never()).unwrap().unwrap();
    let own: Vec<f64> = certificate.shift.coefficients.iter().map(|&c| f64::from(c) * STEP_M).collect();
    let problem = Problem::new(corridor, &case.vehicle);
    let centred = vec![0.0; problem.coefficients()];
    let most = options.max_shift_m;
    let (nominal, nominal_optimum_m) = optimum(&problem, &mut Nominal(&problem), &centred, most, 3e-5);
    let mut certified = Certified::new(&problem, &model);
    let (smooth, _) = optimum(&problem, &mut certified, &nominal, most, 1e-3);
    // A second run with a wide trust region: the deductions of the bounds have changed by then.
    let (_, optimum_m) = optimum(&problem, &mut certified, &smooth, most, 1e-4);
    let compared = Compared {
        name: case.name.clone(),
        centred_m: certified.certificate(&centred).result.rsc_m.unwrap_or(-1e3),
        corrcen_m: certificate.result.rsc_m.unwrap_or(-1e3),
        optimum_m,
        nominal_corrcen_m: problem.least_m(&own),
        nominal_optimum_m,
    };
    println!("{}", compared.line());
    // Nothing is claimed where the bounds do not close, and nothing is measured where feet jump.
    (certificate.result.closes() && compared.corrcen_m > -50.0).then_some(compared)
}

impl Compared {
    fn short_m(&self) -> f64 {
        self.optimum_m - self.corrcen_m
    }

    fn nominal_short_m(&self) -> f64 {
        self.nominal_optimum_m - self.nominal_corrcen_m
    }

    fn line(&self) -> String {
        format!(
            "{}: RSC centred {:.3}, CORRCEN {:.3}, optimum {:.3} ({:+.1} cm); nominal {:.3}, {:.3} ({:+.1} cm)",
            self.name,
            self.centred_m,
            self.corrcen_m,
            self.optimum_m,
            1e2 * self.short_m(),
            self.nominal_corrcen_m,
            self.nominal_optimum_m,
            1e2 * self.nominal_short_m(),
        )
    }
}

/// Prints a distribution and returns its median.
fn report(what: &str, mut short_m: Vec<f64>) -> f64 {
    short_m.sort_by(f64::total_cmp);
    let at = |p: f64| short_m[((short_m.len() - 1) as f64 * p).round() as usize];
    println!(
        "{what}, {} corridors: median {:.1} cm, 75 % {:.1}, 95 % {:.1}, least {:.1}",
        short_m.len(),
        1e2 * at(0.5),
        1e2 * at(0.75),
        1e2 * at(0.95),
        1e2 * short_m[0],
    );
    at(0.5)
}

#[test]
fn corrcen_is_within_2_cm_of_the_best_plan_at_the_median() {
    let mut cases: Vec<Case> = (0..36).map(cases::drawn).collect();
    cases.extend(cases::mapped(&demo(), 6));
    cases.extend(extract("heidelberg_de.osm.pbf").iter().flat_map(|file| cases::mapped(file, 12)));
    let compared: Vec<Compared> = cases.par_iter().filter_map(compare).collect();
    report("nominal leeway, optimum less CORRCEN", compared.iter().map(Compared::nominal_short_m).collect());
    let certified = report("RSC, optimum less CORRCEN", compared.iter().map(Compared::short_m).collect());
    report("RSC, optimum less the centreline", compared.iter().map(|c| c.optimum_m - c.centred_m).collect());
    let wrong: Vec<String> =
        compared.iter().filter(|c| c.short_m() < -0.01 || c.nominal_short_m() < -0.01).map(Compared::line).collect();
    assert!(wrong.is_empty(), "not the optimum:\n{}", wrong.join("\n"));
    assert!(compared.len() >= 36, "only {} corridors could be compared", compared.len());
    assert!(certified <= 0.02, "CORRCEN is {certified} m short at the median");
}
