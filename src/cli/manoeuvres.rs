//! `netcert manoeuvres`: computes low-speed turns of vehicles and compares them with published limits.

use std::io::Write;
use std::path::PathBuf;

use anyhow::bail;
use clap::Args;
use netcert::manoeuvres::{
    self, LimitFinding, ManoeuvreReport, PerformanceMeasure, STEADY_RADII_M, TurnMeasurements, beyond_limit,
};
use netcert::picture;
use netcert::vehicle::Vehicle;
use serde_json::{Value, json};

use super::Session;
use crate::cli::arguments::values::TableFormat;
use crate::cli::arguments::vehicle_files::VehicleFiles;
use crate::cli::output::file::write_file;
use crate::cli::output::results;
use crate::cli::output::table::Table;

/// Show how vehicles turn at low speed, beside published limits: 90°, 180°, a full circle, and steady off-tracking.
///
/// In the turns of 90° and 180°, the outer end of the steer axle follows a path of 12.5 m radius, as in the Australian
/// Performance-Based Standards (PBS). In the circle, the outer front corner enters along the tangent and follows a
/// circle of 12.5 m radius, as in European rules. The motion is the exact no-slip motion of rectangular bodies; real
/// bodies with rounded corners need a little less room.
#[derive(Args)]
#[command(after_help = "\
Examples:
  netcert manoeuvres                                    all vehicles of the catalogue, one a line
  netcert manoeuvres --vehicle AU-BDOUBLE26             one vehicle, with every limit and its source
  netcert manoeuvres --vehicle EU-SEMI16.5 --svg turns.svg

A pass is no approval: official assessments use the real bodies, tyres and axle groups.")]
#[command(mut_arg(VehicleFiles::ID, |files| files.help("A file that defines the vehicles, if the catalogue does not")))]
pub(crate) struct Manoeuvres {
    /// The vehicles; `netcert vehicles list` shows the ids [default: all].
    #[arg(long, value_name = "ID", num_args = 1..)]
    vehicle: Vec<String>,
    #[command(flatten)]
    vehicle_files: VehicleFiles,
    /// The output format.
    #[arg(long, value_enum, default_value_t = TableFormat::Text)]
    format: TableFormat,
    /// Draw the turns of one vehicle into this file.
    #[arg(long, value_name = "OUT.svg")]
    svg: Option<PathBuf>,
}

impl Manoeuvres {
    pub(crate) fn run(&self, session: &Session) -> anyhow::Result<()> {
        let fleet = self.vehicle_files.fleet()?;
        let vehicles: Vec<&Vehicle> = match self.vehicle.as_slice() {
            [] => fleet.catalogue.iter().collect(),
            ids => ids.iter().map(|id| fleet.catalogue.get(id)).collect::<Result<_, _>>()?,
        };
        if let Some(path) = &self.svg {
            let [vehicle] = vehicles.as_slice() else {
                bail!("--svg draws one vehicle; name that vehicle with --vehicle");
            };
            write_file(path, picture::manoeuvres(vehicle))?;
            session.progress.say(&format!("{}: the picture", path.display()));
        }
        let reports: Vec<(&Vehicle, ManoeuvreReport)> = vehicles.iter().map(|v| (*v, manoeuvres::report(v))).collect();
        let mut out = results();
        match (self.format, reports.as_slice()) {
            (TableFormat::Json, all) => {
                let all: Vec<Value> = all.iter().map(|(v, report)| json(v, report)).collect();
                writeln!(out, "{:#}", json!({"manoeuvres": all}))?;
            }
            (TableFormat::Csv, all) => csv(&mut out, all)?,
            (TableFormat::Text, [(vehicle, report)]) => one(&mut out, vehicle, report)?,
            (TableFormat::Text, all) => many(&mut out, all)?,
        }
        Ok(out.flush()?)
    }
}

/// The strictest PBS level whose limit the measure keeps.
fn level(report: &ManoeuvreReport, measure: PerformanceMeasure) -> String {
    let passed = |f: &&LimitFinding| f.limit.measure == measure && f.passes && f.limit.who.starts_with("PBS level");
    report.findings.iter().find(passed).map_or("none".to_owned(), |f| f.limit.who.replace("PBS level ", "L"))
}

fn passes(report: &ManoeuvreReport, measure: PerformanceMeasure, who: &str) -> &'static str {
    let finding = report.findings.iter().find(|f| f.limit.measure == measure && f.limit.who.starts_with(who));
    finding.map_or("", |f| if f.passes { "yes" } else { "no" })
}

/// The swept width; a dash if a body passes the centre of the turn.
fn width(swept: &TurnMeasurements) -> String {
    swept.width_m.map_or("–".to_owned(), |metres| format!("{metres:.2} m"))
}

fn hinge_deg(angles_rad: &[f64]) -> f64 {
    angles_rad.iter().skip(1).fold(0.0_f64, |most, &angle| most.max(angle)).to_degrees()
}

