//! Numbers with units as they stand in tags, in metres, tonnes and km/h unless stated otherwise.
//!
//! A result is finite and greater than zero, or `None`. Signs, exponents, ranges, lists and words are not numbers here. A comma is a decimal
//! one, unless three digits follow: those may be thousands, and then nobody knows. An unknown unit is not known. Units follow the wiki pages Key:width, Key:maxheight, Key:maxweight,
//! Key:maxspeed.

use std::num::NonZeroU8;

use crate::osm::facts::Limit;

const FOOT_M: f64 = 0.3048;
const INCH_M: f64 = 0.0254;
const MILE_M: f64 = 1609.344;
const POUND_T: f64 = 0.000_453_592_37;
const SHORT_TON_T: f64 = 0.907_184_74;
const LONG_TON_T: f64 = 1.016_046_908_8;
const THOUSAND_POUNDS_T: f64 = 0.453_592_37;
const MILE_KM: f64 = MILE_M / 1000.0;
const NAUTICAL_MILE_KM: f64 = 1.852;

/// `maxspeed=walk`, km/h. The tag names no number. Assumed: a brisk walk.
const WALK_KM_H: NonZeroU8 = NonZeroU8::new(7).unwrap();

/// Largest speed limit accepted, km/h. No road has a higher one.
const GREATEST_KM_H: f64 = 200.0;

/// Largest value accepted. Nothing on a road is larger, and `f32` still resolves centimetres.
const GREATEST: f64 = 100_000.0;

/// Most lanes. A toll plaza may have this many in one direction.
pub(super) const MOST_LANES: u8 = 16;

/// Digits with at most one dot or decimal comma at the start of `text`, and the rest of `text`.
fn number(text: &str) -> Option<(f64, &str)> {
    let end = text.find(|c: char| !c.is_ascii_digit() && c != '.' && c != ',').unwrap_or(text.len());
    let (digits, rest) = text.split_at(end);
    if !digits.starts_with(|c: char| c.is_ascii_digit()) || digits.ends_with(['.', ',']) {
        return None;
    }
    let rest = rest.trim_start();
    match digits.split_once(',') {
        None => Some((digits.parse().ok()?, rest)),
        // `12,000` is twelve or twelve thousand.
        Some((_, decimals)) if decimals.len() == 3 => None,
        Some((whole, decimals)) => Some((format!("{whole}.{decimals}").parse().ok()?, rest)),
    }
}

fn usable(value: f64) -> Option<f32> {
    (value > 0.0 && value <= GREATEST).then_some(value as f32).filter(|v| *v > 0.0)
}

/// Inches after feet: empty, `6"`, `6 in`, or a bare `6`.
fn inches(text: &str) -> Option<f64> {
    if text.is_empty() {
        return Some(0.0);
    }
    let (value, unit) = number(text)?;
    (matches!(unit, "" | "\"" | "''" | "″" | "”" | "in" | "in." | "inch" | "inches") && value < 12.0).then_some(value)
}

/// Centimetres after metres: empty, or `80 cm`.
fn centimetres(text: &str) -> Option<f64> {
    if text.is_empty() {
        return Some(0.0);
    }
    let (value, unit) = number(text)?;
    (matches!(unit, "cm" | "см") && value < 100.0).then_some(value)
}

/// A length in metres: `3.5`, `3,5 m`, `350 cm`, `3 m 80 cm`, `0.6 mi`, `16'3"`, `12'6`, `11'-8"`, `12 ft 6 in`.
#[must_use]
pub fn metres(text: &str) -> Option<f32> {
    let (value, unit) = number(text.trim())?;
    let length = match unit {
        "" | "m" | "m." | "м" | "mt" | "mtr" | "metre" | "metres" | "meter" | "meters" => value,
        "cm" | "см" => value / 100.0,
        "mm" | "мм" => value / 1000.0,
        "km" | "км" => value * 1000.0,
        "mi" => value * MILE_M,
        "\"" | "''" | "″" | "”" | "in" | "in." | "inch" | "inches" => value * INCH_M,
        _ => {
            if let Some(rest) = unit.strip_prefix("m ") {
                value + centimetres(rest.trim_start())? / 100.0
            } else {
                let feet = ["'", "′", "’", "feet", "foot", "ft.", "ft"];
                let rest = feet.iter().find_map(|foot| unit.strip_prefix(foot))?.trim_start();
                value * FOOT_M + inches(rest.strip_prefix('-').unwrap_or(rest).trim_start())? * INCH_M
            }
        }
    };
    usable(length)
}

