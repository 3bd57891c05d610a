//! The paths with which the search for a turn's path begins. They leave one centreline at some distance before the place
//! where the two would meet, and join the other at some distance after it; both distances vary. They follow the
//! centrelines, or swing out to the far side before and after the turn, as drivers of long vehicles do.

use super::arms::Arms;
use super::code::{PathCode, PathShape};

/// Distances from the place where the two lines meet, metres. A turn of 90° that takes 12 m of each line has a radius
/// of about 10 m.
const FROM_CORNER_M: [f64; 9] = [4.0, 6.0, 8.5, 11.5, 15.0, 19.0, 24.0, 31.0, 40.0];
/// Swings to the outside before and after the turn, as shares of the room there. Each comes with the largest difference
/// between approach and departure (in entries of the list above).
const SWINGS: [([f64; 2], usize); 5] =
    [([0.0, 0.0], 1), ([1.0, 1.0], 1), ([0.5, 0.5], 0), ([1.0, 0.0], 0), ([0.0, 1.0], 0)];
/// Candidates for entering and leaving a roundabout: share of the room on the road's side, and the range of distances.
const FEW: [(f64, std::ops::Range<usize>); 2] = [(0.0, 1..8), (1.0, 2..6)];
/// Upper bound of the number of candidates in `FEW`.
pub(super) const FEW_NUMBERS: usize = 15;
/// Room kept beside the path on the outside of a swing, metres: half a vehicle's width and the swing of its front.
const OUTSIDE_M: f64 = 1.9;
/// Smallest swing, metres.
const LEAST_SWING_M: f64 = 0.15;
/// Length over which a path swings out before the turn, and back after it, metres.
const SWING_M: [f64; 2] = [16.0, 22.0];
/// Distances before and after the node over which lanes shift, metres.
const SHIFTS_M: [f64; 4] = [10.0, 20.0, 35.0, 55.0];
/// Share of the angle that each transition takes.
const SHARES: [f64; 2] = [0.2, 0.425];
/// Paths at greater angles are never lane shifts, radians.
const MOST_SHIFT_RAD: f64 = 1.0;

/// The codes with which the search begins, without repetitions.
pub(super) fn seeds(arms: &Arms) -> Vec<PathCode> {
    let mut shapes = Vec::new();
    for (swing, unlike) in SWINGS {
        for (i, before_m) in FROM_CORNER_M.into_iter().enumerate() {
            for (j, after_m) in FROM_CORNER_M.into_iter().enumerate().filter(|(j, _)| i.abs_diff(*j) <= unlike) {
                shapes.push(swung(arms, [before_m, after_m], swing, SHARES[0]));
                if i == j && swing == [0.0, 0.0] {
                    shapes.push(swung(arms, [before_m, after_m], swing, SHARES[1]));
                }
            }
        }
    }
    if arms.turn_rad().abs() < MOST_SHIFT_RAD {
        for before_m in SHIFTS_M {
            shapes.extend(SHIFTS_M.map(|after_m| shifted([before_m, after_m])));
        }
    }
    let mut known = Vec::new();
    let mut codes = Vec::new();
    for shape in shapes {
        let code = PathCode::nearest(&shape);
        let shape = code.shape();
        let key = (arms.corner(&shape), shape.aside_m, shape.shares);
        if !known.contains(&key) {
            known.push(key);
            codes.push(code);
        }
    }
    codes
}

/// An end of a roundabout's passage.
#[derive(Clone, Copy)]
pub(super) enum RingEnd {
    Entry,
    Exit,
}

/// The few shapes at one end of a roundabout's passage, by number. The ring bends away
/// from the turn, so its tangent meets the road farther from the node than the path touches the ring. On the road's
/// side the next larger distance is therefore used.
pub(super) fn few(arms: &Arms, end: RingEnd) -> Vec<PathShape> {
    let sides = |road_m: f64, ring_m: f64| match end {
        RingEnd::Entry => [road_m, ring_m],
        RingEnd::Exit => [ring_m, road_m],
    };
    let mut shapes = Vec::new();
    for (swing, places) in FEW {
        for w in FROM_CORNER_M[places].windows(2) {
            shapes.push(swung(arms, sides(w[1], w[0]), sides(swing, 0.0), SHARES[0]));
        }
    }
    shapes.extend(SHIFTS_M[..2].iter().map(|m| shifted([*m; 2])));
    shapes
}

/// A path that takes the given shares of the room on the outside.
fn swung(arms: &Arms, from_corner_m: [f64; 2], swing: [f64; 2], share: f64) -> PathShape {
    let mut shape = PathShape { shares: Some([share; 2]), ..shifted(from_corner_m) };
    let (corner, turn_rad) = (arms.corner(&shape), arms.turn_rad());
    for (i, arm) in [&arms.from, &arms.to].into_iter().enumerate() {
        // In a right turn the outside is to the left of travel.
        let outside = arm.wide(corner[i].round() as usize)[usize::from(turn_rad >= 0.0)];
        let aside_m = (outside - OUTSIDE_M).max(0.0) * swing[i];
        shape.aside_m[i] = if aside_m < LEAST_SWING_M { 0.0 } else { -turn_rad.signum() * aside_m };
    }
    shape
}

fn shifted(from_corner_m: [f64; 2]) -> PathShape {
    PathShape { from_corner_m, shares: None, aside_m: [0.0; 2], swing_m: SWING_M, splay_rad: [0.0; 2] }
}
