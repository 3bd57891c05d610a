//! Selects the vehicles of a run: the requested ones, or those of the extract's countries.

use std::collections::BTreeMap;

use super::error::RunError;
use crate::vehicle::{Catalogue, Regions, Vehicle};

/// The least share of the roads with which a country counts as one of the extract's countries.
const OWN_SHARE: f64 = 0.1;

/// The vehicles to certify.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Selection {
    /// The vehicles of the extract's countries, and the vehicles with these ids.
    Region(Vec<String>),
    /// The vehicles with these ids.
    Ids(Vec<String>),
    /// All vehicles of the catalogue.
    All,
    /// No vehicle; only the network is written.
    None,
}

/// The countries with at least a tenth of the roads, those with most roads first. `roads` counts roads by country.
#[must_use]
pub fn own_countries(roads: &BTreeMap<[u8; 2], usize>) -> Vec<[u8; 2]> {
    let least = (roads.values().sum::<usize>() as f64 * OWN_SHARE) as usize;
    let mut own: Vec<_> = roads.iter().map(|(&country, &n)| (country, n)).filter(|&(_, n)| n >= least.max(1)).collect();
    own.sort_by_key(|&(country, n)| (std::cmp::Reverse(n), country));
    own.into_iter().map(|(country, _)| country).collect()
}

/// The vehicles of a selection, in catalogue order, each once. `roads` counts roads by country.
///
/// # Errors
/// An id is unknown. The error names similar ids.
pub fn selected<'c>(
    catalogue: &'c Catalogue,
    selection: &Selection,
    roads: &BTreeMap<[u8; 2], usize>,
) -> Result<Vec<&'c Vehicle>, RunError> {
    let ids: Vec<&str> = match selection {
        Selection::None => return Ok(Vec::new()),
        Selection::All => return Ok(catalogue.iter().collect()),
        Selection::Ids(ids) => known(catalogue, ids)?,
        Selection::Region(also) => {
            let regions = Regions::builtin()?;
            let of = |country| catalogue.for_country(&regions, country);
            let own = own_countries(roads).into_iter().flat_map(of).map(|v| v.id.as_str());
            own.chain(known(catalogue, also)?).collect()
        }
    };
    Ok(catalogue.iter().filter(|v| ids.contains(&v.id.as_str())).collect())
}

fn known<'c>(catalogue: &'c Catalogue, ids: &[String]) -> Result<Vec<&'c str>, RunError> {
    ids.iter().map(|id| Ok(catalogue.get(id)?.id.as_str())).collect()
}
