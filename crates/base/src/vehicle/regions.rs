//! Regions: whose combinations run on the roads of which countries (`data/regions.toml`, compiled in).

use std::collections::HashMap;

use serde::Deserialize;

use super::{VehicleError, VehicleFault};

const BUILTIN: &str = include_str!("../../../../data/regions.toml");

/// One region of the catalogue.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CatalogueRegion {
    /// As in [`super::Vehicle::region`].
    pub code: String,
    /// Name for people.
    pub name: String,
    /// ISO 3166-1 alpha-2 codes of its countries, upper case.
    pub countries: Vec<String>,
}

/// The map from countries to regions.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Regions {
    otherwise: Vec<String>,
    region: Vec<CatalogueRegion>,
    #[serde(skip)]
    by_country: HashMap<[u8; 2], Vec<String>>,
}

impl Regions {
    /// The shipped map.
    ///
    /// # Errors
    /// None in a build whose tests pass: the file is compiled in.
    pub fn builtin() -> Result<Self, VehicleError> {
        let refused = |problem: String| VehicleError::Refused {
            file: "data/regions.toml".into(),
            faults: vec![VehicleFault { line: None, place: String::new(), problem }],
        };
        let mut regions: Self = toml::from_str(BUILTIN).map_err(|e| refused(e.to_string()))?;
        for region in &regions.region {
            for country in &region.countries {
                let Ok(code) = <[u8; 2]>::try_from(country.as_bytes()) else {
                    return Err(refused(format!("region {:?}: {country:?} is not a two-letter code", region.code)));
                };
                regions.by_country.entry(code).or_default().push(region.code.clone());
            }
        }
        Ok(regions)
    }

    /// The region codes of a country (ISO 3166-1 alpha-2, upper case), in file order; never empty.
    #[must_use]
    pub fn regions_for(&self, country: [u8; 2]) -> &[String] {
        self.by_country.get(&country).unwrap_or(&self.otherwise)
    }

    /// All regions, in file order.
    pub fn iter(&self) -> impl Iterator<Item = &CatalogueRegion> {
        self.region.iter()
    }
}
