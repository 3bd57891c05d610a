//! The areas of a route's turns, carried over into the route's corridor.

use std::ops::Range;
use std::sync::Arc;

use super::pieces::TurnPiece;
use crate::corridor::{Area, AreaSpan, Corridor, Frame, FrameError};

/// Road before the route that a vehicle may stand on when the steer axle is at the route's beginning, metres.
const BEHIND_M: f64 = 70.0;
/// Road behind the route that the vehicle's front may reach, metres.
const AHEAD_M: f64 = 10.0;
/// Length over which the corridor's own strip overlaps an area at the route's ends, metres.
const OVERLAP_M: f64 = 12.0;

/// A turn's area, and how far before and behind the turn's own stations it counts.
pub(super) struct Ground {
    area: Arc<Area>,
    before_m: f64,
    after_m: f64,
}

impl Ground {
    /// The areas of a turn, in the route's frame.
    pub(super) fn of(piece: &TurnPiece, frame: Frame) -> Result<Vec<Self>, FrameError> {
        let metres = |from: usize, to: usize| (to as f64 - from as f64) * piece.corridor.spacing_m;
        let of = |span: &AreaSpan| {
            let area = match piece.frame == frame {
                true => Arc::clone(&span.area),
                false => Arc::new(in_frame(&span.area, piece.frame, frame)?),
            };
            Ok(Self {
                area,
                before_m: metres(span.heads.start, piece.turn.start),
                after_m: metres(piece.turn.end, span.heads.end),
            })
        };
        piece.corridor.areas.iter().map(of).collect()
    }

    /// Where the area counts in a route whose turn has these stations.
    pub(super) fn along(&self, corridor: &Corridor, turn: &Range<usize>) -> AreaSpan {
        let stations = |metres: f64| (metres / corridor.spacing_m).round() as isize;
        let within = |k: isize| k.clamp(0, corridor.len() as isize) as usize;
        let heads =
            within(turn.start as isize - stations(self.before_m))..within(turn.end as isize + stations(self.after_m));
        AreaSpan { heads, area: Arc::clone(&self.area) }
    }
}

fn in_frame(area: &Area, own: Frame, frame: Frame) -> Result<Area, FrameError> {
    let moved = |ring: &Vec<[f64; 2]>| {
        let degrees = own.inverse(ring)?;
        frame.forward_degrees(degrees.into_iter().map(|[lon, lat]| (lon, lat)).collect())
    };
    Ok(Area { rings: area.rings.iter().map(moved).collect::<Result<_, FrameError>>()? })
}

/// Adds the straight road before the route and behind it, where an area counts near the route's ends. The vehicle comes along the
/// one and leaves along the other (proof, section 1), so its bodies are there as in the corridor's own certificate.
pub(super) fn open_ends(corridor: &mut Corridor) {
    let stations = |metres: f64| (metres / corridor.spacing_m).ceil() as usize;
    let (count, overlap) = (corridor.len(), stations(OVERLAP_M));
    let begins =
        corridor.areas.iter().filter(|span| span.heads.start < stations(BEHIND_M)).map(|span| span.heads.start);
    let ends =
        corridor.areas.iter().filter(|span| span.heads.end + stations(AHEAD_M) > count).map(|span| span.heads.start);
    let (begins, ends) = (begins.min(), ends.min());
    if let Some(first) = begins {
        let area = Arc::new(strip(corridor, 0..(first + overlap).min(count), [BEHIND_M, 0.0]));
        let heads = first..stations(BEHIND_M).min(count);
        if heads.len() > 1 {
            corridor.areas.push(AreaSpan { heads, area });
        }
    }
    if let Some(first) = ends {
        let from = count.saturating_sub(overlap);
        let area = Arc::new(strip(corridor, from..count, [0.0, BEHIND_M]));
        let heads = first.max(count.saturating_sub(stations(AHEAD_M)))..count;
        if heads.len() > 1 {
            corridor.areas.push(AreaSpan { heads, area });
        }
    }
    corridor.areas.sort_by_key(|span| (span.heads.start, span.heads.end));
}

/// The corridor between its edges at the given stations, prolonged straight before and behind.
fn strip(corridor: &Corridor, stations: Range<usize>, [before_m, behind_m]: [f64; 2]) -> Area {
    let edge = |k: usize, along_m: f64, aside_m: f64| {
        let (sin, cos) = corridor.heading[k].sin_cos();
        [corridor.x[k] + along_m * cos - aside_m * sin, corridor.y[k] + along_m * sin + aside_m * cos]
    };
    let Some(last) = stations.clone().next_back() else { return Area::default() };
    let first = stations.start;
    let side = |aside: &dyn Fn(usize) -> f64| -> Vec<[f64; 2]> {
        let prolonged = |k: usize, by: f64| (by != 0.0).then(|| edge(k, by, aside(k)));
        let own = stations.clone().map(|k| edge(k, 0.0, aside(k)));
        prolonged(first, -before_m).into_iter().chain(own).chain(prolonged(last, behind_m)).collect()
    };
    let mut ring = side(&|k| -corridor.right_m[k]);
    ring.extend(side(&|k| corridor.left_m[k]).into_iter().rev());
    Area { rings: vec![ring] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_area_near_the_beginning_gets_the_road_before_it() {
        let mut corridor = Corridor::straight(200.0, 2.0, 3.0);
        let area = Arc::new(Area { rings: vec![vec![[0.0, -3.0], [90.0, -3.0], [90.0, 2.0], [0.0, 2.0]]] });
        corridor.areas = vec![AreaSpan { heads: 10..60, area }];
        open_ends(&mut corridor);
        assert_eq!(corridor.areas.len(), 2);
        let own = &corridor.areas[1];
        assert_eq!(own.heads, 10..70);
        assert!(own.area.contains([-50.0, 1.9]) && own.area.contains([15.0, -2.9]));
        assert!(!own.area.contains([-50.0, 2.1]) && !own.area.contains([-71.0, 0.0]));
    }

    #[test]
    fn an_area_amid_a_route_stands_alone() {
        let mut corridor = Corridor::straight(400.0, 2.0, 3.0);
        corridor.areas = vec![AreaSpan { heads: 100..160, area: Arc::default() }];
        open_ends(&mut corridor);
        assert_eq!(corridor.areas.len(), 1);
    }
}
