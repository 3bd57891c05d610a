//! The sheet of conditions: a page to print, or a table that `netcert evidence add` reads when it is filled in.

use std::path::Path;

use anyhow::bail;
use clap::ValueEnum;
use netcert::network::Network;
use netcert::picture::{self, SheetStyle, Units};
use netcert::route::{Conditional, sheet_csv, sheet_geojson};
use netcert::vehicle::Vehicle;

/// The form of a sheet.
#[derive(Clone, Copy)]
pub(crate) enum Kind {
    Table,
    Geojson,
    Page,
}

impl Kind {
    /// The form that a file's name asks for.
    pub(crate) fn of(path: &Path) -> anyhow::Result<Self> {
        let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_ascii_lowercase();
        match ending.as_str() {
            "csv" => Ok(Self::Table),
            "geojson" | "json" => Ok(Self::Geojson),
            "html" | "htm" => Ok(Self::Page),
            _ => bail!("{}: a sheet is a file that ends with .html, .csv or .geojson", path.display()),
        }
    }
}

/// The units of a page.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum PageUnits {
    Metres,
    Feet,
}

impl From<PageUnits> for Units {
    fn from(units: PageUnits) -> Self {
        match units {
            PageUnits::Metres => Self::Metres,
            PageUnits::Feet => Self::Feet,
        }
    }
}

/// Checks that a file's name asks for a form that there is in these units.
pub(crate) fn check(path: &Path, units: PageUnits) -> anyhow::Result<()> {
    match Kind::of(path)? {
        Kind::Table | Kind::Geojson if units == PageUnits::Feet => {
            bail!("{}: a table for `netcert evidence add` is in metres; a page (.html) may be in feet", path.display())
        }
        _ => Ok(()),
    }
}

/// The sheet in the form that the file's name asks for.
pub(crate) fn text(
    path: &Path,
    units: PageUnits,
    network: &Network,
    vehicle: &Vehicle,
    conditional: &Conditional,
) -> anyhow::Result<String> {
    check(path, units)?;
    let units = Units::from(units);
    Ok(match Kind::of(path)? {
        Kind::Table => sheet_csv(network, conditional),
        Kind::Geojson => sheet_geojson(network, vehicle, conditional),
        Kind::Page => picture::sheet(network, vehicle, conditional, units, SheetStyle::Within),
    })
}
