//! The times of a condition, in the grammar of opening hours.

use std::fmt;
use std::sync::Arc;

use jiff::civil::DateTime;
use opening_hours::localization::Country;
use opening_hours::{Context, OpeningHours, RuleKind};

use super::subject::At;
use super::truth::Truth;

/// Times at which a condition holds.
#[derive(Clone)]
pub(crate) struct Hours {
    text: String,
    /// What the text may mean, as [`readings`] has it. Empty: times that only people understand.
    readings: Arc<[OpeningHours]>,
    /// Whether it asks for public holidays.
    holidays: bool,
    /// Whether it asks for school holidays or for the sun, which are not known here.
    unknown: bool,
}

impl fmt::Debug for Hours {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Hours({:?})", self.text)
    }
}

/// Words of which times consist, beside numbers.
const WORDS: [&str; 44] = [
    "mo", "tu", "we", "th", "fr", "sa", "su", "mon", "tue", "wed", "thu", "fri", "sat", "sun", "jan", "feb", "mar",
    "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec", "ph", "sh", "off", "open", "closed", "sunrise",
    "sunset", "dawn", "dusk", "easter", "week", "weekdays", "weekend", "am", "pm", "h", "hrs", "uhr",
];

/// Full names of months and weekdays are cut to these lengths.
const NAMES: [&str; 19] = [
    "january",
    "february",
    "march",
    "april",
    "june",
    "july",
    "august",
    "september",
    "october",
    "november",
    "december",
    "monday",
    "tuesday",
    "wednesday",
    "thursday",
    "friday",
    "saturday",
    "sunday",
    "sept",
];

impl Hours {
    /// The times of a text. `None` if it speaks of no time.
    pub(crate) fn read(text: &str) -> Option<Self> {
        let text = text.trim();
        // A bare number is no time, and a word in quotes is a remark.
        if text.contains(['"', '<', '>', '=', '@']) || !text.contains(|c: char| c.is_ascii_digit() || c.is_alphabetic())
        {
            return None;
        }
        let mut words = text.split(|c: char| !c.is_alphabetic()).filter(|word| !word.is_empty()).peekable();
        let known = |word: &str| {
            let word = word.to_ascii_lowercase();
            WORDS.contains(&word.as_str()) || NAMES.contains(&word.as_str())
        };
        let mut speaks_of_time = text.contains(':') || text == "24/7";
        if words.peek().is_none() && !speaks_of_time {
            return None;
        }
        for word in words {
            if !known(word) {
                return None;
            }
            speaks_of_time |= !matches!(word.to_ascii_lowercase().as_str(), "off" | "open" | "closed" | "h");
        }
        if !speaks_of_time {
            return None;
        }
        let readings = Some(readings(text)).filter(|all| !all.is_empty()).unwrap_or_else(|| readings(&shortened(text)));
        let lower = text.to_ascii_lowercase();
        let asks = |words: &[&str]| lower.split(|c: char| !c.is_alphabetic()).any(|word| words.contains(&word));
        let (holidays, unknown) = (asks(&["ph"]), asks(&["sh", "sunrise", "sunset", "dawn", "dusk"]));
        Some(Self { text: text.to_owned(), readings: readings.into(), holidays, unknown })
    }

    /// Whether it holds at all times, or at none, if it is so plain.
    pub(crate) fn always(&self) -> Option<bool> {
        let constant = |parsed: &OpeningHours| {
            let expression = parsed.get_expression();
            match expression.is_constant().then(|| expression.rules.last().map(|rule| rule.kind))?? {
                RuleKind::Open => Some(true),
                RuleKind::Closed => Some(false),
                RuleKind::Unknown => None,
            }
        };
        agreed(self.readings.iter().map(constant))
    }

    /// When it holds.
    pub(crate) fn truth(&self, at: At) -> Truth {
        let of = |holds| if holds { Truth::Always } else { Truth::Never };
        if let Some(always) = self.always() {
            return of(always);
        }
        let At::Time { time, country } = at else { return Truth::Sometimes };
        if self.unknown {
            return Truth::Sometimes;
        }
        let holds = |parsed: &OpeningHours| match self.state(parsed, time, country)? {
            RuleKind::Open => Some(true),
            RuleKind::Closed => Some(false),
            RuleKind::Unknown => None,
        };
        agreed(self.readings.iter().map(holds)).map_or(Truth::Sometimes, of)
    }

    /// The state at a time. `Unknown` on a day that is a public holiday in a part of the country only.
    fn state(&self, parsed: &OpeningHours, time: DateTime, country: [u8; 2]) -> Option<RuleKind> {
        let naive = naive(time)?;
        if !YEARS.contains(&time.year()) {
            return None;
        }
        if !self.holidays {
            return Some(parsed.state(naive).0);
        }
        let country: Country = std::str::from_utf8(&country).ok()?.parse().ok()?;
        let (holidays, regional) = (country.holidays(), country.holidays_regional());
        // The list begins and ends in some year.
        let (public, year) = (holidays.get_public(), chrono::Days::new(366));
        public.first_after(naive.date() - year).filter(|day| *day < naive.date())?;
        public.first_after(naive.date() + year)?;
        let context = Context::default().with_holidays(holidays).with_holidays_unknown(regional);
        Some(parsed.clone().with_context(context).state(naive).0)
    }
}

/// The years for which times are decided. Others are slips of the pen.
const YEARS: std::ops::RangeInclusive<i16> = 1990..=2100;

/// What all readings say. `None` if they differ, or if there are none.
fn agreed(mut said: impl Iterator<Item = Option<bool>>) -> Option<bool> {
    let first = said.next()??;
    said.all(|other| other == Some(first)).then_some(first)
}

/// What a text may mean. `Mo-Fr, PH 06:00-22:00` is one rule to mappers, and two to the grammar: all of Monday to Friday, and holidays. After a
/// semicolon a rule replaces the one before on its days, which ends what began the night before; as an addition it does not.
fn readings(text: &str) -> Vec<OpeningHours> {
    let joined = text.replace(", ", ",");
    let mut texts = vec![text.to_owned(), joined.clone(), text.replace(';', ","), joined.replace(';', ",")];
    texts.dedup();
    let parsed: Option<Vec<OpeningHours>> = texts.iter().map(|text| text.parse().ok()).collect();
    parsed.unwrap_or_default()
}

/// The text with short names.
fn shortened(text: &str) -> String {
    let mut short = String::with_capacity(text.len());
    let mut word = String::new();
    for c in text.chars().chain(std::iter::once(' ')) {
        if c.is_alphabetic() {
            word.push(c);
            continue;
        }
        let lower = word.to_ascii_lowercase();
        if NAMES.contains(&lower.as_str()) {
            let weekday = lower.ends_with("day");
            short.push_str(word.get(..if weekday { 2 } else { 3 }).unwrap_or(&word));
        } else {
            short.push_str(&word);
        }
        word.clear();
        short.push(c);
    }
    short.trim().replace(", ", ",")
}

fn naive(time: DateTime) -> Option<chrono::NaiveDateTime> {
    let date = chrono::NaiveDate::from_ymd_opt(
        time.year().into(),
        time.month().try_into().ok()?,
        time.day().try_into().ok()?,
    )?;
    date.and_hms_opt(time.hour().try_into().ok()?, time.minute().try_into().ok()?, time.second().try_into().ok()?)
}
