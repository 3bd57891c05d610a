#![allow(clippy::unwrap_used, clippy::print_stdout, missing_docs)]
use netcert::corridor::{Corridor, CurvatureProfile};
use netcert::stet::{Model, Options, certify};
use netcert::vehicle::Catalogue;

#[test]
fn probe() {
    let catalogue = Catalogue::builtin().unwrap();
    for id in ["EU-SEMI16.5", "AU-BDOUBLE26", "AU-ATRIPLE53", "EU-EMS25-C", "US-WB109D"] {
        let t = std::time::Instant::now();
        let model = Model::new(catalogue.get(id).unwrap()).unwrap();
        println!("{id} model {:?}", t.elapsed());
        for radius in [1e9, 600.0, 150.0, 60.0, 30.0, 20.0] {
            let profile = CurvatureProfile::new(1.0)
                .straight(100.0)
                .clothoid(1.0 / radius, 0.5_f64 * f64::min(radius, 100.0))
                .arc(1.0 / radius, f64::min(radius, 300.0))
                .clothoid(0.0, 0.5 * f64::min(radius, 100.0))
                .straight(100.0);
            let c = Corridor::from_curvature(1.0, [0.0, 0.0], 0.0, &profile.curvature, 1.75, 1.75);
            let plain = certify(&c, &model, &Options { max_shift_m: 0.0, correction_sweeps: 0 }).unwrap();
            let t = std::time::Instant::now();
            let best = certify(&c, &model, &Options::default()).unwrap();
            let more = certify(&c, &model, &Options { correction_sweeps: 6, ..Options::default() }).unwrap();
            println!(
                "  R {radius:>6}: centred {:+.3} corrected {:+.3} more {:+.3} γ {:.3} hinge {:.1}° unit {} pt {:.1} {:?} published {:+.2} shift {:.2} {:?}",
                plain.result.rsc_m,
                best.result.rsc_m,
                more.result.rsc_m,
                best.result.shrink,
                best.result.hinge_margin_rad.to_degrees(),
                best.result.limiting.unit,
                best.result.limiting.point_m,
                best.result.limiting.side,
                best.result.rsc_published_m,
                best.shift_m.iter().fold(0.0f64, |a, b| a.max(b.abs())),
                t.elapsed()
            );
        }
    }
}
