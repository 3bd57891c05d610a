//! Merges lines on a raster of half pixels. Lines that fall on the same segment of the raster become one segment with the worst
//! of their attributes. Segments with the same attributes are joined into long lines.
//!
//! Every line that is not certified, however short, leaves a line that is not certified within a raster step and the
//! tolerance of joining. The same input in any order gives the same lines. Certified lines shorter than a step are left
//! out.

use std::collections::{BTreeMap, BTreeSet};

use super::shape::simplified;

/// A point of the raster.
pub(super) type RasterPoint = [i32; 2];

/// The greatest distance of a joined line from its segments, steps. Half a step is a quarter of a pixel.
const TOLERANCE: f64 = 0.5;
/// The drawn length of a segment that is shorter than a step, steps. Two steps are one pixel.
const LEAST_LENGTH: i32 = 2;

/// The attributes of a line. Within a class, the derived order runs from good to bad.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct LineAttributes {
    /// The class of road. Lines of different classes are never merged, because the page can hide each class.
    pub(super) class: u8,
    /// 0 means certified, any other value means not certified.
    pub(super) severity: u8,
    /// Steps of margin below the greatest margin.
    pub(super) short: u8,
    /// Index of the verdict with its reason.
    pub(super) verdict: u8,
    /// How many ranks the source of the width is below the best source.
    pub(super) doubt: u8,
    /// Index of the narrowest policy under which the line is certified; one beyond the last if there is none.
    pub(super) strip: u8,
}

impl LineAttributes {
    /// Merges the attributes of two lines of one class: the worse verdict with its margin, the weaker source of width, and the wider strip.
    fn with(self, other: Self) -> Self {
        Self { doubt: self.doubt.max(other.doubt), strip: self.strip.max(other.strip), ..self.max(other) }
    }
}

/// A segment between two points of the raster, the lesser first. Two equal points stand for a line shorter than a step.
type Segment = (RasterPoint, RasterPoint);

/// The segments of all added lines.
#[derive(Default)]
pub(super) struct Raster {
    segments: Vec<(u8, Segment, LineAttributes)>,
}

impl Raster {
    /// Adds a line, given by its points on the raster.
    pub(super) fn add(&mut self, line: impl Iterator<Item = RasterPoint>, said: LineAttributes) {
        let mut last: Option<(RasterPoint, bool)> = None;
        for cell in line {
            match last {
                Some((before, _)) if before == cell => {}
                Some((before, _)) => {
                    self.segments.push((said.class, (before.min(cell), before.max(cell)), said));
                    last = Some((cell, true));
                }
                None => last = Some((cell, false)),
            }
        }
        if let Some((only, false)) = last {
            self.segments.push((said.class, (only, only), said));
        }
    }

    /// The merged lines by their attributes, from good to bad.
    pub(super) fn lines(mut self) -> BTreeMap<LineAttributes, Vec<Vec<RasterPoint>>> {
        self.segments.sort_unstable();
        let same = |a: &(u8, Segment, LineAttributes), b: &(u8, Segment, LineAttributes)| (a.0, a.1) == (b.0, b.1);
        let worst = |group: &[(u8, Segment, LineAttributes)]| {
            let (first, others) = group.split_first()?;
            Some((first.1, others.iter().fold(first.2, |said, other| said.with(other.2))))
        };
        let segments: Vec<(Segment, LineAttributes)> = self.segments.chunk_by(same).filter_map(worst).collect();
        let barred = segments.iter().filter(|(segment, said)| said.severity > 0 && segment.0 != segment.1);
        let told: BTreeSet<(u8, RasterPoint)> =
            barred.flat_map(|(segment, said)| [(said.class, segment.0), (said.class, segment.1)]).collect();
        let mut kinds: BTreeMap<LineAttributes, Vec<Segment>> = BTreeMap::new();
        for (segment, said) in segments {
            let (a, b) = segment;
            if a != b {
                kinds.entry(said).or_default().push(segment);
            } else if said.severity > 0 && !told.contains(&(said.class, a)) {
                kinds.entry(said).or_default().push((a, [a[0] + LEAST_LENGTH, a[1]]));
            }
        }
        kinds.into_iter().map(|(said, segments)| (said, joined(&segments))).collect()
    }
}

/// Joins segments end to end into simplified lines. Where several segments continue a line, the straightest one is taken.
fn joined(segments: &[Segment]) -> Vec<Vec<RasterPoint>> {
    let mut at: BTreeMap<RasterPoint, Vec<usize>> = BTreeMap::new();
    for (i, &(a, b)) in segments.iter().enumerate() {
        at.entry(a).or_default().push(i);
        at.entry(b).or_default().push(i);
    }
    let mut used = vec![false; segments.len()];
    let mut lines = Vec::new();
    for (i, &(a, b)) in segments.iter().enumerate() {
        if std::mem::replace(&mut used[i], true) {
            continue;
        }
        let mut line = vec![a, b];
        for _ in 0..2 {
            while let Some(next) = onward(&line, segments, &mut at, &mut used) {
                line.push(next);
            }
            line.reverse();
        }
        let line: Vec<[f64; 2]> = line.into_iter().map(|cell| cell.map(f64::from)).collect();
        lines.push(simplified(&line, TOLERANCE).into_iter().map(|point| point.map(|c| c as i32)).collect());
    }
    lines
}

