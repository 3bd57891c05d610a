//! A strip of a corridor as a ring in the plane, nowhere wider than the strip; and the straight road beyond a corridor's ends.

use std::ops::Range;
use std::sync::Arc;

use super::{AreaSpan, Corridor, PlaneArea};

/// Vertices this close to the line between their neighbours are removed, metres.
const COLLINEAR_M: f64 = 2e-3;
/// Road before a corridor that a vehicle may stand on when the steer axle is at the corridor's beginning, metres.
const BEHIND_M: f64 = 70.0;
/// Road after a corridor that the vehicle's front may reach, metres.
const AHEAD_M: f64 = 10.0;
/// Length over which the corridor's own strip overlaps an area at the corridor's ends, metres.
const OVERLAP_M: f64 = 12.0;

/// The ring around a strip between some stations. `edges` are the strip's, left and right, metres to the left of the centreline. The
/// ring goes on straight for the given metres before and after.
///
/// An edge bends between stations, and the ring does not. On the inside of a bend the ring would be wider than the strip, so it is
/// drawn that much farther in. `None` for fewer than two stations.
pub fn outline(
    c: &Corridor,
    stations: Range<usize>,
    edges: &dyn Fn(usize) -> [f64; 2],
    prolonged_m: [f64; 2],
) -> Option<Vec<[f64; 2]>> {
    let first = stations.start;
    let last = stations.end.checked_sub(1).filter(|last| *last > first)?;
    let place = |k: usize, along_m: f64, left_m: f64| {
        let (sin, cos) = c.heading[k].sin_cos();
        [c.x[k] + along_m * cos - left_m * sin, c.y[k] + along_m * sin + left_m * cos]
    };
    let side = |which: usize| {
        let towards = if which == 0 { 1.0 } else { -1.0 };
        let drawn = |k: usize| {
            let edge = edges(k)[which];
            let near = k.saturating_sub(1)..=(k + 1).min(c.len() - 1);
            // The sagitta of the edge between two stations.
            let bends = |k: usize| (towards * c.curvature[k]).max(0.0) * (1.0 - c.curvature[k] * edge).max(1.0);
            let sagitta = near.map(bends).fold(0.0, f64::max) * c.spacing_m * c.spacing_m / 8.0;
            edge - towards * (sagitta + COLLINEAR_M)
        };
        let beyond = |k: usize, by: f64| (by != 0.0).then(|| place(k, by, drawn(k)));
        let own = stations.clone().map(|k| place(k, 0.0, drawn(k)));
        let line: Vec<[f64; 2]> =
            beyond(first, -prolonged_m[0]).into_iter().chain(own).chain(beyond(last, prolonged_m[1])).collect();
        thinned(&line)
    };
    let mut ring = side(0);
    ring.extend(side(1).into_iter().rev());
    Some(ring)
}

/// Removes vertices that add nothing: each is within [`COLLINEAR_M`] of the line that replaces it.
fn thinned(line: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut out: Vec<[f64; 2]> = Vec::with_capacity(line.len());
    let mut from = 0;
    out.extend(line.first());
    for i in 2..line.len() {
        if (from + 1..i).any(|k| from_chord_m(line[k], line[from], line[i]) > COLLINEAR_M) {
            from = i - 1;
            out.push(line[from]);
        }
    }
    if line.len() > 1 {
        out.extend(line.last());
    }
    out
}

/// Distance of a place from the line through two others, metres.
fn from_chord_m(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let d = [b[0] - a[0], b[1] - a[1]];
    let length = d[0].hypot(d[1]);
    if length < 1e-9 { f64::INFINITY } else { (d[0] * (p[1] - a[1]) - d[1] * (p[0] - a[0])).abs() / length }
}

