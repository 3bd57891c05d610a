//! Blends two turns that share a stretch of road: from the path of the first turn into the path of the second, within the width
//! of both.
//!
//! Everything is measured across the stroke between the turns. For a path at an angle to the stroke, half-widths are multiplied
//! by the cosine of the angle, which never makes them too wide.

/// A point of the centreline with the half-widths there.
#[derive(Debug, Clone, Copy)]
pub(super) struct BlendPoint {
    pub(super) at: [f64; 2],
    pub(super) left_m: f64,
    pub(super) right_m: f64,
}

/// The greatest distance of a path from the stroke at which it is blended, metres.
const FARTHEST_M: f64 = 6.0;
/// The cosine of the greatest angle between a path and the stroke at which the path is blended.
const LEAST_COSINE: f64 = 0.82;
/// The least half-width of a blended stretch, metres.
const LEAST_HALF_WIDTH_M: f64 = 0.2;

/// The blended stretch, and the points of the turns that it replaces.
pub(super) struct Blended {
    pub(super) samples: Vec<BlendPoint>,
    /// Number of points to drop at the end of the turn before.
    pub(super) dropped_before: usize,
    /// Number of points to drop at the beginning of the turn after.
    pub(super) dropped_after: usize,
}

/// The crossing of a path with the normal of a station.
#[derive(Clone, Copy)]
struct Crossing {
    /// Offset to the left of the stroke's centreline, metres.
    offset_m: f64,
    left_m: f64,
    right_m: f64,
    /// Cosine of the angle between path and stroke.
    cosine: f64,
    /// Index of the path's point before the crossing.
    index: usize,
}

/// Blends two paths along a stroke. `before` ends at the last of the stroke's points, `after` begins at the first. `None` if the
/// paths cannot be blended.
pub(super) fn blend(before: &[BlendPoint], after: &[BlendPoint], stroke: &[BlendPoint]) -> Option<Blended> {
    let last = stroke.len().checked_sub(1).filter(|&last| last > 0)?;
    let mut samples = Vec::with_capacity(stroke.len());
    let (mut kept_before, mut dropped_after) = (0, 0);
    for k in 0..=last {
        let tangent = direction(stroke, k)?;
        let a = crossing(before, stroke[k].at, tangent)?;
        let b = crossing(after, stroke[k].at, tangent)?;
        if k == 0 {
            kept_before = a.index + 1;
        }
        dropped_after = b.index + 1;
        let weight = smooth(k as f64 / last as f64);
        let offset_m = a.offset_m + weight * (b.offset_m - a.offset_m);
        let high = (a.offset_m + a.left_m).min(b.offset_m + b.left_m);
        let low = (a.offset_m - a.right_m).max(b.offset_m - b.right_m);
        let cosine = a.cosine.min(b.cosine);
        let (left_m, right_m) = ((high - offset_m) * cosine, (offset_m - low) * cosine);
        if !(left_m > LEAST_HALF_WIDTH_M && right_m > LEAST_HALF_WIDTH_M) {
            return None;
        }
        let [x, y] = stroke[k].at;
        samples.push(BlendPoint { at: [x - offset_m * tangent[1], y + offset_m * tangent[0]], left_m, right_m });
    }
    Some(Blended { samples, dropped_before: before.len() - kept_before, dropped_after })
}

fn direction(points: &[BlendPoint], k: usize) -> Option<[f64; 2]> {
    let (a, b) = (points[k.saturating_sub(1)].at, points[(k + 1).min(points.len() - 1)].at);
    let u = [b[0] - a[0], b[1] - a[1]];
    let length = u[0].hypot(u[1]);
    (length > 0.0).then(|| [u[0] / length, u[1] / length])
}

/// The crossing of a path with the normal at `at` that is nearest to `at`.
fn crossing(path: &[BlendPoint], at: [f64; 2], tangent: [f64; 2]) -> Option<Crossing> {
    let local = |p: &BlendPoint| {
        let d = [p.at[0] - at[0], p.at[1] - at[1]];
        [d[0] * tangent[0] + d[1] * tangent[1], d[1] * tangent[0] - d[0] * tangent[1]]
    };
    // Some slack, so that a path that begins or ends on this normal crosses it.
    const SLACK_M: f64 = 1e-3;
    let mut best: Option<Crossing> = None;
    for (index, pair) in path.windows(2).enumerate() {
        let [p, q] = [local(&pair[0]), local(&pair[1])];
        if !(p[0] <= SLACK_M && q[0] >= -SLACK_M && q[0] > p[0]) {
            continue;
        }
        let share = (-p[0] / (q[0] - p[0])).clamp(0.0, 1.0);
        let offset_m = p[1] + share * (q[1] - p[1]);
        let cosine = (q[0] - p[0]) / (q[0] - p[0]).hypot(q[1] - p[1]);
        if offset_m.abs() > FARTHEST_M
            || cosine < LEAST_COSINE
            || best.is_some_and(|b| b.offset_m.abs() <= offset_m.abs())
        {
            continue;
        }
        let left_m = pair[0].left_m.min(pair[1].left_m);
        let right_m = pair[0].right_m.min(pair[1].right_m);
        best = Some(Crossing { offset_m, left_m, right_m, cosine, index });
    }
    best
}

/// The quintic from 0 to 1 whose first and second derivatives are 0 at both ends.
fn smooth(t: f64) -> f64 {
    t * t * t * (10.0 + t * (6.0 * t - 15.0))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    /// A path along x with the given offset to the left at each metre.
    fn path(offset_m: impl Fn(f64) -> f64, [left_m, right_m]: [f64; 2]) -> Vec<BlendPoint> {
        let metres = (0..=20).map(f64::from);
        metres.map(|x| BlendPoint { at: [x, offset_m(x)], left_m, right_m }).collect()
    }

    #[test]
    fn a_blend_begins_on_the_one_path_ends_on_the_other_and_is_nowhere_wider_than_either() {
        let before = path(|x| 1.0 - x / 20.0, [2.0, 2.5]);
        let after = path(|x| -x / 20.0, [2.2, 1.8]);
        let stroke = path(|_| 0.0, [3.0, 3.0]);
        let blended = blend(&before, &after, &stroke).unwrap();
        let samples = &blended.samples;
        assert_eq!((samples.len(), blended.dropped_before, blended.dropped_after), (21, 20, 20));
        assert!((samples[0].at[1] - 1.0).abs() < 1e-9 && (samples[20].at[1] + 1.0).abs() < 1e-9);
        for (k, sample) in samples.iter().enumerate() {
            let (a, b) = (&before[k], &after[k]);
            let (high, low) = (sample.at[1] + sample.left_m, sample.at[1] - sample.right_m);
            assert!(high <= (a.at[1] + a.left_m).min(b.at[1] + b.left_m) + 1e-9, "{k}");
            assert!(low >= (a.at[1] - a.right_m).max(b.at[1] - b.right_m) - 1e-9, "{k}");
        }
    }

    #[test]
    fn paths_with_no_road_in_common_or_at_a_great_angle_are_not_blended() {
        let stroke = path(|_| 0.0, [3.0, 3.0]);
        let [left, right] = [path(|_| 2.5, [2.0, 2.0]), path(|_| -2.5, [2.0, 2.0])];
        assert!(blend(&left, &right, &stroke).is_none(), "5 m apart with 2 m each");
        let steep = path(|x| 0.8 * (x - 10.0), [9.0, 9.0]);
        assert!(blend(&steep, &path(|_| 0.0, [9.0, 9.0]), &stroke).is_none());
        assert!(blend(&left, &right, &stroke[..1]).is_none());
    }
}
