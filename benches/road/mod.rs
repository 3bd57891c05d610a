//! A rural road: straights, clothoids and arcs down to 25 m, lanes of 3.5 m.

use netcert::corridor::{Corridor, CurvatureProfile};

pub(crate) fn road(stations: usize) -> Corridor {
    let radii: [f64; 10] = [600.0, -250.0, 150.0, -900.0, 60.0, -400.0, 2000.0, -100.0, 300.0, 25.0];
    let mut profile = CurvatureProfile::new(1.0).straight(200.0);
    for radius in radii.iter().cycle() {
        if profile.curvature.len() >= stations {
            break;
        }
        let curvature = 1.0 / radius;
        let transition = (40.0_f64).min(0.5 * radius.abs());
        let arc = (radius.abs() * 0.5).clamp(20.0, 150.0);
        profile = profile.clothoid(curvature, transition).arc(curvature, arc).clothoid(0.0, transition).straight(150.0);
    }
    Corridor::from_curvature(1.0, [5000.0, -3000.0], 0.3, &profile.curvature, 1.75, 1.75)
}
