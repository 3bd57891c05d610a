//! The settings that a certificate depends on besides the network and the vehicle.
//!
//! [`Settings::written`] writes every setting, and [`Settings::read`] gives the same settings or an error. A member that is
//! missing, unknown, of another type or out of range is never replaced by a default. A database stores the text with each set
//! of certificates; a new computation of the set reads the settings from it.

use netcert_base::named;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::corridor::Params;
use crate::osm::facts::Policy;
use crate::turns::{Kerbs, TurnParams};
use crate::words::Named as _;
use netcert_base::corrections::Options;

/// How certificates are made.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// The policy: which width of the road the vehicle may use.
    pub policy: Policy,
    /// Parameters of corridors.
    pub corridor: Params,
    /// Options of the certificate's corrections.
    pub stet: Options,
    /// The width that the vehicle may use near turns. Never less than that of `policy` counts.
    pub turn_policy: Policy,
    /// Assumed kerb radii.
    pub kerbs: Kerbs,
    /// Whether turns are certified, too.
    pub turns: bool,
    /// What is said of the width or kerb radius that would be enough.
    pub needs: Needs,
}

/// What is said of certificates that lack room: how much would be enough.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Needs {
    /// Nothing.
    Off,
    /// Of edges the width that is likely to do: the width less twice the RSC. It is not certified.
    Estimated,
    /// Of edges a width that was certified to do.
    Edges,
    /// Of edges and turns what was certified to do. A turn takes as long to search as it takes to certify several turns.
    All,
}

named!(Needs { Off = "off", Estimated = "estimated", Edges = "edges", All = "all" });

impl Needs {
    /// Whether a set with these needs also has what `asked` names.
    #[must_use]
    pub fn include(self, asked: Self) -> bool {
        match asked {
            Self::Off => true,
            Self::Estimated => self != Self::Off,
            Self::Edges => matches!(self, Self::Edges | Self::All),
            Self::All => self == Self::All,
        }
    }
}

impl Default for Settings {
    /// The settings of `ingest` without options.
    fn default() -> Self {
        Self {
            policy: Policy::Lane,
            turn_policy: Policy::Direction,
            corridor: Params::default(),
            stet: Options::default(),
            kerbs: Kerbs::default(),
            turns: true,
            needs: Needs::Estimated,
        }
    }
}

/// The written members. Their names are stable, because `run.parameters` and exports show them.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    corridor: String,
    turn_corridor: String,
    smoothing_tolerance_m: f64,
    smoothing_cutoff_m: f64,
    map_tolerance_m: f64,
    station_spacing_m: f64,
    lead_in_m: f64,
    max_shift_m: f64,
    correction_sweeps: u16,
    turns: bool,
    needs: String,
    kerbs: Kerbs,
}

impl Settings {
    /// The parameters of turns.
    #[must_use]
    pub fn turn_params(&self) -> TurnParams {
        TurnParams { strip: self.turn_policy, corridor: self.corridor, kerbs: self.kerbs.clone(), own_kerb_m: None }
    }

    /// All settings as JSON. The same settings give the same bytes.
    ///
    /// # Errors
    /// A member is out of range; the error names it.
    pub fn written(&self) -> Result<String, String> {
        // The pattern has no `..`, so a new field does not compile until it is written.
        let Self { policy, corridor, stet, turn_policy, kerbs, turns, needs } = self;
        let Params { tolerance_m, map_tolerance_m, spacing_m, cutoff_m, lead_in_m } = *corridor;
        let Options { max_shift_m, correction_sweeps } = *stet;
        let written = Written {
            corridor: policy.name().to_owned(),
            turn_corridor: turn_policy.name().to_owned(),
            smoothing_tolerance_m: tolerance_m,
            smoothing_cutoff_m: cutoff_m,
            map_tolerance_m,
            station_spacing_m: spacing_m,
            lead_in_m,
            max_shift_m,
            correction_sweeps: u16::try_from(correction_sweeps).map_err(|_| "correction_sweeps: out of range")?,
            turns: *turns,
            needs: needs.name().to_owned(),
            kerbs: kerbs.clone(),
        };
        written.check()?;
        serde_json::to_string(&written).map_err(|error| error.to_string())
    }

    /// The members without the table of kerbs, for records that people read.
    ///
    /// # Errors
    /// A member is out of range; the error names it.
    pub fn options(&self) -> Result<Map<String, Value>, String> {
        let mut members: Map<String, Value> =
            serde_json::from_str(&self.written()?).map_err(|error| error.to_string())?;
        members.shift_remove("kerbs");
        Ok(members)
    }

