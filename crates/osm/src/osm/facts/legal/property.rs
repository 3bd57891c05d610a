//! What a rule compares of a vehicle.

use crate::osm::facts::Limit;
use crate::osm::facts::value;
use crate::vehicle::Vehicle;
use crate::verdict::ForbiddenReason;

/// Tolerance of comparisons: tags have two decimals and limits are `f32`, so 2.55 must not exceed 2.55.
pub(crate) const SLACK: f64 = 1e-3;

/// A size, mass or number of a vehicle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Property {
    Height,
    Length,
    Width,
    /// Of the combination.
    Weight,
    AxleLoad,
    /// Without load. Nobody states it; it is at most the gross mass.
    UnladenWeight,
    /// Of a group of so many axles. It is at most so many axle loads.
    GroupLoad(u8),
    /// Of each trailer. It is at most the mass of the combination.
    TrailerWeight,
    /// Of the longest trailer.
    TrailerLength,
    Axles,
    Trailers,
}

impl Property {
    /// The property that a key limits.
    pub(crate) fn of_key(key: &str) -> Option<Self> {
        Some(match key {
            "maxheight" => Self::Height,
            "maxlength" => Self::Length,
            "maxwidth" => Self::Width,
            "maxweight"
            | "maxweightrating"
            | "maxgcweight"
            | "maxgcweightrating"
            | "maxgrossweight"
            | "maxgrossweightrating" => Self::Weight,
            "maxaxleload" | "maxaxleweight" => Self::AxleLoad,
            "maxunladenweight" | "maxemptyweight" => Self::UnladenWeight,
            "maxtandemaxleload" | "maxtandemaxleweight" | "maxtandemweight" => Self::GroupLoad(2),
            "maxbogieweight" | "maxbogieload" | "maxtridemaxleload" | "maxtridemweight" | "maxaxlegroupload" => {
                Self::GroupLoad(3)
            }
            "maxaxles" | "maxaxlecount" => Self::Axles,
            "maxtrailers" => Self::Trailers,
            _ => return None,
        })
    }

    /// The property of a word in a condition, in lower case: `weight`, `maxgcweightrating`, `vehicle_weight`, `axle_load`.
    pub(crate) fn of_word(word: &str) -> Option<Self> {
        let word = word.replace([' ', '-'], "_");
        Some(match word.as_str() {
            "axles" | "axle" | "axle_count" | "axlecount" | "maxaxles" | "number_of_axles" => Self::Axles,
            "trailer" | "trailers" | "maxtrailers" | "trailer_count" => Self::Trailers,
            "trailer_length" | "maxlength:trailer" | "length:trailer" => Self::TrailerLength,
            "trailer_weight" | "maxweight:trailer" | "weight:trailer" => Self::TrailerWeight,
            "height" | "maxheight" | "vehicle_height" => Self::Height,
            "length" | "maxlength" | "vehicle_length" | "total_length" => Self::Length,
            "width" | "maxwidth" | "vehicle_width" => Self::Width,
            word if word.contains("unladen") || word.contains("empty") => Self::UnladenWeight,
            word if word.contains("bogie") || word.contains("tridem") => Self::GroupLoad(3),
            word if word.contains("tandem") => Self::GroupLoad(2),
            word if word.contains("axle") && (word.contains("load") || word.contains("weight")) => Self::AxleLoad,
            word if word.contains("weight") || word.contains("mass") => Self::Weight,
            _ => return None,
        })
    }

    /// The same property of each trailer.
    pub(crate) fn of_trailers(self) -> Self {
        match self {
            Self::Length => Self::TrailerLength,
            Self::Weight => Self::TrailerWeight,
            other => other,
        }
    }

    pub(crate) fn is_number(self) -> bool {
        matches!(self, Self::Axles | Self::Trailers)
    }

    pub(crate) fn is_mass(self) -> bool {
        !self.is_number() && !matches!(self, Self::Height | Self::Length | Self::Width | Self::TrailerLength)
    }

    pub(crate) fn slack(self) -> f64 {
        if self.is_number() { 0.5 } else { SLACK }
    }

    pub(crate) fn unit(self) -> &'static str {
        match self {
            Self::Axles | Self::Trailers => "",
            _ if self.is_mass() => "t",
            _ => "m",
        }
    }

    /// The greatest value that a sign shows. Greater ones are refused, because their unit is missing (kilograms, centimetres).
    pub(crate) fn greatest(self) -> f32 {
        match self {
            Self::Height => 15.0,
            Self::Length | Self::TrailerLength | Self::GroupLoad(_) => 150.0,
            Self::Width => 30.0,
            Self::Weight | Self::UnladenWeight | Self::TrailerWeight => 500.0,
            Self::AxleLoad => 60.0,
            Self::Axles | Self::Trailers => 100.0,
        }
    }

    /// Reads a limit.
    pub(crate) fn read(self, text: &str) -> Limit {
        if self.is_number() {
            return match text.trim() {
                "none" | "unsigned" | "default" | "no" => Limit::None,
                text => text.parse::<u8>().map_or(Limit::Unreadable, |most| Limit::At(f32::from(most))),
            };
        }
        value::limit(text, if self.is_mass() { value::tonnes } else { value::metres }, self.greatest())
    }

    /// Least and greatest value that the vehicle may have. `None`: nobody stated it.
    pub(crate) fn of(self, vehicle: &Vehicle) -> Option<(f64, f64)> {
        let same = |value: f64| (value, value);
        match self {
            Self::Height => vehicle.height_m.map(same),
            Self::Length => Some(same(vehicle.length_m)),
            Self::Width => Some(same(vehicle.width_m())),
            Self::Weight => vehicle.gross_mass_t.map(same),
            Self::AxleLoad => vehicle.axle_load_t.map(same),
            Self::UnladenWeight | Self::TrailerWeight => vehicle.gross_mass_t.map(|most| (0.0, most)),
            Self::GroupLoad(axles) => {
                let group = vehicle.axle_load_t.map(|load| load * f64::from(axles));
                group.into_iter().chain(vehicle.gross_mass_t).reduce(f64::min).map(|most| (0.0, most))
            }
            Self::TrailerLength => {
                let trailers = (1..vehicle.units.len()).filter(|&unit| !vehicle.is_dolly(unit));
                let lengths = trailers.filter_map(|unit| {
                    let unit = vehicle.units.get(unit)?;
                    Some(unit.front_overhang_m + unit.coupling_to_axle_m + unit.rear_overhang_m)
                });
                lengths.reduce(f64::max).map(same)
            }
            Self::Axles => {
                let (least, most) = vehicle.axle_range();
                Some((f64::from(least), most.map_or(f64::INFINITY, f64::from)))
            }
            Self::Trailers => {
                let [least, most] = vehicle.trailers();
                Some((f64::from(least), f64::from(most)))
            }
        }
    }

    /// The reason of a verdict that this property brings about.
    pub(crate) fn reason(self) -> ForbiddenReason {
        match self {
            Self::Height => ForbiddenReason::Height,
            Self::Length | Self::TrailerLength => ForbiddenReason::Length,
            Self::Width => ForbiddenReason::Width,
            Self::Weight | Self::UnladenWeight | Self::TrailerWeight => ForbiddenReason::Weight,
            Self::AxleLoad | Self::GroupLoad(_) => ForbiddenReason::AxleLoad,
            Self::Axles => ForbiddenReason::Axles,
            Self::Trailers => ForbiddenReason::Trailers,
        }
    }
}
