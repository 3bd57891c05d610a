//! Parses values of options: words of the library's enumerations, and numbers within bounds.

use clap::builder::{PossibleValuesParser, TypedValueParser};
use jiff::civil::DateTime;
use netcert::words::Named;

/// How a table is written: for people, or for programs.
#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum TableFormat {
    Text,
    Json,
    Csv,
}

/// A parser for the words of an enumeration. The help text lists the words.
pub(crate) fn word<T: Named + Send + Sync>() -> impl TypedValueParser<Value = T> {
    PossibleValuesParser::new(T::ALL.iter().map(|value| value.name()))
        .try_map(|word| T::named(&word).ok_or("not one of the words"))
}

/// Parses a country code of two letters and returns it in capitals.
pub(crate) fn country_code(text: &str) -> Result<String, String> {
    let letters = text.len() == 2 && text.bytes().all(|b| b.is_ascii_alphabetic());
    if letters { Ok(text.to_ascii_uppercase()) } else { Err("give two letters of ISO 3166-1, such as AU".to_owned()) }
}

/// Parses a local time such as `2026-12-01T08:00`.
pub(crate) fn local_time(text: &str) -> Result<DateTime, String> {
    let formats = ["%Y-%m-%dT%H:%M", "%Y-%m-%dT%H:%M:%S"];
    let time = formats.iter().find_map(|format| DateTime::strptime(format, text).ok());
    time.ok_or_else(|| "give the local time of the place, such as 2026-12-01T08:00, without a zone".to_owned())
}

/// Parses a length from 0 to 100 metres.
pub(crate) fn metres(text: &str) -> Result<f64, String> {
    within(text, 0.0, 100.0)
}

/// Parses a length from -100 to 100 metres.
pub(crate) fn signed_metres(text: &str) -> Result<f64, String> {
    within(text, -100.0, 100.0)
}

fn within(text: &str, low: f64, high: f64) -> Result<f64, String> {
    let value = text.parse::<f64>().ok().filter(|value| (low..=high).contains(value));
    value.ok_or_else(|| format!("give a number of metres from {low} to {high}"))
}
