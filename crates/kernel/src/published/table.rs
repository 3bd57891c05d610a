//! Table I: the seven scenarios, from `data/paper/scenarios.toml`.

use serde::Deserialize;
use thiserror::Error;

use super::reading::As;
use super::rsc::Rsc;
use super::system::System;

const FILE: &str = "data/paper/scenarios.toml";

/// One row of Table I.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scenario {
    /// Sc. No.
    pub number: u32,
    /// N, L, θ and 𝒟.
    pub system: System,
    /// h_Ω, metres.
    pub h_omega_m: f64,
    /// h_Ξ.
    pub h_xi: f64,
    /// w_min, metres.
    pub w_min_m: f64,
}

impl Scenario {
    /// 𝒞 from the row's own numbers, with r_0 half the body's length.
    #[must_use]
    pub fn rsc(&self) -> Rsc {
        Rsc::from_bounds(self.w_min_m, self.h_omega_m, self.h_xi, self.system.prime_radius_m(As::Printed))
    }
}

/// Why the shipped table cannot be read. This is a fault of the build, not of a user.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum TableError {
    /// Unexpected fields.
    #[error("{FILE}: {0}")]
    Syntax(#[from] toml::de::Error),
    /// A number out of bounds.
    #[error("{FILE}: scenario {number}: units, lengths and angles must be above 0, the angle at most 90°")]
    Bounds {
        /// Sc. No.
        number: u32,
    },
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    scenario: Vec<Row>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Row {
    number: u32,
    units: usize,
    link_m: f64,
    sway_deg: f64,
    length_m: f64,
    width_m: f64,
    h_omega_m: f64,
    h_xi: f64,
    w_min_m: f64,
}

/// The seven scenarios, in the order of the table.
///
/// # Errors
/// None with the shipped file.
pub fn scenarios() -> Result<Vec<Scenario>, TableError> {
    let table: Table = toml::from_str(include_str!("../../../../data/paper/scenarios.toml"))?;
    table.scenario.iter().map(scenario).collect()
}

fn scenario(row: &Row) -> Result<Scenario, TableError> {
    let positive = [row.link_m, row.sway_deg, row.length_m, row.width_m, row.h_xi, row.w_min_m];
    if row.units == 0 || row.sway_deg > 90.0 || !positive.iter().all(|v| *v > 0.0 && v.is_finite()) {
        return Err(TableError::Bounds { number: row.number });
    }
    Ok(Scenario {
        number: row.number,
        system: System {
            trailers: row.units - 1,
            link_m: row.link_m,
            sway_rad: row.sway_deg.to_radians(),
            length_m: row.length_m,
            width_m: row.width_m,
        },
        h_omega_m: row.h_omega_m,
        h_xi: row.h_xi,
        w_min_m: row.w_min_m,
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn the_tables_own_numbers_give_the_papers_verdicts() {
        let safe: Vec<u32> = scenarios().unwrap().iter().filter(|s| s.rsc().printed_safe()).map(|s| s.number).collect();
        assert_eq!(safe, [1, 3, 5]);
    }

    #[test]
    fn scenario_five_in_numbers() {
        let five = scenarios().unwrap()[4];
        assert_eq!((five.system.trailers, five.system.length_m), (3, 10.1));
        // 7.984 − (0.250 + 1.006 · 5.05)
        assert!((five.rsc().rsc_m - 2.6537).abs() < 1e-9);
    }
}
