//! Where the adjoint is worth its time.

use crate::stet::block::{BLOCK, FIELDS, row};
use crate::stet::group::Group;
use crate::stet::lanes::{LANES, Vector};

/// The adjoint is used from the unit on at which Σ tan² δ_j/2 over the units up to it exceeds this. Bends alone decide,
/// so neither a looser tolerance nor another trailer can bring a tighter bound and raise an RSC. At 0.008 (six units at
/// 120 m, a semi-trailer at 67 m) the filter costs a centimetre.
const WORTH: f64 = 0.008;

/// The first unit of a vehicle for which a block of rows bends enough to make the adjoint worth its time.
#[inline(always)]
pub(in crate::stet) fn first_loose<V: Vector>(group: &Group<'_, V>, lane: usize, rows: &[f64]) -> usize {
    let mut sum = 0.0;
    for unit in 0..group.models[lane].units.len() {
        let start = ((unit * LANES + lane) * FIELDS + row::CURVATURE) * BLOCK;
        let most =
            rows[start..start + BLOCK].iter().fold(0.0, |most: f64, &k| if k.abs() > most { k.abs() } else { most });
        let tangent = most * group.chain[unit].length.lane(lane);
        sum += 0.5 * tangent * tangent;
        if sum > WORTH {
            return unit;
        }
    }
    usize::MAX
}
