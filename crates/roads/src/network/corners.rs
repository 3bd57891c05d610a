//! Sharp corners: bends of the map's line that no smoothed line rounds. A road is cut there, and the way round is a turn.
//!
//! Whether a vertex is a corner depends on the line beside it alone, and not on the direction of travel.

use super::geometry::{chord_deg, deflection_deg, offset_m};
use crate::osm::LonLat;

/// Length of line at which the directions beside a vertex are taken, metres. It passes over steps that smoothing takes out.
pub(super) const REACH_M: f64 = 2.5;
/// Least turn at a sharp corner, degrees. Smoothing rounds such a corner to a radius of some metres, if at all. No lorry steers
/// through that: of the corners above it in five extracts, two were on edges that were safe for a lorry.
const SHARP_DEG: f64 = 60.0;

/// Most vertices that are looked at within [`REACH_M`] to one side. Real lines have fewer: they would lie 4 cm apart. Near a pole, where a
/// step of longitude is no way at all, all vertices of a line may be that near.
const MOST_NEAR: usize = 64;

/// Whether a turn of the line is a sharp corner. Its directions are those of chords of [`REACH_M`].
pub(super) fn is_sharp(corner_deg: f64) -> bool {
    corner_deg >= SHARP_DEG
}

/// Whether a way is cut at an inner vertex of its line. Of several sharp corners within reach of each other only the sharpest
/// one is cut: they are one corner with a short side.
pub(super) fn cuts(line: &[u32], at: usize, place: &impl Fn(u32) -> LonLat) -> bool {
    let back_deg = |i: usize| chord_deg(line[..=i].iter().rev().take(MOST_NEAR + 1).map(|&v| place(v)), REACH_M);
    let ahead_deg = |i: usize| chord_deg(line[i..].iter().take(MOST_NEAR + 1).map(|&v| place(v)), REACH_M);
    let corner = |i: usize| deflection_deg(back_deg(i), ahead_deg(i));
    let own_deg = corner(at);
    if !is_sharp(own_deg) {
        return false;
    }
    // Of two that are equal, the earlier node counts. Drawn the other way round, the way is cut at the same node.
    let counts = |i: usize, corner_deg: f64| ((corner_deg * 1e3).round() as u32, std::cmp::Reverse(line[i]));
    let before = near(line, (1..at).rev(), at, place);
    let after = near(line, at + 1..line.len() - 1, at, place);
    before.chain(after).all(|i| counts(i, corner(i)) < counts(at, own_deg))
}

/// The inner vertices within reach of a vertex along the line, going away from it.
fn near(
    line: &[u32],
    away: impl Iterator<Item = usize>,
    from: usize,
    place: &impl Fn(u32) -> LonLat,
) -> impl Iterator<Item = usize> {
    let (mut last, mut along_m) = (from, 0.0);
    away.take(MOST_NEAR).take_while(move |&i| {
        let [x, y] = offset_m(place(line[last]), place(line[i]));
        along_m += x.hypot(y);
        last = i;
        along_m <= REACH_M
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn looked_at(line: &[LonLat]) -> (u64, Vec<usize>) {
        let looked = std::cell::Cell::new(0);
        let vertices: Vec<u32> = (0..line.len() as u32).collect();
        let place = |vertex: u32| {
            looked.set(looked.get() + 1);
            line[vertex as usize]
        };
        let cut = (1..line.len() - 1).filter(|&at| cuts(&vertices, at, &place)).collect();
        (looked.get(), cut)
    }

    /// All vertices of this line are one place at the pole and turn sharply; that was 10^9 looks for each 1,000 vertices.
    #[test]
    fn a_line_at_a_pole_takes_few_looks_for_each_vertex() {
        let zigzag = |k: i32| LonLat { lon_e7: 40 * (k % 2) + k, lat_e7: 900_000_000 - k % 2 };
        let line: Vec<LonLat> = (0..2_000).map(zigzag).collect();
        let (looked, _) = looked_at(&line);
        assert!(looked < 2_000 * 2 * 66 * 2 * 130, "{looked}");
        // Anywhere else few are within reach.
        let corner: Vec<LonLat> =
            [(0, 0), (1_000, 0), (1_000, 1_000)].map(|(lon_e7, lat_e7)| LonLat { lon_e7, lat_e7 }).to_vec();
        assert_eq!(looked_at(&corner).1, [1]);
    }
}
