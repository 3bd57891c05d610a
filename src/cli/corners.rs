//! `netcert corners`: the least kerb radius with which a vehicle turns from one straight road into another.

use std::io::Write;
use std::ops::RangeInclusive;
use std::path::PathBuf;

use anyhow::bail;
use clap::Args;
use netcert::certify::{CORNER_ANGLES_DEG, CORNER_WIDTHS_M, Corners as Certified};
use netcert::picture;
use netcert::stet::{Model, Options};
use netcert::vehicle::Vehicle;
use serde_json::{Value, json};

use super::Session;
use crate::cli::arguments::values::TableFormat;
use crate::cli::arguments::vehicle_files::VehicleFiles;
use crate::cli::output::file::{check_writable, write_file};
use crate::cli::output::table::Table;
use crate::cli::output::{results, wrapped};

/// The angles that a turn may have, degrees. A sharper one has no kerb return.
const ANGLES_DEG: RangeInclusive<f64> = 15.0..=145.0;

/// Show the least kerb radius with which a vehicle turns from one road into another, by angle and by the widths of both
/// roads.
///
/// Each value is certified on a drawn crossing of two straight roads with one kerb between them. The vehicle may use
/// the whole width of both roads. Of a corner on the map the value is an estimate: `netcert explain` certifies that
/// corner itself.
#[derive(Args)]
#[command(after_help = "\
Examples:
  netcert corners --vehicle EU-SEMI16.5                 all angles from 30° to 135°
  netcert corners --vehicle US-WB67 --angle 90          one angle
  netcert corners --vehicle EU-SEMI16.5 --svg corners.svg

A table takes up to a minute of processor time.")]
#[command(mut_arg(VehicleFiles::ID, |files| files.help("A file that defines the vehicles, if the catalogue does not")))]
pub(crate) struct Corners {
    /// The vehicles; `netcert vehicles list` shows the ids.
    #[arg(long, value_name = "ID", num_args = 1.., required = true)]
    vehicle: Vec<String>,
    #[command(flatten)]
    vehicle_files: VehicleFiles,
    /// The angles that the vehicle turns by, degrees [default: 30, 45, 60, 75, 90, 105, 120, 135].
    #[arg(long, value_name = "DEGREES", num_args = 1.., value_parser = angle)]
    angle: Vec<f64>,
    /// The output format.
    #[arg(long, value_enum, default_value_t = TableFormat::Text)]
    format: TableFormat,
    /// Draw the table of one vehicle into this file.
    #[arg(long, value_name = "OUT.svg")]
    svg: Option<PathBuf>,
}

/// The angle of a turn, degrees.
fn angle(text: &str) -> Result<f64, String> {
    let deg = text.parse().ok().filter(|deg| ANGLES_DEG.contains(deg));
    deg.ok_or_else(|| format!("a turn is by {} to {} degrees", ANGLES_DEG.start(), ANGLES_DEG.end()))
}

impl Corners {
    pub(crate) fn run(&self, session: &Session) -> anyhow::Result<()> {
        let fleet = self.vehicle_files.fleet()?;
        let vehicles: Vec<&Vehicle> =
            self.vehicle.iter().map(|id| fleet.catalogue.get(id)).collect::<Result<_, _>>()?;
        if self.svg.is_some() && vehicles.len() > 1 {
            bail!("--svg draws one vehicle; name that vehicle alone with --vehicle");
        }
        check_writable([self.svg.as_ref()], None)?;
        let mut tables = Vec::new();
        for vehicle in vehicles {
            let model = Model::new(vehicle)?;
            let angles_deg = if self.angle.is_empty() { &CORNER_ANGLES_DEG[..] } else { &self.angle };
            let options = Options::default();
            let certify = |stop: &_| Ok(Certified::certify(&model, angles_deg, &options, &session.progress, stop)?);
            let Some(corners) = session.progress.in_time("table of corners", certify)? else {
                bail!("{}: the vehicle is {:.1} m long; turns are certified up to 60 m", vehicle.id, vehicle.length_m);
            };
            tables.push((vehicle, corners));
        }
        if let (Some(path), [(vehicle, corners)]) = (&self.svg, tables.as_slice()) {
            write_file(path, picture::corners(vehicle, corners))?;
            session.progress.say(&format!("{}: the picture", path.display()));
        }
        let mut out = results();
        match self.format {
            TableFormat::Json => {
                let all: Vec<Value> = tables.iter().map(|(v, corners)| json_of(v, corners)).collect();
                writeln!(out, "{:#}", json!({"corners": all}))?;
            }
            TableFormat::Csv => csv(&mut out, &tables)?,
            TableFormat::Text => tables.iter().try_for_each(|(v, corners)| write_text(&mut out, v, corners))?,
        }
        Ok(out.flush()?)
    }
}

