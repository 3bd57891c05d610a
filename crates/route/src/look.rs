//! Looks at the parts of a way that climbs, and once more at those that failed or have changed. The way is looked at in pieces, each with
//! some road before and after it, on several threads. A look decides nothing: it finds what has to become wider before the whole way is
//! certified.

use std::ops::Range;

use rayon::prelude::*;

use super::assemble::{PartKind, RoutePart, RoutePath};
use super::driver::Driver;
use crate::stet::{SpanResult, certify_parts};
use crate::stop::{Stop, Stopped};

/// Length of the pieces, metres.
const PIECE_M: f64 = 1_000.0;
/// Road on both sides of a part that is looked at again, and road before and after a piece, which is not judged: metres, and vehicle lengths.
const BEYOND_M: f64 = 30.0;
const BEYOND_LENGTHS: f64 = 2.0;
/// Distance between the places of a part that are compared, and what they may differ by, metres.
const SHAPE_M: f64 = 4.0;
const ALONG_M: f64 = 0.6;
const ACROSS_M: f64 = 0.02;
const SAME_WIDTH_M: f64 = 0.05;

/// The parts of a way, as they were looked at.
#[derive(Default)]
pub(super) struct Judged {
    /// The parts with their results, in driving order.
    pub(super) parts: Vec<(PartKind, SpanResult)>,
    /// By part: places along it.
    shapes: Vec<Shape>,
}

/// Places along a part, at even distances: position (metres), heading (radians) and half-widths (metres).
type Shape = Vec<[f64; 5]>;

/// Looks at all parts of a way, except those that are safe in `before` and have kept their shape.
///
/// # Errors
/// `stop` was told.
pub(super) fn judge(path: &RoutePath, before: &Judged, driver: &Driver, stop: &Stop) -> Result<Judged, Stopped> {
    let shapes: Vec<Shape> = path.parts.iter().map(|part| shape(path, &part.stations)).collect();
    let kept: Vec<Option<&SpanResult>> =
        (0..shapes.len()).map(|number| before.safe_part(&path.parts, number, &shapes[number])).collect();
    let beside = stations(path, beyond_m(driver));
    let mut near: Vec<Range<usize>> = Vec::new();
    for (part, _) in path.parts.iter().zip(&kept).filter(|(_, kept)| kept.is_none()) {
        let end = (part.stations.end + beside).min(path.corridor.len());
        match near.last_mut() {
            Some(last) if part.stations.start <= last.end + beside => last.end = end,
            _ => near.push(part.stations.start.saturating_sub(beside)..end),
        }
    }
    let mut results: Vec<Option<SpanResult>> = kept.into_iter().map(Option::<&_>::cloned).collect();
    for (part, found) in looked_at(path, &near, driver, stop)? {
        // Only some of a kept part was looked at again. It gets the worse of both results.
        let result = &mut results[part];
        *result = Some(result.take().map_or_else(|| found.clone(), |known| worse(&known, &found).clone()));
    }
    let kinds = path.parts.iter().map(|part| part.kind);
    let parts = kinds.zip(results).zip(shapes).filter_map(|((kind, result), shape)| Some(((kind, result?), shape)));
    let (parts, shapes) = parts.unzip();
    Ok(Judged { parts, shapes })
}

impl Judged {
    /// Whether all parts are safe.
    pub(super) fn safe(&self) -> bool {
        self.parts.iter().all(|(_, result)| result.safe())
    }

    /// Puts other results of the parts in place of these.
    pub(super) fn put(&mut self, results: Vec<SpanResult>) {
        debug_assert_eq!(self.parts.len(), results.len());
        for ((_, known), result) in self.parts.iter_mut().zip(results) {
            *known = result;
        }
    }

