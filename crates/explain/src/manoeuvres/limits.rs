//! Published limits with their sources and sureness, compared with measured values.
//!
//! A pass here is no approval: assessments use the real bodies, tyres and axle groups.

use super::measure::{CircleMeasurements, TurnMeasurements, beyond_limit};
use crate::vehicle::Vehicle;

/// The quantity that a limit bounds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PerformanceMeasure {
    /// Low-speed swept path, 90° at 12.5 m: upper limit.
    SweptPath,
    /// Tail swing in the same turn: upper limit.
    TailSwing,
    /// Frontal swing in the same turn: upper limit.
    FrontalSwing,
    /// Inner radius of the circle with 12.5 m outer radius: lower limit.
    InnerRadius,
    /// Width of the ring: upper limit.
    RingWidth,
    /// Swing-out on entering the circle: upper limit.
    SwingOut,
}

impl PerformanceMeasure {
    /// Name for people.
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

    /// Name in files.
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

    /// Whether the limit is a lower limit.
    #[must_use]
    pub fn at_least(self) -> bool {
        self == Self::InnerRadius
    }
}

/// Reliability of a limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sureness {
    /// Read in the named source.
    Read,
    /// The standard is named, but its text was not available: check before quoting.
    NotRead,
}

impl Sureness {
    /// Text for people.
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
pub struct PublishedLimit {
    /// The limited quantity.
    pub measure: PerformanceMeasure,
    /// The issuer with the level: `PBS level 2`.
    pub who: &'static str,
    /// Value, metres.
    pub metres: f64,
    /// Source of the value.
    pub source: &'static str,
    /// Reliability of the value.
    pub sureness: Sureness,
    /// Whether it applies to buses only or to others only; `None` for all.
    pub buses: Option<bool>,
}

/// A measured value compared with a limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LimitFinding {
    /// The limit.
    pub limit: PublishedLimit,
    /// Measured value, metres. `None` if the turn cannot be driven (a hinge or the steering would exceed its limit) or
    /// the quantity does not exist.
    pub metres: Option<f64>,
    /// Whether the value keeps the limit.
    pub passes: bool,
}

const PBS: &str = "Australian PBS, Standards and Vehicle Assessment Rules (NTC 2008); the manoeuvre: \
                   advantia.com.au/technical/understanding-low-speed-swept-path";
const EU: &str = "Directive 96/53/EC with 97/27/EC 7.6.1: outer radius 12.50 m, inner 5.30 m, full circle";
const STVZO: &str = "StVZO § 32d (rewis.io/gesetze/stvzo/p/stvzo-32d)";

const fn pbs(measure: PerformanceMeasure, who: &'static str, metres: f64) -> PublishedLimit {
    PublishedLimit { measure, who, metres, source: PBS, sureness: Sureness::NotRead, buses: None }
}

const fn read(
    measure: PerformanceMeasure,
    who: &'static str,
    metres: f64,
    source: &'static str,
    buses: Option<bool>,
) -> PublishedLimit {
    PublishedLimit { measure, who, metres, source, sureness: Sureness::Read, buses }
}

/// All limits, the stricter levels first.
const LIMITS: [PublishedLimit; 14] = [
    pbs(PerformanceMeasure::SweptPath, "PBS level 1", 7.4),
    pbs(PerformanceMeasure::SweptPath, "PBS level 2", 8.7),
    pbs(PerformanceMeasure::SweptPath, "PBS level 3", 10.6),
    pbs(PerformanceMeasure::SweptPath, "PBS level 4", 13.7),
    pbs(PerformanceMeasure::TailSwing, "PBS level 1", 0.30),
    pbs(PerformanceMeasure::TailSwing, "PBS level 2", 0.35),
    pbs(PerformanceMeasure::TailSwing, "PBS level 3", 0.35),
    pbs(PerformanceMeasure::TailSwing, "PBS level 4", 0.50),
    PublishedLimit { buses: Some(false), ..pbs(PerformanceMeasure::FrontalSwing, "PBS, all levels", 0.70) },
    PublishedLimit { buses: Some(true), ..pbs(PerformanceMeasure::FrontalSwing, "PBS, buses", 1.50) },
    read(PerformanceMeasure::InnerRadius, "EU", 5.30, EU, None),
    read(PerformanceMeasure::RingWidth, "DE", 7.20, STVZO, None),
    read(PerformanceMeasure::SwingOut, "DE", 0.80, STVZO, Some(false)),
    read(PerformanceMeasure::SwingOut, "DE, buses", 0.60, STVZO, Some(true)),
];

/// Compares the measured values with every limit for such a vehicle. A vehicle whose name contains "bus" is a bus.
#[must_use]
pub fn findings(vehicle: &Vehicle, right_angle: &TurnMeasurements, circle: &CircleMeasurements) -> Vec<LimitFinding> {
    let bus = vehicle.name.to_lowercase().contains("bus");
    let turned = beyond_limit(vehicle, &right_angle.angles_rad).is_none();
    let circled = beyond_limit(vehicle, &circle.angles_rad).is_none();
    let finding = |limit: &PublishedLimit| {
        let metres = match limit.measure {
            PerformanceMeasure::SweptPath => right_angle.width_m.filter(|_| turned),
            PerformanceMeasure::TailSwing => turned.then_some(right_angle.tail_swing_m),
            PerformanceMeasure::FrontalSwing => turned.then_some(right_angle.frontal_swing_m),
            PerformanceMeasure::InnerRadius => circled.then_some(circle.inner_m),
            PerformanceMeasure::RingWidth => circled.then_some(circle.width_m()),
            PerformanceMeasure::SwingOut => circled.then_some(circle.swing_out_m),
        };
        let keeps = |m: f64| if limit.measure.at_least() { m >= limit.metres } else { m <= limit.metres };
        LimitFinding { limit: *limit, metres, passes: metres.is_some_and(keeps) }
    };
    LIMITS.iter().filter(|limit| limit.buses.is_none_or(|buses| buses == bus)).map(finding).collect()
}