fn write_text(out: &mut dyn Write, vehicle: &Vehicle, corners: &Certified) -> std::io::Result<()> {
    writeln!(out, "{} {}: the least kerb radius, metres\n", vehicle.id, vehicle.name)?;
    for (angle, turn_deg) in corners.angles_deg().iter().enumerate() {
        writeln!(out, "turn by {turn_deg}°, from a road as wide as the row says into one as wide as the column says")?;
        let headings: Vec<String> = CORNER_WIDTHS_M.iter().map(|width_m| format!(">{width_m:.2} m")).collect();
        let headings: Vec<&str> = std::iter::once(">").chain(headings.iter().map(String::as_str)).collect();
        let mut table = Table::new(&headings);
        for (from, width_m) in CORNER_WIDTHS_M.iter().enumerate() {
            let radius = |to: usize| corners.least_m(angle, from, to).map_or("–".to_owned(), |m| format!("{m}"));
            let cells = (0..CORNER_WIDTHS_M.len()).map(radius);
            table.row(std::iter::once(format!("{width_m:.2} m")).chain(cells));
        }
        table.write(out, "  ")?;
        writeln!(out)?;
    }
    let scope = "0: a sharp corner does. –: no radius up to 25 m is certified; a kerb return reaches no farther than 15 m along its roads. Two straight \
                 roads cross, the vehicle uses the whole width of both, and other traffic waits. Each value holds within the stated model and the \
                 vehicle's error bounds. For a corner on the map it is an estimate, and it is no permit.";
    writeln!(out, "{}\n", wrapped(scope, ""))
}

fn json_of(vehicle: &Vehicle, corners: &Certified) -> Value {
    let of_angle = |(angle, turn_deg): (usize, &f64)| {
        let row = |from: usize| -> Vec<Option<f64>> {
            (0..CORNER_WIDTHS_M.len()).map(|to| corners.least_m(angle, from, to)).collect()
        };
        let least: Vec<_> = (0..CORNER_WIDTHS_M.len()).map(row).collect();
        json!({"turn_deg": turn_deg, "least_kerb_radius_m": least})
    };
    let angles: Vec<Value> = corners.angles_deg().iter().enumerate().map(of_angle).collect();
    json!({"vehicle": vehicle.id, "from_and_to_widths_m": CORNER_WIDTHS_M, "angles": angles})
}

/// One line for each corner; no radius where none does.
fn csv(out: &mut dyn Write, tables: &[(&Vehicle, Certified)]) -> std::io::Result<()> {
    writeln!(out, "vehicle_id,turn_deg,from_width_m,to_width_m,least_kerb_radius_m")?;
    for (vehicle, corners) in tables {
        for (angle, turn_deg) in corners.angles_deg().iter().enumerate() {
            for (from, from_m) in CORNER_WIDTHS_M.iter().enumerate() {
                for (to, to_m) in CORNER_WIDTHS_M.iter().enumerate() {
                    let radius = corners.least_m(angle, from, to).map_or(String::new(), |m| m.to_string());
                    writeln!(out, "{},{},{from_m},{to_m},{radius}", vehicle.id, turn_deg)?;
                }
            }
        }
    }
    Ok(())
}
