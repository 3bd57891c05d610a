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

/// Whether a turn of the line is a sharp corner. Its directions are those of chords of [`REACH_M`].
pub(super) fn is_sharp(corner_deg: f64) -> bool {
    corner_deg >= SHARP_DEG
}

/// Whether a way is cut at an inner vertex of its line. Of several sharp corners within reach of each other only the sharpest
/// one is cut: they are one corner with a short side.
pub(super) fn cuts(line: &[u32], at: usize, place: &impl Fn(u32) -> LonLat) -> bool {
    let back_deg = |i: usize| chord_deg(line[..=i].iter().rev().map(|&v| place(v)), REACH_M);
    let ahead_deg = |i: usize| chord_deg(line[i..].iter().map(|&v| place(v)), REACH_M);
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
    away.take_while(move |&i| {
        let [x, y] = offset_m(place(line[last]), place(line[i]));
        along_m += x.hypot(y);
        last = i;
        along_m <= REACH_M
    })
}
