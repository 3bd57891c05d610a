//! Measures run time over the number of trailers, and fits a line through each series by least squares, with R².
//!
//! Algorithm 1 runs with 1 to 10 trailers, netcert with as many as [`MAX_UNITS`] allows. The gains that netcert computes
//! once per vehicle are measured separately.

use std::time::Instant;

use anyhow::anyhow;
use netcert::published::{DrawnRoute, Permissible, Reading, Scenario, System, TimedRoute, route_cert};
use netcert::speed_profile::SpeedProfile;
use netcert::stet::{self, MAX_UNITS, Model, Options};
use netcert::stop::Stop;

/// The greatest number of trailers measured.
const TRAILERS: usize = 10;
/// Each time is the least of this many runs, because other work of the machine can only add time.
const RUNS: usize = 7;

/// Seconds by the number of trailers.
pub(super) struct Timing {
    /// Times of Algorithm 1.
    pub(super) paper: Series,
    /// Times of netcert's certificate of the route.
    pub(super) netcert: Series,
    /// Times of netcert's gains, which depend on the vehicle alone.
    pub(super) gains: Series,
}

impl Timing {
    /// The three series with their names.
    pub(super) fn series(&self) -> [(&'static str, &Series); 3] {
        [("Algorithm 1", &self.paper), ("netcert, certificate", &self.netcert), ("netcert, gains", &self.gains)]
    }
}

/// Measured times and the line fitted through them.
pub(super) struct Series {
    /// (trailers, seconds)
    pub(super) points: Vec<(usize, f64)>,
    pub(super) slope_s: f64,
    pub(super) intercept_s: f64,
    pub(super) r_squared: f64,
}

impl Series {
    fn new(points: Vec<(usize, f64)>) -> Self {
        let n = points.len().max(1) as f64;
        let mean = |f: &dyn Fn(&(usize, f64)) -> f64| points.iter().map(f).sum::<f64>() / n;
        let (mx, my) = (mean(&|p| p.0 as f64), mean(&|p| p.1));
        let covariance = mean(&|p| (p.0 as f64 - mx) * (p.1 - my));
        let (vx, vy) = (mean(&|p| (p.0 as f64 - mx).powi(2)), mean(&|p| (p.1 - my).powi(2)));
        let slope_s = if vx > 0.0 { covariance / vx } else { 0.0 };
        let r_squared = if vx * vy > 0.0 { covariance * covariance / (vx * vy) } else { 1.0 };
        Self { points, slope_s, intercept_s: my - slope_s * mx, r_squared }
    }
}

/// Width added on each side, metres. With it no vehicle needs correction, and all runs do the same work.
const ROOM_M: f64 = 10.0;

/// Measures the vehicle and route of scenario 5 with different numbers of trailers.
pub(super) fn measure(table: &[Scenario], route: &DrawnRoute) -> anyhow::Result<Timing> {
    let scenario = table.get(4).ok_or_else(|| anyhow!("data/paper/scenarios.toml: there is no scenario 5"))?;
    let corridor = route.corridor(scenario.w_min_m + ROOM_M);
    let timed = TimedRoute::new(&corridor, &SpeedProfile::default());
    let with = |trailers: usize| System { trailers, ..scenario.system };
    let paper = (1..=TRAILERS).map(|n| {
        let run = || {
            let path = timed.centre.as_slice();
            route_cert(&with(n), &timed, path, &Permissible::default(), &Reading::SIMULATED).map(|r| r.rsc.rsc_m)
        };
        (n, least_s(run))
    });
    let most = TRAILERS.min(MAX_UNITS - 1);
    let (mut netcert, mut gains) = (Vec::new(), Vec::new());
    for n in 1..=most {
        let vehicle = with(n).vehicle("PAPER");
        let model = Model::new(&vehicle)?;
        gains.push((n, least_s(|| Model::new(&vehicle))));
        netcert.push((n, least_s(|| stet::certify(&corridor, &model, &Options::default(), &Stop::never()))));
    }
    Ok(Timing { paper: Series::new(paper.collect()), netcert: Series::new(netcert), gains: Series::new(gains) })
}

fn least_s<T>(run: impl Fn() -> T) -> f64 {
    let time = |_| {
        let start = Instant::now();
        std::hint::black_box(run());
        start.elapsed().as_secs_f64()
    };
    (0..RUNS).map(time).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_found_again() {
        let line = Series::new((1..=10).map(|n| (n, 0.3 + 0.02 * n as f64)).collect());
        assert!((line.slope_s - 0.02).abs() < 1e-12 && (line.intercept_s - 0.3).abs() < 1e-12);
        assert!((line.r_squared - 1.0).abs() < 1e-9);
        let bent = Series::new((1..=10).map(|n| (n, (n * n) as f64)).collect());
        assert!(bent.r_squared > 0.9 && bent.r_squared < 0.97, "{}", bent.r_squared);
    }
}
