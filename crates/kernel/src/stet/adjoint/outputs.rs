//! The outputs of a unit that the adjoint bounds: its heading, its axle and its body points, eight at a time.

use crate::stet::lanes::{LANES, Vector};
use crate::stet::model::UnitModel;

/// Indices of a unit's outputs: heading, axle, then the body points.
pub(super) const HEADING: usize = 0;
pub(super) const AXLE: usize = 1;
pub(super) const POINTS: usize = 2;

/// Eight outputs of one unit: weights of its axle's deviation and of its coupling's deviation over cos δ.
pub(super) struct Outputs<V> {
    pub(super) axle: V,
    pub(super) coupling: V,
}

/// All outputs of a unit.
pub(super) fn outputs<V: Vector>(unit: &UnitModel) -> Vec<Outputs<V>> {
    let per_length = 1.0 / unit.length;
    let point = |&a: &f64| (1.0 - a * per_length, a * per_length);
    let all: Vec<(f64, f64)> =
        [(-per_length, per_length), (1.0, 0.0)].into_iter().chain(unit.points.iter().map(point)).collect();
    let batch = |some: &[(f64, f64)]| {
        let at = |i: usize| some[i.min(some.len() - 1)];
        Outputs { axle: V::from(std::array::from_fn(|i| at(i).0)), coupling: V::from(std::array::from_fn(|i| at(i).1)) }
    };
    all.chunks(LANES).map(batch).collect()
}
