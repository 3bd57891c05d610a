//! The tagged rule that forbids an edge, or that cannot be read, beside what the vehicle has.

use crate::network::Edge;
use crate::osm::facts::Limit;
use crate::vehicle::Vehicle;
use crate::verdict::{ForbiddenReason, UnknownReason, Verdict};

/// A rule against a vehicle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conflict {
    /// The tag, or the chief of those that may have said it: where several limit the same, the strictest counts.
    pub tag: &'static str,
    /// What it allows, in `unit`; `None` where it is no number, or one that cannot be read.
    pub allowed: Option<f64>,
    /// What the vehicle has, in `unit`.
    pub has: Option<f64>,
    /// `m` or `t`.
    pub unit: &'static str,
}

impl Conflict {
    /// In the order in which [`crate::osm::facts::Legal::forbids`] decides.
    pub(super) fn of(edge: &Edge, vehicle: &Vehicle) -> Option<Self> {
        let legal = &edge.legal;
        let rule = |tag| Some(Self { tag, allowed: None, has: None, unit: "" });
        let dimensions = [
            (legal.max_height, vehicle.height_m, "maxheight", "m", ForbiddenReason::Height),
            (legal.max_weight, vehicle.gross_mass_t, "maxweight", "t", ForbiddenReason::Weight),
            (legal.max_axle_load, vehicle.axle_load_t, "maxaxleload", "t", ForbiddenReason::AxleLoad),
            (legal.max_length, Some(vehicle.length_m), "maxlength", "m", ForbiddenReason::Length),
            (legal.max_width, Some(vehicle.width_m()), "maxwidth", "m", ForbiddenReason::Width),
        ];
        match legal.forbids(vehicle) {
            Some(Verdict::Forbidden(ForbiddenReason::Access)) => rule("access, vehicle or motor_vehicle"),
            Some(Verdict::Forbidden(ForbiddenReason::Hgv)) => rule("hgv"),
            Some(Verdict::Forbidden(reason)) => {
                let (limit, has, tag, unit, _) = dimensions.into_iter().find(|row| row.4 == reason)?;
                let allowed = if let Limit::At(most) = limit { Some(centi(most)) } else { None };
                Some(Self { tag, allowed, has, unit })
            }
            Some(Verdict::Unknown(UnknownReason::Limit)) => {
                let unreadable = |row: &&(Limit, Option<f64>, _, _, _)| row.0 == Limit::Unreadable && row.1.is_some();
                let (_, has, tag, unit, _) = dimensions.iter().find(unreadable)?;
                Some(Self { tag, allowed: None, has: *has, unit })
            }
            _ if edge.barred => rule("barrier"),
            _ => None,
        }
    }
}

/// Limits are kept in single precision: what was tagged had two decimals.
fn centi(limit: f32) -> f64 {
    (f64::from(limit) * 100.0).round() / 100.0
}