/// A mass in tonnes: `7.5`, `7,5 t`, `3500 kg`, `16000 lbs`, `10 st` (short tons), `10 lt` (long tons), `27 kips`. `tons` may be short, long or
/// metric ones and are not known.
#[must_use]
pub fn tonnes(text: &str) -> Option<f32> {
    let (value, unit) = number(text.trim())?;
    let factor = match unit {
        "" | "t" | "t." | "т" | "mt" | "tonne" | "tonnes" => 1.0,
        "kg" | "kgs" | "кг" => 0.001,
        "lb" | "lbs" | "lb." | "lbs." | "pounds" => POUND_T,
        "kip" | "kips" => THOUSAND_POUNDS_T,
        "st" => SHORT_TON_T,
        "lt" => LONG_TON_T,
        _ => return None,
    };
    usable(value * factor)
}

/// A legal limit. Of a list, the smallest value counts, and all have to be readable. A value above `greatest` probably lacks its unit (`maxweight=7500`) and is unreadable, because
/// reading it as it stands would allow what may be forbidden. `below_default` and `unknown` state that there is a
/// limit, but not its value.
#[must_use]
pub(super) fn limit(text: &str, read: fn(&str) -> Option<f32>, greatest: f32) -> Limit {
    match text.trim() {
        "none" | "default" | "unsigned" | "no_sign" | "no_indications" => Limit::None,
        text => {
            let one = |text: &str| match read(text) {
                Some(value) if value <= greatest => Limit::At(value),
                _ => Limit::Unreadable,
            };
            text.split(';').map(one).fold(Limit::None, Limit::stricter)
        }
    }
}

/// What a tag says of a speed limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Speed {
    /// Km/h, to the nearest whole number.
    KmH(NonZeroU8),
    /// `none`, or `signals` and `variable`, whose limit the tag does not say.
    Unlimited,
    /// The default of a country and a kind of road, as `DE:urban`. The tag names no number.
    National,
    /// Anything else, lists among them.
    Unreadable,
}

/// A speed limit: `50`, `50 km/h`, `30 mph`, `10 knots`, `walk`, `none`, `DE:urban`.
#[must_use]
pub(super) fn speed(text: &str) -> Speed {
    match text.trim() {
        "none" | "signals" | "variable" => Speed::Unlimited,
        "walk" => Speed::KmH(WALK_KM_H),
        text if national(text) => Speed::National,
        text => km_h(text).map_or(Speed::Unreadable, Speed::KmH),
    }
}

fn km_h(text: &str) -> Option<NonZeroU8> {
    let (value, unit) = number(text).filter(|_| !text.contains(','))?;
    let factor = match unit {
        "" | "km/h" | "kmh" | "kph" => 1.0,
        "mph" => MILE_KM,
        "knots" => NAUTICAL_MILE_KM,
        _ => return None,
    };
    let km_h = value * factor;
    // What rounds to 0 is no speed.
    (km_h <= GREATEST_KM_H).then(|| NonZeroU8::new(km_h.round() as u8)).flatten()
}

/// A country, perhaps with its region, and a kind of road or zone: `DE:urban`, `BE-VLG:rural`, `FR:zone30`.
fn national(text: &str) -> bool {
    let Some((place, kind)) = text.split_once(':') else { return false };
    let country = place.split('-').next().unwrap_or("");
    country.len() == 2
        && country.bytes().all(|b| b.is_ascii_uppercase())
        && kind.starts_with(|c: char| c.is_ascii_alphabetic())
        && kind.bytes().all(|b| b.is_ascii_alphanumeric() || matches!(b, b':' | b'_' | b'-'))
}

/// A lane count from 1 to 16, and whether the value is as documented. `1.5`, once used for narrow two-way roads, counts
/// as one lane.
#[must_use]
pub(super) fn lane_count(text: &str) -> (Option<u8>, bool) {
    match text.trim() {
        "1.5" => (Some(1), false),
        text => {
            let count = text.parse::<u8>().ok().filter(|n| (1..=MOST_LANES).contains(n) && !text.starts_with('+'));
            (count, count.is_some())
        }
    }
}