/// The far end of the unused segment that continues the line most nearly straight. Marks the segment as used. Used ones are taken out of `at`.
fn onward(
    line: &[RasterPoint],
    segments: &[Segment],
    at: &mut BTreeMap<RasterPoint, Vec<usize>>,
    used: &mut [bool],
) -> Option<RasterPoint> {
    let [.., before, end] = line else { return None };
    let other = |&i: &usize| if segments[i].0 == *end { segments[i].1 } else { segments[i].0 };
    let straight = |i: &usize| {
        let (u, v) = (step(*before, *end), step(*end, other(i)));
        (u[0] * v[0] + u[1] * v[1]) / (v[0].hypot(v[1]) * u[0].hypot(u[1])).max(1e-9)
    };
    let free = at.get_mut(end)?;
    free.retain(|&i| !used[i]);
    let next = *free.iter().max_by(|a, b| straight(a).total_cmp(&straight(b)))?;
    used[next] = true;
    Some(other(&next))
}

fn step(from: RasterPoint, to: RasterPoint) -> [f64; 2] {
    [f64::from(to[0] - from[0]), f64::from(to[1] - from[1])]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn said(severity: u8, short: u8, doubt: u8) -> LineAttributes {
        LineAttributes { class: 0, severity, short, verdict: severity, doubt, strip: severity }
    }

    fn lines(all: &[(&[RasterPoint], LineAttributes)]) -> BTreeMap<LineAttributes, Vec<Vec<RasterPoint>>> {
        let mut raster = Raster::default();
        all.iter().for_each(|(line, said)| raster.add(line.iter().copied(), *said));
        raster.lines()
    }

    #[test]
    fn of_two_directions_the_worse_counts_on_the_lesser_evidence() {
        let there: &[RasterPoint] = &[[0, 0], [10, 0], [10, 9]];
        let back: &[RasterPoint] = &[[10, 9], [10, 0], [0, 0]];
        let drawn = lines(&[(there, said(0, 3, 4)), (back, said(2, 1, 0))]);
        assert_eq!(drawn, BTreeMap::from([(said(2, 1, 4), vec![there.to_vec()])]));
        let drawn = lines(&[(there, said(0, 3, 0)), (back, said(0, 1, 2))]);
        assert_eq!(drawn.into_keys().collect::<Vec<_>>(), [said(0, 3, 2)]);
    }

    #[test]
    fn what_says_the_same_is_one_line_and_what_is_not_certified_has_a_pixel_at_least() {
        let drawn = lines(&[
            (&[[0, 0], [5, 0]], said(0, 0, 0)),
            (&[[5, 0], [5, 0]], said(2, 0, 0)),
            (&[[5, 0], [9, 0], [20, 0]], said(0, 0, 0)),
            (&[[7, 7]], said(0, 0, 0)),
        ]);
        assert_eq!(drawn[&said(0, 0, 0)], [vec![[0, 0], [20, 0]]]);
        assert_eq!(drawn[&said(2, 0, 0)], [vec![[5, 0], [7, 0]]]);
        assert_eq!(drawn.len(), 2);
        let beside = lines(&[(&[[5, 0], [9, 0]], said(1, 0, 0)), (&[[5, 0]], said(2, 0, 0))]);
        assert_eq!(beside.into_keys().collect::<Vec<_>>(), [said(1, 0, 0)], "the place is told already");
    }

    fn distance(p: RasterPoint, line: &[RasterPoint]) -> f64 {
        let p = p.map(f64::from);
        let to = |pair: &[RasterPoint]| {
            let (a, b) = (pair[0].map(f64::from), pair[1].map(f64::from));
            let (u, v) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
            let squared = u[0] * u[0] + u[1] * u[1];
            let along = if squared > 0.0 { ((u[0] * v[0] + u[1] * v[1]) / squared).clamp(0.0, 1.0) } else { 0.0 };
            (v[0] - along * u[0]).hypot(v[1] - along * u[1])
        };
        line.windows(2).map(to).fold(f64::INFINITY, f64::min)
    }

    proptest! {
        /// Short steps on a small raster, so that lines meet, cover and collapse.
        #[test]
        fn nothing_that_is_not_certified_gets_lost(
            all in prop::collection::vec((prop::collection::vec((0..12_i32, 0..12_i32), 1..6), 0..3_u8, 0..3_u8), 1..20),
            turned in any::<bool>()
        ) {
            let mut raster = Raster::default();
            let mut other = Raster::default();
            for (line, severity, short) in &all {
                raster.add(line.iter().map(|&(x, y)| [x, y]), said(*severity, *short, 0));
            }
            for (line, severity, short) in all.iter().rev() {
                let mut line = line.clone();
                if turned {
                    line.reverse();
                }
                other.add(line.into_iter().map(|(x, y)| [x, y]), said(*severity, *short, 0));
            }
            let drawn = raster.lines();
            prop_assert_eq!(&drawn, &other.lines());
            let barred: Vec<&Vec<RasterPoint>> =
                drawn.iter().filter(|(said, _)| said.severity > 0).flat_map(|(_, lines)| lines).collect();
            for (line, ..) in all.iter().filter(|(_, severity, _)| *severity > 0) {
                for &(x, y) in line {
                    let near = barred.iter().map(|line| distance([x, y], line)).fold(f64::INFINITY, f64::min);
                    prop_assert!(near <= TOLERANCE, "{x} {y}: {near}");
                }
            }
        }
    }
}