    /// Reads the text of [`Self::written`].
    ///
    /// # Errors
    /// The text is no such text; the error says what is wrong.
    pub fn read(text: &str) -> Result<Self, String> {
        let written: Written = serde_json::from_str(text).map_err(|error| error.to_string())?;
        written.check()?;
        let policy = Policy::named(&written.corridor).ok_or("corridor: no such policy")?;
        let turn_policy = Policy::named(&written.turn_corridor).ok_or("turn_corridor: no such policy")?;
        let needs = Needs::named(&written.needs).ok_or("needs: no such word")?;
        Ok(Self {
            policy,
            turn_policy,
            corridor: Params {
                tolerance_m: written.smoothing_tolerance_m,
                map_tolerance_m: written.map_tolerance_m,
                spacing_m: written.station_spacing_m,
                cutoff_m: written.smoothing_cutoff_m,
                lead_in_m: written.lead_in_m,
            },
            stet: Options {
                max_shift_m: written.max_shift_m,
                correction_sweeps: usize::from(written.correction_sweeps),
            },
            kerbs: written.kerbs,
            turns: written.turns,
            needs,
        })
    }
}

impl Written {
    /// Checks that members are within bounds. The bounds contain the ranges of the options, and keep a damaged file from
    /// causing endless work.
    fn check(&self) -> Result<(), String> {
        for (name, value, low, high) in [
            ("smoothing_tolerance_m", self.smoothing_tolerance_m, 0.0, 100.0),
            ("smoothing_cutoff_m", self.smoothing_cutoff_m, 1.0, 10_000.0),
            ("map_tolerance_m", self.map_tolerance_m, 0.0, 100.0),
            ("station_spacing_m", self.station_spacing_m, 0.1, 10.0),
            ("lead_in_m", self.lead_in_m, 0.0, 10_000.0),
            ("max_shift_m", self.max_shift_m, 0.0, 100.0),
            ("correction_sweeps", f64::from(self.correction_sweeps), 0.0, 100.0),
        ] {
            if !(low..=high).contains(&value) {
                return Err(format!("{name}: {value} is not between {low} and {high}"));
            }
        }
        self.kerbs.check().map_err(|detail| format!("kerbs: {detail}"))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use serde_json::json;

    use super::*;

    fn some() -> Settings {
        Settings {
            policy: Policy::Direction,
            turn_policy: Policy::Carriageway,
            corridor: Params {
                tolerance_m: 0.1 + 0.2,
                map_tolerance_m: 0.3,
                spacing_m: 0.5,
                cutoff_m: 123.0,
                lead_in_m: 77.5,
            },
            stet: Options { max_shift_m: 0.0, correction_sweeps: 5 },
            kerbs: Kerbs::everywhere(2.5),
            turns: false,
            needs: Needs::All,
        }
    }

    #[test]
    fn what_is_written_is_read_again_to_the_last_bit() {
        for settings in [Settings::default(), some()] {
            assert_eq!(Settings::read(&settings.written().unwrap()).unwrap(), settings);
        }
    }

    #[test]
    fn what_is_not_whole_is_an_error_that_names_the_member() {
        let whole: Value = serde_json::from_str(&some().written().unwrap()).unwrap();
        for name in whole.as_object().unwrap().keys() {
            let mut missing = whole.clone();
            missing.as_object_mut().unwrap().shift_remove(name);
            assert!(Settings::read(&missing.to_string()).unwrap_err().contains(name), "{name} is missing");
            let mut of_another_type = whole.clone();
            of_another_type[name] = json!([["x"]]);
            assert!(Settings::read(&of_another_type.to_string()).is_err(), "{name} is a list");
        }
        let mut unknown = whole.clone();
        unknown["max_sway_m"] = json!(1);
        assert!(Settings::read(&unknown.to_string()).unwrap_err().contains("max_sway_m"));
        for (name, wrong) in [
            ("corridor", json!("shoulder")),
            ("turn_corridor", json!("same")),
            ("smoothing_tolerance_m", json!(-0.1)),
            ("smoothing_cutoff_m", json!(0)),
            ("map_tolerance_m", json!(100.5)),
            ("station_spacing_m", json!(0.0)),
            ("lead_in_m", json!(1e9)),
            ("max_shift_m", json!(-1)),
            ("correction_sweeps", json!(101)),
            ("needs", json!("some")),
        ] {
            let mut out = whole.clone();
            out[name] = wrong.clone();
            assert!(Settings::read(&out.to_string()).unwrap_err().contains(name), "{name} {wrong}");
        }
        let mut kerbs = whole;
        kerbs["kerbs"][0]["primary"] = json!(-1.0);
        assert!(Settings::read(&kerbs.to_string()).unwrap_err().contains("kerbs"));
        for text in ["", "{}", "null", "[]", "{\"corridor\":"] {
            assert!(Settings::read(text).is_err(), "{text:?}");
        }
    }

    #[test]
    fn what_is_out_of_range_is_not_written() {
        let stet = Options { max_shift_m: f64::NAN, ..Options::default() };
        assert!(Settings { stet, ..some() }.written().unwrap_err().contains("max_shift_m"));
        assert!(Settings { kerbs: Kerbs::everywhere(f64::INFINITY), ..some() }.written().is_err());
    }
}
