//! Checks that the stations lie on the curve that a certificate assumes (proof, A1): linear curvature leads from each
//! station to the next.

use super::{Corridor, gentle_clothoid_step};

/// Largest distance (metres) and heading difference (radians) between a station and where the station before it leads,
/// per metre of spacing. Sampling a smooth line leaves as much.
const PLACE: f64 = 0.02;
const HEADING: f64 = 0.04;
/// Largest turn of a corridor from one station to the next, radians.
const MOST_TURN_RAD: f64 = 0.5;

impl Corridor {
    /// Returns in ascending order the stations that do not fit their neighbours. Nothing can be certified there.
    #[must_use]
    pub fn torn(&self) -> Vec<usize> {
        let mut torn = Vec::new();
        for k in 0..self.len() {
            if k > 0 && !follows(self, k) {
                torn.extend([k - 1, k]);
            }
            if crosses(self, k) {
                torn.push(k);
            }
        }
        torn.dedup();
        torn
    }
}

/// Whether the normals of neighbouring stations cross within the half-width.
fn crosses(c: &Corridor, k: usize) -> bool {
    !(c.curvature[k] * c.left_m[k] < 1.0 && -c.curvature[k] * c.right_m[k] < 1.0)
}

/// Whether station `k` lies where the station before it leads.
fn follows(c: &Corridor, k: usize) -> bool {
    let (h, before) = (c.spacing_m, k - 1);
    let [from, to] = [c.curvature[before], c.curvature[k]];
    let turn = 0.5 * h * (from + to);
    let sharpest = turn.abs().max(h * to.abs()).max(h * from.abs());
    if sharpest.is_nan() || sharpest > MOST_TURN_RAD {
        return false;
    }
    let turned = c.heading[k] - c.heading[before] - turn;
    let turned = turned - std::f64::consts::TAU * (turned / std::f64::consts::TAU).round();
    let (sin, cos) = c.heading[before].sin_cos();
    let (along, across) = gentle_clothoid_step(h, from, to);
    let (dx, dy) = (cos * along - sin * across, sin * along + cos * across);
    let [off_x, off_y] = [c.x[before] + dx - c.x[k], c.y[before] + dy - c.y[k]];
    turned.abs() <= HEADING * h && off_x * off_x + off_y * off_y <= PLACE * h * (PLACE * h)
}

#[cfg(test)]
mod tests {
    use crate::corridor::{Corridor, CurvatureProfile};

    fn bend() -> Corridor {
        let profile =
            CurvatureProfile::new(0.5).straight(60.0).clothoid(0.02, 10.0).arc(0.02, 20.0).clothoid(0.0, 10.0);
        let profile = profile.straight(60.0);
        Corridor::from_curvature(0.5, [3.0, 4.0], 6.0, &profile.curvature, 5.0, 5.0)
    }

    #[test]
    fn stations_that_follow_from_each_other_are_whole() {
        assert!(bend().torn().is_empty());
    }

    #[test]
    fn where_one_is_aside_or_turned_or_normals_cross_they_are_not() {
        let (mut aside, mut turned, mut crossed) = (bend(), bend(), bend());
        aside.x[150] += 0.02;
        turned.heading[150..].iter_mut().for_each(|heading| *heading += 0.03);
        crossed.curvature[150] = 0.21;
        assert_eq!(aside.torn(), [149, 150, 151]);
        assert_eq!(turned.torn()[..2], [149, 150]);
        assert!(crossed.torn().contains(&150));
    }
}
