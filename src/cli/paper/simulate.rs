//! Runs one scenario: Algorithm 1 with each β, and netcert's certificate for the same vehicle and corridor.

use anyhow::anyhow;
use netcert::corridor::Corridor;
use netcert::published::{Beta, DrawnRoute, Permissible, Reading, RouteCert, Scenario, TimedRoute, route_cert};
use netcert::speed_profile::SpeedProfile;
use netcert::stet::{self, Certificate, Model, Options};
use netcert::stop::Stop;
use netcert::vehicle::Vehicle;

/// netcert's default tolerances of a vehicle: ε in metres, the tolerance of the heading in degrees, σ in degrees, γ_min.
const USUAL: (f64, f64, f64, f64) = (0.15, 3.0, 0.2, 0.3);

/// A scenario and its results.
pub(super) struct Simulated {
    pub(super) scenario: Scenario,
    pub(super) corridor: Corridor,
    pub(super) route: TimedRoute,
    /// Algorithm 1 in the reading nearest to the paper's results.
    pub(super) paper: RouteCert,
    /// Algorithm 1 with β° as printed.
    pub(super) printed_beta: RouteCert,
    /// netcert's certificate without tolerances, as in the paper.
    pub(super) exact: Certificate,
    /// netcert's certificate with its default tolerances.
    pub(super) usual: Certificate,
}

pub(super) fn run(scenario: &Scenario, route: &DrawnRoute) -> anyhow::Result<Simulated> {
    let corridor = route.corridor(scenario.w_min_m);
    let route = TimedRoute::new(&corridor, &SpeedProfile::default());
    let by = |beta| {
        let reading = Reading { beta, ..Reading::SIMULATED };
        route_cert(&scenario.system, &route, &route.centre, &Permissible::default(), &reading)
            .ok_or_else(|| anyhow!("data/paper/route.toml: the route has no station"))
    };
    let (paper, printed_beta) = (by(Beta::TraceOptimal)?, by(Beta::Printed)?);
    let vehicle = scenario.system.vehicle(&format!("PAPER-S{}", scenario.number));
    let exact = decide(&corridor, &vehicle)?;
    let usual = decide(&corridor, &with_usual_tolerances(vehicle))?;
    Ok(Simulated { scenario: *scenario, corridor, route, paper, printed_beta, exact, usual })
}

fn decide(corridor: &Corridor, vehicle: &Vehicle) -> anyhow::Result<Certificate> {
    let certificate = stet::certify(corridor, &Model::new(vehicle)?, &Options::default(), &Stop::never())?;
    certificate.ok_or_else(|| anyhow!("data/paper/route.toml: the route has no station"))
}

fn with_usual_tolerances(mut vehicle: Vehicle) -> Vehicle {
    let (tolerance_m, heading_deg, sway_deg, min_shrink) = USUAL;
    vehicle.tracking_tolerance_m = tolerance_m;
    vehicle.tracking_heading_rad = heading_deg.to_radians();
    vehicle.min_shrink = min_shrink;
    vehicle.units.iter_mut().for_each(|unit| unit.sway_rad = sway_deg.to_radians());
    vehicle
}
