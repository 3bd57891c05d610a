#[path = "../../tests/support/routing.rs"]
#[allow(dead_code)]
mod routing;
use netcert::network::MovementKind;
use netcert::osm::facts::Policy;
use netcert::route::*;
use netcert::store::Named;
use netcert::verdict::Verdict;
fn main() {
    let a: Vec<String> = std::env::args().skip(1).collect();
    let region = routing::Region::read(a[0].as_ref(), Policy::named(&a[2]).unwrap());
    let driver = region.driver(&a[1]);
    let made = region.turns(&driver.model);
    let mut strokes = region.strokes();
    let (mut n, mut ok, mut err) = (0, 0, 0);
    for (m, p) in region.movements.all().iter().zip(&driver.permits.movements) {
        if m.kind != MovementKind::Turn || p.verdict != Verdict::Safe {
            continue;
        }
        n += 1;
        let pieces = made.pieces(&mut strokes, m).unwrap();
        if pieces.is_empty() {
            println!("{m:?} no pieces");
            continue;
        }
        let way = Way { edges: &[m.from, m.to], start: 0.0, end: 1.0 };
        match assemble(&region.network, &region.movements, &mut strokes, &made, &way) {
            Err(e) => {
                err += 1;
                println!("{m:?} {e:?}");
            }
            Ok(path) => {
                let c = &path.corridor;
                let cert = certify_whole(&path, &driver.model, &region.settings.stet).unwrap();
                let own = &pieces[0];
                let k1 = own.corridor.curvature.iter().fold(0.0_f64, |a, k| a.max(k.abs()));
                let k2 = c.curvature.iter().fold(0.0_f64, |a, k| a.max(k.abs()));
                if cert.result.safe() {
                    ok += 1;
                }
                println!(
                    "{} {} permit {:?} whole {:.3} hinge {:.2} safe {} kmax {k1:.4} {k2:.4} len {} parts {:?} sp {:.3} {:.3} turn {:?} of {}",
                    m.from,
                    m.to,
                    p.rsc_m,
                    cert.result.rsc_m,
                    cert.result.hinge_margin_rad,
                    cert.result.safe(),
                    c.len(),
                    path.parts.iter().map(|p| p.stations.clone()).collect::<Vec<_>>(),
                    c.spacing_m,
                    own.corridor.spacing_m,
                    own.turn,
                    own.corridor.len()
                );
                if !cert.result.safe() && a.len() > 3 {
                    for k in 0..c.len() {
                        println!(
                            "   {k} {:.2} {:.2} h {:.3} k {:.4} w {:.2} {:.2}",
                            c.x[k], c.y[k], c.heading[k], c.curvature[k], c.left_m[k], c.right_m[k]
                        );
                    }
                    let c = &own.corridor;
                    for k in 0..c.len() {
                        println!(
                            "   own {k} {:.2} {:.2} h {:.3} k {:.4} w {:.2} {:.2}",
                            c.x[k], c.y[k], c.heading[k], c.curvature[k], c.left_m[k], c.right_m[k]
                        );
                    }
                    return;
                }
            }
        }
    }
    println!("{n} turns, {ok} ok as short routes, {err} not assembled");
}