    /// The result of the part with this number if it is safe and has kept its shape. A way may drive a part twice.
    fn safe_part(&self, parts: &[RoutePart], number: usize, shape: &Shape) -> Option<&SpanResult> {
        let kind = parts[number].kind;
        let earlier = parts[..number].iter().filter(|part| part.kind == kind).count();
        let same = |known: &Shape| {
            // Stations may be elsewhere along the road.
            let near = |a: &[f64; 5], b: &[f64; 5]| {
                let ([east, north], (sin, cos)) = ([b[0] - a[0], b[1] - a[1]], a[2].sin_cos());
                let (along, across) = (cos * east + sin * north, cos * north - sin * east);
                let widths = (b[3] - a[3]).abs().max((b[4] - a[4]).abs());
                along.abs() < ALONG_M && across.abs() < ACROSS_M && widths < SAME_WIDTH_M
            };
            known.len() == shape.len() && known.iter().zip(shape).all(|(a, b)| near(a, b))
        };
        let mut of_kind = self.parts.iter().zip(&self.shapes).filter(|((of, _), _)| *of == kind);
        let ((_, result), known) = of_kind.nth(earlier)?;
        (result.safe() && same(known)).then_some(result)
    }
}

/// Places along some stations.
fn shape(path: &RoutePath, along: &Range<usize>) -> Shape {
    let corridor = &path.corridor;
    let last = along.len().saturating_sub(1);
    let count = ((last as f64 * corridor.spacing_m / SHAPE_M).round() as usize).max(1);
    let place = |i: usize| {
        let at = along.start as f64 + last as f64 * i as f64 / count as f64;
        let (before, share) = (at as usize, at.fract());
        let after = (before + 1).min(corridor.len() - 1);
        [&corridor.x, &corridor.y, &corridor.heading, &corridor.left_m, &corridor.right_m]
            .map(|column| column[before] + share * (column[after] - column[before]))
    };
    (0..=count).map(place).collect()
}

/// The results of the parts along some stretches of a way, by the parts' numbers. A part that lies in several pieces has several results.
fn looked_at(
    path: &RoutePath,
    stretches: &[Range<usize>],
    driver: &Driver,
    stop: &Stop,
) -> Result<Vec<(usize, SpanResult)>, Stopped> {
    let corridor = &path.corridor;
    let beyond = stations(path, beyond_m(driver));
    let pieces: Vec<Range<usize>> =
        stretches.iter().flat_map(|stretch| cut(stretch, stations(path, PIECE_M))).collect();
    let look = |piece: &Range<usize>| {
        let slice = piece.start.saturating_sub(beyond)..(piece.end + beyond).min(corridor.len());
        let within = |(part, stations): (usize, &Range<usize>)| {
            let own = stations.start.max(piece.start)..stations.end.min(piece.end);
            (own.start < own.end).then(|| (part, own.start - slice.start..own.end - slice.start))
        };
        let parts = path.parts.iter().map(|part| &part.stations).enumerate().filter_map(within);
        let (parts, spans): (Vec<usize>, Vec<Range<usize>>) = parts.unzip();
        let options = &driver.permits.settings.stet;
        let results = certify_parts(&corridor.sliced(slice.clone()), &driver.model, &spans, options, stop)?;
        Ok(parts.into_iter().zip(results).collect::<Vec<_>>())
    };
    let looked = pieces.par_iter().map(look).collect::<Result<Vec<_>, Stopped>>()?;
    Ok(looked.into_iter().flatten().collect())
}

/// Road after which it no longer matters to the vehicle how it began, metres.
fn beyond_m(driver: &Driver) -> f64 {
    BEYOND_M + BEYOND_LENGTHS * driver.model.vehicle.length_m
}

/// A number of metres as stations.
fn stations(path: &RoutePath, metres: f64) -> usize {
    (metres / path.corridor.spacing_m).ceil() as usize
}

/// A stretch in nearly equal pieces that are no longer than `longest` stations.
fn cut(stretch: &Range<usize>, longest: usize) -> impl Iterator<Item = Range<usize>> {
    let (start, length) = (stretch.start, stretch.len());
    let count = length.div_ceil(longest.max(1));
    (0..count).map(move |i| start + length * i / count..start + length * (i + 1) / count)
}