fn many(out: &mut dyn Write, all: &[(&Vehicle, ManoeuvreReport)]) -> std::io::Result<()> {
    let mut table = Table::new(&[
        "id",
        ">swept 90°",
        "PBS",
        ">tail",
        "PBS",
        ">frontal",
        ">hinge",
        ">swept 180°",
        ">inner",
        "EU",
        ">ring",
        "DE",
        ">swing-out",
        ">off at 50 m",
    ]);
    for (v, r) in all {
        let driven = beyond_limit(v, &r.circle.angles_rad).is_none();
        let circle = |metres: f64| if driven { format!("{metres:.2} m") } else { "–".to_owned() };
        table.row([
            v.id.clone(),
            width(&r.right_angle),
            level(r, PerformanceMeasure::SweptPath),
            format!("{:.2} m", r.right_angle.tail_swing_m),
            level(r, PerformanceMeasure::TailSwing),
            format!("{:.2} m", r.right_angle.frontal_swing_m),
            format!("{:.0}°", hinge_deg(&r.right_angle.angles_rad)),
            if beyond_limit(v, &r.u_turn.angles_rad).is_some() { "–".to_owned() } else { width(&r.u_turn) },
            circle(r.circle.inner_m),
            passes(r, PerformanceMeasure::InnerRadius, "EU").to_owned(),
            circle(r.circle.width_m()),
            passes(r, PerformanceMeasure::RingWidth, "DE").to_owned(),
            circle(r.circle.swing_out_m),
            r.steady_offtracking_m[2].map_or("none".to_owned(), |m| format!("{m:.2} m")),
        ]);
    }
    table.write(out, "")?;
    writeln!(
        out,
        "\nswept, tail, frontal, hinge: 90° and 180° turns, the outer end of the steer axle on 12.5 m; inner, ring, swing-out: \
         a full\ncircle, the outer front corner on 12.5 m; off: steady, steer axle to last axle. – : beyond a hinge's or the \
         steering's limit,\nor past the centre of the turn. Limits and their sources: name one vehicle."
    )
}

fn one(out: &mut dyn Write, v: &Vehicle, r: &ManoeuvreReport) -> std::io::Result<()> {
    writeln!(out, "{} {}\n", v.id, v.name)?;
    turns(out, v, r)?;
    angles(out, v, r)?;
    writeln!(out)?;
    limits(out, r)?;
    writeln!(out, "\n– : beyond a hinge's or the steering's limit, or past the centre of the turn.")?;
    writeln!(out, "Rectangular bodies, one effective axle a unit, no tyre slip: a pass is no approval.")
}

/// Prints what each turn sweeps, with its guide, then the circle and the steady off-tracking.
fn turns(out: &mut dyn Write, v: &Vehicle, r: &ManoeuvreReport) -> std::io::Result<()> {
    let mut table =
        Table::new(&["turn", "guide", ">swept path", ">tail swing", ">frontal swing", ">last axle cuts in"]);
    for (name, turn, swept) in [
        ("90° at 12.5 m", manoeuvres::right_angle(v), &r.right_angle),
        ("180° at 12.5 m", manoeuvres::u_turn(v), &r.u_turn),
    ] {
        table.row([
            name.to_owned(),
            turn.guide.words().to_owned(),
            width(swept),
            format!("{:.2} m", swept.tail_swing_m),
            format!("{:.2} m", swept.frontal_swing_m),
            swept.width_m.map_or("–".to_owned(), |_| format!("{:.2} m", swept.offtracking_m)),
        ]);
    }
    table.write(out, "  ")?;
    let ring = match beyond_limit(v, &r.circle.angles_rad) {
        Some(0) => "cannot be driven, beyond the steering lock".to_owned(),
        Some(hinge) => format!("cannot be driven, beyond the limit of hinge {hinge}"),
        None => format!(
            "inner radius {:.2} m, ring {:.2} m, swing-out {:.2} m",
            r.circle.inner_m,
            r.circle.width_m(),
            r.circle.swing_out_m
        ),
    };
    writeln!(out, "\n  circle, {} on 12.5 m: {ring}", manoeuvres::circle(v).guide.words())?;
    let steady = STEADY_RADII_M.iter().zip(&r.steady_offtracking_m).map(|(radius, off)| match off {
        Some(metres) => format!("{metres:.2} m at {radius} m"),
        None => format!("none at {radius} m"),
    });
    writeln!(out, "  steady off-tracking, steer axle to last axle: {}\n", steady.collect::<Vec<_>>().join(", "))
}

