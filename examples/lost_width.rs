//! Counts the edges whose corridor is narrower than their strip. Compared are the corridor's width at the certificate's
//! limiting place, its least width, and the width of the strip.
//!
//! `cargo run --release --example lost_width -- REGION.gpkg VEHICLE POLICY [list]`, with a database that certifies the
//! vehicle's edges. With `list`, every edge that lost more than 0.3 m follows as comma-separated values.
#![allow(clippy::print_stdout)]

use netcert::corridor::{Corridor, EdgeSpan, Params, stroke_corridor};
use netcert::network::{EdgeNo, Network};
use netcert::osm::facts::{Direction, Policy};
use netcert::rows::EdgeRow;
use netcert::store::{Database, QueryOptions};
use netcert::verdict::{UnsafeReason, Verdict};
use netcert::words::Named;
use rayon::prelude::*;

type Failure = Box<dyn std::error::Error>;

/// Least lost width that counts, metres. Less is rounding and a mapper's inaccuracy.
const LOST_M: f64 = 0.3;
/// Classes that count as main roads.
const MAIN: [&str; 4] = ["motorway", "trunk", "primary", "secondary"];

/// The width of one edge's corridor.
struct Width {
    strip_m: f64,
    /// Width at the certificate's limiting place, metres.
    limiting_m: Option<f64>,
    least_m: f64,
    /// Place along the edge where the corridor is narrowest, metres.
    least_at_m: f64,
    length_m: f64,
}

impl Width {
    fn of(corridor: &Corridor, span: &EdgeSpan, strip_m: f64, row: &EdgeRow) -> Self {
        let width = |k: usize| corridor.left_m[k] + corridor.right_m[k];
        let narrowest = span.stations.clone().min_by(|a, b| width(*a).total_cmp(&width(*b))).unwrap_or(0);
        let last = span.stations.end - 1;
        let station = |s_m: f64| (span.stations.start + (s_m / corridor.spacing_m).round() as usize).min(last);
        Self {
            strip_m,
            limiting_m: row.certificate.limiting_s_m.map(|s_m| width(station(s_m))),
            least_m: width(narrowest),
            least_at_m: (narrowest - span.stations.start) as f64 * corridor.spacing_m,
            length_m: (span.stations.len() - 1) as f64 * corridor.spacing_m,
        }
    }

    fn lost(&self) -> bool {
        self.least_m < self.strip_m - LOST_M
    }

    fn lost_where_limited(&self) -> bool {
        self.limiting_m.is_some_and(|limiting_m| limiting_m < self.strip_m - LOST_M)
    }
}

#[derive(Default)]
struct Count {
    edges: usize,
    safe: usize,
    too_narrow: usize,
    lost_where_limited: usize,
    lost: usize,
}

impl Count {
    fn add(&mut self, row: &EdgeRow, width: Option<&Width>) {
        let too_narrow = row.certificate.verdict == Verdict::Unsafe(UnsafeReason::Width);
        self.edges += 1;
        self.safe += usize::from(row.certificate.verdict == Verdict::Safe);
        self.too_narrow += usize::from(too_narrow);
        self.lost_where_limited += usize::from(too_narrow && width.is_some_and(Width::lost_where_limited));
        self.lost += usize::from(width.is_some_and(Width::lost));
    }

    fn print(&self, what: &str) {
        println!(
            "{what}: {} edges, {:.2} % safe, {} unsafe for width, of which {} are judged by a width more than {LOST_M} m under \
             their strip's; {} edges have such a place",
            self.edges,
            100.0 * self.safe as f64 / self.edges.max(1) as f64,
            self.too_narrow,
            self.lost_where_limited,
            self.lost
        );
    }
}

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [path, vehicle, policy, rest @ ..] = arguments.as_slice() else {
        return Err("usage: lost_width REGION.gpkg VEHICLE POLICY [list]".into());
    };
    let policy = Policy::named(policy).ok_or("POLICY is lane, direction or carriageway")?;
    let mut database = Database::open(path.as_ref())?;
    let network = database.load_network()?;
    let rows: Vec<EdgeRow> = database.query(&QueryOptions::new(vehicle, policy))?.collect::<Result<_, _>>()?;
    let widths = widths(&network, &rows, policy);
    let (mut all, mut main) = (Count::default(), Count::default());
    for (row, width) in rows.iter().zip(&widths) {
        all.add(row, width.as_ref());
        if MAIN.contains(&row.road.highway.trim_end_matches("_link")) {
            main.add(row, width.as_ref());
        }
    }
    all.print("all");
    main.print("main roads");
    if rest.iter().any(|word| word == "list") {
        list(&rows, &widths);
    }
    Ok(())
}

/// Widths by edge. `None` if the edge is unknown.
fn widths(network: &Network, rows: &[EdgeRow], policy: Policy) -> Vec<Option<Width>> {
    let of_stroke = |stroke| -> Vec<(EdgeNo, Width)> {
        let Ok(made) = stroke_corridor(network, stroke, policy, &Params::default()) else { return Vec::new() };
        let known = made.spans.iter().filter(|span| span.unknown.is_none());
        let width = |span: &EdgeSpan| {
            let edge = network.edges.get(span.edge.index())?;
            let section = network.road(edge).sections[usize::from(edge.direction == Direction::Backward)];
            let strip_m = f64::from(section.strip(policy)?.width_m());
            Some((span.edge, Width::of(&made.corridor, span, strip_m, rows.get(span.edge.index())?)))
        };
        known.filter_map(width).collect()
    };
    let mut widths: Vec<Option<Width>> = rows.iter().map(|_| None).collect();
    for (edge, width) in network.strokes.par_iter().flat_map_iter(of_stroke).collect::<Vec<_>>() {
        if let Some(slot) = widths.get_mut(edge.index()) {
            *slot = Some(width);
        }
    }
    widths
}

fn list(rows: &[EdgeRow], widths: &[Option<Width>]) {
    println!("edge,edge_id,way_id,highway,verdict,strip_m,limiting_m,least_m,least_at_m,length_m");
    for (row, width) in rows.iter().zip(widths) {
        let Some(width) = width.as_ref().filter(|width| width.lost()) else { continue };
        println!(
            "{},{},{},{},{:?},{:.2},{:.2},{:.2},{:.1},{:.1}",
            row.edge.index,
            row.edge.id,
            row.edge.way_id,
            row.road.highway,
            row.certificate.verdict,
            width.strip_m,
            width.limiting_m.unwrap_or(f64::NAN),
            width.least_m,
            width.least_at_m,
            width.length_m
        );
    }
}
