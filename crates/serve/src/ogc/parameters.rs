//! The parameters of a request for features.

use super::super::problem::Problem;
use super::cql2::{self, Attribute};
use super::{CRS84, DecodedRequest};
use crate::rows::Bounds;
use crate::store::Predicate;

/// The greatest number of features of a page, and the number where none is given. Each takes about a kilobyte.
pub(super) const MOST: usize = 5000;
const USUAL: usize = 1000;

/// `limit`: more than [`MOST`] means [`MOST`], as the standard has it.
pub(super) fn limit(ask: &DecodedRequest) -> Result<usize, Problem> {
    let Some(text) = ask.parameter("limit") else { return Ok(USUAL) };
    let wrong = || Problem::parameter("limit", format!("give a whole number from 1 on; a page has {MOST} at most"));
    if text.is_empty() || !text.bytes().all(|b| b.is_ascii_digit()) {
        return Err(wrong());
    }
    match text.parse::<usize>().unwrap_or(MOST) {
        0 => Err(wrong()),
        limit => Ok(limit.min(MOST)),
    }
}

/// `bbox`: four numbers, or six with heights, which do not matter, because the features have none. A box whose west is east of its east goes
/// over 180°.
pub(super) fn bbox(ask: &DecodedRequest) -> Result<Option<Bounds>, Problem> {
    let Some(text) = ask.parameter("bbox") else { return Ok(None) };
    let wrong = |detail: &str| {
        Problem::parameter("bbox", format!("{detail}; give degrees: west,south,east,north, such as 8.6,49.3,8.8,49.5"))
    };
    let numbers: Option<Vec<f64>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    let Some(numbers) = numbers.filter(|numbers| numbers.iter().all(|number| number.is_finite())) else {
        return Err(wrong("not all of it are numbers"));
    };
    let [west, south, east, north] = match numbers[..] {
        [west, south, east, north] => [west, south, east, north],
        [west, south, low, east, north, high] if low <= high => [west, south, east, north],
        [_, _, _, _, _, _] => return Err(wrong("the third number, the least height, is above the sixth")),
        _ => return Err(wrong("four or six numbers are wanted")),
    };
    if south.abs() > 90.0 || north.abs() > 90.0 {
        return Err(wrong("a latitude lies beyond 90°: longitude comes first"));
    }
    if west.abs() > 180.0 || east.abs() > 180.0 {
        return Err(wrong("a longitude lies beyond 180°"));
    }
    if south > north {
        return Err(wrong("the south lies north of the north: they are in the wrong order"));
    }
    Ok(Some(Bounds { west, south, east, north }))
}

/// `datetime`: a time or an interval. Roads have no time here, so that every time finds all of them; but it must be one.
pub(super) fn datetime(ask: &DecodedRequest) -> Result<(), Problem> {
    let Some(text) = ask.parameter("datetime") else { return Ok(()) };
    let open = |part: &str| part.is_empty() || part == "..";
    let fits = match text.split_once('/') {
        None => is_time(text),
        Some((from, to)) => (open(from) || is_time(from)) && (open(to) || is_time(to)) && !(open(from) && open(to)),
    };
    let detail = "give a time such as 2026-11-21T08:00:00Z, or two with a slash between; .. stands for an open end";
    if fits { Ok(()) } else { Err(Problem::parameter("datetime", detail)) }
}

/// Whether a text is a day or a time of RFC 3339.
fn is_time(text: &str) -> bool {
    let Some((day, time)) = text.split_at_checked(10) else { return false };
    let day = day.as_bytes();
    let shaped = |text: &[u8], shape: &str| {
        let fits = |(b, c): (&u8, char)| if c == '0' { b.is_ascii_digit() } else { char::from(*b) == c };
        text.len() == shape.len() && text.iter().zip(shape.chars()).all(fits)
    };
    let two = |text: &[u8], at: usize| match text.get(at..at + 2) {
        Some([tens, ones]) => u32::from(tens.wrapping_sub(b'0')) * 10 + u32::from(ones.wrapping_sub(b'0')),
        _ => u32::MAX,
    };
    if !shaped(day, "0000-00-00") || !(1..=12).contains(&two(day, 5)) || !(1..=31).contains(&two(day, 8)) {
        return false;
    }
    if time.is_empty() {
        return true;
    }
    let Some((clock, rest)) = time.split_at_checked(9) else { return false };
    let clock = clock.to_ascii_uppercase();
    let clock = clock.as_bytes();
    if !shaped(clock, "T00:00:00") || two(clock, 1) > 23 || two(clock, 4) > 59 || two(clock, 7) > 60 {
        return false;
    }
    let zone = match rest.strip_prefix('.') {
        Some(part) => {
            let zone = part.trim_start_matches(|c: char| c.is_ascii_digit());
            if zone.len() == part.len() {
                return false;
            }
            zone
        }
        None => rest,
    };
    let offset = zone.as_bytes();
    zone.eq_ignore_ascii_case("z")
        || ((shaped(offset, "+00:00") || shaped(offset, "-00:00")) && two(offset, 1) <= 23 && two(offset, 4) <= 59)
}

