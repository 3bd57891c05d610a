//! The areas of a corridor, and their boundaries sorted for the search.

use std::ops::Range;

use crate::STEPS;
use crate::fit::{FARTHEST_M, RoadError};
use crate::hull::{Segment, bounds};
use crate::vector::Point;
use netcert_base::corridor::{AreaSpan, Corridor, PlaneArea};

/// Most vertices of one area.
pub(crate) const MOST_VERTICES: usize = 100_000;
/// Strips into which a boundary is sorted. More hardly help, and a boundary of long segments is in all of them.
const STRIPS: usize = 64;
/// Least height of a strip, metres: a boundary may be one line from west to east.
const LEAST_STRIP_M: f64 = 1e-3;

/// The areas of a corridor.
#[derive(Debug, Clone, Default)]
pub(crate) struct Areas {
    pub(crate) spans: Vec<Span>,
}

/// The steps in which an area counts.
#[derive(Debug, Clone)]
pub(crate) struct Span {
    steps: Range<usize>,
    pub(crate) boundary: Boundary,
}

impl Areas {
    /// The areas in the road's frame: metres from the corridor's first station, and steps from the road's start. The road
    /// begins `lead` stations before the corridor.
    ///
    /// # Errors
    /// [`RoadError`] at the first station of an area that is malformed.
    pub(crate) fn new(corridor: &Corridor, lead: usize) -> Result<Self, RoadError> {
        let span = |span: &AreaSpan| {
            let heads = &span.heads;
            let wrong = |problem| RoadError { station: heads.start, problem };
            if heads.len() < 2 || heads.end > corridor.len() {
                let n = corridor.len();
                return Err(wrong(format!(
                    "an area for stations {heads:?}; it needs two at least, of the corridor's {n}"
                )));
            }
            let boundary = Boundary::new(&span.area, [corridor.x[0], corridor.y[0]]).map_err(wrong)?;
            Ok(Span { steps: (lead + heads.start) * STEPS..(lead + heads.end - 1) * STEPS, boundary })
        };
        Ok(Self { spans: corridor.areas.iter().map(span).collect::<Result<_, _>>()? })
    }

    /// Whether an area, and not the corridor's half-widths, decides in a step.
    pub(crate) fn decides(&self, step: usize) -> bool {
        self.spans.iter().any(|span| span.steps.contains(&step))
    }

    /// The spans that count in a step.
    pub(crate) fn active(&self, step: usize) -> Vec<usize> {
        (0..self.spans.len()).filter(|&k| self.spans[k].steps.contains(&step)).collect()
    }
}

/// An area's boundary. Its segments are sorted into strips of northing; a segment is in each strip that it meets.
#[derive(Debug, Clone)]
pub(crate) struct Boundary {
    pub(crate) segments: Vec<Segment>,
    strips: Vec<Vec<u32>>,
    low: f64,
    height: f64,
}

impl Boundary {
    fn new(area: &PlaneArea, origin: Point) -> Result<Self, String> {
        let vertices = || area.rings.iter().flatten();
        if vertices().count() > MOST_VERTICES {
            return Err(format!("an area of {} vertices; at most {MOST_VERTICES}", vertices().count()));
        }
        if area.rings.is_empty() {
            return Err("an area without a boundary".to_owned());
        }
        if let Some(ring) = area.rings.iter().find(|ring| ring.len() < 3) {
            return Err(format!("a ring of {} vertices in an area; it needs 3", ring.len()));
        }
        if let Some(vertex) = vertices().find(|vertex| !vertex.iter().all(|x| x.abs() < FARTHEST_M)) {
            return Err(format!("an area's vertex {vertex:?} is not finite and below 1e8"));
        }
        let own = |[x, y]: Point| [x - origin[0], y - origin[1]];
        let segments: Vec<Segment> = area.segments().map(|segment| segment.map(own)).collect();
        let ends = |y: fn(f64, f64) -> f64, from: f64| segments.iter().fold(from, |most, [a, _]| y(most, a[1]));
        let (low, high) = (ends(f64::min, f64::INFINITY), ends(f64::max, f64::NEG_INFINITY));
        let height = ((high - low) / STRIPS as f64).max(LEAST_STRIP_M);
        let mut boundary = Self { segments: Vec::new(), strips: vec![Vec::new(); STRIPS], low, height };
        for (k, [a, b]) in segments.iter().enumerate() {
            for strip in boundary.strips_of(a[1].min(b[1]), a[1].max(b[1])) {
                boundary.strips[strip].push(k as u32);
            }
        }
        boundary.segments = segments;
        Ok(boundary)
    }

    /// The strips between two northings. Beyond the boundary it is the first or the last.
    fn strips_of(&self, from: f64, to: f64) -> Range<usize> {
        let at = |y: f64| (((y - self.low) / self.height).max(0.0) as usize).min(STRIPS - 1);
        at(from)..at(to) + 1
    }

    /// The segments that may be within `reach` of the hull of some points.
    pub(crate) fn near(&self, points: &[Point], reach: f64) -> Vec<u32> {
        // A negative claim asks for less than none.
        let reach = reach.max(0.0);
        let [low, high] = bounds(points);
        let meets = |k: &u32| {
            let [from, to] = bounds(&self.segments[*k as usize]);
            (0..2).all(|i| from[i] <= high[i] + reach && to[i] >= low[i] - reach)
        };
        let strips = &self.strips[self.strips_of(low[1] - reach, high[1] + reach)];
        let mut near: Vec<u32> = strips.iter().flatten().copied().filter(meets).collect();
        near.sort_unstable();
        near.dedup();
        near
    }

    /// Whether a place is inside: whether a ray to the east crosses the boundary an odd number of times.
    pub(crate) fn contains(&self, [x, y]: Point) -> bool {
        let crossed = |k: &&u32| {
            let [a, b] = self.segments[**k as usize];
            (a[1] > y) != (b[1] > y) && x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
        };
        self.strips[self.strips_of(y, y)].iter().flatten().filter(crossed).count() % 2 == 1
    }
}
