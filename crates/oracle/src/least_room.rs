//! The least room of a driving vehicle's bodies, while its steer axle is where an area counts.

use std::ops::Range;

use netcert_base::corridor::{Corridor, PlaneArea};

use crate::area::{AreaBoundary, Body, BodyEdge, EDGES, Touch, in_any, place_in_any};
use crate::path::V2;
use crate::simulator::{SimulatedDrive, SimulatedRun};

/// Each unit counts an area by its own clock: the place of its axle's foot. A disturbed unit's clock differs from the
/// steer axle's by less than this, metres.
const CLOCK_M: f64 = 1.5;
/// Steps between the states of a coarse search, which a fine one follows.
const COARSE: usize = 5;

/// The areas along a path, and the steps at which each counts.
pub struct PathAreas {
    spans: Vec<(AreaBoundary, Range<usize>)>,
    /// Steps in [`CLOCK_M`].
    clock: usize,
}

/// Steps over which the same is known of all units.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Stretch {
    /// Some area counts for every unit.
    Inside(Range<usize>),
    /// No area counts for any unit.
    Outside(Range<usize>),
    /// Areas may count for some units and not for others.
    Doubtful(Range<usize>),
}

/// The least room of a run, and its place.
#[derive(Debug, Clone, Copy)]
pub struct Worst {
    pub room_m: f64,
    pub step: usize,
    pub unit: usize,
    pub edge: BodyEdge,
    /// Ahead of the unit's axle, and to its left, metres.
    pub ahead_m: f64,
    pub aside_m: f64,
    /// Where that is, and where the boundary is nearest.
    pub at: V2,
    pub nearest: V2,
}

impl Worst {
    fn of(touch: Touch, step: usize, unit: usize) -> Self {
        let Touch { room_m, edge, ahead_m, aside_m, at, nearest } = touch;
        Self { room_m, step, unit, edge, ahead_m, aside_m, at, nearest }
    }
}

/// The step at which the steer axle is `from_m` from the first vertex of the path's plan.
fn step_at(drive: &SimulatedDrive<'_>, from_m: f64) -> f64 {
    let spans = drive.path.span_of_vertex(0) as f64 + from_m / drive.path.spacing_m;
    spans * drive.steps_per_span as f64
}

/// The least room of any body while the steer axle is between two places of the path, metres from the first vertex of
/// its plan. A metre and a half at both ends does not count. `None` if nothing is left.
pub fn swept_room(
    drive: &SimulatedDrive<'_>,
    run: &SimulatedRun,
    area: &PlaneArea,
    heads_m: [f64; 2],
) -> Option<Worst> {
    let grounds = PathAreas::between(drive, &[(area, heads_m)]);
    grounds.least(drive, run, run.steps())
}

impl PathAreas {
    /// The areas of a corridor, for a path with one vertex for each of its stations.
    pub fn new(corridor: &Corridor, drive: &SimulatedDrive<'_>) -> Self {
        let places = |heads: &Range<usize>| {
            [heads.start as f64 * corridor.spacing_m, heads.end.saturating_sub(1) as f64 * corridor.spacing_m]
        };
        let spans: Vec<_> = corridor.areas.iter().map(|span| (&*span.area, places(&span.heads))).collect();
        Self::between(drive, &spans)
    }

    /// Areas, each with the first and the last place of the steer axle for which it counts, metres from the first
    /// vertex of the path's plan.
    pub fn between(drive: &SimulatedDrive<'_>, spans: &[(&PlaneArea, [f64; 2])]) -> Self {
        let steps = |[from_m, to_m]: [f64; 2]| {
            step_at(drive, from_m).ceil().max(0.0) as usize..step_at(drive, to_m).floor().max(0.0) as usize + 1
        };
        let spans = spans.iter().map(|(area, places)| (AreaBoundary::new(area), steps(*places))).collect();
        Self { spans, clock: (step_at(drive, CLOCK_M) - step_at(drive, 0.0)).ceil() as usize }
    }

    /// Steps at which some area may count.
    pub fn steps(&self) -> Range<usize> {
        let first = self.spans.iter().map(|span| span.1.start).min().unwrap_or(0);
        let end = self.spans.iter().map(|span| span.1.end).max().unwrap_or(0);
        first..end
    }

    /// Whether some area counts at a step for every unit, whatever the units' clocks.
    pub fn surely(&self, step: usize) -> bool {
        self.spans.iter().any(|(_, steps)| steps.start + self.clock <= step && step + self.clock < steps.end)
    }

    /// Whether no area counts at a step for any unit.
    pub fn surely_none(&self, step: usize) -> bool {
        self.spans.iter().all(|(_, steps)| step + self.clock < steps.start || steps.end + self.clock <= step)
    }

    /// What is known of the steps of a range, in order.
    pub fn stretches(&self, range: Range<usize>) -> Vec<Stretch> {
        let mut stretches = Vec::new();
        let mut from = range.start;
        let kind = |step: usize| (self.surely(step), self.surely_none(step));
        while from < range.end {
            let first = kind(from);
            let steps = from..(from..range.end).find(|step| kind(*step) != first).unwrap_or(range.end);
            from = steps.end;
            stretches.push(match first {
                (true, _) => Stretch::Inside(steps),
                (_, true) => Stretch::Outside(steps),
                _ => Stretch::Doubtful(steps),
            });
        }
        stretches
    }

    /// The least room of a unit at a step in the areas that may count.
    pub fn room_m(&self, drive: &SimulatedDrive<'_>, run: &SimulatedRun, step: usize, unit: usize) -> f64 {
        let (grounds, body) = (self.counting(step), body(drive, run, step, unit));
        let rooms = EDGES.into_iter().filter_map(|edge| in_any(&grounds, &body, edge, f64::INFINITY));
        rooms.map(|touch| touch.room_m).fold(f64::INFINITY, f64::min)
    }

