//! What the certifier claims of a corridor, in the oracle's words.

use netcert::corridor::Corridor;
use netcert::vehicle::Vehicle;

use super::path::V2;

/// A certificate's claims that the oracle can try to refute.
pub struct Claim {
    pub rsc_m: f64,
    /// γ: what the steer axle keeps to is γ ε.
    pub shrink: f64,
    pub hinge_margin_rad: f64,
    pub limiting: Place,
    pub plan: Vec<V2>,
}

/// A body point whose foot is at a station.
#[derive(Debug, Clone, Copy)]
pub struct Place {
    pub foot_m: f64,
    pub unit: usize,
    /// +1 left, −1 right.
    pub side: f64,
    pub ahead_m: f64,
}

/// STAND-IN until the certifier is merged: centred plan, linear reach at the nominal worst place.
pub fn certify(corridor: &Corridor, vehicle: &Vehicle) -> Claim {
    use super::{adversary::*, path::*, road::Road, simulator::*};
    let plan: Vec<V2> = corridor.x.iter().zip(&corridor.y).map(|(&x, &y)| [x, y]).collect();
    let heading = (corridor.heading[0], corridor.heading[corridor.len() - 1]);
    let path = Path::through(&plan, corridor.spacing_m, heading, 3.0 * vehicle.length_m, vehicle.length_m + 5.0);
    let drive = Drive::new(vehicle, &path, 10);
    let none = Disturbance::none(drive.steps());
    let run = drive.whole(&none);
    let road = Road::new(corridor);
    let mut worst: Option<Near> = None;
    sweep(&drive, &run, &road, path.span_of_vertex(0) * 10..drive.steps(), (5, 0.5), |n| {
        if worst.is_none_or(|w| n.clearance_m < w.clearance_m) {
            worst = Some(n);
        }
    });
    let w = worst.unwrap();
    let (_, tangent) = road.centre(w.foot_m);
    let n = left_of(tangent);
    let aside = w.side * 0.5 * vehicle.units[w.unit].width_m;
    let target =
        Target { step: w.step, unit: w.unit, ahead_m: w.ahead_m, aside_m: aside, push: [w.edge * n[0], w.edge * n[1]] };
    let k = kernel(&drive, &run, &none, &target, 100_000);
    let slip: PerUnit = std::array::from_fn(|i| vehicle.units.get(i).map_or(0.0, |u| u.sway_rad));
    let reach = k.reach_m(&Bounds { steer_m: vehicle.tracking_tolerance_m, change_m: 1.0, slip });
    Claim {
        rsc_m: w.clearance_m - reach,
        shrink: 1.0,
        hinge_margin_rad: -1.0,
        limiting: Place { foot_m: w.foot_m, unit: w.unit, side: w.side, ahead_m: w.ahead_m },
        plan,
    }
}
