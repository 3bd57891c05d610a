//! A route for Table I's scenarios, from `data/paper/route.toml`. It is as long as the paper's route; its shape is
//! netcert's own.

use serde::Deserialize;
use thiserror::Error;

use netcert_base::corridor::Corridor;

const FILE: &str = "data/paper/route.toml";
/// Approximate station spacing, metres. The route's length is a whole number of steps.
const SPACING_M: f64 = 1.0;

/// Why the shipped route cannot be read. This is a fault of the build, not of a user.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum DrawnError {
    /// Unexpected fields.
    #[error("{FILE}: {0}")]
    Syntax(#[from] toml::de::Error),
    /// Pieces or widths that do not make a route.
    #[error("{FILE}: {0}")]
    Shape(&'static str),
}

/// The route's curvature, and its half-width beyond w_min.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DrawnRoute {
    /// Length of the centreline, metres.
    pub length_m: f64,
    piece: Vec<Clothoid>,
    width: Vec<Knot>,
}

/// A piece of linear curvature, from that of the piece before to its own.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Clothoid {
    length_m: f64,
    to_curvature: f64,
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Knot {
    at_m: f64,
    extra_m: f64,
}

/// The shipped route.
///
/// # Errors
/// None with the shipped file.
pub fn drawn_route() -> Result<DrawnRoute, DrawnError> {
    let route: DrawnRoute = toml::from_str(include_str!("../../../../data/paper/route.toml"))?;
    let total: f64 = route.piece.iter().map(|p| p.length_m).sum();
    if !(route.length_m > 1.0 && (total - route.length_m).abs() < 1e-9) {
        return Err(DrawnError::Shape("the pieces' lengths do not add up to length_m"));
    }
    if route.piece.iter().any(|p| !(p.length_m > 0.0 && p.to_curvature.abs() < 0.1)) {
        return Err(DrawnError::Shape("a piece is not longer than 0 or tighter than 10 m"));
    }
    let grows = route.width.windows(2).all(|w| w[1].at_m > w[0].at_m);
    if route.width.len() < 2 || !grows || route.width.iter().any(|k| !(0.0..100.0).contains(&k.extra_m)) {
        return Err(DrawnError::Shape("width needs two knots or more, at_m growing, extra_m from 0 to 100"));
    }
    Ok(route)
}

impl DrawnRoute {
    /// The corridor with half-widths of at least `w_min_m` (metres), equal on both sides. Its last station stands
    /// exactly `length_m` from the first.
    #[must_use]
    pub fn corridor(&self, w_min_m: f64) -> Corridor {
        let steps = (self.length_m / SPACING_M).round().max(1.0);
        let spacing_m = self.length_m / steps;
        let places: Vec<f64> = (0..=steps as usize).map(|k| k as f64 * spacing_m).collect();
        let curvature: Vec<f64> = places.iter().map(|&s| self.curvature(s)).collect();
        let half: Vec<f64> = places.iter().map(|&s| w_min_m + self.extra_m(s)).collect();
        let line = Corridor::from_curvature(spacing_m, [0.0; 2], 0.0, &curvature, w_min_m, w_min_m);
        Corridor { left_m: half.clone(), right_m: half, ..line }
    }

    fn curvature(&self, s: f64) -> f64 {
        let (mut from, mut kappa) = (0.0, 0.0);
        for piece in &self.piece {
            if s <= from + piece.length_m {
                return kappa + (piece.to_curvature - kappa) * (s - from) / piece.length_m;
            }
            from += piece.length_m;
            kappa = piece.to_curvature;
        }
        kappa
    }

    fn extra_m(&self, s: f64) -> f64 {
        for pair in self.width.windows(2) {
            let t = (s - pair[0].at_m) / (pair[1].at_m - pair[0].at_m);
            if t <= 1.0 {
                let t = t.max(0.0);
                return pair[0].extra_m + (pair[1].extra_m - pair[0].extra_m) * t * t * (3.0 - 2.0 * t);
            }
        }
        self.width.last().map_or(0.0, |knot| knot.extra_m)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn the_route_is_as_long_as_the_papers_and_reaches_w_min() {
        let corridor = drawn_route().unwrap().corridor(7.984);
        let length = (corridor.len() - 1) as f64 * corridor.spacing_m;
        assert!((length - 543.62).abs() < 1e-9, "{length}");
        assert_eq!(corridor.left_m.iter().copied().fold(f64::INFINITY, f64::min), 7.984);
        assert_eq!(corridor.left_m, corridor.right_m);
    }

    #[test]
    fn it_bends_both_ways_without_kinks_in_line_or_width() {
        let route = drawn_route().unwrap();
        let fine = |f: &dyn Fn(f64) -> f64| (0..54362).map(|i| f(0.01 * f64::from(i))).collect::<Vec<_>>();
        let curvature = fine(&|s| route.curvature(s));
        assert!(curvature.iter().any(|&k| k > 0.01) && curvature.iter().any(|&k| k < -0.01));
        assert!(curvature.windows(2).all(|w| (w[1] - w[0]).abs() < 1e-5), "heading is C¹, curvature continuous");
        let slope: Vec<f64> = fine(&|s| route.extra_m(s)).windows(2).map(|w| (w[1] - w[0]) / 0.01).collect();
        assert!(slope.windows(2).all(|w| (w[1] - w[0]).abs() < 2e-4), "the width's slope is continuous");
    }
}
