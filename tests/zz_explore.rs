#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]
#[path = "support/ascii_map.rs"]
#[allow(dead_code)]
mod ascii_map;
#[path = "support/routing.rs"]
#[allow(dead_code)]
mod routing;
use ascii_map::AsciiMap;
use netcert::osm::facts::Policy;
use netcert::route::*;
use netcert::turns::Kerbs;
use rayon::prelude::*;
use routing::Region;

#[test]
fn explore() {
    let mut cases = Vec::new();
    for id in ["EU-SEMI16.5", "AU-BDOUBLE26"] {
        for width in [7.0, 8.0, 9.0, 10.0, 12.0] {
            for kerb in [8.0, 12.0, 16.0] {
                for l in [15.0, 25.0, 35.0, 50.0, 70.0] {
                    for side in [1.0, -1.0] { cases.push((id, width, kerb, l, side)); }
                }
            }
        }
    }
    let lines: Vec<String> = cases.par_iter().map(|&(id, width, kerb, l, side)| {
        let map = AsciiMap::placed(&[
            ('W', [-200.0, 0.0]), ('J', [0.0, 0.0]), ('K', [0.0, l]), ('E', [side * 200.0, l]),
            ('S', [0.0, -150.0]), ('N', [0.0, l + 150.0]),
        ]);
        let tags = format!("highway=secondary width={width}");
        let map = map.way("SJKN", &tags).way("WJ", &tags).way("KE", &tags);
        let mut region = Region::of(map.extract(), Policy::Carriageway);
        region.kerbs = Kerbs::everywhere(kerb);
        let driver = region.driver(id);
        let edge = |a: char, b: char| (0..).zip(&region.network.edges).find(|(_, e)| (e.from_node, e.to_node) == (ascii_map::id_of(a), ascii_map::id_of(b))).unwrap().0;
        let permit = |a, b| driver.permits.movements[region.movements.index(a, b).unwrap()];
        let one = permit(edge('W', 'J'), edge('J', 'K'));
        let two = permit(edge('J', 'K'), edge('K', 'E'));
        let made = region.turns(&driver.model);
        let mut planner = region.planner(&driver, &made, Measure::Time);
        let place = |c: char| { let e = &region.network.edges[edge(c, if c == 'W' { 'J' } else { 'K' }) as usize]; let p: Vec<_> = region.network.positions(e).collect(); let (a, b) = (p[0].degrees(), p[1].degrees()); Position { lon: 0.5 * (a.0 + b.0), lat: 0.5 * (a.1 + b.1) } };
        let answer = planner.answer(&Question { places: vec![place('W'), place('E')], snap_m: 30.0, alternatives: 0, tries: 20 });
        let text = match &answer { Ok(a) => format!("routes {} refuted {:?}", a.routes.len(), a.refuted.iter().map(|r| (r.at, r.result, r.assembly.as_ref().map(|e| e.to_string()))).collect::<Vec<_>>()), Err(e) => e.to_string() };
        format!("{id} w{width} k{kerb} l{l} s{side}: {:?} {:?} | {:?} {:?} | {text}", one.verdict, one.rsc_m, two.verdict, two.rsc_m)
    }).collect();
    for line in lines { if line.contains("Safe") { println!("{line}"); } }
}