/// Adds the straight road before a corridor and after it, where an area counts near its ends. The vehicle comes along the one and
/// leaves along the other (proof, section 1), so bodies beyond the ends are not held against the cut end of an area. `open` says at
/// which ends the area itself does not go on.
pub fn open_ends(corridor: &mut Corridor, open: [bool; 2]) {
    let stations = |metres: f64| (metres / corridor.spacing_m).ceil() as usize;
    let (count, overlap) = (corridor.len(), stations(OVERLAP_M));
    let own = |k: usize| [corridor.left_m[k], -corridor.right_m[k]];
    // The stations of the areas that count near an end. Without them the strip would stand alone.
    let counting = |near: &dyn Fn(&Range<usize>) -> bool| {
        let near = corridor.areas.iter().map(|span| span.heads.clone()).filter(|heads| near(heads));
        near.reduce(|a, b| a.start.min(b.start)..a.end.max(b.end))
    };
    let before = counting(&|heads| heads.start < stations(BEHIND_M)).filter(|_| open[0]).map(|heads| {
        let strip = outline(corridor, 0..(heads.start + overlap).min(count), &own, [BEHIND_M, 0.0]);
        (heads.start..stations(BEHIND_M).min(heads.end), strip)
    });
    let after = counting(&|heads| heads.end + stations(AHEAD_M) > count).filter(|_| open[1]).map(|heads| {
        let strip = outline(corridor, count.saturating_sub(overlap)..count, &own, [0.0, BEHIND_M]);
        (heads.start.max(count.saturating_sub(stations(AHEAD_M)))..heads.end, strip)
    });
    for (heads, strip) in [before, after].into_iter().flatten() {
        if let Some(ring) = strip.filter(|_| heads.len() > 1) {
            corridor.areas.push(AreaSpan { heads, area: Arc::new(PlaneArea { rings: vec![ring] }) });
        }
    }
    corridor.areas.sort_by_key(|span| (span.heads.start, span.heads.end));
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::super::CurvatureProfile;
    use super::*;

    #[test]
    fn the_ring_is_nowhere_wider_than_the_strip() {
        let profile = CurvatureProfile::new(1.0).straight(20.0).clothoid(0.1, 3.0).arc(0.1, 9.0).clothoid(-0.08, 6.0);
        let profile = profile.arc(-0.08, 9.0).clothoid(0.0, 3.0).straight(20.0);
        let corridor = Corridor::from_curvature(1.0, [3.0, -4.0], 0.7, &profile.curvature, 4.0, 5.0);
        let edges = |_| [4.0, -5.0];
        let ring = PlaneArea { rings: vec![outline(&corridor, 0..corridor.len(), &edges, [0.0; 2]).unwrap()] };
        // The same road in steps of a hundredth: places of its edges are not inside.
        let fine: Vec<f64> = (0..100 * (corridor.len() - 1))
            .map(|i| {
                let (k, t) = (i / 100, f64::from(i as u32 % 100) / 100.0);
                corridor.curvature[k] + t * (corridor.curvature[k + 1] - corridor.curvature[k])
            })
            .collect();
        let road = Corridor::from_curvature(0.01, [3.0, -4.0], 0.7, &fine, 4.0, 5.0);
        let mut widest = 0.0_f64;
        for k in 0..road.len() {
            let (sin, cos) = road.heading[k].sin_cos();
            for left_m in [4.0, -5.0] {
                let p = [road.x[k] - left_m * sin, road.y[k] + left_m * cos];
                let near = ring.nearest(p).unwrap();
                widest = widest.max((near[0] - p[0]).hypot(near[1] - p[1]));
                assert!(!ring.contains(p), "{left_m} at {k}");
            }
        }
        assert!(widest < 0.035, "{widest}");
    }

    #[test]
    fn an_area_near_the_beginning_gets_the_road_before_it() {
        let mut corridor = Corridor::straight(200.0, 2.0, 3.0);
        let area = Arc::new(PlaneArea { rings: vec![vec![[0.0, -3.0], [90.0, -3.0], [90.0, 2.0], [0.0, 2.0]]] });
        corridor.areas = vec![AreaSpan { heads: 10..60, area }];
        let mut shut = corridor.clone();
        open_ends(&mut shut, [false, true]);
        assert_eq!(shut.areas.len(), 1);
        open_ends(&mut corridor, [true; 2]);
        assert_eq!(corridor.areas.len(), 2);
        let own = &corridor.areas[1];
        assert_eq!(own.heads, 10..60);
        assert!(own.area.contains([-50.0, 1.9]) && own.area.contains([15.0, -2.9]));
        assert!(!own.area.contains([-50.0, 2.1]) && !own.area.contains([-71.0, 0.0]));
    }

    #[test]
    fn an_area_amid_a_corridor_stands_alone() {
        let mut corridor = Corridor::straight(400.0, 2.0, 3.0);
        corridor.areas = vec![AreaSpan { heads: 100..160, area: Arc::default() }];
        open_ends(&mut corridor, [true; 2]);
        assert_eq!(corridor.areas.len(), 1);
    }
}
