//! `netcert corridor`: certifies one vehicle through one corridor of the user's, and writes the complete certificate.

use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::{anyhow, bail};
use clap::Args;
use netcert::corridor::{self, FileCorridor, corridor_from_file};
use netcert::explain::{self, Explanation, explain_corridor};
use netcert::stet::{Certificate, Model, Options};
use netcert::words::Named;

use super::Session;
use super::explain::write_picture;
use crate::cli::arguments::values::metres;
use crate::cli::arguments::vehicle_files::VehicleFiles;
use crate::cli::output::file::{check_writable, write_file};
use crate::cli::output::{results, wrapped};

/// The file is read into memory; 64 MiB hold a million points.
const MAX_FILE_BYTES: u64 = 64 << 20;

/// Certify a vehicle through a corridor of your own: a lane, an aisle, a depot entry.
///
/// The corridor file is JSON:
///
///   {"frame": "metres", "points": [[0, 0], [60, 0], [100, 25]], "width_m": 7.0}
///
///   frame                  metres, or lonlat (degrees)
///   points                 the centreline, in driving direction
///   width_m                the width: one number, or a list with one number per point
///   left_m, right_m        instead of width_m: the widths to the left and right of the centreline
///   smoothing_tolerance_m  the vehicle follows the smoothest line within this distance of the
///                          points [default: 0.5]; with 0 it follows the points themselves
#[derive(Args)]
#[command(
    verbatim_doc_comment,
    after_help = "\
Examples:
  netcert corridor entry.json --vehicle EU-SEMI16.5
  netcert corridor aisle.json --vehicle AGV-TUG4 --max-shift 0 --out certificate.json

The vehicle enters straight, along the heading at the first point, and leaves straight.
The exit status is 0 for an `unsafe` corridor, too; read `safe` in the certificate.

The certificate holds the vehicle, the corridor, the plan of the steer axle, the leeway at every
station before and after correction, and the tube of every axle. Its `t` is the time of a vehicle
at 80 km/h that slows down where the sideways acceleration would exceed 2 m/s²."
)]
#[command(mut_arg(VehicleFiles::ID, |files| files.help("A file that defines the vehicle, if the catalogue does not")))]
pub(crate) struct Corridor {
    /// The corridor file.
    #[arg(value_name = "CORRIDOR.json")]
    file: PathBuf,
    /// The vehicle; `netcert vehicles list` shows the ids.
    #[arg(long, value_name = "ID")]
    vehicle: String,
    #[command(flatten)]
    vehicle_files: VehicleFiles,
    /// The greatest planned distance of the steer axle from the centreline, metres. The shift gives the trailers room
    /// in bends.
    #[arg(long, value_name = "METRES", value_parser = metres, default_value_t = Options::default().max_shift_m)]
    max_shift: f64,
    /// Write the certificate into this file, as JSON.
    #[arg(long, value_name = "CERTIFICATE.json")]
    out: Option<PathBuf>,
    /// Draw a picture into this file: the tightest place with the vehicle there, and the leeway along the corridor.
    #[arg(long, value_name = "OUT.svg")]
    svg: Option<PathBuf>,
}

impl Corridor {
    pub(crate) fn run(&self, session: &Session) -> anyhow::Result<()> {
        check_writable([self.out.as_ref(), self.svg.as_ref()], Some(&self.file))?;
        let fleet = self.vehicle_files.fleet()?;
        let model = Model::new(fleet.catalogue.get(&self.vehicle)?)?;
        let given = read(&self.file)?;
        let options = Options { max_shift_m: self.max_shift, ..Options::default() };
        let explained = session
            .progress
            .in_time("certificate", |stop| Ok(explain_corridor(&given.corridor, &model, &options, stop)?))?;
        let Some((certificate, why)) = explained else {
            bail!("{}: the corridor has no station to certify; give two points or more", self.file.display());
        };
        if let Some(path) = &self.out {
            let text = netcert::certificate::text(&given, &model, &certificate, &options)?;
            write_file(path, text)?;
        }
        if let Some(path) = &self.svg {
            write_picture(path, &why)?;
        }
        let mut out = results();
        writeln!(out, "{}", describe(&self.file, &given.corridor))?;
        answer(&mut out, &model, &given.corridor, &certificate)?;
        because(&mut out, &why)?;
        out.flush()?;
        if let Some(path) = &self.out {
            session.progress.say(&format!("{}: the whole certificate", path.display()));
        }
        if let Some(path) = &self.svg {
            session.progress.say(&format!("{}: the picture", path.display()));
        }
        Ok(())
    }
}