    /// The areas that may count at a step. One more than really counts only adds to the room.
    fn counting(&self, step: usize) -> Vec<&AreaBoundary> {
        let near = |steps: &Range<usize>| steps.start <= step + self.clock && step < steps.end + self.clock;
        self.spans.iter().filter(|(_, steps)| near(steps)).map(|(ground, _)| ground).collect()
    }

    /// The least room of one edge of a unit at a step. `None` where it is not sure that an area counts.
    pub fn edge(
        &self,
        drive: &SimulatedDrive<'_>,
        run: &SimulatedRun,
        step: usize,
        unit: usize,
        edge: BodyEdge,
    ) -> Option<Worst> {
        if !self.surely(step) {
            return None;
        }
        let touch = in_any(&self.counting(step), &body(drive, run, step, unit), edge, f64::INFINITY)?;
        Some(Worst::of(touch, step, unit))
    }

    /// The two ends of one edge of a unit at a step. Empty where it is not sure that an area counts.
    pub fn ends(
        &self,
        drive: &SimulatedDrive<'_>,
        run: &SimulatedRun,
        step: usize,
        unit: usize,
        edge: BodyEdge,
    ) -> Vec<Worst> {
        if !self.surely(step) {
            return Vec::new();
        }
        let (grounds, body) = (self.counting(step), body(drive, run, step, unit));
        let touches = body.edge(edge).into_iter().filter_map(|place| place_in_any(&grounds, &body, edge, place));
        touches.map(|touch| Worst::of(touch, step, unit)).collect()
    }

    /// The least room of a unit in some steps of a run.
    pub fn least_of(
        &self,
        drive: &SimulatedDrive<'_>,
        run: &SimulatedRun,
        range: Range<usize>,
        unit: usize,
    ) -> Option<Worst> {
        let range = range.start.max(run.first)..range.end.min(run.steps().end);
        let search = |range: Range<usize>, stride: usize| {
            let mut least: Option<Worst> = None;
            for step in range.step_by(stride).filter(|step| self.surely(*step)) {
                let (grounds, body) = (self.counting(step), body(drive, run, step, unit));
                for edge in EDGES {
                    let enough = least.map_or(f64::INFINITY, |least| least.room_m);
                    let touch = in_any(&grounds, &body, edge, enough);
                    least = touch.map(|touch| Worst::of(touch, step, unit)).or(least);
                }
            }
            least
        };
        let rough = search(range.clone(), COARSE)?;
        let close = rough.step.saturating_sub(COARSE).max(range.start)..(rough.step + COARSE + 1).min(range.end);
        search(close, 1)
    }

    /// The least room of any unit in some steps of a run.
    pub fn least(&self, drive: &SimulatedDrive<'_>, run: &SimulatedRun, range: Range<usize>) -> Option<Worst> {
        let units = 0..drive.vehicle.units.len();
        let rooms = units.filter_map(|unit| self.least_of(drive, run, range.clone(), unit));
        rooms.min_by(|a, b| a.room_m.total_cmp(&b.room_m))
    }

    /// Whether a vertex of the boundary gets under a body in some steps of a run. With several areas a vertex of one
    /// may be in the middle of another; such a vertex is none.
    pub fn under(&self, drive: &SimulatedDrive<'_>, run: &SimulatedRun, range: Range<usize>) -> Option<(usize, V2)> {
        let range = range.start.max(run.first)..range.end.min(run.steps().end);
        range.step_by(COARSE).filter(|step| self.surely(*step)).find_map(|step| {
            let grounds = self.counting(step);
            let outside = |vertex: &V2| grounds.iter().all(|ground| ground.room(*vertex).0 < 1e-9);
            (0..drive.vehicle.units.len()).find_map(|unit| {
                let body = body(drive, run, step, unit);
                let vertex = grounds.iter().find_map(|ground| ground.under(&body).find(outside))?;
                Some((step, vertex))
            })
        })
    }
}

/// A unit's body after a step.
pub fn body(drive: &SimulatedDrive<'_>, run: &SimulatedRun, step: usize, unit: usize) -> Body {
    let (guide, headings) = run.at(step);
    Body::new(&drive.vehicle.units[unit], drive.axles(guide, headings)[unit], headings[unit])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fleet;
    use crate::path::Path;
    use crate::simulator::Disturbance;

    #[test]
    fn on_a_straight_the_room_is_what_the_width_leaves() {
        let vehicle = fleet::vehicle("EU-SEMI16.5");
        let plan: Vec<V2> = (0..=200).map(|k| [0.5 * f64::from(k), 0.0]).collect();
        let path = Path::through(&plan, 0.5, (0.0, 0.0), 50.0, 25.0);
        let drive = SimulatedDrive::new(&vehicle, &path, 5);
        let run = drive.whole(&Disturbance::none(drive.steps()));
        let strip = PlaneArea { rings: vec![vec![[-60.0, -2.0], [100.0, -2.0], [100.0, 1.9], [-60.0, 1.9]]] };
        let worst = swept_room(&drive, &run, &strip, [10.0, 60.0]).unwrap();
        assert!((worst.room_m - (1.9 - 0.5 * 2.55)).abs() < 1e-9, "{worst:?}");
        assert_eq!(worst.edge, BodyEdge::Left);
        // The front is 1.4 m ahead of the steer axle, whose last place that counts is 98.5 m.
        let worst = swept_room(&drive, &run, &strip, [20.0, 100.0]).unwrap();
        assert!((worst.room_m - 0.1).abs() < 0.01 && worst.ahead_m > 5.0, "{worst:?}");
        assert!(swept_room(&drive, &run, &strip, [10.0, 12.0]).is_none());
    }
}
