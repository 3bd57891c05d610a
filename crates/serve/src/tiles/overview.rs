//! The main roads at zooms up to 10. They are held in memory without names and ids, and all roads that coincide in a tile
//! become one line.
//!
//! A road is never drawn as certified where one of its directions or pieces is not. The worst verdict counts of all that
//! falls on one half pixel, margins are rounded down, and a piece that is not certified is drawn at least a pixel long.
//! Left out are the classes that `classes` leaves out, ramps below zoom 10, and certified pieces of less than half a
//! pixel.

use super::classes::{BY_RANK, classes};
use super::encode::{TagValue, TileLayer};
use super::grid::{self, BUFFER, TileAddress};
use super::raster::{LineAttributes, Raster};
use super::shape;
use crate::osm::facts::highway;
use crate::osm::facts::{Policy, WidthSource};
use crate::rows::MainRoad;
use crate::verdict::Verdict;
use crate::words::{Named, verdict_words};

/// The last zoom of the overview. Tiles of deeper zooms show each edge.
pub(super) const LAST_ZOOM: u8 = 10;
/// Units per side of a tile. A unit is half a pixel of a tile of 512 pixels; nobody sees finer detail, and small numbers
/// are encoded in fewer bytes.
const EXTENT: f64 = 1024.0;
/// Units of the other layers in one unit of the overview.
const COARSER: f64 = grid::EXTENT / EXTENT;
/// Ramps are shown from this zoom on.
const FIRST_WITH_RAMPS: u8 = 10;

/// Size of a step of the margin (the RSC), millimetres. Margins are rounded down to steps; every bound between two colours of
/// the map is a whole number of steps.
const STEP_MM: i64 = 250;
/// The greatest margin, in steps. Greater margins are shown as this one.
const MOST_STEPS: i64 = 4;
/// The least margin, in steps. Smaller margins are shown as this one.
const LEAST_STEPS: i64 = -5;

/// The main roads of a region under a vehicle's certificates.
pub(super) struct Overview {
    /// Sorted by class, the most important first.
    roads: Vec<Road>,
    /// The verdicts with their reasons. `LineAttributes::verdict` is an index into them.
    verdicts: Vec<Verdict>,
}

struct Road {
    said: LineAttributes,
    /// Least and greatest of each coordinate.
    bounds: [grid::World; 2],
    line: Vec<grid::World>,
}

impl Overview {
    /// The roads of the overview, simplified for [`LAST_ZOOM`]. The two directions of a road get lines of the same order of
    /// points, so that they coincide.
    pub(super) fn new(rows: &[MainRoad]) -> Self {
        let mut verdicts: Vec<Verdict> = rows.iter().map(|row| row.verdict).collect();
        verdicts.sort_unstable_by_key(|&verdict| (severity(verdict), verdict_words(verdict)));
        verdicts.dedup();
        let road = |row: &MainRoad| {
            let rank = BY_RANK.iter().position(|class| *class == row.class)?;
            let said = said(row, rank, verdicts.iter().position(|other| *other == row.verdict)?);
            let line = simplified(row);
            let (first, last) = (*line.first()?, *line.last()?);
            let side = |pick: fn(f64, f64) -> f64| {
                line.iter().fold(first, |bound, p| [pick(bound[0], p[0]), pick(bound[1], p[1])])
            };
            let bounds = [side(f64::min), side(f64::max)];
            // Reversed if needed, so that both directions of a road have the same line.
            let turned = first.partial_cmp(&last).is_some_and(std::cmp::Ordering::is_gt);
            let line = if turned { line.into_iter().rev().collect() } else { line };
            Some(Road { said, bounds, line })
        };
        let mut roads: Vec<Road> = rows.iter().filter_map(road).collect();
        roads.sort_by_key(|road| road.said.class);
        Self { roads, verdicts }
    }

    /// The layer of a tile.
    pub(super) fn layer(&self, tile: TileAddress) -> TileLayer {
        let classes = classes(tile.z).len();
        let [west_north, east_south] = tile.world(BUFFER);
        let outside = |road: &Road| {
            let [least, greatest] = road.bounds;
            (0..2).any(|axis| greatest[axis] < west_north[axis] || least[axis] > east_south[axis])
        };
        let mut raster = Raster::default();
        for road in self.roads.iter().take_while(|road| class_of(road.said).0 < classes) {
            if outside(road) || class_of(road.said).1 && tile.z < FIRST_WITH_RAMPS {
                continue;
            }
            let line: Vec<[f64; 2]> = road.line.iter().map(|&world| tile.units_of(world)).collect();
            for part in shape::clipped(&line) {
                raster.add(part.into_iter().map(|point| point.map(|c| (c / COARSER).round() as i32)), road.said);
            }
        }
        let mut layer = TileLayer::new("overview", EXTENT as u16);
        for (said, lines) in raster.lines() {
            self.add(&mut layer, said, &lines);
        }
        layer
    }

