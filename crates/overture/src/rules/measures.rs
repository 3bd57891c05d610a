//! Values with units: dimensions of vehicles in metres and tonnes, speeds in km/h.

use std::num::NonZeroU8;

use super::{Limit, LimitKind};
use crate::record::{Comparison, Speed};

/// Metres of a length's unit.
fn metres(unit: &str) -> Option<f64> {
    Some(match unit {
        "m" => 1.0,
        "cm" => 0.01,
        "km" => 1000.0,
        "in" => 0.0254,
        "ft" => 0.3048,
        "yd" => 0.9144,
        "mi" => 1609.344,
        _ => return None,
    })
}

/// Tonnes of a weight's unit. Tons are short ones (`st`) and long ones (`lt`).
fn tonnes(unit: &str) -> Option<f64> {
    Some(match unit {
        "t" => 1.0,
        "kg" => 1e-3,
        "g" => 1e-6,
        "oz" => 2.834_952_312_5e-5,
        "lb" => 4.535_923_7e-4,
        "st" => 0.907_184_74,
        "lt" => 1.016_046_908_8,
        _ => return None,
    })
}

/// The limit that a denial by this comparison sets. `None` if it bars none but small vehicles or cannot be decided.
pub(super) fn limit(comparison: &Comparison) -> Option<(LimitKind, Limit)> {
    let (kind, unit): (_, fn(&str) -> Option<f64>) = match comparison.dimension.as_deref()? {
        "height" => (LimitKind::Height, metres),
        "length" => (LimitKind::Length, metres),
        "width" => (LimitKind::Width, metres),
        "weight" => (LimitKind::Weight, tonnes),
        "axle_load" => (LimitKind::AxleLoad, tonnes),
        _ => return None,
    };
    let value = comparison.value? * unit(comparison.unit.as_deref()?)?;
    let limit = match comparison.comparison.as_deref()? {
        "greater_than" => kind.at(value),
        "greater_than_equal" => kind.below(value),
        _ => return None,
    };
    Some((kind, limit))
}

/// The greatest number of axles that a denial by this comparison leaves.
pub(super) fn axles(comparison: &Comparison) -> Option<u32> {
    if comparison.dimension.as_deref() != Some("axle_count") {
        return None;
    }
    let value = comparison.value.filter(|value| (1.0..=100.0).contains(value) && value.fract() == 0.0)? as u32;
    match comparison.comparison.as_deref()? {
        "greater_than" => Some(value),
        "greater_than_equal" => value.checked_sub(1),
        _ => None,
    }
}

/// A speed limit, to the nearest whole number. What no road has is no limit.
pub(super) fn km_h(speed: &Speed) -> Option<NonZeroU8> {
    let factor = match speed.unit.as_deref()? {
        "km/h" => 1.0,
        "mph" => 1.609_344,
        _ => return None,
    };
    let km_h = speed.value? * factor;
    (km_h <= 200.0).then(|| NonZeroU8::new(km_h.round() as u8)).flatten()
}
