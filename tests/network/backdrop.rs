//! What lies behind the roads, against osmium: it makes the same areas of real extracts.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

use netcert::osm::facts::{BackdropForm, BackdropKind};
use netcert::osm::pbf::read_extract;
use netcert::osm::{Backdrop, BackdropShape, LonLat};

use netcert_testing::extracts;
use netcert_testing::skip::skipped;

fn area_deg2(ring: &[LonLat]) -> f64 {
    let origin = ring[0].degrees();
    let at = |p: &LonLat| (p.degrees().0 - origin.0, p.degrees().1 - origin.1);
    let cross = |pair: &[LonLat]| {
        let ((ax, ay), (bx, by)) = (at(&pair[0]), at(&pair[1]));
        ax * by - bx * ay
    };
    0.5 * ring.windows(2).map(cross).sum::<f64>().abs()
}

/// The whole area of each kind, square degrees, holes taken off.
fn areas(things: &[Backdrop]) -> BTreeMap<BackdropKind, f64> {
    let mut areas = BTreeMap::new();
    for thing in things.iter().filter(|thing| thing.kind.form() == BackdropForm::Area) {
        let BackdropShape::Areas(polygons) = &thing.shape else { panic!("{thing:?}") };
        for polygon in polygons {
            assert!(polygon.iter().all(|ring| ring.len() >= 4 && ring.first() == ring.last()), "{thing:?}");
            let holes: f64 = polygon[1..].iter().map(|ring| area_deg2(ring)).sum();
            *areas.entry(thing.kind).or_default() += area_deg2(&polygon[0]) - holes;
        }
    }
    areas
}

/// What osmium makes areas of.
const AREAS: [&str; 3] = ["natural=water,wood", "waterway=riverbank,dock", "landuse=forest,reservoir,basin"];

/// The same by osmium, and the number of areas. `None` without osmium.
fn by_osmium(path: &Path) -> Option<(BTreeMap<BackdropKind, f64>, u64)> {
    let folder = tempfile::tempdir().unwrap();
    let [config, sorted, found, shapes] =
        ["config.json", "sorted.osm.pbf", "found.osm.pbf", "shapes.json"].map(|name| folder.path().join(name));
    let wanted = serde_json::json!({"linear_tags": false, "area_tags": AREAS, "exclude_tags": [], "include_tags": []});
    std::fs::write(&config, wanted.to_string()).unwrap();
    let osmium = |command: &mut Command| {
        let done = command.output().ok()?;
        assert!(done.status.success(), "{command:?}: {}", String::from_utf8_lossy(&done.stderr));
        Some(())
    };
    osmium(Command::new("osmium").args(["sort", "-o"]).arg(&sorted).arg(path))?;
    osmium(Command::new("osmium").args(["tags-filter", "-o"]).arg(&found).arg(&sorted).args(AREAS)).unwrap();
    let export = ["export", "--geometry-types=polygon", "-f", "geojsonseq", "-c"];
    osmium(Command::new("osmium").args(export).arg(&config).arg("-o").arg(&shapes).arg(&found)).unwrap();
    let text = std::fs::read_to_string(shapes).unwrap();
    let (mut areas, mut count) = (BTreeMap::new(), 0);
    for line in text.lines().map(|line| line.trim_start_matches('\u{1e}')).filter(|line| !line.is_empty()) {
        let feature: serde_json::Value = serde_json::from_str(line).unwrap();
        let tag = |key: &str| feature["properties"][key].as_str().unwrap_or("no").to_owned();
        if tag("tunnel") != "no"
            || tag("covered") != "no"
            || ["underground", "indoor"].contains(&tag("location").as_str())
        {
            continue;
        }
        let water = tag("natural") == "water"
            || ["riverbank", "dock"].contains(&tag("waterway").as_str())
            || ["reservoir", "basin"].contains(&tag("landuse").as_str());
        let polygons: Vec<Vec<Vec<[f64; 2]>>> =
            serde_json::from_value(feature["geometry"]["coordinates"].clone()).unwrap();
        let ring =
            |ring: &Vec<[f64; 2]>| area_deg2(&ring.iter().map(|&[lon, lat]| rounded(lon, lat)).collect::<Vec<_>>());
        let polygon = |rings: &Vec<Vec<[f64; 2]>>| ring(&rings[0]) - rings[1..].iter().map(ring).sum::<f64>();
        let kind = if water { BackdropKind::Water } else { BackdropKind::Wood };
        *areas.entry(kind).or_default() += polygons.iter().map(polygon).sum::<f64>();
        count += 1;
    }
    Some((areas, count))
}

fn rounded(lon: f64, lat: f64) -> LonLat {
    LonLat { lon_e7: (lon * 1e7).round() as i32, lat_e7: (lat * 1e7).round() as i32 }
}

#[test]
fn areas_of_real_extracts_are_those_of_osmium() {
    for name in ["andorra", "victoria_au", "columbus_oh_us", "sydney_au"] {
        let Some(path) = extracts::extract(&format!("{name}.osm.pbf")) else { continue };
        let Some((theirs, count)) = by_osmium(&path) else { return skipped("osmium", "Debian: osmium-tool") };
        let extract = read_extract(&path, &|_| ()).unwrap();
        let ours = areas(&extract.backdrop);
        println!("{name}: {ours:?}, {:?}; osmium {theirs:?}, {count} areas", extract.account.backdrop);
        for (kind, theirs) in theirs {
            let ours = ours.get(&kind).copied().unwrap_or(0.0);
            // Shapes are within two metres: a hundredth, and some twenty square metres of each area, most of which are ponds.
            let allowed = 0.01 * theirs + 2e-9 * count as f64;
            assert!((ours - theirs).abs() <= allowed, "{name}, {kind:?}: {ours} instead of {theirs}");
        }
        let kept = extract.backdrop.iter().filter(|thing| thing.kind.form() == BackdropForm::Area).count() as u64;
        assert_eq!(kept + extract.account.backdrop.too_small, count, "{name}");
    }
}