    fn add(&self, layer: &mut TileLayer, said: LineAttributes, lines: &[Vec<[i32; 2]>]) {
        let (rank, link) = class_of(said);
        let (Some(class), Some(&verdict)) = (BY_RANK.get(rank), self.verdicts.get(usize::from(said.verdict))) else {
            return;
        };
        let (verdict, reason) = verdict_words(verdict);
        let highway = highway(*class, link);
        layer.feature(None, lines, |tags| {
            tags.add("highway", TagValue::Text(&highway));
            tags.add("verdict", TagValue::Text(verdict));
            tags.text("reason", Some(reason).filter(|reason| !reason.is_empty()));
            tags.number("rsc_m", steps(said.short).map(|steps| (steps * STEP_MM) as f64 / 1000.0));
            tags.text("width_source", source(said.doubt).map(WidthSource::name));
            tags.text("uses", Policy::ALL.get(usize::from(said.strip)).copied().map(Policy::name));
        });
    }
}

fn simplified(row: &MainRoad) -> Vec<grid::World> {
    let line: Vec<grid::World> = row.line.iter().map(|&position| grid::world(position)).collect();
    // A quarter of a pixel at the last zoom.
    shape::simplified(&line, 1.0 / (512.0 * 4.0 * f64::from(1_u32 << LAST_ZOOM)))
}

/// How strongly a verdict shows over others: a known obstacle over an unknown one, anything over safe.
pub(in super::super) fn severity(verdict: Verdict) -> u8 {
    match verdict {
        Verdict::Safe => 0,
        Verdict::Unknown(_) => 1,
        Verdict::Unsafe(_) => 2,
        Verdict::Forbidden(_) => 3,
    }
}

fn said(row: &MainRoad, rank: usize, verdict: usize) -> LineAttributes {
    let decided = matches!(row.verdict, Verdict::Safe | Verdict::Unsafe(_));
    let steps = row.rsc_mm.filter(|_| decided).map(|mm| mm.div_euclid(STEP_MM).clamp(LEAST_STEPS, MOST_STEPS));
    LineAttributes {
        class: (2 * rank + usize::from(row.link)) as u8,
        severity: severity(row.verdict),
        short: steps.map_or(UNTOLD, |steps| (MOST_STEPS - steps) as u8),
        verdict: verdict as u8,
        strip: row.uses.map_or(Policy::ALL.len(), |policy| policy as usize) as u8,
        doubt: row.width_source.map_or(WidthSource::ALL.len(), |own| {
            WidthSource::ALL.iter().rev().position(|source| *source == own).unwrap_or(WidthSource::ALL.len())
        }) as u8,
    }
}

/// The value of `LineAttributes::short` that means there is no margin.
const UNTOLD: u8 = u8::MAX;

fn steps(short: u8) -> Option<i64> {
    (short != UNTOLD).then(|| MOST_STEPS - i64::from(short))
}

fn source(doubt: u8) -> Option<WidthSource> {
    WidthSource::ALL.iter().rev().nth(usize::from(doubt)).copied()
}

/// The rank of the class, and whether the road is a ramp.
fn class_of(said: LineAttributes) -> (usize, bool) {
    (usize::from(said.class / 2), said.class % 2 == 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::osm::LonLat;
    use crate::osm::facts::RoadClass;
    use crate::verdict::{UnknownReason, UnsafeReason};

    fn row(verdict: Verdict, rsc_mm: Option<i64>, width_source: Option<WidthSource>) -> MainRoad {
        let line = [(0, 0), (10_000_000, 0)].map(|(lon_e7, lat_e7)| LonLat { lon_e7, lat_e7 }).to_vec();
        MainRoad {
            class: RoadClass::Primary,
            link: false,
            width_source,
            verdict,
            rsc_mm,
            uses: Some(Policy::Direction),
            line,
        }
    }

    #[test]
    fn a_margin_is_rounded_down_and_evidence_comes_back() {
        for (mm, told_m) in
            [(0, 0.0), (249, 0.0), (250, 0.25), (999, 0.75), (5000, 1.0), (-1, -0.25), (-1000, -1.0), (-90_000, -1.25)]
        {
            let verdict = if mm < 0 { Verdict::Unsafe(UnsafeReason::Width) } else { Verdict::Safe };
            let said = said(&row(verdict, Some(mm), None), 2, 0);
            assert_eq!(steps(said.short).map(|steps| (steps * STEP_MM) as f64 / 1000.0), Some(told_m), "{mm}");
            assert!(told_m * 1000.0 <= mm as f64 || mm < -1250);
        }
        for own in WidthSource::ALL.iter().map(|&source| Some(source)).chain([None]) {
            let said = said(&row(Verdict::Safe, Some(0), own), 2, 0);
            assert_eq!((source(said.doubt), class_of(said)), (own, (2, false)));
            assert_eq!(Policy::ALL[usize::from(said.strip)], Policy::Direction);
        }
        assert_eq!(steps(said(&row(Verdict::Unknown(UnknownReason::Width), Some(3), None), 0, 0).short), None);
    }

    #[test]
    fn both_directions_are_one_line_with_the_worse_verdict() {
        let mut back = row(Verdict::Unsafe(UnsafeReason::Width), Some(-10), None);
        back.line.reverse();
        let overview = Overview::new(&[row(Verdict::Safe, Some(700), None), back]);
        assert_eq!(overview.roads[0].line, overview.roads[1].line);
        assert_eq!(overview.verdicts, [Verdict::Safe, Verdict::Unsafe(UnsafeReason::Width)]);
    }
}
