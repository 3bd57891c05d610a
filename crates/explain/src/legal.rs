//! The rule that forbids an edge or cannot be read, tagged or measured, beside the vehicle's own value.

use crate::network::{Edge, Network};
use crate::osm::facts::{At, Limit};
use crate::vehicle::Vehicle;
use crate::verdict::{ForbiddenReason, UnknownReason, Verdict};

/// A rule that forbids a vehicle or cannot be read.
#[derive(Debug, Clone, PartialEq)]
pub struct RuleConflict {
    /// The tag as `key=value`. Where it is not known, as after a measurement, the key, or the main key if several can set the same limit.
    /// The strictest of them counts.
    pub tag: String,
    /// The allowed value, in `unit`. `None` if the rule has no number or its number cannot be read.
    pub allowed: Option<f64>,
    /// The vehicle's value, in `unit`.
    pub has: Option<f64>,
    /// `m` or `t`.
    pub unit: &'static str,
    /// Whether the limit is a measurement of the register and not the map's.
    pub surveyed: bool,
}

impl RuleConflict {
    /// The first rule in the order in which [`crate::osm::facts::Legal::forbids`] decides.
    pub(super) fn of(network: &Network, edge: &Edge, vehicle: &Vehicle) -> Option<Self> {
        let (legal, limits) = (&network.legal(edge), network.site.limits(edge));
        let judged = legal.judge(vehicle, At::Always);
        let surveyed = |reason| match reason {
            Some(Verdict::Forbidden(ForbiddenReason::Height)) => limits.height_m.is_some(),
            Some(Verdict::Forbidden(ForbiddenReason::Weight)) => limits.weight_t.is_some(),
            _ => false,
        };
        if let Some(tag) = judged.rule {
            let (allowed, has, unit) = (judged.allowed.map(to_centi), judged.has, judged.unit);
            return Some(Self { tag, allowed, has, unit, surveyed: surveyed(judged.verdict) });
        }
        let rule = |tag: &str| Some(Self { tag: tag.to_owned(), allowed: None, has: None, unit: "", surveyed: false });
        let dimensions = [
            (legal.max_height, vehicle.height_m, "maxheight", "m", ForbiddenReason::Height),
            (legal.max_weight, vehicle.gross_mass_t, "maxweight", "t", ForbiddenReason::Weight),
            (legal.max_axle_load, vehicle.axle_load_t, "maxaxleload", "t", ForbiddenReason::AxleLoad),
            (legal.max_length, Some(vehicle.length_m), "maxlength", "m", ForbiddenReason::Length),
            (legal.max_width, Some(vehicle.width_m()), "maxwidth", "m", ForbiddenReason::Width),
        ];
        match judged.verdict {
            Some(Verdict::Forbidden(ForbiddenReason::Access)) => rule("access, vehicle or motor_vehicle"),
            Some(Verdict::Forbidden(ForbiddenReason::Hgv)) => rule("hgv"),
            Some(Verdict::Forbidden(reason)) => {
                let (limit, has, tag, unit, _) = dimensions.into_iter().find(|row| row.4 == reason)?;
                let allowed = if let Limit::At(most) = limit { Some(centi(most)) } else { None };
                let surveyed = surveyed(judged.verdict);
                Some(Self { tag: tag.to_owned(), allowed, has, unit, surveyed })
            }
            Some(Verdict::Unknown(UnknownReason::Limit)) => {
                let unreadable = |row: &&(Limit, Option<f64>, _, _, _)| row.0 == Limit::Unreadable && row.1.is_some();
                let (_, has, tag, unit, _) = dimensions.iter().find(unreadable)?;
                Some(Self { tag: (*tag).to_owned(), allowed: None, has: *has, unit, surveyed: false })
            }
            _ if edge.barred => rule(&legal.barrier_tag().unwrap_or_else(|| "barrier".to_owned())),
            _ => None,
        }
    }
}

/// A limit rounded to two decimals, as tags have them. Limits are stored in single precision.
fn centi(limit: f32) -> f64 {
    to_centi(f64::from(limit))
}

fn to_centi(limit: f64) -> f64 {
    (limit * 100.0).round() / 100.0
}
