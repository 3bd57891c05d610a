//! Country and driving side of a position, looked up offline.
//!
//! Boundaries come from the crate `country-boundaries`. Its data are © OpenStreetMap contributors, ODbL, simplified,
//! and made for "every settlement and major road on the right side of the border". Without a country the code is `ZZ`
//! (left to users by ISO 3166), and traffic is assumed to keep to the right; the account counts these ways. The borders name
//! regions within others, smallest first. The first one with a known side decides, so an island that the list of sides lacks has
//! the side of the state that it belongs to.

use country_boundaries::{BOUNDARIES_ODBL_180X90, CountryBoundaries, LatLon};

use crate::osm::LonLat;
use crate::osm::facts::rules::{Rules, RulesError, country_code};

/// The side of the road to which traffic keeps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TrafficSide {
    /// Left-hand traffic.
    Left,
    /// Right-hand traffic.
    Right,
}

/// Country rules at a position, independent of tags.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Jurisdiction {
    /// ISO 3166-1 alpha-2 code; `ZZ` if there is none.
    pub country: [u8; 2],
    /// Whether traffic keeps to the left.
    pub left_hand_traffic: bool,
}

impl Jurisdiction {
    /// No country known; traffic keeps to the right.
    pub const NOWHERE: Jurisdiction = Jurisdiction { country: *b"ZZ", left_hand_traffic: false };

    pub(super) fn side(&self) -> TrafficSide {
        if self.left_hand_traffic { TrafficSide::Left } else { TrafficSide::Right }
    }
}

