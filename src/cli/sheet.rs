//! The sheet of conditions: a page to print, or a table that `netcert evidence add` reads when it is filled in.

use std::path::Path;

use anyhow::bail;
use netcert::network::Network;
use netcert::picture::{self, SheetStyle, Units};
use netcert::route::{Conditional, sheet_csv, sheet_geojson};
use netcert::vehicle::Vehicle;

/// The form of a sheet.
#[derive(Clone, Copy)]
pub(super) enum Kind {
    Table,
    Geojson,
    Page,
}

impl Kind {
    /// The form that a file's name asks for.
    pub(super) fn of(path: &Path) -> anyhow::Result<Self> {
        let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_ascii_lowercase();
        match ending.as_str() {
            "csv" => Ok(Self::Table),
            "geojson" | "json" => Ok(Self::Geojson),
            "html" | "htm" => Ok(Self::Page),
            _ => bail!("{}: a sheet is a file that ends with .html, .csv or .geojson", path.display()),
        }
    }
}

/// The sheet in the form that the file's name asks for.
pub(super) fn text(
    path: &Path,
    network: &Network,
    vehicle: &Vehicle,
    conditional: &Conditional,
) -> anyhow::Result<String> {
    Ok(match Kind::of(path)? {
        Kind::Table => sheet_csv(network, conditional),
        Kind::Geojson => sheet_geojson(network, vehicle, conditional),
        Kind::Page => picture::sheet(network, vehicle, conditional, Units::Metres, SheetStyle::Within),
    })
}
