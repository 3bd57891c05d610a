//! `netcert vehicles`: lists the catalogue, shows vehicles, and checks the user's vehicle files.

use std::io::Write;
use std::path::{Path, PathBuf};

use clap::{Args, Subcommand, ValueEnum};
use netcert::picture;
use netcert::stet::{Model, steady_offtracking};
use netcert::vehicle::{Catalogue, Vehicle, VehicleDefinition};
use serde::Serialize;

use super::Session;
use crate::cli::arguments::vehicle_files::VehicleFiles;
use crate::cli::output::file::write_file;
use crate::cli::output::results;
use crate::cli::output::table::Table;

/// Radii at which offtracking is shown, metres.
const RADII_M: [f64; 3] = [50.0, 100.0, 200.0];

/// List and show the vehicles that netcert knows, and check vehicle files of your own.
#[derive(Args)]
#[command(after_help = "\
Examples:
  netcert vehicles list --region AU
  netcert vehicles show AU-ATRIPLE53 > ours.toml       start a vehicle file of your own
  netcert vehicles show AU-ATRIPLE53 --svg train.svg
  netcert vehicles check ours.toml

A vehicle of your own needs an id that the catalogue does not have.")]
pub(crate) struct Vehicles {
    #[command(subcommand)]
    what: What,
}

#[derive(Subcommand)]
enum What {
    /// List the vehicles of the catalogue.
    List {
        /// List only vehicles of this region: AU, CA, EU, US, indoor, airside.
        #[arg(long, value_name = "REGION")]
        region: Option<String>,
    },
    /// Show the definition of one vehicle as a vehicle file, with all defaults filled in.
    #[command(mut_arg(VehicleFiles::ID, |files| files.help("A vehicle file in which to look for the id, too")))]
    Show {
        /// The vehicle's id.
        id: String,
        #[command(flatten)]
        vehicle_files: VehicleFiles,
        /// The output format: TOML as in a vehicle file, or JSON as in a certificate.
        #[arg(long, value_enum, default_value_t = Form::Toml)]
        format: Form,
        /// Draw the vehicle into this file: from above and from the side, to scale, with dimensions.
        #[arg(long, value_name = "OUT.svg")]
        svg: Option<PathBuf>,
    },
    /// Check a vehicle file and list every fault with its line, or else the vehicles and warnings.
    ///
    /// A vehicle that cannot be built is a fault: its bodies overlap, its lengths do not add up, or its bodies would
    /// meet within a hinge limit even with rounded ends. What a real vehicle may have is only a warning: bodies of which
    /// only the corners would meet.
    Check {
        /// The vehicle file.
        file: PathBuf,
    },
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Form {
    Toml,
    Json,
}

#[derive(Serialize)]
struct VehicleFile {
    vehicle: [VehicleDefinition; 1],
}

impl Vehicles {
    pub(crate) fn run(&self, session: &Session) -> anyhow::Result<()> {
        match &self.what {
            What::List { region } => list(region.as_deref()),
            What::Show { id, vehicle_files, format, svg } => {
                let fleet = vehicle_files.fleet()?;
                let vehicle = fleet.catalogue.get(id)?;
                if let Some(path) = svg {
                    write_file(path, picture::vehicle(vehicle))?;
                    session.progress.say(&format!("{}: the picture", path.display()));
                }
                show(vehicle, *format)
            }
            What::Check { file } => check(file, session),
        }
    }
}

fn list(region: Option<&str>) -> anyhow::Result<()> {
    let catalogue = Catalogue::builtin()?;
    let wanted: Vec<&Vehicle> =
        catalogue.iter().filter(|v| region.is_none_or(|region| v.region.eq_ignore_ascii_case(region))).collect();
    if wanted.is_empty() {
        let mut regions: Vec<&str> = catalogue.iter().map(|v| v.region.as_str()).collect();
        regions.dedup();
        anyhow::bail!("no vehicle of region {:?}; there are {}", region.unwrap_or_default(), regions.join(", "));
    }
    let mut out = results();
    table(&wanted).write(&mut out, "")?;
    Ok(out.flush()?)
}

fn table(vehicles: &[&Vehicle]) -> Table {
    let mut table = Table::new(&["id", "region", ">length", ">units", ">mass", "name"]);
    for v in vehicles {
        table.row([
            v.id.clone(),
            v.region.clone(),
            format!("{:.2} m", v.length_m),
            v.units.len().to_string(),
            v.gross_mass_t.map_or("not known".to_owned(), |t| format!("{t:.1} t")),
            v.name.clone(),
        ]);
    }
    table
}

fn show(vehicle: &Vehicle, form: Form) -> anyhow::Result<()> {
    let mut out = results();
    match form {
        Form::Json => writeln!(out, "{:#}", vehicle.to_json()?)?,
        Form::Toml => {
            write!(out, "{}", toml::to_string(&VehicleFile { vehicle: [vehicle.definition()] })?)?;
            writeln!(out, "\n# {}", offtracking(vehicle))?;
        }
    }
    Ok(out.flush()?)
}

/// The last axle's steady offtracking at the radii of `RADII_M`, by the closed form.
fn offtracking(vehicle: &Vehicle) -> String {
    let at = |radius_m: f64| match steady_offtracking(vehicle, radius_m) {
        Some(metres) => format!("{metres:.2} m at {radius_m:.0} m"),
        None => format!("no steady turn at {radius_m:.0} m"),
    };
    format!("The last axle cuts in, on a steady circle of the steer axle: {}", RADII_M.map(at).join(", "))
}

fn check(file: &Path, session: &Session) -> anyhow::Result<()> {
    let own = Catalogue::from_path(file)?;
    // An id that the catalogue already has is a fault of the file. So is a vehicle that the certificate's model does not cover.
    Catalogue::builtin()?.extended(own.clone(), &file.display().to_string())?;
    for vehicle in own.iter() {
        Model::new(vehicle).map_err(|refused| anyhow::anyhow!("{}: {refused}", file.display()))?;
    }
    for odd in own.warnings() {
        session.progress.say(&format!("{}: warning: {odd}", file.display()));
    }
    let mut out = results();
    let count = own.iter().len();
    writeln!(out, "{}: {count} {}, no fault", file.display(), if count == 1 { "vehicle" } else { "vehicles" })?;
    table(&own.iter().collect::<Vec<_>>()).write(&mut out, "  ")?;
    for vehicle in own.iter() {
        writeln!(out, "  {}: {}", vehicle.id, offtracking(vehicle))?;
    }
    Ok(out.flush()?)
}