/// Why positions cannot be looked up.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
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
    pub fn driving_on(mut self, side: TrafficSide) -> Countries {
        self.left_hand_traffic = Some(side == TrafficSide::Left);
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
    pub fn jurisdiction(&self, position: LonLat) -> Jurisdiction {
        let found = match self.country {
            Some(country) => {
                let left = std::str::from_utf8(&country).is_ok_and(|code| self.rules.drives_on_the_left(code));
                Jurisdiction { country, left_hand_traffic: left }
            }
            None => self.look_up(position),
        };
        Jurisdiction { left_hand_traffic: self.left_hand_traffic.unwrap_or(found.left_hand_traffic), ..found }
    }

    /// The codes of the regions around a position, the smallest first: states (ISO 3166-2) and countries.
    #[must_use]
    pub fn regions(&self, position: LonLat) -> Vec<&str> {
        let (lon, lat) = position.degrees();
        LatLon::new(lat, lon).map_or_else(|_| Vec::new(), |at| self.boundaries.ids(at))
    }

    fn look_up(&self, position: LonLat) -> Jurisdiction {
        let (lon, lat) = position.degrees();
        let Ok(at) = LatLon::new(lat, lon) else { return Jurisdiction::NOWHERE };
        // Smallest region first: US-VI (left) before US (right), HK before CN.
        let ids = self.boundaries.ids(at);
        let Some(country) = ids.iter().find_map(|id| country_code(id.get(..2)?)) else { return Jurisdiction::NOWHERE };
        let known = |id: &&str| {
            let left = self.rules.drives_on_the_left(id);
            (left || self.rules.drives_on_the_right(id)).then_some(left)
        };
        let left_hand_traffic = ids.iter().find_map(known).unwrap_or(false);
        Jurisdiction { country, left_hand_traffic }
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
            let jurisdiction = countries.jurisdiction(at(lon, lat));
            assert_eq!((&jurisdiction.country, jurisdiction.left_hand_traffic), (country, left), "{name}");
        }
    }

    #[test]
    fn places_have_a_state() {
        let countries = Countries::load().unwrap();
        assert_eq!(countries.regions(at(-83.0, 39.96)), ["US-OH", "US"]);
        assert_eq!(countries.regions(at(151.2, -33.87)), ["AU-NSW", "AU"]);
        assert_eq!(countries.regions(at(-30.0, 40.0)), Vec::<&str>::new());
    }

    /// One place or more of every country and territory that keeps left, islands far from the rest of their state above all.
    const LEFT: &[(&str, f64, f64, &[u8; 2])] = &[
        ("Ascension", -14.41, -7.93, b"AC"),
        ("Saint Helena", -5.72, -15.93, b"SH"),
        ("Tristan da Cunha", -12.31, -37.07, b"TA"),
        ("Gough", -9.93, -40.35, b"SH"),
        ("Pitcairn", -130.1, -25.068, b"PN"),
        ("Nukunonu", -171.85, -9.199, b"TK"),
        ("Atafu", -172.5, -8.56, b"TK"),
        ("Fakaofo", -171.24, -9.38, b"TK"),
        ("South Georgia", -36.5, -54.283, b"GS"),
        ("Guernsey", -2.55, 49.45, b"GG"),
        ("Sark", -2.36, 49.433, b"GG"),
        ("Alderney", -2.2, 49.71, b"GG"),
        ("Jersey", -2.1, 49.2, b"JE"),
        ("Isle of Man", -4.5, 54.2, b"IM"),
        ("Shetland", -1.15, 60.15, b"GB"),
        ("Scilly", -6.3, 49.92, b"GB"),
        ("Belfast", -5.93, 54.6, b"GB"),
        ("Dhekelia", 33.745, 34.989, b"GB"),
        ("Akrotiri", 32.97, 34.6, b"GB"),
        ("Nicosia", 33.36, 35.17, b"CY"),
        ("Kyrenia", 33.32, 35.33, b"CY"),
        ("Dublin", -6.26, 53.35, b"IE"),
        ("Gozo", 14.24, 36.05, b"MT"),
        ("Landi Kotal", 71.145, 34.1, b"PK"),
        ("Azad Kashmir", 73.47, 34.37, b"PK"),
        ("Srinagar", 74.8, 34.09, b"IN"),
        ("Port Blair", 92.73, 11.67, b"IN"),
        ("Kavaratti", 72.64, 10.57, b"IN"),
        ("Kathmandu", 85.32, 27.7, b"NP"),
        ("Thimphu", 89.64, 27.47, b"BT"),
        ("Dhaka", 90.4, 23.8, b"BD"),
        ("Galle", 80.22, 6.03, b"LK"),
        ("Malé", 73.51, 4.18, b"MV"),
        ("Addu", 73.09, -0.63, b"MV"),
        ("Bangkok", 100.5, 13.75, b"TH"),
        ("Labuan", 115.24, 5.28, b"MY"),
        ("Singapore", 103.82, 1.35, b"SG"),
        ("Bandar Seri Begawan", 114.94, 4.9, b"BN"),
        ("Jakarta", 106.8, -6.2, b"ID"),
        ("Dili", 125.57, -8.56, b"TL"),
        ("Oecusse", 124.37, -9.2, b"TL"),
        ("Hong Kong", 114.16, 22.32, b"HK"),
        ("Macau", 113.54, 22.2, b"MO"),
        ("Tokyo", 139.7, 35.7, b"JP"),
        ("Naha", 127.68, 26.21, b"JP"),
        ("Chichijima", 142.19, 27.09, b"JP"),
        ("Tarawa", 173.0, 1.35, b"KI"),
        ("Kiritimati", -157.47, 1.99, b"KI"),
        ("Banaba", 169.53, -0.87, b"KI"),
        ("Nauru", 166.92, -0.53, b"NR"),
        ("Funafuti", 179.2, -8.52, b"TV"),
        ("Suva", 178.44, -18.14, b"FJ"),
        ("Taveuni", -179.97, -16.85, b"FJ"),
        ("Rotuma", 177.07, -12.5, b"FJ"),
        ("Tongatapu", -175.2, -21.14, b"TO"),
        ("Apia", -171.77, -13.83, b"WS"),
        ("Niue", -169.92, -19.05, b"NU"),
        ("Rarotonga", -159.78, -21.21, b"CK"),
        ("Pukapuka", -165.85, -10.88, b"CK"),
        ("Chatham", -176.55, -43.95, b"NZ"),
        ("Lord Howe", 159.07, -31.55, b"AU"),
        ("Norfolk Island", 167.95, -29.04, b"NF"),
        ("Christmas Island", 105.67, -10.43, b"CX"),
        ("Cocos", 96.83, -12.18, b"CC"),
        ("Heard", 73.5, -53.1, b"HM"),
        ("Port Moresby", 147.18, -9.44, b"PG"),
        ("Bougainville", 155.57, -6.2, b"PG"),
        ("Honiara", 159.95, -9.43, b"SB"),
        ("Stanley", -57.86, -51.69, b"FK"),
        ("Bermuda", -64.78, 32.29, b"BM"),
        ("Nassau", -77.35, 25.06, b"BS"),
        ("Grand Turk", -71.14, 21.46, b"TC"),
        ("Grand Cayman", -81.38, 19.29, b"KY"),
        ("Kingston", -76.8, 18.0, b"JM"),
        ("Tortola", -64.62, 18.43, b"VG"),
        ("Saint Croix", -64.73, 17.73, b"VI"),
        ("Anguilla", -63.06, 18.22, b"AI"),
        ("Montserrat", -62.2, 16.75, b"MS"),
        ("Saint Kitts", -62.72, 17.3, b"KN"),
        ("Antigua", -61.84, 17.12, b"AG"),
        ("Barbuda", -61.82, 17.63, b"AG"),
        ("Dominica", -61.39, 15.3, b"DM"),
        ("Saint Lucia", -60.99, 13.91, b"LC"),
        ("Bequia", -61.24, 13.01, b"VC"),
        ("Carriacou", -61.46, 12.48, b"GD"),
        ("Barbados", -59.6, 13.1, b"BB"),
        ("Tobago", -60.73, 11.18, b"TT"),
        ("Georgetown", -58.16, 6.8, b"GY"),
        ("Paramaribo", -55.17, 5.83, b"SR"),
        ("Nairobi", 36.82, -1.29, b"KE"),
        ("Kampala", 32.58, 0.32, b"UG"),
        ("Zanzibar", 39.2, -6.16, b"TZ"),
        ("Lilongwe", 33.78, -13.96, b"MW"),
        ("Lusaka", 28.28, -15.42, b"ZM"),
        ("Harare", 31.05, -17.83, b"ZW"),
        ("Maputo", 32.58, -25.96, b"MZ"),
        ("Gaborone", 25.91, -24.65, b"BW"),
        ("Windhoek", 17.08, -22.56, b"NA"),
        ("Cape Town", 18.42, -33.93, b"ZA"),
        ("Maseru", 27.48, -29.31, b"LS"),
        ("Mbabane", 31.13, -26.32, b"SZ"),
        ("Mahé", 55.45, -4.62, b"SC"),
        ("Rodrigues", 63.42, -19.68, b"MU"),
    ];

    #[test]
    fn every_territory_that_keeps_left_does() {
        let countries = Countries::load().unwrap();
        for (name, lon, lat, country) in LEFT {
            let jurisdiction = countries.jurisdiction(at(*lon, *lat));
            assert_eq!((&jurisdiction.country, jurisdiction.left_hand_traffic), (*country, true), "{name}");
        }
        // None is missing.
        for code in countries.rules().left.iter().filter(|code| code.len() == 2) {
            assert!(LEFT.iter().any(|row| row.3 == code.as_bytes()), "no place in {code}");
        }
        for (name, lon, lat) in [
            ("Diego Garcia", 72.411, -7.313),
            ("Longyearbyen", 15.65, 78.22),
            ("Palau", 134.48, 7.34),
            ("Gibraltar", -5.35, 36.14),
            ("San Juan", -66.1, 18.4),
            ("Pago Pago", -170.7, -14.28),
            ("Guam", 144.75, 13.47),
            ("Wake", 166.63, 19.28),
            ("Mayotte", 45.22, -12.78),
            ("Nouméa", 166.45, -22.27),
            ("Port Vila", 168.32, -17.74),
            ("Nuuk", -51.72, 64.18),
            ("Tórshavn", -6.77, 62.01),
            ("Jalalabad", 70.45, 34.43),
            ("Zhuhai", 113.54, 22.28),
            ("Saint-Pierre", -56.17, 46.78),
            ("Marigot", -63.08, 18.07),
            ("Luanda", 13.24, -8.84),
            ("Yangon", 96.16, 16.8),
        ] {
            assert!(!countries.jurisdiction(at(lon, lat)).left_hand_traffic, "{name}");
        }
    }

    #[test]
    fn every_region_of_the_borders_has_a_side() {
        let countries = Countries::load().unwrap();
        let rules = countries.rules();
        let mut unknown = std::collections::BTreeSet::new();
        for lat in -89..90 {
            for lon in -180..180 {
                let at = LatLon::new(f64::from(lat) + 0.2, f64::from(lon) + 0.3).unwrap();
                for id in countries.boundaries.ids(at).iter().filter(|id| id.len() == 2) {
                    if !rules.drives_on_the_left(id) && !rules.drives_on_the_right(id) {
                        unknown.insert((*id).to_owned());
                    }
                }
            }
        }
        // It has no roads; it lies in Australia's territory.
        unknown.remove("HM");
        assert!(unknown.is_empty(), "{unknown:?}");
    }

    #[test]
    fn overrides_come_first() {
        let nz = Countries::load().unwrap().in_country("nz").unwrap();
        assert_eq!(nz.jurisdiction(at(8.69, 49.41)), Jurisdiction { country: *b"NZ", left_hand_traffic: true });
        let odd = nz.driving_on(TrafficSide::Right);
        assert_eq!(odd.jurisdiction(at(8.69, 49.41)), Jurisdiction { country: *b"NZ", left_hand_traffic: false });
        assert!(Countries::load().unwrap().in_country("Germany").is_err());
    }
}
