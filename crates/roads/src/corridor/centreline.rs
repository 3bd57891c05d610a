//! Corridors from a centreline given in metres: drawn, planned or surveyed.
//!
//! With a tolerance of 0 the cubic spline through the points is the C¹ centreline. Otherwise the points are smoothed
//! like a map's line. Half-widths are linear between points, and between stations never more than that.

use super::polyline::Polyline;
use super::profile::Profile;
use super::resample::{ArcLength, Curve, EdgedCurve, MOST_STATIONS};
use super::smooth::{Smoothing, smooth};
use super::spline::Interpolant;
use super::{Corridor, Params};

/// Why a given centreline cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CentrelineError {
    /// A value that cannot be used.
    #[error("{field}: {message}")]
    Value {
        /// Field, with its index: `points[3]`.
        field: String,
        /// The value, and what is expected.
        message: String,
    },
    /// No curve stays within the tolerance.
    #[error(
        "no smooth line stays within {tolerance_m} m of the points: {worst_m:.2} m off; allow more, or take out the kink"
    )]
    Kink {
        /// Asked for, metres.
        tolerance_m: f64,
        /// Reached, metres.
        worst_m: f64,
    },
}

impl CentrelineError {
    pub(crate) fn value(field: impl Into<String>, message: impl Into<String>) -> Self {
        Self::Value { field: field.into(), message: message.into() }
    }
}

/// Points closer than this are the same, metres.
const LEAST_STEP_M: f64 = 0.01;
/// Shortest corridor, metres.
const LEAST_LENGTH_M: f64 = 2.0;
/// Largest turn from one point of a C¹ centreline to the next, radians: a radius of 6 m with points 3 m apart.
const MOST_TURN_RAD: f64 = 0.6;

/// Builds a corridor along `points` (metres) with half-widths `left` and `right` (metres, > 0, one per point or a
/// single one). With `tolerance_m` 0 the points are the centreline, otherwise it may be that far from them. Stations
/// are about `spacing_m` apart.
///
/// Errors name the point that is not finite, coincides with the previous one, or makes a kink. A line has at most 50 million stations.
pub fn from_centreline(
    points: &[[f64; 2]],
    left: &[f64],
    right: &[f64],
    tolerance_m: f64,
    spacing_m: f64,
) -> Result<Corridor, CentrelineError> {
    check_number("smoothing_tolerance_m", tolerance_m, 0.0..=100.0)?;
    check_number("spacing_m", spacing_m, 0.05..=100.0)?;
    let line = checked_line(points)?;
    check_stations(line.length(), spacing_m)?;
    let left = checked_widths("left_m", left, points.len())?;
    let right = checked_widths("right_m", right, points.len())?;
    if tolerance_m > 0.0 {
        let smoothed = smooth(&line, Smoothing { tolerance_m, cutoff_m: Params::default().cutoff_m });
        let worst_m = smoothed.deviation_m(0.0, line.length());
        if worst_m > tolerance_m {
            return Err(CentrelineError::Kink { tolerance_m, worst_m });
        }
        return sampled(&line, &smoothed.curve, &left, &right, spacing_m);
    }
    check_turns(&line)?;
    let curve = Interpolant::through(&line.points, &line.at);
    sampled(&line, &curve, &left, &right, spacing_m)
}

fn check_number(field: &str, value: f64, range: std::ops::RangeInclusive<f64>) -> Result<(), CentrelineError> {
    if range.contains(&value) {
        return Ok(());
    }
    let message = format!("{value} is not in {}..={}", range.start(), range.end());
    Err(CentrelineError::value(field, message))
}

fn checked_line(points: &[[f64; 2]]) -> Result<Polyline, CentrelineError> {
    let mut line = Polyline::default();
    for (i, &[x, y]) in points.iter().enumerate() {
        let field = || format!("points[{i}]");
        if !(x.abs() < 1e8 && y.abs() < 1e8) {
            return Err(CentrelineError::value(field(), format!("[{x}, {y}] is not a place in metres")));
        }
        let before = line.length();
        if line.push([x, y]) - before < LEAST_STEP_M && i > 0 {
            return Err(CentrelineError::value(field(), "the same place as the point before; leave it out"));
        }
    }
    if line.length() < LEAST_LENGTH_M {
        let message =
            format!("{} points over {:.2} m; expected at least 2 over {LEAST_LENGTH_M} m", points.len(), line.length());
        return Err(CentrelineError::value("points", message));
    }
    Ok(line)
}

