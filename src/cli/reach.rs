//! `netcert reach`: finds the roads that a vehicle can reach over certified edges and turns, and from which it can come back.

use std::io::Write;

use anyhow::bail;
use clap::{Args, ValueEnum};
use netcert::network::{EdgeNo, Network};
use netcert::osm::rounded;
use netcert::route::{self, Measure, PartKind, Position, ReachableEdges, Snapper};
use netcert::words::at_local_time;
use serde_json::{Value, json};

use super::Session;
use crate::cli::arguments::position::place;
use crate::cli::database::routing::{RoutingArgs, RoutingInputs};
use crate::cli::output::{printable, results, wrapped};

/// Find the certified roads that a vehicle can reach from a place, and those from which it can come back.
///
/// The vehicle uses edges and turns whose own certificates are safe, and it obeys turn restrictions. With --what-if,
/// the answer also shows what would become reachable if one more edge were safe.
#[derive(Args)]
#[command(after_help = "\
Examples:
  netcert reach --vehicle AU-ATRIPLE53 --from 144.29,-36.74
  netcert reach --vehicle EU-SEMI16.5 --from 8.67,49.40 --format geojson > reach.geojson
  netcert reach --vehicle EU-SEMI16.5 --from 8.67,49.40 --what-if 7129168334710566423

GeoJSON has one line for each certified edge. `reach` is `return` (the vehicle gets there and back),
`there` (the vehicle gets there but not back), `opened` (the vehicle gets there only with --what-if)
or `no`. `component` is the number of a part of the network in which the vehicle can drive from
every edge to every other; the largest part has number 0.")]
pub(crate) struct ReachQuery {
    #[command(flatten)]
    inputs: RoutingArgs,
    /// The place where the vehicle begins, degrees.
    #[arg(long, value_name = "LON,LAT", value_parser = place, allow_hyphen_values = true)]
    from: Position,
    /// The greatest distance from that place to a certified road, metres.
    #[arg(long, value_name = "METRES", default_value_t = 100.0)]
    snap: f64,
    /// Also show what the vehicle could reach if this edge (an edge_id) and every lawful turn into and out of it were
    /// safe.
    #[arg(long, value_name = "EDGE")]
    what_if: Option<i64>,
    /// The output format.
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    Text,
    Geojson,
}

impl ReachQuery {
    pub(crate) fn run(&self, session: &Session) -> anyhow::Result<()> {
        let inputs = self.inputs.load(session, "reach")?;
        let graph = inputs.graph(Measure::Distance);
        let access = inputs.driver.permits.access(&inputs.roads.movements);
        let snapped =
            Snapper::new(&inputs.roads).snap(self.from, self.snap, |edge| inputs.driver.permits.edge(edge))?;
        let starts: Vec<EdgeNo> = snapped.on.iter().map(|on| on.edge).collect();
        session.progress.say(&format!("the road is {:.0} m from there", snapped.distance_m));
        let now = route::reach(&graph, &access, &starts);
        let components = route::components(&graph, &access);
        let opened = match self.what_if {
            None => None,
            Some(id) => {
                let found = inputs.roads.network.numbered_edges().find(|(_, edge)| edge.id == id);
                let Some((edge, _)) = found else {
                    bail!("{}: no edge {id}; `netcert query` lists their ids", inputs.path.display());
                };
                let then = route::reach(&graph, &route::with_edge(&graph, &access, edge), &starts);
                Some((edge, then))
            }
        };
        let mut out = results();
        match self.format {
            Format::Geojson => {
                let opened = opened.as_ref().map(|(_, then)| then);
                writeln!(out, "{}", geojson(&inputs, &now, opened, &components))?;
            }
            Format::Text => tell(&mut out, &inputs, &now, opened.as_ref(), &components)?,
        }
        Ok(out.flush()?)
    }
}

