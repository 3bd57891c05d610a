//! Blocks: rectangles of cells whose networks are built one after the other, so that memory does not grow with the file.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use super::cell::{GridCell, ZOOM, corner_deg};
use super::extent::Extent;

/// How far beyond the cells around a block roads matter to it, metres (see `docs/decisions/cells.md`).
const HALO_M: f64 = 1000.0;

/// A rectangle of cells.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub(super) struct CellBlock {
    x: RangeInclusive<u32>,
    y: RangeInclusive<u32>,
}

impl CellBlock {
    /// The smallest rectangle with all of these cells, of which there is at least one.
    fn around(cells: &[(GridCell, u32)]) -> Self {
        let range = |of: fn(&GridCell) -> u32| {
            let all = || cells.iter().map(|(cell, _)| of(cell));
            all().min().unwrap_or(0)..=all().max().unwrap_or(0)
        };
        Self { x: range(|cell| cell.x), y: range(|cell| cell.y) }
    }

    pub(super) fn has(&self, cell: GridCell) -> bool {
        self.x.contains(&cell.x) && self.y.contains(&cell.y)
    }

    /// Whether a stroke in the surroundings of this block may begin in the other one. Surroundings end within the second cell beyond a
    /// block, and a stroke begins at most one cell before.
    pub(super) fn needs(&self, other: &Self) -> bool {
        const CELLS: i64 = 3;
        let meet = |a: &RangeInclusive<u32>, b: &RangeInclusive<u32>, by: i64| {
            let [a_start, a_end, b_start, b_end] = [a.start(), a.end(), b.start(), b.end()].map(|&at| i64::from(at));
            a_start + by - CELLS <= b_end && b_start - CELLS <= a_end + by
        };
        // The grid goes on beyond the 180th meridian.
        let around = 1 << ZOOM;
        meet(&self.y, &other.y, 0) && [0, around, -around].into_iter().any(|by| meet(&self.x, &other.x, by))
    }

    /// The extent of all that its edges, strokes and turns depend on: its cells, their neighbours and 1 km more.
    pub(super) fn surroundings(&self) -> Extent {
        let last = (1 << ZOOM) - 1;
        let (west, north) = corner_deg(i64::from(*self.x.start()) - 1, self.y.start().saturating_sub(1));
        let (east, south) = corner_deg(i64::from(*self.x.end()) + 2, (self.y.end() + 1).min(last) + 1);
        let e7 = |degrees: f64| (degrees * 1e7).round() as i32;
        // Positions beyond the grid's northern and southern borders are in its outermost cells.
        let south = if *self.y.end() + 1 >= last { -90.0 } else { south };
        let north = if *self.y.start() <= 1 { 90.0 } else { north };
        Extent { west: e7(west), south: e7(south), east: e7(east), north: e7(north) }.wider_by(HALO_M)
    }
}

/// Divides the cells of a world, given with the number of their edges, into blocks with at most `most` edges where a cell has no more.
/// Every cell is in exactly one block.
pub(super) fn divide(cells: &BTreeMap<GridCell, u32>, most: u64) -> Vec<CellBlock> {
    let mut blocks = Vec::new();
    let mut left: Vec<Vec<(GridCell, u32)>> = vec![cells.iter().map(|(&cell, &edges)| (cell, edges)).collect()];
    while let Some(mut cells) = left.pop() {
        let edges = |cells: &[(GridCell, u32)]| cells.iter().map(|&(_, edges)| u64::from(edges)).sum::<u64>();
        let CellBlock { x, y } = CellBlock::around(&cells);
        if cells.is_empty() {
            continue;
        }
        if edges(&cells) <= most || cells.len() == 1 {
            blocks.push(CellBlock { x, y });
            continue;
        }
        // Cut across the longer side, where the halves have most nearly the same number of edges.
        let wide = x.end() - x.start() >= y.end() - y.start();
        let along = |cell: &GridCell| if wide { cell.x } else { cell.y };
        cells.sort_unstable_by_key(|(cell, _)| (along(cell), *cell));
        let half = edges(&cells) / 2;
        let mut before = 0;
        let middle = cells.iter().find(|(_, edges)| {
            before += u64::from(*edges);
            before > half
        });
        let ends = [cells.first(), cells.last()].map(|end| end.map_or(0, |(cell, _)| along(cell)));
        let line = middle.map_or(0, |(cell, _)| along(cell)).clamp(ends[0] + 1, ends[1]);
        let rest = cells.split_off(cells.partition_point(|(cell, _)| along(cell) < line));
        left.extend([rest, cells]);
    }
    blocks
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::osm::LonLat;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn every_cell_is_in_one_block(
            cells in prop::collection::btree_map((0_u32..40, 0_u32..40), 1_u32..900, 0..200), most in 1_u64..5000,
        ) {
            let cells: BTreeMap<GridCell, u32> = cells.into_iter().map(|((y, x), edges)| (GridCell { y, x }, edges)).collect();
            let blocks = divide(&cells, most);
            for cell in cells.keys() {
                prop_assert_eq!(blocks.iter().filter(|block| block.has(*cell)).count(), 1);
            }
            for block in &blocks {
                let own: Vec<u32> = cells.iter().filter(|(cell, _)| block.has(**cell)).map(|(_, edges)| *edges).collect();
                prop_assert!(own.len() == 1 || own.iter().map(|&edges| u64::from(edges)).sum::<u64>() <= most);
            }
        }
    }

    #[test]
    fn the_surroundings_have_the_neighbours_and_a_kilometre_more() {
        let block = CellBlock { x: 1073..=1074, y: 699..=699 };
        let extent = block.surroundings();
        let has = |(lon, lat): (f64, f64)| {
            let at = LonLat { lon_e7: (lon * 1e7) as i32, lat_e7: (lat * 1e7) as i32 };
            Extent::of([at].into_iter()).is_some_and(|place| place.meets(extent))
        };
        let ((west, north), (east, south)) = (corner_deg(1072, 698), corner_deg(1076, 701));
        // The neighbours of the last column are those of the first one.
        let [first, last] = [0..=0, 2047..=2047].map(|x| CellBlock { x, y: 699..=699 });
        assert!(first.needs(&last) && last.needs(&first));
        for (block, inside_deg, outside_deg) in [(&first, 179.83, 179.7), (&last, -179.83, -179.7)] {
            let has = |lon: f64| {
                let at = LonLat { lon_e7: (lon * 1e7) as i32, lat_e7: 493_000_000 };
                Extent::of([at].into_iter()).is_some_and(|place| place.meets(block.surroundings()))
            };
            assert!(has(inside_deg) && !has(outside_deg) && has(180.0) && has(-180.0));
        }
        let degree = 111_195.0;
        let (lat, lon) = (990.0 / degree, 990.0 / degree / 49.5_f64.to_radians().cos());
        for (inside, at) in [
            (true, (west - lon, north + lat)),
            (true, (east + lon, south - lat)),
            (false, (west - 1.1 * lon, north)),
            (false, (east, south - 1.1 * lat)),
        ] {
            assert_eq!(has(at), inside, "{at:?}");
        }
        // At the poles the outermost cells have no border.
        let extent = CellBlock { x: 0..=2047, y: 0..=2047 }.surroundings();
        assert!(extent.south <= -900_000_000 && extent.north >= 900_000_000);
    }
}