/// `filter`, with `filter-lang` and `filter-crs`: a condition on these attributes.
pub(super) fn filter(ask: &DecodedRequest, attributes: &[Attribute]) -> Result<Option<Predicate>, Problem> {
    if ask.parameter("filter-lang").is_some_and(|language| language != "cql2-text") {
        return Err(Problem::parameter("filter-lang", "only cql2-text is understood"));
    }
    if ask.parameter("filter-crs").is_some_and(|crs| crs != CRS84) {
        return Err(Problem::parameter("filter-crs", format!("only {CRS84} is understood")));
    }
    let Some(text) = ask.parameter("filter") else { return Ok(None) };
    let read = cql2::read(text, attributes);
    read.map(Some).map_err(|fault| Problem::parameter("filter", format!("character {}: {}", fault.at, fault.what)))
}

/// `after`: the key of the last feature of the page before. It is refused if the database has changed since then: pages of two states would
/// have gaps and repeats.
pub(super) fn after(ask: &DecodedRequest, state: &str) -> Result<Option<i64>, Problem> {
    let Some(text) = ask.parameter("after") else { return Ok(None) };
    let read = text.rsplit_once('-').and_then(|(key, of)| Some((key.parse::<i64>().ok()?, of)));
    let Some((key, of)) = read else {
        return Err(Problem::parameter("after", "take it from the link `next` of the page before"));
    };
    if of != state {
        return Err(Problem::changed(
            "the database has changed since the page before; begin again with the first page",
        ));
    }
    Ok(Some(key))
}

/// The value of `after` for the page behind a feature.
pub(super) fn behind(key: i64, state: &str) -> String {
    format!("{key}-{state}")
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn times_and_what_is_none() {
        for time in [
            "2026-11-21",
            "2026-11-21T08:00:00Z",
            "2026-11-21t08:00:00.125z",
            "2026-12-31T23:59:60+05:30",
            "2026-01-01T00:00:00-00:00",
        ] {
            assert!(is_time(time), "{time}");
        }
        for other in [
            "",
            "2026",
            "2026-13-01",
            "2026-00-10",
            "2026-11-32",
            "2026-11-21T08:00Z",
            "2026-11-21T24:00:00Z",
            "2026-11-21T08:00:00",
            "2026-11-21T08:00:00.Z",
            "2026-11-21 08:00:00Z",
            "2026-11-21T08:00:00+5:30",
            "2026-11-2ä",
            "now",
        ] {
            assert!(!is_time(other), "{other}");
        }
    }

    #[test]
    fn a_place_in_the_order_comes_back_and_only_under_its_state() {
        let ask = |after: &str| DecodedRequest::with_parameters(&[("after", after)]);
        let state = "0123456789abcdef";
        assert_eq!(after(&ask(&behind(42, state)), state).unwrap(), Some(42));
        assert_eq!(after(&ask(&behind(-7, state)), state).unwrap(), Some(-7));
        assert_eq!(after(&ask("42-fedcba9876543210"), state).unwrap_err().status.as_u16(), 409);
        for wrong in ["", "42", "x-0123456789abcdef", "1.5-0123456789abcdef"] {
            assert_eq!(after(&ask(wrong), state).unwrap_err().status.as_u16(), 400, "{wrong}");
        }
    }

    #[test]
    fn boxes_and_limits() {
        let ask = |name: &'static str, value: &str| DecodedRequest::with_parameters(&[(name, value)]);
        let found = |value: &str| bbox(&ask("bbox", value));
        let own = Bounds { west: 8.6, south: 49.3, east: 8.8, north: 49.5 };
        assert_eq!(found("8.6,49.3,8.8,49.5").unwrap(), Some(own));
        assert_eq!(found("8.6,49.3,-10,8.8,49.5,10").unwrap(), Some(own));
        assert!(found("170,-20,-170,-10").unwrap().is_some_and(|own| own.west > own.east));
        for wrong in [
            "",
            "8.6,49.3,8.8",
            "1,2,3,4,5",
            "8.6,49.5,8.8,49.3",
            "49.3,98.6,49.5,98.8",
            "181,0,1,1",
            "0,0,inf,1",
            "a,b,c,d",
            "8.6,49.3,10,8.8,49.5,-10",
        ] {
            assert_eq!(found(wrong).unwrap_err().status.as_u16(), 400, "{wrong}");
        }
        for (text, number) in [("1", 1), ("5000", MOST), ("5001", MOST), ("99999999999999999999999", MOST)] {
            assert_eq!(limit(&ask("limit", text)).unwrap(), number);
        }
        for wrong in ["0", "", "-1", "1.0", "many"] {
            assert!(limit(&ask("limit", wrong)).is_err(), "{wrong}");
        }
    }
}