/// A longer line has a mistaken point. Its corridor would not fit into memory.
fn check_stations(length_m: f64, spacing_m: f64) -> Result<(), CentrelineError> {
    let most_m = MOST_STATIONS * spacing_m.min(1.0);
    if length_m <= most_m {
        return Ok(());
    }
    let message = format!(
        "{:.0} km long, and at most {:.0} km have stations {spacing_m} m apart; correct the points, cut the line, or give a larger spacing_m",
        length_m / 1e3,
        most_m / 1e3
    );
    Err(CentrelineError::value("points", message))
}

fn checked_widths(field: &str, widths: &[f64], points: usize) -> Result<Vec<f64>, CentrelineError> {
    if widths.len() != 1 && widths.len() != points {
        let message = format!("{} values for {points} points; expected one number, or one per point", widths.len());
        return Err(CentrelineError::value(field, message));
    }
    if let Some(i) = widths.iter().position(|w| !(*w > 0.0 && *w < 1e4)) {
        let field = if widths.len() == 1 { field.to_owned() } else { format!("{field}[{i}]") };
        return Err(CentrelineError::value(
            field,
            format!("{} is not a width in metres; expected more than 0", widths[i]),
        ));
    }
    Ok(if widths.len() == 1 { vec![widths[0]; points] } else { widths.to_vec() })
}

fn check_turns(line: &Polyline) -> Result<(), CentrelineError> {
    for i in 1..line.points.len() - 1 {
        let (a, b) = (line.direction(i - 1), line.direction(i));
        let turn = (a[0] * b[1] - a[1] * b[0]).atan2(a[0] * b[0] + a[1] * b[1]);
        if turn.abs() > MOST_TURN_RAD {
            let message = format!(
                "the line turns by {:.0}° here, which no C¹ centreline sampled closely enough does; \
                 give more points, or a smoothing_tolerance_m above 0",
                turn.to_degrees()
            );
            return Err(CentrelineError::value(format!("points[{i}]"), message));
        }
    }
    Ok(())
}

fn sampled(
    line: &Polyline,
    curve: &impl Curve,
    left: &[f64],
    right: &[f64],
    spacing_m: f64,
) -> Result<Corridor, CentrelineError> {
    // The curve itself is the centreline. Its edges follow below.
    let profile = Profile { knot_m: line.length(), coefficients: vec![[1.0, -1.0, 0.0]; 4] }.cubics();
    let track = EdgedCurve { curve, profile: &profile };
    let (mut corridor, arc) = track.resample(0.0, line.length(), spacing_m);
    corridor.left_m = below(&line.at, left, &arc, &corridor);
    corridor.right_m = below(&line.at, right, &arc, &corridor);
    let folds = (0..corridor.len()).find(|&i| {
        let k = corridor.curvature[i];
        !k.is_finite() || k * corridor.left_m[i] >= 1.0 || -k * corridor.right_m[i] >= 1.0
    });
    if let Some(i) = folds {
        let message = format!(
            "the bend {:.0} m from the start has a radius of {:.2} m, less than the corridor is wide on its inside",
            i as f64 * corridor.spacing_m,
            1.0 / corridor.curvature[i].abs()
        );
        return Err(CentrelineError::value("points", message));
    }
    Ok(corridor)
}

/// Widths at stations whose linear interpolation stays below the given widths. Where a given point between two stations
/// is narrower than the line between them, both stations are lowered.
fn below(at: &[f64], widths: &[f64], arc: &ArcLength, corridor: &Corridor) -> Vec<f64> {
    let last = corridor.len() - 1;
    let mut hint = 0;
    let parameters: Vec<f64> = (0..=last).map(|i| arc.parameter(i as f64 * corridor.spacing_m, &mut hint)).collect();
    let on_line: Vec<f64> = parameters.iter().map(|&u| linear(at, widths, u)).collect();
    let mut out = on_line.clone();
    for (&u, &width) in at.iter().zip(widths) {
        let i = parameters.partition_point(|&p| p <= u).clamp(1, last);
        let share = ((u - parameters[i - 1]) / (parameters[i] - parameters[i - 1])).clamp(0.0, 1.0);
        let between = on_line[i - 1] + share * (on_line[i] - on_line[i - 1]);
        for j in [i - 1, i] {
            out[j] = out[j].min(on_line[j] - (between - width).max(0.0)).max(0.5 * width.min(on_line[j]));
        }
    }
    out
}

