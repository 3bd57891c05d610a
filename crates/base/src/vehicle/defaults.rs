//! What a vehicle definition that leaves something out gets. Every default errs to the wider, longer or less nimble
//! side of the catalogue's lorries, so that leaving a field out does not make one look easier to place than it is.
//!
//! L has none: nothing stands in for the length that the off-tracking comes from. Height, mass and axle load have none
//! either: they stay unknown. The catalogue itself relies on no default: it states every value.

/// d: the hitch over the axle. Steady off-tracking falls with d² whichever the sign, so 0 is its worst case.
pub(crate) const HITCH_OFFSET_M: f64 = 0.0;

/// f of the prime mover: the longest nose of a catalogue lorry (AU-SEMI19; buses have up to 2.8 m).
pub(crate) const FRONT_OVERHANG_FIRST_M: f64 = 1.6;

/// f of a trailer: the front of the EU semi-trailer (2.04 m front swing radius, directive 96/53/EC) is 1.6 m ahead.
pub(crate) const FRONT_OVERHANG_TRAILER_M: f64 = 1.6;

/// r: the longest tail of the catalogue, the EU semi-trailer's 12.0 m kingpin to rear less its 7.7 m wheelbase.
pub(crate) const REAR_OVERHANG_M: f64 = 4.3;

/// b: the widest general limit of the catalogue's regions (Canada 2.60 m; also refrigerated bodies in the EU).
pub(crate) const WIDTH_M: f64 = 2.6;

/// Steering lock. Assumed; the published minimum turns of AASHTO trucks ask for 12° to 29° of it at the tightest.
pub(crate) const STEERING_LOCK_DEG: f64 = 42.0;

/// Hinges: the low end of what fifth wheels allow (70° to 90°). Assumed.
pub(crate) const HINGE_DEG: f64 = 70.0;

/// σ: assumed; about the slip angle of lorry tyres on a 2.5 % crossfall (0.025 over a cornering stiffness of some seven
/// times the load per radian).
pub(crate) const SWAY_DEG: f64 = 0.2;

/// ε: assumed; a careful driver's or lane keeping's tracking at low speed.
pub(crate) const TRACKING_TOLERANCE_M: f64 = 0.15;

/// m: assumed.
pub(crate) const TRACKING_HEADING_DEG: f64 = 3.0;

/// γ_min: assumed.
pub(crate) const MIN_SHRINK: f64 = 0.3;