/// Prints the measures beside the published limits, and the sources of the limits.
fn limits(out: &mut dyn Write, r: &ManoeuvreReport) -> std::io::Result<()> {
    let mut table = Table::new(&["limit", "of", ">at", ">measured", "", "sureness"]);
    for f in &r.findings {
        let bound = if f.limit.measure.at_least() { "at least" } else { "at most" };
        table.row([
            f.limit.measure.words().to_owned(),
            f.limit.who.to_owned(),
            format!("{bound} {:.2} m", f.limit.metres),
            f.metres.map_or("–".to_owned(), |m| format!("{m:.2} m")),
            if f.passes { "pass" } else { "FAIL" }.to_owned(),
            f.limit.sureness.words().to_owned(),
        ]);
    }
    table.write(out, "  ")?;
    writeln!(out, "\nSources:")?;
    let mut told: Vec<&str> = Vec::new();
    for f in &r.findings {
        if !told.contains(&f.limit.source) {
            told.push(f.limit.source);
            writeln!(out, "  {}", f.limit.source)?;
        }
    }
    Ok(())
}

/// Prints the greatest angles of steering and hinges in the turns, beside the angles that the vehicle allows.
fn angles(out: &mut dyn Write, v: &Vehicle, r: &ManoeuvreReport) -> std::io::Result<()> {
    let mut table = Table::new(&["greatest angle", ">90°", ">180°", ">circle", ">allowed", ""]);
    for (i, unit) in v.units.iter().enumerate() {
        let of = |angles: &[f64]| angles.get(i).copied().unwrap_or(0.0).to_degrees();
        let all = [of(&r.right_angle.angles_rad), of(&r.u_turn.angles_rad), of(&r.circle.angles_rad)];
        let allowed = unit.max_articulation_rad.to_degrees();
        let most = all.iter().fold(0.0_f64, |most, &angle| most.max(angle));
        table.row([
            if i == 0 { "steering".to_owned() } else { format!("hinge ahead of {}", unit.name) },
            format!("{:.1}°", all[0]),
            format!("{:.1}°", all[1]),
            format!("{:.1}°", all[2]),
            format!("{allowed:.0}°"),
            if most > allowed { "beyond its limit" } else { "" }.to_owned(),
        ]);
    }
    table.write(out, "  ")
}

fn json(v: &Vehicle, r: &ManoeuvreReport) -> Value {
    let degrees = |angles: &[f64]| angles.iter().map(|a| a.to_degrees()).collect::<Vec<f64>>();
    let swept = |s: &TurnMeasurements| {
        json!({
            "guide": manoeuvres::Guide::OuterSteerTyre.words(),
            "swept_path_m": s.width_m,
            "tail_swing_m": s.tail_swing_m,
            "tail_swing_unit": s.tail_unit,
            "frontal_swing_m": s.frontal_swing_m,
            "offtracking_m": s.offtracking_m,
            "angles_deg": degrees(&s.angles_rad),
            "within_hinge_limits": beyond_limit(v, &s.angles_rad).is_none(),
        })
    };
    let steady = STEADY_RADII_M.iter().zip(&r.steady_offtracking_m);
    let finding = |f: &LimitFinding| {
        json!({
            "measure": f.limit.measure.name(),
            "who": f.limit.who,
            "limit_m": f.limit.metres,
            "at_least": f.limit.measure.at_least(),
            "measured_m": f.metres,
            "passes": f.passes,
            "source": f.limit.source,
            "sureness": f.limit.sureness.words(),
        })
    };
    json!({
        "vehicle": v.id,
        "turn_90": swept(&r.right_angle),
        "turn_180": swept(&r.u_turn),
        "circle": {
            "guide": manoeuvres::Guide::FrontOuterCorner.words(),
            "outer_radius_m": r.circle.outer_m,
            "inner_radius_m": r.circle.inner_m,
            "ring_width_m": r.circle.width_m(),
            "swing_out_m": r.circle.swing_out_m,
            "angles_deg": degrees(&r.circle.angles_rad),
            "within_hinge_limits": beyond_limit(v, &r.circle.angles_rad).is_none(),
        },
        "steady_offtracking": steady.map(|(radius, m)| json!({"radius_m": radius, "metres": m})).collect::<Vec<_>>(),
        "limits": r.findings.iter().map(finding).collect::<Vec<_>>(),
    })
}

/// Writes one line for each vehicle and limit, so that a spreadsheet can sort them.
fn csv(out: &mut dyn Write, all: &[(&Vehicle, ManoeuvreReport)]) -> std::io::Result<()> {
    writeln!(out, "vehicle_id,measure,who,limit_m,at_least,measured_m,passes,sureness")?;
    for (v, r) in all {
        for f in &r.findings {
            writeln!(
                out,
                "{},{},\"{}\",{},{},{},{},\"{}\"",
                v.id,
                f.limit.measure.name(),
                f.limit.who,
                f.limit.metres,
                f.limit.measure.at_least(),
                f.metres.map_or(String::new(), |m| format!("{m:.3}")),
                f.passes,
                f.limit.sureness.words()
            )?;
        }
    }
    Ok(())
}
