//! Published limits, each with its source and how sure it is, beside what was measured.
//!
//! A pass here is no approval: assessments use the real bodies, tyres and axle groups.

use super::measure::{Ring, Swept, beyond_limit};
use crate::vehicle::Vehicle;

/// What is limited.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// Low-speed swept path, 90° at 12.5 m: at most.
    SweptPath,
    /// Tail swing in the same turn: at most.
    TailSwing,
    /// Frontal swing in the same turn: at most.
    FrontalSwing,
    /// Inner radius of the circle with 12.5 m outer radius: at least.
    InnerRadius,
    /// Width of the ring: at most.
    RingWidth,
    /// Swing-out on entering the circle: at most.
    SwingOut,
}

impl Measure {
    /// For people.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::SweptPath => "swept path, 90° at 12.5 m",
            Self::TailSwing => "tail swing, 90° at 12.5 m",
            Self::FrontalSwing => "frontal swing, 90° at 12.5 m",
            Self::InnerRadius => "inner radius, circle of 12.5 m",
            Self::RingWidth => "ring width, circle of 12.5 m",
            Self::SwingOut => "swing-out on entering the circle",
        }
    }

    /// For files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::SweptPath => "swept_path_m",
            Self::TailSwing => "tail_swing_m",
            Self::FrontalSwing => "frontal_swing_m",
            Self::InnerRadius => "inner_radius_m",
            Self::RingWidth => "ring_width_m",
            Self::SwingOut => "swing_out_m",
        }
    }

    /// Whether more is better.
    #[must_use]
    pub fn at_least(self) -> bool {
        self == Self::InnerRadius
    }
}

/// How sure a limit is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sureness {
    /// Read at the source that is named.
    Read,
    /// The standard is named, its text was not at hand: check before quoting.
    NotRead,
}

impl Sureness {
    /// For people.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Read => "read at the source",
            Self::NotRead => "standard named, text not read",
        }
    }
}

/// A published limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limit {
    /// What it limits.
    pub measure: Measure,
    /// Whose it is, with the level: `PBS level 2`.
    pub who: &'static str,
    /// Metres.
    pub metres: f64,
    /// Where it comes from.
    pub source: &'static str,
    /// How sure.
    pub sureness: Sureness,
    /// For buses only, for others only, or for all.
    pub buses: Option<bool>,
}

/// A measure beside a limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Finding {
    /// The limit.
    pub limit: Limit,
    /// Measured, metres; `None`: the turn cannot be driven (a hinge or the steering would go beyond its limit), or the
    /// measure does not exist.
    pub metres: Option<f64>,
    /// Whether it keeps the limit.
    pub passes: bool,
}

const PBS: &str = "Australian PBS, Standards and Vehicle Assessment Rules (NTC 2008); the manoeuvre: \
                   advantia.com.au/technical/understanding-low-speed-swept-path";
const EU: &str = "Directive 96/53/EC with 97/27/EC 7.6.1: outer radius 12.50 m, inner 5.30 m, full circle";
const STVZO: &str = "StVZO § 32d (rewis.io/gesetze/stvzo/p/stvzo-32d)";

const fn pbs(measure: Measure, who: &'static str, metres: f64) -> Limit {
    Limit { measure, who, metres, source: PBS, sureness: Sureness::NotRead, buses: None }
}

const fn read(measure: Measure, who: &'static str, metres: f64, source: &'static str, buses: Option<bool>) -> Limit {
    Limit { measure, who, metres, source, sureness: Sureness::Read, buses }
}

/// All limits, the stricter levels first.
const LIMITS: [Limit; 14] = [
    pbs(Measure::SweptPath, "PBS level 1", 7.4),
    pbs(Measure::SweptPath, "PBS level 2", 8.7),
    pbs(Measure::SweptPath, "PBS level 3", 10.6),
    pbs(Measure::SweptPath, "PBS level 4", 13.7),
    pbs(Measure::TailSwing, "PBS level 1", 0.30),
    pbs(Measure::TailSwing, "PBS level 2", 0.35),
    pbs(Measure::TailSwing, "PBS level 3", 0.35),
    pbs(Measure::TailSwing, "PBS level 4", 0.50),
    Limit { buses: Some(false), ..pbs(Measure::FrontalSwing, "PBS, all levels", 0.70) },
    Limit { buses: Some(true), ..pbs(Measure::FrontalSwing, "PBS, buses", 1.50) },
    read(Measure::InnerRadius, "EU", 5.30, EU, None),
    read(Measure::RingWidth, "DE", 7.20, STVZO, None),
    read(Measure::SwingOut, "DE", 0.80, STVZO, Some(false)),
    read(Measure::SwingOut, "DE, buses", 0.60, STVZO, Some(true)),
];

/// Measures beside every limit that is for such a vehicle. A vehicle whose name says bus is one.
#[must_use]
pub fn findings(vehicle: &Vehicle, right_angle: &Swept, circle: &Ring) -> Vec<Finding> {
    let bus = vehicle.name.to_lowercase().contains("bus");
    let turned = beyond_limit(vehicle, &right_angle.angles_rad).is_none();
    let circled = beyond_limit(vehicle, &circle.angles_rad).is_none();
    let finding = |limit: &Limit| {
        let metres = match limit.measure {
            Measure::SweptPath => right_angle.width_m.filter(|_| turned),
            Measure::TailSwing => turned.then_some(right_angle.tail_swing_m),
            Measure::FrontalSwing => turned.then_some(right_angle.frontal_swing_m),
            Measure::InnerRadius => circled.then_some(circle.inner_m),
            Measure::RingWidth => circled.then_some(circle.width_m()),
            Measure::SwingOut => circled.then_some(circle.swing_out_m),
        };
        let keeps = |m: f64| if limit.measure.at_least() { m >= limit.metres } else { m <= limit.metres };
        Finding { limit: *limit, metres, passes: metres.is_some_and(keeps) }
    };
    LIMITS.iter().filter(|limit| limit.buses.is_none_or(|buses| buses == bus)).map(finding).collect()
}
