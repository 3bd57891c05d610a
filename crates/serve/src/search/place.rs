//! Coordinates as people type them: `49.41, 8.69`, `49.41N 8.69E`, `geo:49.41,8.69`, `49°24'36"N 8°41'24"E`.

use crate::route::Position;
use crate::rows::Bounds;

/// A piece of the text.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Token {
    Number(f64),
    /// `n`, `s`, `e` or `w`
    Letter(char),
    Degrees,
    Minutes,
    Seconds,
    Comma,
}

/// One of the two numbers, with the letter of its direction, if it has one.
struct Coordinate {
    degrees: f64,
    letter: Option<char>,
}

/// The place that a text names. Without letters, latitude comes first, unless only the other order lies in `extent`.
pub(in super::super) fn coordinates(text: &str, extent: Option<Bounds>) -> Option<Position> {
    let text = text.trim();
    let geo = text.get(..4).filter(|start| start.eq_ignore_ascii_case("geo:"));
    // What follows are an altitude and parameters (RFC 5870).
    let plain = if geo.is_some() { text[4..].split([';', '?']).next().unwrap_or_default() } else { text };
    let typed = numbers(plain)?;
    let [first, second] = match geo {
        Some(_) => [typed.first()?, typed.get(1)?],
        None => <&[Coordinate; 2]>::try_from(typed.as_slice()).ok()?.each_ref(),
    };
    let on_earth = |lat: f64, lon: f64| (lat.abs() <= 90.0 && lon.abs() <= 180.0).then_some(Position { lon, lat });
    match (first.letter, second.letter) {
        (Some('n' | 's'), Some('e' | 'w')) => on_earth(first.degrees, second.degrees),
        (Some('e' | 'w'), Some('n' | 's')) => on_earth(second.degrees, first.degrees),
        (None, None) => {
            let as_typed = on_earth(first.degrees, second.degrees);
            let swapped = on_earth(second.degrees, first.degrees).filter(|_| geo.is_none());
            let inside = |place: &Position| {
                extent
                    .is_some_and(|b| (b.west..=b.east).contains(&place.lon) && (b.south..=b.north).contains(&place.lat))
            };
            as_typed.filter(inside).or_else(|| swapped.filter(inside)).or(as_typed)
        }
        _ => None,
    }
}

/// The numbers of a text, degrees. `None` if there is anything else in it, or if nothing but whole numbers: these may be an address.
fn numbers(text: &str) -> Option<Vec<Coordinate>> {
    let tokens = tokens(text)?;
    let exact = text.contains('.') || tokens.iter().any(|token| !matches!(token, Token::Number(_) | Token::Comma));
    let (mut found, mut left) = (Vec::new(), tokens.as_slice());
    while !left.is_empty() && exact {
        found.push(coordinate(&mut left)?);
        if left.len() > 1 {
            take(&mut left, |token| (token == Token::Comma).then_some(()));
        }
    }
    exact.then_some(found)
}

/// Degrees with minutes and seconds, and a letter before or after them.
fn coordinate(left: &mut &[Token]) -> Option<Coordinate> {
    let letter = |token| if let Token::Letter(letter) = token { Some(letter) } else { None };
    let number = |token| if let Token::Number(number) = token { Some(number) } else { None };
    let before = take(left, letter);
    let mut degrees = take(left, number)?;
    if take(left, |token| (token == Token::Degrees).then_some(())).is_some() {
        for (unit, share) in [(Token::Minutes, 60.0), (Token::Seconds, 3600.0)] {
            if let [Token::Number(value), next, ..] = *left
                && *next == unit
                && (0.0..60.0).contains(value)
            {
                degrees += value.copysign(degrees) / share;
                *left = left.get(2..).unwrap_or_default();
            }
        }
    }
    let letter = before.or_else(|| take(left, letter));
    Some(Coordinate { degrees: if matches!(letter, Some('s' | 'w')) { -degrees } else { degrees }, letter })
}

fn take<T>(left: &mut &[Token], wanted: impl Fn(Token) -> Option<T>) -> Option<T> {
    let (&first, rest) = left.split_first()?;
    let found = wanted(first)?;
    *left = rest;
    Some(found)
}

fn tokens(text: &str) -> Option<Vec<Token>> {
    let mut tokens = Vec::new();
    let mut letters = text.chars().peekable();
    while let Some(c) = letters.next() {
        tokens.push(match c.to_ascii_lowercase() {
            c if c.is_whitespace() => continue,
            ',' | ';' | '/' => Token::Comma,
            '°' | 'º' | '˚' => Token::Degrees,
            '′' | '’' | '\'' => Token::Minutes,
            '″' | '”' | '"' => Token::Seconds,
            c @ ('n' | 's' | 'e' | 'w') => Token::Letter(c),
            // German for east. French `O` is west, so a place in France is typed with `W`.
            'o' => Token::Letter('e'),
            c => {
                let mut number = String::from(if c == '−' { '-' } else { c });
                number.extend(std::iter::from_fn(|| letters.next_if(|next| next.is_ascii_digit() || *next == '.')));
                Token::Number(number.parse().ok().filter(|value: &f64| value.is_finite())?)
            }
        });
    }
    Some(tokens)
}

#[cfg(test)]
mod tests {
    use super::*;

    const REGION: Bounds = Bounds { west: 8.0, south: 49.0, east: 9.0, north: 50.0 };

    fn read(text: &str) -> Option<(f64, f64)> {
        let rounded = |degrees: f64| (degrees * 1e4).round() / 1e4;
        coordinates(text, Some(REGION)).map(|place| (rounded(place.lat), rounded(place.lon)))
    }

    #[test]
    fn a_place_is_read_in_every_common_form() {
        for text in [
            "49.41, 8.69",
            "49.41 8.69",
            "49.41,8.69",
            "8.69, 49.41",
            "geo:49.41,8.69",
            "GEO:49.41,8.69,120;u=35",
            "geo:49.41,8.69?z=14",
            "49.41N 8.69E",
            "N49.41 E8.69",
            "N 49.41, E 8.69",
            "8.69 E, 49.41 N",
            "49.41°N 8.69°O",
            "49.41° 8.69°",
            "49°24'36\"N 8°41'24\"E",
            "49° 24′ 36″ N, 8° 41′ 24″ E",
            "N 49° 24.6' E 8° 41.4'",
        ] {
            assert_eq!(read(text), Some((49.41, 8.69)), "{text}");
        }
        assert_eq!(read("33.86S 151.2E"), Some((-33.86, 151.2)));
        assert_eq!(read("S33.86 E151.2"), Some((-33.86, 151.2)));
        assert_eq!(read("45.52 -122.68"), Some((45.52, -122.68)));
        assert_eq!(read("45.52N 122.68W"), Some((45.52, -122.68)));
        // As the page writes places.
        assert_eq!(read("−33.85710, 151.21520"), Some((-33.8571, 151.2152)));
        assert_eq!(read(" −33.8571° 151.2152° "), Some((-33.8571, 151.2152)));
    }

    #[test]
    fn names_and_numbers_of_roads_are_no_places() {
        for text in [
            "",
            "I-5",
            "5 8",
            "A 5",
            "49.41",
            "12",
            "I 405",
            "95, 10",
            "10, 200",
            "Road 1, 2",
            "1,2,3",
            "hauptstr 12",
            "100.5 200.5",
            "N 5",
            "49.4 8.6 7.7",
            "n e",
            "NaN 1.0",
            "S",
            "é",
            "geo:x",
        ] {
            assert_eq!(read(text), None, "{text}");
        }
    }
}
