//! Effects between stations a metre apart, in the tightest bends. Hinges fold farthest between two stations. Trailers
//! follow curves and not chords. On the inside of a bend feet move several times as far as their points.

use crate::ends::{attacked, refuted, unit, vehicle};

use netcert::corridor::Corridor;
use netcert::stet::Options;
use netcert::vehicle::Vehicle;
use netcert_testing::oracle::claim::{certify, claim};
use netcert_testing::oracle::draw::Draw;
use netcert_testing::oracle::path::Path;
use netcert_testing::oracle::road;
use netcert_testing::thorough;
use rayon::prelude::*;

fn cases() -> u64 {
    thorough::cases(200, 2_000)
}

/// A bend, perhaps one to the other side, and straights. Curvature rises within one to three stations.
fn tight(draw: &mut Draw, radius_m: f64, half_width: impl Fn(f64) -> [f64; 2]) -> Corridor {
    let rise = 1.0 + draw.below(3) as f64;
    let side = draw.sign();
    let (arc, gap) = (draw.between(4.0, 1.5 * radius_m), draw.between(1.0, 12.0));
    let back = draw.one_in(2);
    let at = |s: f64| {
        let bend = |from: f64| ((s - from) / rise).min((from + arc - s) / rise).clamp(0.0, 1.0);
        let curvature = bend(12.0) - if back { bend(12.0 + arc + gap) } else { 0.0 };
        side * curvature / radius_m
    };
    let curvature: Vec<f64> = (0..60).map(|k| at(k as f64)).collect();
    let [left, right] = [0, 1].map(|i| curvature.iter().map(|&k| half_width(k)[i]).collect::<Vec<f64>>());
    road::corridor(1.0, [0.0; 2], draw.between(-3.0, 3.0), &curvature, &left, &right)
}

/// The number of claims, and the refuted ones. `attack` returns `None` without a claim, otherwise a description of any
/// refutation.
fn refute(attack: impl Fn(&mut Draw) -> Option<Option<String>> + Sync) -> (usize, Vec<String>) {
    let one = |index: u64| Some((index, attack(&mut Draw(0x57a7_1000 + index * 7919))?));
    let tried: Vec<(u64, Option<String>)> = (0..cases()).into_par_iter().filter_map(one).collect();
    let broken = tried.iter().filter_map(|(index, words)| words.as_ref().map(|words| format!("{index}: {words}")));
    (tried.len(), broken.collect())
}

/// The corridor's own centreline, four vertices per metre: a cubic through stations a metre apart is another curve.
fn centreline(corridor: &Corridor, vehicle: &Vehicle) -> Path {
    let road = road::PreparedCorridor::new(corridor);
    let places: Vec<[f64; 2]> = (0..=4 * (corridor.len() - 1)).map(|k| road.centre(0.25 * k as f64).0).collect();
    let headings = (corridor.heading[0], corridor.heading[corridor.len() - 1]);
    Path::through(&places, 0.25, headings, 3.0 * vehicle.length_m, vehicle.length_m + 8.0)
}

#[test]
fn what_is_nominal_between_stations_is_counted() {
    let (tried, broken) = refute(|draw| {
        // There is hardly any disturbance, so the test examines the nominal motion itself.
        let hitch = draw.between(-0.6, 8.0);
        let units = [
            unit(draw.between(3.5, 6.4), hitch, 1.0, hitch.max(0.5), 80.0, 0.0),
            unit(draw.between(3.0, 8.0), draw.between(-0.5, 3.0), -1.0, 3.5, 80.0, 0.0),
            unit(draw.between(3.0, 8.0), 0.0, -1.0, 3.0, 80.0, 0.0),
        ];
        let vehicle = vehicle("nearly exact", 0.002, units[..2 + draw.below(2)].to_vec());
        let radius_m = draw.log_between(8.0, 25.0);
        let corridor = tight(draw, radius_m, |_| [6.0; 2]);
        let claim = claim(&corridor, &vehicle, &Options { max_shift_m: 0.0, ..Options::default() })?;
        Some(attacked(&corridor, &vehicle, &centreline(&corridor, &vehicle), &claim, draw, 1))
    });
    println!("{tried} corridors have a claim, {} are refuted", broken.len());
    assert!(broken.is_empty(), "{} of {tried} claims refuted: {broken:#?}", broken.len());
    assert!(tried * 2 > cases() as usize, "only {tried} corridors could be tried");
}

#[test]
fn the_inside_of_a_tight_bend_is_as_wide_as_is_said() {
    let (tried, broken) = refute(|draw| {
        let vehicle = vehicle("rigid", draw.between(0.05, 0.3), vec![unit(4.0, 0.0, 1.0, 1.5, 70.0, 0.3)]);
        let radius_m = draw.log_between(6.0, 12.0);
        // The tighter the bend, the wider the corridor: the inside reaches far towards the centre, and its edge runs
        // askew.
        let (part, other) = (draw.between(0.5, 0.85), draw.between(2.0, 3.0));
        let inside = move |towards: f64| other.max(part * radius_m * (towards * radius_m).clamp(0.0, 1.0));
        let corridor = tight(draw, radius_m, |k| [inside(k), inside(-k)]);
        let claim = certify(&corridor, &vehicle)?;
        Some(refuted(&corridor, &vehicle, &claim, draw, 1))
    });
    println!("{tried} corridors have a claim, {} are refuted", broken.len());
    assert!(broken.is_empty(), "{} of {tried} claims refuted: {broken:#?}", broken.len());
    assert!(tried * 2 > cases() as usize, "only {tried} corridors could be tried");
}