/// A length, with a comma or a point before its decimals.
pub(super) fn readable(text: &str) -> Option<f32> {
    metres(text).or_else(|| {
        let (whole, rest) = text.split_once(',')?;
        let decimals = rest.len() - rest.trim_start_matches(|c: char| c.is_ascii_digit()).len();
        // Three digits after a comma may be thousands.
        if (1..=2).contains(&decimals) { metres(&format!("{whole}.{rest}")) } else { None }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_read_in_the_units_of_the_wiki() {
        for (text, expected) in [
            ("3.5", 3.5),
            (" 2 m", 2.0),
            ("3.5m", 3.5),
            ("0.6 mi", 965.6064),
            ("16'3\"", 4.953),
            ("12'6\"", 3.81),
            ("12' 6\"", 3.81),
            ("6'", 1.8288),
            ("11 ft", 3.3528),
            ("13 ft 6 in", 4.1148),
            ("75\"", 1.905),
            ("350 cm", 3.5),
            ("2 km", 2000.0),
            ("7,5", 7.5),
            ("3,80 m", 3.8),
            ("12'6", 3.81),
            ("12 ft", 3.6576),
            ("380 cm", 3.8),
            ("3 m 80 cm", 3.8),
            ("11'-8\"", 3.556),
            ("13′ 6″", 4.1148),
            ("12’6”", 3.81),
            ("13.5'", 4.1148),
            ("12.5 ft", 3.81),
            ("12 ft. 10 in.", 3.9116),
            ("4 м", 4.0),
        ] {
            let got = metres(text).unwrap_or(-1.0);
            assert!((got - expected).abs() < 1e-4 * expected, "{text}: {got}");
        }
    }

    #[test]
    fn what_is_no_positive_length_is_none() {
        for text in [
            "7,500",
            "1,2,5",
            "7,",
            ",5",
            "3 m 800 cm",
            "12 yd",
            "-3",
            "0",
            "0.0",
            "NaN",
            "inf",
            "1e400",
            "ten",
            "99999999999999999999",
            "1.5;2",
            "",
            " ",
            "2-3",
            "~3",
            "3.",
            ".",
            ".5",
            "1.2.3",
            "+3",
            "3 x",
            "6'14\"",
            "'",
            "m",
            "3 m m",
            "0.0000000000000000000000000000000000000000000000001",
        ] {
            assert_eq!(metres(text), None, "{text}");
        }
    }

    #[test]
    fn masses_are_read_in_their_units() {
        for (text, expected) in [
            ("7.5", 7.5),
            ("7.5 t", 7.5),
            ("3500 kg", 3.5),
            ("10 st", 9.071_847),
            ("16000 lbs", 7.257_478),
            ("7,5 t", 7.5),
            ("3500 кг", 3.5),
            ("8 т", 8.0),
            ("27 kips", 12.246_994),
            ("10 lt", 10.160_469),
            ("80000 lb", 36.287_39),
            ("1.200 kg", 0.0012),
        ] {
            let got = tonnes(text).unwrap_or(-1.0);
            assert!((got - expected).abs() < 1e-4, "{text}: {got}");
        }
        for text in ["-3", "7.5 tons", "t", "NaN", "0", "12,000 lbs", "7.5 x"] {
            assert_eq!(tonnes(text), None, "{text}");
        }
    }

    #[test]
    fn a_limit_is_a_number_nothing_or_unreadable() {
        assert_eq!(limit("default", metres, 15.0), Limit::None);
        assert_eq!(limit("below_default", metres, 15.0), Limit::Unreadable);
        assert_eq!(limit("0", metres, 15.0), Limit::Unreadable);
        assert_eq!(limit("", metres, 15.0), Limit::Unreadable);
        assert_eq!(limit("4", metres, 15.0), Limit::At(4.0));
        assert_eq!(limit("7500", tonnes, 500.0), Limit::Unreadable);
        assert_eq!(limit("7.5;3.5", tonnes, 500.0), Limit::At(3.5));
        assert_eq!(limit("12;7,5", tonnes, 500.0), Limit::At(7.5));
        assert_eq!(limit("12;heavy", tonnes, 500.0), Limit::Unreadable);
    }

    #[test]
    fn speeds_are_read_in_the_units_of_the_wiki() {
        for (text, km_h) in [
            ("50", 50),
            (" 50 ", 50),
            ("50 km/h", 50),
            ("50kmh", 50),
            ("30 mph", 48),
            ("30mph", 48),
            ("55 mph", 89),
            ("10 knots", 19),
            ("12.5", 13),
            ("5", 5),
            ("200", 200),
            ("walk", 7),
        ] {
            assert_eq!(NonZeroU8::new(km_h).map(Speed::KmH), Some(speed(text)), "{text}");
        }
        for text in ["none", "signals", "variable"] {
            assert_eq!(speed(text), Speed::Unlimited, "{text}");
        }
        for text in ["DE:urban", "DE:rural", "AU:urban", "BE-VLG:rural", "GB:nsl_single", "FR:zone30", "DE:zone:30"] {
            assert_eq!(speed(text), Speed::National, "{text}");
        }
    }

    #[test]
    fn what_is_no_speed_is_unreadable() {
        for text in [
            "",
            " ",
            "0",
            "0.4",
            "-3",
            "NaN",
            "inf",
            "201",
            "5030",
            "99999999999999999999",
            "1e400",
            "50;70",
            "50,5",
            "50|70",
            "30-50",
            "~50",
            "50 mps",
            "50 mph 30",
            "fifty",
            "de:urban",
            "DE:",
            "DE:50",
            ":urban",
            "50 @ (22:00-06:00)",
        ] {
            assert_eq!(speed(text), Speed::Unreadable, "{text}");
        }
    }

    #[test]
    fn lane_counts_are_small_whole_numbers() {
        assert_eq!(lane_count("2"), (Some(2), true));
        assert_eq!(lane_count("1.5"), (Some(1), false));
        for text in ["2;3", "-3", "0", "1e400", "99999999999999999999", "NaN", "", "+2", "17"] {
            assert_eq!(lane_count(text), (None, false), "{text}");
        }
    }
}