fn read(path: &Path) -> anyhow::Result<FileCorridor> {
    let name = path.display();
    let cannot = |e: std::io::Error| anyhow!("{name}: cannot read the corridor: {e}");
    let bytes = std::fs::metadata(path).map_err(cannot)?.len();
    if bytes > MAX_FILE_BYTES {
        bail!("{name}: {bytes} bytes are too many for a corridor; cut the corridor into parts that overlap");
    }
    let text = std::fs::read_to_string(path).map_err(cannot)?;
    corridor_from_file(&text).map_err(|e| anyhow!("{name}: {e}; see `netcert help corridor`"))
}

fn describe(file: &Path, corridor: &corridor::Corridor) -> String {
    let length_m = corridor.spacing_m * (corridor.len() as f64 - 1.0);
    let width = |k: usize| corridor.left_m[k] + corridor.right_m[k];
    let (low, high) =
        (0..corridor.len()).map(width).fold((f64::INFINITY, 0.0_f64), |(low, high), w| (low.min(w), high.max(w)));
    let bend = corridor.curvature.iter().fold(0.0_f64, |most, k| most.max(k.abs()));
    let wide = if high - low < 0.005 { format!("{low:.2} m") } else { format!("{low:.2} to {high:.2} m") };
    let bent = if bend < 1e-4 { "straight".to_owned() } else { format!("radius down to {:.1} m", 1.0 / bend) };
    format!("{}: {length_m:.1} m long, {wide} wide, {bent}", file.display())
}

fn answer(
    out: &mut dyn Write,
    model: &Model,
    corridor: &corridor::Corridor,
    certificate: &Certificate,
) -> std::io::Result<()> {
    let (vehicle, result) = (&model.vehicle, &certificate.result);
    let unit = |i: usize| vehicle.units.get(i).map_or(String::new(), |unit| format!("{} (unit {i})", unit.name));
    let verdict = if result.safe() { "SAFE" } else { "UNSAFE" };
    writeln!(out, "{} {}: {verdict}\n", vehicle.id, vehicle.name)?;
    match result.rsc_m {
        Some(rsc_m) => {
            let said = if rsc_m >= 0.0 { "to spare where it is tightest" } else { "missing where it is tightest" };
            writeln!(out, "  RSC           {rsc_m:>8.3} m  {said}, all error bounds deducted")?;
        }
        None => writeln!(out, "  RSC               none    no bound holds for where the vehicle may be")?,
    }
    writeln!(
        out,
        "  RSC published {:>8.3} m  the paper's formula to the letter; it decides nothing",
        result.rsc_published_m
    )?;
    let hinge = match result.hinge_unit {
        0 => "from the steering lock".to_owned(),
        i => format!("from the limit of the hinge ahead of {}", unit(i)),
    };
    match result.hinge_margin_rad {
        Some(margin_rad) => writeln!(out, "  hinge margin  {:>8.1} °  {hinge}", margin_rad.to_degrees())?,
        None => writeln!(out, "  hinge margin      none    no bound holds for the angles")?,
    }
    let tolerance_m = result.shrink * vehicle.tracking_tolerance_m;
    writeln!(
        out,
        "  shrink        {:>8.3}    the steer axle must stay within {tolerance_m:.3} m of the plan",
        result.shrink
    )?;
    let shift = certificate.shift_m.iter().fold(0.0_f64, |most, &q| if q.abs() > most.abs() { q } else { most });
    let side = if shift > 0.0 { "to the left of" } else { "to the right of" };
    let shifted =
        if shift == 0.0 { "the plan is the centreline".to_owned() } else { format!("at most, {side} the centreline") };
    writeln!(out, "  planned shift {:>8.3} m  {shifted}", shift.abs())?;
    if result.rsc_m.is_none() {
        return Ok(());
    }
    let at = &result.limiting;
    let along = if at.point_m >= 0.0 { "ahead of" } else { "behind" };
    writeln!(
        out,
        "  tightest at   {:>8.1} m  along the corridor: {}, {} side, {:.1} m {along} its axle",
        at.station as f64 * corridor.spacing_m,
        unit(at.unit),
        at.side.name(),
        at.point_m.abs(),
    )?;
    Ok(())
}

/// Prints what limits the vehicle, what would make the corridor safe, and the scope of the answer.
fn because(out: &mut dyn Write, why: &Explanation) -> std::io::Result<()> {
    let words = explain::words(why);
    writeln!(out)?;
    for paragraph in std::iter::once(&words.headline).chain(&words.hints) {
        writeln!(out, "{}", wrapped(paragraph, "  "))?;
    }
    writeln!(out, "\n{}", wrapped(&words.scope, ""))?;
    writeln!(out, "The vehicle: `netcert vehicles show {}`.", why.vehicle.id)
}
