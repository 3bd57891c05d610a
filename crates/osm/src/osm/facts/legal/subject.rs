//! For whom and when a rule is judged.

use jiff::civil::DateTime;

use crate::vehicle::{Class, Vehicle};

/// The time for which rules are judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum At {
    /// Whenever: what is closed at some time is not open.
    #[default]
    Always,
    /// A time.
    Time {
        /// Local time of the place.
        time: DateTime,
        /// The country of the place, with whose public holidays it is judged: ISO 3166-1, two letters.
        country: [u8; 2],
    },
}

/// Who drives, and when.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Subject<'v> {
    /// `None`: any vehicle of the class.
    pub(crate) vehicle: Option<&'v Vehicle>,
    pub(crate) class: &'v Class,
    pub(crate) at: At,
}