fn km(network: &Network, on: impl Fn(usize) -> bool) -> f64 {
    let edges = network.edges.iter().enumerate().filter(|(i, _)| on(*i));
    // The fold begins at 0.0, because an empty `sum` of floats is -0.0.
    edges.map(|(_, edge)| network.length_m(edge) / 1000.0).fold(0.0, |sum, km| sum + km)
}

fn tell(
    out: &mut dyn Write,
    inputs: &RoutingInputs,
    now: &ReachableEdges,
    opened: Option<&(EdgeNo, ReachableEdges)>,
    components: &route::Components,
) -> std::io::Result<()> {
    let (network, vehicle) = (&inputs.roads.network, &inputs.driver.model.vehicle);
    let certified = km(network, |i| inputs.driver.permits.edge(EdgeNo::at(i)));
    let there = km(network, |i| now.there[i]);
    let back = km(network, |i| now.and_back[i]);
    let share = |part: f64| if certified > 0.0 { 100.0 * part / certified } else { 0.0 };
    writeln!(out, "{} {}, over roads and turns certified for it\n", vehicle.id, vehicle.name)?;
    writeln!(out, "  certified      {certified:>9.1} km  each direction of a road counted by itself")?;
    writeln!(out, "  reached        {there:>9.1} km  {:.1} %", share(there))?;
    writeln!(out, "  there and back {back:>9.1} km  {:.1} %", share(back))?;
    let largest = km(network, |i| components.of[i] == Some(0));
    let fall_apart = "parts that the network falls into; within each one can drive from anywhere to anywhere";
    writeln!(out, "  parts          {:>9}     {fall_apart}", components.count)?;
    writeln!(out, "  the largest    {largest:>9.1} km  {:.1} %", share(largest))?;
    if let Some((edge, then)) = opened {
        let more = |a: &[bool], b: &[bool]| km(network, |i| a[i] && !b[i] && i != edge.index());
        let (more_there, more_back) = (more(&then.there, &now.there), more(&then.and_back, &now.and_back));
        let name = printable(&route::title(network, PartKind::Edge(*edge)));
        let text = format!(
            "If edge {} ({name}) and the turns at it were safe, {more_there:.1} km more could be reached, and {more_back:.1} km \
             more with the way back.",
            network.edges[edge.index()].id
        );
        writeln!(out, "\n{}", wrapped(&text, "  "))?;
    }
    let time = at_local_time(inputs.at);
    let scope =
        format!("Edges and turns are certified by themselves, whole routes are not: `netcert route` does that.{time}");
    writeln!(out, "\n{}", wrapped(&scope, ""))
}

fn geojson(
    inputs: &RoutingInputs,
    now: &ReachableEdges,
    opened: Option<&ReachableEdges>,
    components: &route::Components,
) -> Value {
    let network = &inputs.roads.network;
    let mut features = Vec::new();
    for (i, edge) in network.edges.iter().enumerate() {
        let opens = opened.is_some_and(|then| then.there[i] && !now.there[i]);
        if !inputs.driver.permits.edge(EdgeNo::at(i)) && !opens {
            continue;
        }
        let reach = match (now.and_back[i], now.there[i], opens) {
            (true, ..) => "return",
            (false, true, _) => "there",
            (false, false, true) => "opened",
            (false, false, false) => "no",
        };
        let line: Vec<[f64; 2]> = network.positions(edge).map(|place| place.degrees().into()).map(rounded).collect();
        features.push(json!({
            "type": "Feature",
            "id": edge.id.to_string(),
            "geometry": {"type": "LineString", "coordinates": line},
            "properties": {
                "edge_id": edge.id,
                "vehicle_id": inputs.driver.model.vehicle.id,
                "reach": reach,
                "component": components.of[i],
                "length_m": network.length_m(edge),
                "rsc_m": inputs.driver.permits.edges[i].rsc_m,
                "title": route::title(network, PartKind::Edge(EdgeNo::at(i))),
            },
        }));
    }
    let mut collection = json!({"type": "FeatureCollection", "features": features});
    if let Some(time) = inputs.at {
        collection["at"] = json!(time.to_string());
    }
    collection
}