/// Piecewise linear interpolation, constant beyond the ends.
fn linear(at: &[f64], values: &[f64], u: f64) -> f64 {
    let i = at.partition_point(|&a| a <= u).clamp(1, at.len() - 1);
    let t = ((u - at[i - 1]) / (at[i] - at[i - 1])).clamp(0.0, 1.0);
    values[i - 1] + t * (values[i] - values[i - 1])
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn circle(radius: f64, step_m: f64, n: u32) -> Vec<[f64; 2]> {
        (0..n)
            .map(|i| (f64::from(i) * step_m / radius).sin_cos())
            .map(|(s, c)| [radius * s, radius * (1.0 - c)])
            .collect()
    }

    #[test]
    fn a_given_circle_keeps_its_radius_to_its_ends() {
        for (radius, step) in [(12.0, 1.0), (12.0, 2.0), (80.0, 5.0)] {
            let c = from_centreline(&circle(radius, step, 60), &[3.0], &[2.0], 0.0, 1.0).unwrap();
            assert!((c.spacing_m * (c.len() - 1) as f64 - 59.0 * step).abs() < 0.01);
            for i in 0..c.len() {
                assert!((c.curvature[i] * radius - 1.0).abs() < 0.025, "{radius} {i}: {}", c.curvature[i]);
                assert!((c.heading[i] - i as f64 * c.spacing_m / radius).abs() < 0.002);
                assert!((c.x[i].hypot(c.y[i] - radius) - radius).abs() < 0.001);
                assert!(c.left_m[i] == 3.0 && c.right_m[i] == 2.0);
            }
        }
    }

    #[test]
    fn smoothing_a_given_line_rounds_its_corner_within_the_tolerance() {
        let points = [[0.0, 0.0], [100.0, 0.0], [190.0, 40.0]];
        let c = from_centreline(&points, &[3.0], &[3.0], 1.0, 1.0).unwrap();
        let sharpest = c.curvature.iter().fold(0.0_f64, |m, k| m.max(k.abs()));
        // The arc of 24° that cuts the corner by 1 m is 45 m long. Swinging out before the corner makes it wider.
        assert!(sharpest < 1.0 / 45.0, "{sharpest}");
    }

    #[test]
    fn widths_between_stations_are_never_more_than_given() {
        let points: Vec<[f64; 2]> = (0..40).map(|i| [1.3 * f64::from(i), 0.0]).collect();
        let widths: Vec<f64> = (0..40).map(|i| 2.0 + f64::from(i * i * 7 % 11) * 0.1).collect();
        let c = from_centreline(&points, &widths, &[2.0], 0.0, 1.0).unwrap();
        for i in 0..=500 {
            let s = 0.1 * f64::from(i);
            let (k, t) = ((s / c.spacing_m) as usize, (s / c.spacing_m).fract());
            let ours = c.left_m[k] + t * (c.left_m[(k + 1).min(c.len() - 1)] - c.left_m[k]);
            let at: Vec<f64> = points.iter().map(|p| p[0]).collect();
            assert!(ours <= linear(&at, &widths, s) + 1e-6, "{s}: {ours}");
        }
    }

    /// Without the limit the second line has 4e9 stations.
    #[test]
    fn a_line_of_too_many_stations_is_refused() {
        let ends = [[-9e7, 0.0], [9e7, 0.0]];
        for (tolerance_m, spacing_m) in [(0.0, 1.0), (0.0, 0.05), (1.0, 100.0)] {
            let refused = from_centreline(&ends, &[3.0], &[3.0], tolerance_m, spacing_m).unwrap_err().to_string();
            assert!(refused.starts_with("points: 180000 km long, and at most "), "{refused}");
        }
        assert_eq!(check_stations(5e7, 1.0), Ok(()));
        assert_eq!(check_stations(2e7, 0.5), Ok(()));
        assert!(check_stations(2e7, 0.25).is_err() && check_stations(f64::NAN, 1.0).is_err());
    }

    #[test]
    fn what_is_no_centreline_is_refused_by_name() {
        let refused = |points: &[[f64; 2]], left: &[f64], tolerance: f64| {
            from_centreline(points, left, &[2.0], tolerance, 1.0).unwrap_err().to_string()
        };
        let corner = [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0]];
        assert!(refused(&corner, &[2.0], 0.0).starts_with("points[1]: the line turns by 90°"));
        assert!(refused(&corner, &[2.0, 2.0], 0.5).starts_with("left_m: 2 values for 3 points"));
        assert!(refused(&corner, &[2.0, -1.0, 2.0], 0.5).starts_with("left_m[1]: -1 is not a width"));
        assert!(refused(&corner, &[2.0], -1.0).starts_with("smoothing_tolerance_m: -1"));
        assert!(refused(&[[0.0, 0.0], [0.0, 0.0], [9.0, 0.0]], &[2.0], 0.5).starts_with("points[1]: the same place"));
        assert!(refused(&[[0.0, 0.0], [f64::NAN, 0.0]], &[2.0], 0.5).starts_with("points[1]: [NaN, 0]"));
        assert!(refused(&[[0.0, 0.0]], &[2.0], 0.5).starts_with("points: 1 points over 0.00 m"));
        assert!(refused(&circle(4.0, 1.0, 30), &[5.0], 0.0).contains("less than the corridor is wide"));
    }
}
