//! Country and driving side of a position, looked up offline.
//!
//! Boundaries come from the crate `country-boundaries`. Its data are © OpenStreetMap contributors, ODbL, simplified,
//! and made for "every settlement and major road on the right side of the border". Without a country the code is `ZZ`
//! (left to users by ISO 3166), and traffic is assumed to keep to the right.

use country_boundaries::{BOUNDARIES_ODBL_180X90, CountryBoundaries, LatLon};

use crate::osm::LonLat;
use crate::osm::facts::rules::{Rules, RulesError, country_code};

/// Country rules at a position, independent of tags.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Place {
    /// ISO 3166-1 alpha-2 code; `ZZ` if there is none.
    pub country: [u8; 2],
    /// Whether traffic keeps to the left.
    pub left_hand_traffic: bool,
}

impl Place {
    /// No country known; traffic keeps to the right.
    pub const NOWHERE: Place = Place { country: *b"ZZ", left_hand_traffic: false };
}

/// Why positions cannot be looked up.
#[derive(Debug, thiserror::Error)]
pub enum CountriesError {
    /// The boundaries in the program are damaged.
    #[error("the built-in country boundaries cannot be read: {0}; reinstall netcert")]
    Boundaries(String),
    /// The rules, which list left-hand traffic, are wrong.
    #[error(transparent)]
    Rules(#[from] RulesError),
    /// An override that is not a country code.
    #[error("\"{0}\" is not a country code: give two letters of ISO 3166-1, such as AU")]
    Code(String),
}

/// The lookup. It takes about 3 MB; load it once.
#[derive(Debug)]
pub struct Countries {
    boundaries: CountryBoundaries,
    rules: Rules,
    country: Option<[u8; 2]>,
    left_hand_traffic: Option<bool>,
}

impl Countries {
    /// Loads the lookup with the built-in rules.
    ///
    /// # Errors
    /// [`CountriesError`] if built-in data are damaged.
    pub fn load() -> Result<Countries, CountriesError> {
        Self::with_rules(Rules::builtin()?)
    }

    /// Loads the lookup with the driving sides of these rules.
    ///
    /// # Errors
    /// [`CountriesError`] if the built-in boundaries are damaged.
    pub fn with_rules(rules: Rules) -> Result<Countries, CountriesError> {
        let boundaries = CountryBoundaries::from_reader(BOUNDARIES_ODBL_180X90)
            .map_err(|error| CountriesError::Boundaries(error.to_string()))?;
        Ok(Countries { boundaries, rules, country: None, left_hand_traffic: None })
    }

    /// Overrides the country of every position (`--country`).
    ///
    /// # Errors
    /// [`CountriesError::Code`] if `code` is not two letters.
    pub fn in_country(mut self, code: &str) -> Result<Countries, CountriesError> {
        let upper = code.to_ascii_uppercase();
        self.country = Some(country_code(&upper).ok_or_else(|| CountriesError::Code(code.to_owned()))?);
        Ok(self)
    }

    /// Overrides the driving side of every position (`--driving-side`).
    #[must_use]
    pub fn driving_on_the_left(mut self, left: bool) -> Countries {
        self.left_hand_traffic = Some(left);
        self
    }

    /// The rules of this lookup.
    #[must_use]
    pub fn rules(&self) -> &Rules {
        &self.rules
    }

    /// All that the user can change of this lookup, as text: equal texts, equal places and widths.
    #[must_use]
    pub fn identity(&self) -> String {
        let Self { boundaries: _, rules, country, left_hand_traffic } = self;
        format!("{rules:?} {country:?} {left_hand_traffic:?}")
    }

    /// Country and driving side of a position. Overrides take precedence.
    #[must_use]
    pub fn place(&self, position: LonLat) -> Place {
        let found = match self.country {
            Some(country) => {
                let left = std::str::from_utf8(&country).is_ok_and(|code| self.rules.drives_on_the_left(code));
                Place { country, left_hand_traffic: left }
            }
            None => self.look_up(position),
        };
        Place { left_hand_traffic: self.left_hand_traffic.unwrap_or(found.left_hand_traffic), ..found }
    }

    fn look_up(&self, position: LonLat) -> Place {
        let (lon, lat) = position.degrees();
        let Ok(at) = LatLon::new(lat, lon) else { return Place::NOWHERE };
        // Smallest region first: US-VI (left) before US (right), HK before CN.
        let ids = self.boundaries.ids(at);
        let Some(country) = ids.iter().find_map(|id| country_code(id.get(..2)?)) else { return Place::NOWHERE };
        let left_hand_traffic =
            ids.iter().take_while(|id| id.as_bytes().starts_with(&country)).any(|id| self.rules.drives_on_the_left(id));
        Place { country, left_hand_traffic }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn at(lon: f64, lat: f64) -> LonLat {
        LonLat { lon_e7: (lon * 1e7) as i32, lat_e7: (lat * 1e7) as i32 }
    }

    #[test]
    fn places_have_a_country_and_a_driving_side() {
        let countries = Countries::load().unwrap();
        for (name, lon, lat, country, left) in [
            ("Heidelberg", 8.69, 49.41, b"DE", false),
            ("Sydney", 151.2, -33.87, b"AU", true),
            ("Columbus", -83.0, 39.96, b"US", false),
            ("Andorra la Vella", 1.52, 42.506, b"AD", false),
            ("London", -0.12, 51.5, b"GB", true),
            ("Hong Kong", 114.16, 22.32, b"HK", true),
            ("Shenzhen", 114.06, 22.55, b"CN", false),
            ("Charlotte Amalie", -64.93, 18.343, b"VI", true),
            ("Luanda", 13.24, -8.84, b"AO", false),
            ("the Atlantic", -30.0, 40.0, b"ZZ", false),
        ] {
            let place = countries.place(at(lon, lat));
            assert_eq!((&place.country, place.left_hand_traffic), (country, left), "{name}");
        }
    }

    #[test]
    fn overrides_come_first() {
        let nz = Countries::load().unwrap().in_country("nz").unwrap();
        assert_eq!(nz.place(at(8.69, 49.41)), Place { country: *b"NZ", left_hand_traffic: true });
        let odd = nz.driving_on_the_left(false);
        assert_eq!(odd.place(at(8.69, 49.41)), Place { country: *b"NZ", left_hand_traffic: false });
        assert!(Countries::load().unwrap().in_country("Germany").is_err());
    }
}
