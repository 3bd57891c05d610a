//! Certifies vehicles on drawn bends, one after the other on one thread, and prints the seconds: the peer of `benches/python.py`.
//!
//!     cargo run --release --example certify_bends VEHICLE BENDS
#![allow(clippy::print_stdout)]

use std::time::Instant;

use netcert::corridor::Drawn;
use netcert::stet::{Model, Options, certify};
use netcert::stop::Stop;
use netcert::vehicle::Catalogue;

/// A bend of 90° with 200 m of straight road before and after it; each bend has another radius.
fn bend(number: u32) -> Vec<[f64; 2]> {
    let radius = 20.0 + f64::from(number % 60);
    let arc = (0..=60).map(|step| f64::from(step) * std::f64::consts::FRAC_PI_2 / 60.0);
    let arc = arc.map(|angle| [radius * angle.sin(), radius * (1.0 - angle.cos())]);
    std::iter::once([-200.0, 0.0]).chain(arc).chain([[radius, radius + 200.0]]).collect()
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [vehicle, bends] = arguments.as_slice() else { return Err("VEHICLE BENDS".into()) };
    let bends: u32 = bends.parse()?;
    let model = Model::new(Catalogue::builtin()?.get(vehicle)?)?;
    let drawn = |number| Drawn { points: bend(number), width_m: Some(vec![8.0]), ..Drawn::default() }.corridor();
    let corridors = (0..bends).map(drawn).collect::<Result<Vec<_>, _>>()?;
    let begin = Instant::now();
    let mut sum_m = 0.0;
    for corridor in &corridors {
        let certificate = certify(&corridor.corridor, &model, &Options::default(), &Stop::never())?;
        sum_m += certificate.and_then(|certificate| certificate.result.rsc_m).unwrap_or(0.0);
    }
    println!("{} {sum_m}", begin.elapsed().as_secs_f64());
    Ok(())
}
