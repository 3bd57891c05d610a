//! Vehicles by id, from the shipped catalogue (`data/vehicles.toml`, compiled in) and from the user's files.
//!
//! All orders are the file's order.

use std::path::Path;

use super::regions::Regions;
use super::{Vehicle, VehicleError, VehicleFault, file};

/// The catalogue that ships.
const BUILTIN: &str = include_str!("../../../../data/vehicles.toml");
/// File name of the shipped catalogue in messages.
const BUILTIN_NAME: &str = "data/vehicles.toml";
/// Largest vehicle file, bytes. A file is read whole; the shipped one has 43 kB.
const MAX_FILE_BYTES: u64 = 4 << 20;
/// Longer texts are compared by their first characters.
const MAX_COMPARED: usize = 100;

/// Vehicles in file order, with distinct ids.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Catalogue {
    vehicles: Vec<Vehicle>,
    odd: Vec<VehicleFault>,
}

impl Catalogue {
    /// The shipped vehicles.
    ///
    /// # Errors
    /// None in a build whose tests pass: the file is compiled in.
    pub fn builtin() -> Result<Self, VehicleError> {
        Self::from_toml(BUILTIN, BUILTIN_NAME)
    }

    /// The vehicles of a TOML file.
    ///
    /// # Errors
    /// [`VehicleError::Unreadable`], [`VehicleError::Refused`].
    pub fn from_path(path: &Path) -> Result<Self, VehicleError> {
        let file = path.display().to_string();
        let unreadable = |cause| VehicleError::Unreadable { file: file.clone(), cause };
        let bytes = std::fs::metadata(path).map_err(unreadable)?.len();
        if bytes > MAX_FILE_BYTES {
            let cause = std::io::Error::other(format!("it has {bytes} bytes; at most {MAX_FILE_BYTES}"));
            return Err(unreadable(cause));
        }
        let text = std::fs::read_to_string(path).map_err(unreadable)?;
        Self::from_toml(&text, &file)
    }

    /// Reads the vehicles of TOML text. Messages call the text `file`.
    ///
    /// # Errors
    /// [`VehicleError::Refused`] with every fault and its line.
    pub fn from_toml(text: &str, file: &str) -> Result<Self, VehicleError> {
        match file::parse(text) {
            Ok((vehicles, odd)) => Ok(Self { vehicles, odd }),
            Err(faults) => Err(VehicleError::Refused { file: file.to_owned(), faults }),
        }
    }

    /// Appends the vehicles of `other`. Messages call `other` `file`.
    ///
    /// # Errors
    /// [`VehicleError::Clash`] if both catalogues define an id. A shipped id therefore never changes its meaning.
    pub fn extended(mut self, other: Self, file: &str) -> Result<Self, VehicleError> {
        if let Some(twice) = other.vehicles.iter().find(|v| self.find(&v.id).is_some()) {
            return Err(VehicleError::Clash { file: file.to_owned(), id: twice.id.clone() });
        }
        self.vehicles.extend(other.vehicles);
        self.odd.extend(other.odd);
        Ok(self)
    }

    /// The vehicle with this id.
    ///
    /// # Errors
    /// [`VehicleError::Unknown`] with the most similar ids.
    pub fn get(&self, id: &str) -> Result<&Vehicle, VehicleError> {
        self.find(id).ok_or_else(|| VehicleError::Unknown { id: id.to_owned(), nearest: self.nearest(id) })
    }

    fn find(&self, id: &str) -> Option<&Vehicle> {
        self.vehicles.iter().find(|v| v.id == id)
    }

    /// Warnings with vehicle, field and line: values that are possible but unusual.
    #[must_use]
    pub fn warnings(&self) -> &[VehicleFault] {
        &self.odd
    }

    /// All vehicles, in file order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &Vehicle> {
        self.vehicles.iter()
    }

    /// The vehicles of a region, in file order.
    pub fn region<'a>(&'a self, code: &'a str) -> impl Iterator<Item = &'a Vehicle> {
        self.vehicles.iter().filter(move |v| v.region == code)
    }

    /// The vehicles that `ingest` certifies by default, in file order: those of the country's regions. `country` is ISO 3166-1 alpha-2,
    /// upper case.
    #[must_use]
    pub fn for_country(&self, regions: &Regions, country: [u8; 2]) -> Vec<&Vehicle> {
        let codes = regions.regions_for(country);
        self.vehicles.iter().filter(|v| codes.contains(&v.region)).collect()
    }

    /// At most four similar ids. First come those whose id or name contains the typed text, then those that differ
    /// from it in at most a third of its letters. Case, blanks and punctuation are ignored. A word for any lorry stands for the usual ones.
    fn nearest(&self, id: &str) -> Vec<String> {
        let wanted = letters(id);
        let typed: Vec<char> = wanted.chars().collect();
        let mut scored: Vec<(usize, &str)> = self
            .vehicles
            .iter()
            .filter_map(|v| {
                let other = letters(&v.id);
                let holds = typed.len() >= 3 && (other.contains(&wanted) || letters(&v.name).contains(&wanted));
                let distance = if holds { 0 } else { edits(&typed, &other) };
                (distance <= typed.len() / 3).then_some((distance, v.id.as_str()))
            })
            .collect();
        scored.sort_by_key(|&(distance, _)| distance);
        if scored.is_empty() && ANY_LORRY.contains(&wanted.as_str()) {
            return USUAL_LORRIES.iter().filter(|id| self.find(id).is_some()).map(|&id| id.to_owned()).collect();
        }
        scored.into_iter().take(3).map(|(_, id)| id.to_owned()).collect()
    }
}

/// What people type for a lorry of no certain kind, as [`letters`] has it.
const ANY_LORRY: [&str; 8] = ["truck", "trucks", "lorries", "hgv", "artic", "tractor", "semis", "vehicle"];
/// The commonest lorry of the regions of the catalogue.
const USUAL_LORRIES: [&str; 4] = ["EU-SEMI16.5", "US-WB67", "AU-SEMI19", "CA-SEMI23"];

/// The characters of an id or a name that count in a comparison.
fn letters(text: &str) -> String {
    text.chars().filter(char::is_ascii_alphanumeric).map(|c| c.to_ascii_lowercase()).take(MAX_COMPARED).collect()
}

/// Levenshtein distance: insertions, deletions and substitutions that turn one into the other.
fn edits(typed: &[char], other: &str) -> usize {
    let mut row: Vec<usize> = (0..=typed.len()).collect();
    for (i, to) in other.chars().enumerate() {
        let mut diagonal = i;
        let mut left = i + 1;
        for (cell, &from) in row.iter_mut().skip(1).zip(typed) {
            let substituted = diagonal + usize::from(from != to);
            diagonal = *cell;
            left = substituted.min(diagonal + 1).min(left + 1);
            *cell = left;
        }
        if let Some(first) = row.first_mut() {
            *first = i + 1;
        }
    }
    row.last().copied().unwrap_or(0)
}
