//! Which vehicles a run certifies: those asked for, or those of the extract's own countries and the ones that are asked
//! for everywhere (a 3-trailer road train).

use std::collections::BTreeMap;

use super::RunError;
use crate::network::Network;
use crate::vehicle::{Catalogue, Regions, Vehicle};

/// A country counts as the extract's own from this share of its roads.
const OWN_SHARE: f64 = 0.1;

/// Which vehicles to certify.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Selection {
    /// Those of the extract's own countries, and a 3-trailer road train.
    Region,
    /// These ids.
    Ids(Vec<String>),
    /// The whole catalogue.
    All,
    /// None: the network only.
    None,
}

/// The countries that hold at least a tenth of the network's roads, most roads first.
#[must_use]
pub fn own_countries(network: &Network) -> Vec<[u8; 2]> {
    let mut counts: BTreeMap<[u8; 2], usize> = BTreeMap::new();
    for road in &network.roads {
        *counts.entry(road.country).or_default() += 1;
    }
    let least = (network.roads.len() as f64 * OWN_SHARE) as usize;
    let mut own: Vec<_> = counts.into_iter().filter(|&(_, n)| n >= least.max(1)).collect();
    own.sort_by_key(|&(country, n)| (std::cmp::Reverse(n), country));
    own.into_iter().map(|(country, _)| country).collect()
}

/// The vehicles of a selection, in catalogue order, each once.
///
/// # Errors
/// An unknown id, with the ids most like it.
pub fn selected<'c>(
    catalogue: &'c Catalogue,
    selection: &Selection,
    network: &Network,
) -> Result<Vec<&'c Vehicle>, RunError> {
    let ids: Vec<&str> = match selection {
        Selection::None => return Ok(Vec::new()),
        Selection::All => return Ok(catalogue.iter().collect()),
        Selection::Ids(ids) => {
            let found = ids.iter().map(|id| catalogue.get(id)).collect::<Result<Vec<_>, _>>()?;
            found.into_iter().map(|v| v.id.as_str()).collect()
        }
        Selection::Region => {
            let regions = Regions::builtin()?;
            let of = |country| catalogue.for_country(&regions, country);
            own_countries(network).into_iter().flat_map(of).map(|v| v.id.as_str()).collect()
        }
    };
    Ok(catalogue.iter().filter(|v| ids.contains(&v.id.as_str())).collect())
}
