//! A thousand rows with noise of 3 m on roads side by side: none may be matched wrongly.

use std::collections::BTreeMap;

use super::super::{Match, MeasurementRow, Place, match_rows};
use super::drawing::{Drawing, at, row};
use crate::network::Network;

/// Numbers that are the same in every run (`SplitMix64`).
pub(super) struct Random(pub(super) u64);

impl Random {
    pub(super) fn below_one(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(super) fn below(&mut self, n: usize) -> usize {
        (self.below_one() * n as f64) as usize
    }

    /// Two numbers from a normal distribution (Box and Muller 1958).
    pub(super) fn normal(&mut self, sigma: f64) -> [f64; 2] {
        let (radius, angle) = ((-2.0 * (1.0 - self.below_one()).ln()).sqrt(), std::f64::consts::TAU * self.below_one());
        [sigma * radius * angle.cos(), sigma * radius * angle.sin()]
    }
}

const GROUPS: usize = 40;
const PIECES: usize = 5;
const PIECE_M: f64 = 100.0;

/// How far apart the roads of a group are, metres. Every fifth group has 20 m, the others 8 to 12 m.
fn apart_m(group: usize) -> f64 {
    if group.is_multiple_of(5) { 20.0 } else { 8.0 + (group % 5) as f64 }
}

/// A place on a road. The roads of odd groups are curved.
fn place(group: usize, road: usize, along_m: f64) -> [f64; 2] {
    let offset_m = apart_m(group) * road as f64;
    if group.is_multiple_of(2) {
        return [along_m, 300.0 * group as f64 + offset_m];
    }
    let (sin, cos) = (along_m / 400.0).sin_cos();
    [2000.0 + (400.0 - offset_m) * sin, 300.0 * group as f64 + 400.0 - (400.0 - offset_m) * cos]
}

fn way_id(group: usize, road: usize, piece: usize) -> i64 {
    (1 + 100 * group + 10 * road + piece) as i64
}

fn name(group: usize, road: usize) -> String {
    format!("Road {group}-{road}")
}

/// Groups of three roads of five edges each, drawn every 20 m.
fn network() -> Network {
    let mut drawing = Drawing::default();
    for (group, road) in (0..GROUPS).flat_map(|group| (0..3).map(move |road| (group, road))) {
        for piece in 0..PIECES {
            let at = |step: i32| place(group, road, PIECE_M * piece as f64 + 20.0 * f64::from(step));
            let line: Vec<[f64; 2]> = (0..=5).map(at).collect();
            drawing = drawing.road(way_id(group, road, piece), &line, &name(group, road));
        }
    }
    drawing.network()
}

/// A row and the ways that it means. Noise is either of each position or of the whole line.
fn drawn(random: &mut Random, number: usize) -> (String, MeasurementRow, Vec<i64>) {
    let (group, road) = (random.below(GROUPS), random.below(3));
    let first = random.below(PIECES);
    let last = first + random.below(PIECES - first);
    let (named, whole) = (number.is_multiple_of(2), (number / 2).is_multiple_of(2));
    let shift = random.normal(3.0);
    let (start_m, end_m) = (PIECE_M * first as f64, PIECE_M * (last + 1) as f64);
    let steps = ((end_m - start_m) / 20.0) as usize;
    let line = (0..=steps).map(|step| {
        let place = place(group, road, start_m + 20.0 * step as f64);
        let noise = if whole { shift } else { random.normal(3.0) };
        at([place[0] + noise[0], place[1] + noise[1]])
    });
    let place = Place::Line(line.collect());
    let kind = format!(
        "{} {}",
        if named { "named" } else { "nameless" },
        if apart_m(group) < 20.0 { "8-12 m" } else { "20 m" }
    );
    let row = MeasurementRow { name: named.then(|| name(group, road)), ..row(place) };
    (kind, row, (first..=last).map(|piece| way_id(group, road, piece)).collect())
}

#[test]
#[allow(clippy::print_stderr)]
fn of_a_thousand_rows_with_noise_none_is_matched_wrongly() {
    let network = network();
    let mut random = Random(7);
    let cases: Vec<_> = (0..1000).map(|number| drawn(&mut random, number)).collect();
    let rows: Vec<MeasurementRow> = cases.iter().map(|case| case.1.clone()).collect();
    let matches = match_rows(&network, &rows);
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    assert_eq!(one_thread.install(|| match_rows(&network, &rows)), matches);
    // By kind: all rows, matched whole, matched in part.
    let mut counts: BTreeMap<&str, [usize; 3]> = BTreeMap::new();
    for ((kind, row, truth), found) in cases.iter().zip(&matches) {
        let count = counts.entry(kind).or_default();
        count[0] += 1;
        let Match::Edges(edges) = found else { continue };
        let mut ways: Vec<i64> = edges.iter().map(|&edge| network.road(&network.edges[edge.index()]).way_id).collect();
        assert_eq!(edges.len() % 2, 0, "both directions");
        ways.dedup();
        assert!(ways.iter().all(|way| truth.contains(way)), "{kind}: {ways:?} for {truth:?}: {:?}", row.place);
        count[if ways == *truth { 1 } else { 2 }] += 1;
    }
    eprintln!("kind: rows, matched whole, matched in part: {counts:?}");
    for (kind, [rows, whole, _]) in counts {
        assert!(kind == "nameless 8-12 m" || 10 * whole > 9 * rows, "{kind}: {whole} of {rows}");
    }
}

#[test]
fn of_a_thousand_points_with_noise_none_is_matched_wrongly() {
    let network = network();
    let mut random = Random(8);
    let mut matched = 0;
    for _ in 0..1000 {
        let (group, road, along_m) = (random.below(GROUPS), random.below(3), random.below_one() * 500.0);
        let (place, noise) = (place(group, road, along_m), random.normal(3.0));
        let row = super::drawing::point([place[0] + noise[0], place[1] + noise[1]]);
        let Match::Edges(edges) = super::drawing::matched(&network, &row) else { continue };
        let way = network.road(&network.edges[edges[0].index()]).way_id;
        assert_eq!(way, way_id(group, road, (along_m / PIECE_M) as usize), "{place:?} {noise:?}");
        matched += 1;
    }
    assert!(matched > 50, "{matched}");
}
