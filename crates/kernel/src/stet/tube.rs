//! The tubes, for files and pictures: each axle's nominal place and the bound of its deviation.

use super::adjoint::{Histories, Refined, close, first_loose, refine};
use super::block::{BLOCK, FIELDS, row};
use super::drive::{Motion, drive};
use super::group::Group;
use super::lanes::{LANES, Vector, on_widest};
use super::model::Model;
use super::reach::VehicleReach;
use super::results::Certificate;
use super::ride::{Ride, SweepScope};
use super::steer::SteerPaths;
use super::step::MOST;
use super::track::Track;
use netcert_base::corridor::Corridor;

/// The tube of one unit, with one entry per station that the steer axle passes.
#[derive(Debug, Clone, PartialEq)]
pub struct Tube {
    /// Unit index, 0 the prime mover.
    pub unit: usize,
    /// Nominal position of the axle, metres in the corridor's frame.
    pub centre: Vec<[f64; 2]>,
    /// Nominal heading, a unit vector.
    pub heading: Vec<[f64; 2]>,
    /// Lateral semi-axis across the heading, metres: the largest deviation of the axle at the certificate's γ. Read it
    /// through [`Tube::bound_m`].
    pub lateral_m: Vec<f64>,
}

impl Tube {
    /// Largest deviation of the axle at a station, metres. `None` if the bounds do not close there.
    #[must_use]
    pub fn bound_m(&self, station: usize) -> Option<f64> {
        self.lateral_m.get(station).copied().filter(|lateral_m| *lateral_m < MOST)
    }
}

/// The tubes of a certificate that [`super::certify`] made from this corridor and model.
#[must_use]
pub fn tubes(corridor: &Corridor, model: &Model, certificate: &Certificate) -> Vec<Tube> {
    on_widest!(V => driven::<V>(corridor, model, certificate))
}

fn driven<V: Vector>(corridor: &Corridor, model: &Model, certificate: &Certificate) -> Vec<Tube> {
    let units = model.units.len();
    let mut tubes: Vec<Tube> =
        (0..units).map(|unit| Tube { unit, centre: Vec::new(), heading: Vec::new(), lateral_m: Vec::new() }).collect();
    let Some(last) = certificate.shift_m.len().checked_sub(1) else { return tubes };
    let shrink = certificate.result.shrink;
    let group = Group::<V>::new(&[(model, shrink)]);
    let track = Track::new(corridor, VehicleReach::of(model).extensions(corridor.spacing_m));
    let shift: Vec<f64> =
        (0..track.len()).map(|k| certificate.shift_m[k.saturating_sub(track.lead).min(last)]).collect();
    let ride = Ride { track: &track, model, shrink, shift: &shift, scope: SweepScope::ALL };
    let mut paths = SteerPaths::new(&[&ride]);
    let mut motion = Motion::new(&group, &paths);
    let mut histories = Histories::new();
    let mut trail = histories.trail(&group);
    let mut refined = Refined::new();
    let mut rows = vec![0.0; units * LANES * FIELDS * BLOCK];
    let (mut head, mut after) = (track.first_head, usize::MAX);
    while head <= track.lead + last {
        paths.next_block(&[&ride]);
        drive::<V, true, true>(&mut motion, &group, &paths, &mut rows, &mut trail);
        let loose = first_loose(&group, 0, &rows);
        if loose.min(after) < units {
            refine(&mut trail, &group, 0, loose.min(after), &mut motion.extra, &mut rows, &mut refined);
        }
        close(&mut trail, 0, units);
        after = loose;
        for tube in &mut tubes {
            let at = |field: usize, k: usize| rows[(tube.unit * LANES * FIELDS + field) * BLOCK + k];
            for k in track.lead.saturating_sub(head)..BLOCK.min(track.lead + last + 1 - head) {
                tube.centre.push([at(row::X, k), at(row::Y, k)]);
                tube.heading.push([at(row::UX, k), at(row::UY, k)]);
                tube.lateral_m.push(group.chain[tube.unit].axle.lane(0) + at(row::EXTRA_AXLE, k));
            }
        }
        head += BLOCK;
    }
    tubes
}