/// The result with less to spare.
fn worse<'r>(a: &'r SpanResult, b: &'r SpanResult) -> &'r SpanResult {
    let key = |result: &SpanResult| (result.safe(), result.rsc_m);
    if key(b).partial_cmp(&key(a)) == Some(std::cmp::Ordering::Less) { b } else { a }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::super::attested::Attested;
    use super::super::permits::Permits;
    use super::super::rungs::Rungs;
    use super::*;
    use crate::corridor::{Corridor, Frame};
    use crate::network::EdgeNo;
    use crate::osm::LonLat;
    use crate::osm::facts::Policy;
    use crate::settings::Settings;
    use crate::stet::Model;
    use crate::vehicle::Catalogue;

    const NARROW: Range<usize> = 1_220..1_280;

    fn driver() -> Driver {
        let settings = Settings::default();
        let permits = Permits {
            settings,
            edges: Vec::new(),
            movements: Vec::new(),
            passages: Vec::new(),
            rungs: Rungs::level(Policy::Lane),
        };
        let model = Model::new(Catalogue::builtin().unwrap().get("EU-SEMI16.5").unwrap()).unwrap();
        Driver { model, permits, attested: Attested::default() }
    }

    /// A straight way of 3 km in three parts, so wide to both sides in the middle of the second one.
    fn way(half_m: f64) -> RoutePath {
        let mut corridor = Corridor::straight(3_000.0, 1.8, 1.8);
        assert!((corridor.spacing_m - 1.0).abs() < 1e-9);
        corridor.left_m[NARROW].fill(half_m);
        corridor.right_m[NARROW].fill(half_m);
        let ends = [0, NARROW.start - 20, NARROW.end + 20, corridor.len()];
        let part = |(edge, ends): (usize, &[usize])| RoutePart {
            kind: PartKind::Edge(EdgeNo::new(edge as u32)),
            stations: ends[0]..ends[1],
        };
        let parts = ends.windows(2).enumerate().map(part).collect();
        let frame = Frame::around(&[LonLat { lon_e7: 86_000_000, lat_e7: 494_000_000 }]).unwrap();
        RoutePath { corridor, frame, parts }
    }

    #[test]
    fn what_fails_or_has_changed_is_looked_at_again_and_nothing_else() {
        let (driver, stop) = (driver(), Stop::default());
        let rsc_m = |judged: &Judged| judged.parts.iter().map(|(_, result)| result.rsc_m.unwrap()).collect::<Vec<_>>();
        let narrow = way(1.2);
        let mut judged = judge(&narrow, &Judged::default(), &driver, &stop).unwrap();
        assert_eq!(judged.parts.iter().map(|(_, result)| result.safe()).collect::<Vec<_>>(), [true, false, true]);
        let spans: Vec<Range<usize>> = narrow.parts.iter().map(|part| part.stations.clone()).collect();
        let options = &driver.permits.settings.stet;
        let whole = certify_parts(&narrow.corridor, &driver.model, &spans, options, &stop).unwrap();
        for (part, whole) in rsc_m(&judged).iter().zip(whole) {
            assert!((part - whole.rsc_m.unwrap()).abs() < 1e-3, "{part} {whole:?}");
        }
        // A mark on what is kept.
        judged.parts[2].1.rsc_m = Some(9.0);
        let wide = judge(&way(1.7), &judged, &driver, &stop).unwrap();
        assert!(wide.safe());
        assert!(rsc_m(&wide)[1] > 0.0 && rsc_m(&wide)[1] < 0.5, "{:?}", rsc_m(&wide));
        // The last part is no better than its stretch beside the second one, and the rest of it is not looked at.
        assert!(rsc_m(&wide)[2] < 1.0);
        let mut changed = way(1.7);
        changed.corridor.left_m[2_500] -= 0.1;
        let mut marked = wide;
        marked.parts.iter_mut().for_each(|(_, result)| result.rsc_m = Some(9.0));
        let again = judge(&changed, &marked, &driver, &stop).unwrap();
        assert_eq!(rsc_m(&again)[0], 9.0, "far from the change");
        assert!(rsc_m(&again)[2] < 1.0, "changed");
    }
}
