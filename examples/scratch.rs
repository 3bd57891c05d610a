#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs, dead_code)]
#[path = "../tests/support/ascii_map.rs"]
mod ascii_map;
use ascii_map::*;
use netcert::network::*;
use netcert::osm::facts::*;
use netcert::turns::*;
use netcert::stet::*;
use std::fmt::Write;

fn svg(t: &TurnCorridors, show: &[usize]) -> String {
    let pts: Vec<_> = t.paths.iter().flat_map(|p| (p.turn.clone()).map(move |k| [p.corridor.x[k], p.corridor.y[k]])).collect();
    let (cx, cy) = pts.iter().fold((0.0, 0.0), |a, p| (a.0 + p[0] / pts.len() as f64, a.1 + p[1] / pts.len() as f64));
    let s = 12.0;
    let at = |p: [f64; 2]| format!("{:.2},{:.2}", 600.0 + (p[0] - cx) * s, 500.0 - (p[1] - cy) * s);
    let mut o = String::from("<svg xmlns='http://www.w3.org/2000/svg' width='1200' height='1000'><rect width='1200' height='1000' fill='white'/>");
    for poly in &t.area {
        let mut d = String::new();
        for r in std::iter::once(poly.exterior()).chain(poly.interiors()) {
            write!(d, "M{}Z", r.coords().map(|c| at([c.x, c.y])).collect::<Vec<_>>().join("L")).unwrap();
        }
        write!(o, "<path d='{d}' fill='#ddd' stroke='#888' fill-rule='evenodd'/>").unwrap();
    }
    for (i, p) in t.paths.iter().enumerate() {
        let c = &p.corridor;
        let line: Vec<_> = (0..c.len()).map(|k| at([c.x[k], c.y[k]])).collect();
        write!(o, "<polyline points='{}' fill='none' stroke='#88f' stroke-width='0.6'/>", line.join(" ")).unwrap();
        if show.contains(&i) {
            for side in [1.0, -1.0] {
                let line: Vec<_> = (0..c.len()).map(|k| { let w = if side > 0.0 { c.left_m[k] } else { -c.right_m[k] }; let (sn, cs) = c.heading[k].sin_cos(); at([c.x[k] - w * sn, c.y[k] + w * cs]) }).collect();
                write!(o, "<polyline points='{}' fill='none' stroke='#c00' stroke-width='1'/>", line.join(" ")).unwrap();
            }
        }
    }
    o + "</svg>"
}

fn main() {
    let map = AsciiMap::drawn(60.0, "
            D
            |
        A---B---C
            |
            E
        ").way("ABC", "highway=secondary width=7.5").way("DBE", "highway=secondary width=7.5");
    let countries = Countries::load().unwrap();
    let rules = countries.rules();
    let (n, _) = build(map.extract(), &somewhere, &|f, p| cross_sections(f, p, rules));
    let edge = |a: char, b: char| n.edges.iter().position(|e| e.from_node == id_of(a) && e.to_node == id_of(b)).unwrap() as u32;
    for (name, from, to) in [("right", edge('E', 'B'), edge('B', 'C')), ("left", edge('E', 'B'), edge('B', 'A'))] {
        for policy in [Policy::Carriageway] {
            for r in [8.0, 15.0] {
            let params = TurnParams { kerbs: Kerbs::everywhere(r), ..TurnParams::default() };
            let clock = std::time::Instant::now();
            let t = turn_corridors(&n, Movement { from, to, kind: MovementKind::Turn, forbidden: None }, policy, &params, Reach::Short).unwrap();
            println!("{name} {policy:?} {r}: {} paths in {:?}, turn {:.2}", t.paths.len(), clock.elapsed(), t.turn_rad);
            let veh = netcert::vehicle::Catalogue::builtin().unwrap().get("EU-SEMI16.5").unwrap().clone();
            let m = Model::new(&veh).unwrap();
            let mut v0 = veh.clone(); v0.tracking_tolerance_m = 0.001; v0.tracking_heading_rad = 1e-4; for u in &mut v0.units { u.sway_rad = 0.0; } let m0 = Model::new(&v0).unwrap();
            let mut best = (0, -1e9);
            let clock = std::time::Instant::now();
            for (i, p) in t.paths.iter().enumerate() {
                let rows = certify_spans(&p.corridor, &[&m], &[p.counted.clone()], &Options::default());
                let x = &rows[0].spans[0];
                let (cert, _) = certify_planned(&p.corridor, &m, &[p.counted.clone()], &Options::default()).unwrap();
                let z = &certify_spans(&p.corridor, &[&m0], &[p.counted.clone()], &Options { max_shift_m: 0.0, correction_sweeps: 0 })[0].spans[0];
                if p.number == 50 { for k in p.turn.clone().step_by(2) { println!("     {} kappa {:.3} left {:.2} right {:.2}  leeway {:.2} {:.2}", k - p.turn.start, p.corridor.curvature[k], p.corridor.left_m[k], p.corridor.right_m[k], cert.left_m[k], cert.right_m[k]); } std::fs::write("/tmp/wt/turns/target/c50.svg", svg(&t, &[i])).unwrap(); }
                print!("zero {:.2} at {} {:?} u{} p{:.1} ", z.rsc_m, z.limiting.station as i64 - p.turn.start as i64, z.limiting.side, z.limiting.unit, z.limiting.point_m);
                println!("  {} n={} R={:.1} nominal {:.2} rsc {:.2} hinge {:.2} at {} side {:?} unit {} shift {:.2}..{:.2}", p.number, p.corridor.len(), p.min_radius_m, nominal_leeway_m(p, &veh), x.rsc_m, x.hinge_margin_rad, x.limiting.station as i64 - p.turn.start as i64, x.limiting.side, x.limiting.unit, cert.shift_m.iter().fold(0.0f64, |a, b| a.min(*b)), cert.shift_m.iter().fold(0.0f64, |a, b| a.max(*b)));
                if x.rsc_m > best.1 { best = (i, x.rsc_m) }
            }
            println!("   certified in {:?}", clock.elapsed());
            std::fs::write(format!("/tmp/wt/turns/target/{name}_{policy:?}_{r}.svg"), svg(&t, &[best.0])).unwrap();
            }
        }
    }
}
