//! The Hilbert curve: neighbours on it are neighbours on the ground.

use crate::osm::LonLat;

/// The place of a cell along the curve through 2^`bits` × 2^`bits` cells. `bits` is at most 32.
pub(super) fn hilbert(mut x: u32, mut y: u32, bits: u32) -> u64 {
    let mut along = 0_u64;
    for bit in (0..bits).rev() {
        let (right, up) = (x >> bit & 1, y >> bit & 1);
        // The quarters are visited in the order (0, 0), (0, 1), (1, 1), (1, 0); the first and last are rotated.
        along = along << 2 | u64::from((3 * right) ^ up);
        if up == 0 {
            if right == 1 {
                (x, y) = (!x, !y);
            }
            (x, y) = (y, x);
        }
    }
    along
}

/// The place along the curve over the whole earth of the middle of a line's box, in cells of 1e-7 degree.
pub(super) fn of_line(line: &[LonLat]) -> u64 {
    let middle = |values: &mut dyn Iterator<Item = i32>| {
        let (low, high) = values.fold((i32::MAX, i32::MIN), |(low, high), value| (low.min(value), high.max(value)));
        // 180° are 1.8e9 cells: longitudes and latitudes are then above 0 and below 2^32.
        ((i64::from(low) + i64::from(high)) / 2 + 1_800_000_000).clamp(0, u32::MAX.into()) as u32
    };
    let x = middle(&mut line.iter().map(|place| place.lon_e7));
    let y = middle(&mut line.iter().map(|place| place.lat_e7));
    hilbert(x, y, u32::BITS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_goes_from_each_cell_to_a_neighbour() {
        const N: u32 = 32;
        let mut cells: Vec<(u64, u32, u32)> =
            (0..N * N).map(|cell| (hilbert(cell % N, cell / N, 5), cell % N, cell / N)).collect();
        cells.sort_unstable();
        assert!(cells.iter().map(|cell| cell.0).eq(0..u64::from(N * N)));
        for pair in cells.windows(2) {
            assert_eq!(pair[0].1.abs_diff(pair[1].1) + pair[0].2.abs_diff(pair[1].2), 1, "{pair:?}");
        }
        assert_eq!((hilbert(0, 0, 32), hilbert(u32::MAX, 0, 32)), (0, u64::MAX));
    }

    #[test]
    fn a_line_is_where_the_middle_of_its_box_is() {
        let at = |lon_e7, lat_e7| LonLat { lon_e7, lat_e7 };
        let line = [at(10, 40), at(30, 0), at(20, 20)];
        assert_eq!(of_line(&line), of_line(&[at(20, 20)]));
        assert_ne!(of_line(&line), of_line(&[at(21, 20)]));
        assert_eq!(of_line(&[at(-1_800_000_000, -900_000_000)]), hilbert(0, 900_000_000, 32));
    }
}
