//! Prints the answer of `netcert paper`: three tables for people, or all numbers as JSON.

use std::io::{self, Write};

use netcert::published::{Correction, DrawnRoute, RouteCert, Rsc};
use netcert::stet::Certificate;
use serde_json::{Value, json};

use super::simulate::Simulated;
use super::timing::{Series, Timing};
use crate::cli::output::table::Table;

pub(super) fn table(out: &mut dyn Write, simulated: &[Simulated], timing: Option<&Timing>) -> io::Result<()> {
    writeln!(out, "Table I: 𝒞 = w_min − (h_Ω + h_Ξ·r_0) from its own numbers, r_0 half the body's length; metres\n")?;
    own_numbers(simulated).write(out, "  ")?;
    writeln!(
        out,
        "\nAlgorithm 1 on a route of {:.2} m, with the table's numbers in brackets. β has the least trace. The last\n\
         column is 𝒞 with β° as printed (erratum E1); the prime mover's tube is shrunk where the algorithm requires it.\n",
        length_m(simulated)
    )?;
    by_algorithm(simulated).write(out, "  ")?;
    writeln!(
        out,
        "\nWhat netcert decides for the same vehicles and corridors: RSC, the least leeway of any point of any body. First without\n\
         tolerances, as in the paper, then with ε 0.15 m and σ 0.2°\n"
    )?;
    decided(simulated).write(out, "  ")?;
    writeln!(
        out,
        "\nWhy they differ: 𝒞 requires half a body's length of room on each side (r_N^max, over all directions: E7), at the\n\
         narrowest place, and for the last trailer only. 𝒞 allows for no steering error and ignores the corners of bodies. RSC\n\
         requires the room that each body takes across the road at its place. netcert also requires every hinge to stay within\n\
         ±θ; where RSC is positive and the verdict is `unsafe`, a hinge does not. The paper puts q_0 on the centreline; netcert\n\
         puts the steer axle there, L further ahead. docs/errata.md shows every fault in numbers."
    )?;
    if let Some(timing) = timing {
        writeln!(out, "\nRun time on this machine, milliseconds (least of some runs)\n")?;
        times(timing).write(out, "  ")?;
        writeln!(out)?;
        for (name, series) in timing.series() {
            let (slope, intercept, r2) = (1e3 * series.slope_s, 1e3 * series.intercept_s, series.r_squared);
            writeln!(out, "  {name}: {intercept:.2} ms and {slope:.2} ms a trailer, R² {r2:.4}")?;
        }
        writeln!(
            out,
            "  netcert's certificate takes longer where its quick bound loses centimetres in a bend and the exact bound is computed"
        )?;
        writeln!(out, "  the paper: 0.5 s for two trailers, 1.15 s for five (i7-12650H)")?;
    }
    Ok(())
}

fn own_numbers(simulated: &[Simulated]) -> Table {
    let mut table =
        Table::new(&[">Sc", ">units", ">L", ">θ", ">body", ">h_Ω", ">h_Ξ", ">r_N^max", ">w_min", ">𝒞", "verdict"]);
    for s in simulated {
        let (sc, rsc) = (&s.scenario, s.scenario.rsc());
        table.row([
            sc.number.to_string(),
            (sc.system.trailers + 1).to_string(),
            format!("{:.2}", sc.system.link_m),
            format!("{:.1}°", sc.system.sway_rad.to_degrees()),
            format!("{:.1} × {:.1}", sc.system.length_m, sc.system.width_m),
            metres(sc.h_omega_m),
            format!("{:.3}", sc.h_xi),
            metres(rsc.last_radius_m),
            metres(sc.w_min_m),
            metres(rsc.rsc_m),
            verdict(rsc.printed_safe()).to_owned(),
        ]);
    }
    table
}

fn by_algorithm(simulated: &[Simulated]) -> Table {
    let mut table = Table::new(&[
        ">Sc",
        ">h_Ω",
        ">(table)",
        ">h_Ξ",
        ">(table)",
        ">r_N^max",
        ">(table)",
        ">𝒞",
        ">(table)",
        "verdict",
        ">𝒞, β° as printed",
    ]);
    for s in simulated {
        let (sc, ours, theirs) = (&s.scenario, &s.paper.rsc, s.scenario.rsc());
        let bracketed = |value: f64| format!("({value:.3})");
        table.row([
            sc.number.to_string(),
            metres(ours.h_omega_m),
            bracketed(theirs.h_omega_m),
            format!("{:.3}", ours.h_xi),
            bracketed(theirs.h_xi),
            metres(ours.last_radius_m),
            bracketed(theirs.last_radius_m),
            metres(ours.rsc_m),
            bracketed(theirs.rsc_m),
            verdict(ours.printed_safe()).to_owned(),
            metres(s.printed_beta.rsc.rsc_m),
        ]);
    }
    table
}

