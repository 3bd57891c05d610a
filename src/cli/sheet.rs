//! The sheet of a route's conditions: a page to print, or a table that `netcert evidence add` reads when it is filled in.

use std::path::Path;

use anyhow::bail;
use netcert::network::Network;
use netcert::picture::{self, SheetStyle};
use netcert::route::{Conditional, sheet_csv, sheet_geojson};
use netcert::vehicle::Vehicle;

/// The sheet in the form that the file's name asks for.
pub(super) fn text(
    path: &Path,
    network: &Network,
    vehicle: &Vehicle,
    conditional: &Conditional,
) -> anyhow::Result<String> {
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_ascii_lowercase();
    match ending.as_str() {
        "csv" => Ok(sheet_csv(network, conditional)),
        "geojson" | "json" => Ok(sheet_geojson(network, vehicle, conditional)),
        "html" | "htm" => Ok(picture::sheet(network, vehicle, conditional, SheetStyle::Within)),
        _ => bail!("{}: a sheet is a file that ends with .html, .csv or .geojson", path.display()),
    }
}
