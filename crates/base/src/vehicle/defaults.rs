//! Default values for fields that a vehicle definition leaves out. Every default errs to the wider, longer or less
//! manoeuvrable side of the catalogue's lorries. Leaving a field out therefore never makes a vehicle look easier to
//! place.
//!
//! L has no default, because offtracking comes from it. Height, mass and axle load have none either: they stay unknown.
//! The shipped catalogue states every value and relies on no default.

/// d: the hitch over the axle. Steady offtracking falls with d² for either sign, so 0 is the worst case.
pub(crate) const HITCH_OFFSET_M: f64 = 0.0;

/// f of the prime mover: the longest front overhang of a catalogue lorry (AU-SEMI19). Buses have up to 2.8 m.
pub(crate) const FRONT_OVERHANG_FIRST_M: f64 = 1.6;

/// f of a trailer: the EU semi-trailer's front (front swing radius 2.04 m, directive 96/53/EC) is 1.6 m ahead of the
/// kingpin.
pub(crate) const FRONT_OVERHANG_TRAILER_M: f64 = 1.6;

/// r: the longest rear overhang of the catalogue. The EU semi-trailer has 12.0 m from kingpin to rear, less 7.7 m of
/// wheelbase.
pub(crate) const REAR_OVERHANG_M: f64 = 4.3;

/// b: the widest general limit of the catalogue's regions (Canada, 2.60 m; also refrigerated bodies in the EU).
pub(crate) const WIDTH_M: f64 = 2.6;

/// Steering lock. Assumed. The published minimum turns of AASHTO trucks need 12° to 29°.
pub(crate) const STEERING_LOCK_DEG: f64 = 42.0;

/// Hinge limit: the low end of what fifth wheels allow (70° to 90°). Assumed.
pub(crate) const HINGE_DEG: f64 = 70.0;

/// σ. Assumed: about the slip angle of lorry tyres on a 2.5 % crossfall, with a cornering stiffness of about seven
/// times the load per radian.
pub(crate) const SWAY_DEG: f64 = 0.2;

/// ε. Assumed: the tracking of a careful driver or of lane keeping at low speed.
pub(crate) const TRACKING_TOLERANCE_M: f64 = 0.15;

/// m. Assumed.
pub(crate) const TRACKING_HEADING_DEG: f64 = 3.0;

/// γ_min. Assumed.
pub(crate) const MIN_SHRINK: f64 = 0.3;