fn decided(simulated: &[Simulated]) -> Table {
    let mut table = Table::new(&[
        ">Sc",
        ">𝒞 (table)",
        "",
        ">RSC, no tolerances",
        ">hinge margin",
        "verdict",
        ">RSC, ε 0.15 m",
        ">γ",
        ">hinge margin",
        "verdict",
    ]);
    for s in simulated {
        let (exact, usual) = (&s.exact.result, &s.usual.result);
        let degrees = |rad: Option<f64>| rad.map_or("none".to_owned(), |rad| format!("{:.2}°", rad.to_degrees()));
        let known = |m: Option<f64>| m.map_or("none".to_owned(), metres);
        table.row([
            s.scenario.number.to_string(),
            metres(s.scenario.rsc().rsc_m),
            verdict(s.scenario.rsc().printed_safe()).to_owned(),
            known(exact.rsc_m),
            degrees(exact.hinge_margin_rad),
            verdict(exact.safe()).to_owned(),
            known(usual.rsc_m),
            format!("{:.2}", usual.shrink),
            degrees(usual.hinge_margin_rad),
            verdict(usual.safe()).to_owned(),
        ]);
    }
    table
}

fn times(timing: &Timing) -> Table {
    let names = timing.series().map(|(name, _)| format!(">{name}"));
    let headings: Vec<&str> = std::iter::once(">trailers").chain(names.iter().map(String::as_str)).collect();
    let mut table = Table::new(&headings);
    for (trailers, _) in &timing.paper.points {
        let cell = |(_, series): (&str, &Series)| {
            let own = series.points.iter().find(|(n, _)| n == trailers);
            own.map_or_else(|| "—".to_owned(), |(_, seconds)| format!("{:.2}", 1e3 * seconds))
        };
        table.row(std::iter::once(trailers.to_string()).chain(timing.series().map(cell)));
    }
    table
}

pub(super) fn json(
    out: &mut dyn Write,
    simulated: &[Simulated],
    route: &DrawnRoute,
    timing: Option<&Timing>,
) -> io::Result<()> {
    let mut value = json!({
        "route_length_m": route.length_m,
        "scenarios": simulated.iter().map(scenario).collect::<Vec<_>>(),
    });
    if let Some(timing) = timing {
        value["timing"] = json!({
            "algorithm_1": series(&timing.paper),
            "netcert": series(&timing.netcert),
            "netcert_gains": series(&timing.gains),
        });
    }
    writeln!(out, "{value:#}")
}

fn scenario(s: &Simulated) -> Value {
    let sc = &s.scenario;
    json!({
        "scenario": sc.number,
        "units": sc.system.trailers + 1,
        "link_m": sc.system.link_m,
        "sway_deg": sc.system.sway_rad.to_degrees(),
        "body_m": [sc.system.length_m, sc.system.width_m],
        "table": rsc(&sc.rsc()),
        "simulated": run(&s.paper),
        "simulated_beta_as_printed": run(&s.printed_beta),
        "netcert_no_tolerances": certificate(&s.exact),
        "netcert_usual_tolerances": certificate(&s.usual),
    })
}

fn rsc(rsc: &Rsc) -> Value {
    json!({
        "h_omega_m": rsc.h_omega_m,
        "h_xi": rsc.h_xi,
        "r_0_max_m": rsc.prime_radius_m,
        "r_n_max_m": rsc.last_radius_m,
        "w_min_m": rsc.w_min_m,
        "rsc_m": rsc.rsc_m,
        "safe": rsc.printed_safe(),
    })
}

fn run(run: &RouteCert) -> Value {
    let count = |kind: Correction| run.steps.iter().filter(|step| step.correction == kind).count();
    let mut value = rsc(&run.rsc);
    value["instants"] = json!(run.steps.len());
    value["shifted"] = json!(count(Correction::Centre));
    value["shifted_and_shrunk"] = json!(count(Correction::CentreAndShape));
    value
}

fn certificate(certificate: &Certificate) -> Value {
    let result = &certificate.result;
    json!({
        "rsc_m": result.rsc_m,
        "hinge_margin_deg": result.hinge_margin_rad.map(f64::to_degrees),
        "shrink": result.shrink,
        "safe": result.safe(),
    })
}

fn series(series: &Series) -> Value {
    json!({
        "seconds": series.points.iter().map(|(n, s)| json!({"trailers": n, "s": s})).collect::<Vec<_>>(),
        "slope_s": series.slope_s,
        "intercept_s": series.intercept_s,
        "r_squared": series.r_squared,
    })
}

fn length_m(simulated: &[Simulated]) -> f64 {
    simulated.first().map_or(0.0, |s| s.corridor.spacing_m * (s.corridor.len() as f64 - 1.0))
}

fn metres(value: f64) -> String {
    format!("{value:.3}")
}

fn verdict(safe: bool) -> &'static str {
    if safe { "safe" } else { "unsafe" }
}
