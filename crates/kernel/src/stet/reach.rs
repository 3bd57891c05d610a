//! How far a vehicle reaches from its steer axle, rounded so that vehicles share tracks.

use super::block::BLOCK;
use super::lanes::LANES;
use super::model::Model;
use super::track::Extensions;

/// Vehicles share a track whose lengths, in steps of this, are the same, metres.
const LENGTH_STEP_M: f64 = 8.0;
/// Vehicles up to this front overhang share a track. The longest of the catalogue is 3 m.
const LEAST_FRONT_M: f64 = 4.0;
/// Track left over behind the farthest place that a point is expected at, metres: feet are searched a little beyond.
const TAIL_M: f64 = 10.0;

/// Assumed reach of a vehicle behind and ahead of its steer axle, metres. Vehicles of the same reach share a track.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct VehicleReach {
    pub(super) length_m: f64,
    pub(super) front_m: f64,
}

impl VehicleReach {
    pub(super) fn of(model: &Model) -> Self {
        let length_m = (model.length / LENGTH_STEP_M).ceil() * LENGTH_STEP_M;
        Self { length_m, front_m: model.front.max(LEAST_FRONT_M) }
    }

    /// The extensions before and behind the corridor.
    pub(super) fn extensions(self, spacing: f64) -> Extensions {
        let Self { length_m, front_m } = self;
        let slack = (BLOCK + 2 * LANES) as f64 * spacing;
        Extensions {
            lead_m: length_m + front_m + 2.0 * LANES as f64 * spacing,
            tail_m: length_m + 2.0 * front_m + 2.0 * slack + TAIL_M,
            front_m,
        }
    }
}
