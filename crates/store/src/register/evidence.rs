//! Writes and reads the register of measurements. It is written as a whole; numbers stay what they are.

use sqlx::Row as _;
use sqlx::sqlite::{SqliteConnection, SqliteRow};

use crate::network::{Network, Site};
use crate::osm::NodeId;
use crate::words::Named;
use netcert_evidence::{
    Columns, Counted, Edges, Entry, MeasurementRow, MeasurementTarget, Quantity, State, Value, parts, surface,
};
use netcert_rows::Bounds;

use crate::columns::read::{rows, word};
use crate::database::Database;
use crate::database::register_state::RegisterState;
use crate::error::{StoreError, content};
use crate::file::bulk::Bulk;
use crate::layers::contents::LayerTable;

type Sql<T> = Result<T, sqlx::Error>;

/// The measurements that a database keeps.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Register {
    /// In order of their numbers.
    pub entries: Vec<Entry>,
    /// The greatest number that was ever given.
    pub last_no: i64,
}

impl Database {
    /// The register of measurements.
    ///
    /// # Errors
    /// The file cannot be read, or the register is damaged.
    pub fn register(&mut self) -> Result<Register, StoreError> {
        self.session.run(async |c| read(c).await)
    }
}

async fn read(c: &mut SqliteConnection) -> Sql<Register> {
    let RegisterState { last_no, .. } = RegisterState::read(c).await?;
    let mut entries = rows(c, "SELECT * FROM evidence ORDER BY evidence_no", entry).await?;
    let places = "SELECT evidence_no, edge_id, node, from_edge, to_edge, counts, quantity FROM evidence_place \
                  JOIN (SELECT evidence_no, quantity FROM evidence) USING (evidence_no) ORDER BY place_no";
    let places =
        rows(c, places, |row| Ok((row.try_get::<i64, _>(0)?, target(row, 1)?, row.try_get::<bool, _>(5)?))).await?;
    for (no, target, counts) in places {
        let of = entries.binary_search_by_key(&no, |entry: &Entry| entry.no);
        let of = of.map_err(|_| content(format!("a place of measurement {no}, which is missing")))?;
        entries[of].places.push((target, counts));
    }
    Ok(Register { entries, last_no })
}

fn pair(row: &SqliteRow, first: &str, second: &str) -> Sql<Option<[i64; 2]>> {
    let pair = row.try_get::<Option<i64>, _>(first)?.zip(row.try_get(second)?);
    Ok(pair.map(|(a, b)| [a, b]))
}

fn entry(row: &SqliteRow) -> Sql<Entry> {
    let no = row.try_get("evidence_no")?;
    let column = |name: &str| row.try_get::<&str, _>(name).map(str::to_owned);
    let optional = |name: &str| row.try_get::<Option<String>, _>(name);
    let named = |name: &str| content(format!("{name} of measurement {no}"));
    let quantity = Quantity::named(&column("quantity")?).ok_or_else(|| named("quantity"))?;
    let columns = Columns {
        value: row.try_get("value")?,
        vehicle: optional("vehicle")?,
        way_id: row.try_get("way_id")?,
        nodes: pair(row, "from_node", "to_node")?.map(|nodes| nodes.map(NodeId::new)),
        edge_id: row.try_get("edge_id")?,
        junction: row.try_get::<Option<i64>, _>("junction")?.map(NodeId::new),
        edges: pair(row, "from_edge", "to_edge")?,
        geom: row.try_get("geom")?,
    };
    let (value, place, at) = parts(quantity, &columns).map_err(|why| content(format!("measurement {no}: {why}")))?;
    let sigma: f64 = row.try_get("sigma")?;
    let measured = MeasurementRow {
        number: row.try_get::<i64, _>("file_row")?.unsigned_abs(),
        id: optional("id")?,
        quantity,
        value,
        sigma,
        along: Named::named(&column("direction")?).ok_or_else(|| named("direction"))?,
        place,
        way_id: columns.way_id,
        at,
        source: column("source")?,
        date: optional("date")?,
        licence: optional("licence")?,
        name: optional("name")?,
        note: optional("note")?,
    };
    let state = State::named(&column("state")?).ok_or_else(|| named("state"))?;
    // What counts must be what the value gives: nothing else may be certified with.
    if row.try_get::<Option<f64>, _>("lower")? != measured.lower() {
        return Err(content(format!("`lower` of measurement {no} is not what its value and sigma give")));
    }
    Ok(Entry { no, file: column("file")?, row: measured, state, why: optional("why")?, places: Vec::new() })
}

/// The place in the columns from `first` on: edge, node, and the edges of a corner; the quantity is two columns after them.
fn target(row: &SqliteRow, first: usize) -> Sql<MeasurementTarget> {
    let at = |column: usize| row.try_get::<Option<i64>, _>(first + column);
    let quantity: Quantity = word(row, first + 5)?;
    match (at(0)?, at(1)?, at(2)?.zip(at(3)?)) {
        (Some(edge), None, None) => Ok(MeasurementTarget::Edge(edge)),
        (None, Some(node), None) if quantity == Quantity::Surface => Ok(MeasurementTarget::Area(NodeId::new(node))),
        (None, Some(node), edges) => {
            Ok(MeasurementTarget::Corner { node: NodeId::new(node), edges: edges.map(|(a, b)| [a, b]) })
        }
        _ => Err(content("a place of a measurement is neither edge nor junction")),
    }
}

/// What counts of a surface whose outline is known to `sigma` metres.
fn measured_surface(geom: Option<Vec<u8>>, sigma: f64) -> Option<Counted> {
    let columns = Columns { geom, ..Columns::default() };
    match parts(Quantity::Surface, &columns).ok()?.0 {
        Value::Polygon(rings) => surface(&rings, sigma).map(Counted::Surface),
        _ => None,
    }
}

/// What certificates see of the register.
pub(crate) async fn site(c: &mut SqliteConnection, network: &Network) -> Sql<Site> {
    let sql = "SELECT edge_id, node, from_edge, to_edge, lower, quantity, evidence_no, sigma, geom FROM evidence_place \
               JOIN (SELECT evidence_no, lower, quantity, sigma, geom FROM evidence) USING (evidence_no) WHERE counts \
               ORDER BY place_no";
    let counting = rows(c, sql, |row| {
        let (lower, no): (Option<f64>, i64) = (row.try_get(4)?, row.try_get(6)?);
        let quantity: Quantity = word(row, 5)?;
        let counted = match quantity {
            Quantity::Surface => measured_surface(row.try_get(8)?, row.try_get(7)?),
            _ => lower.map(Counted::Number),
        };
        let counted = counted.ok_or_else(|| content(format!("measurement {no} counts and has no value")))?;
        Ok((quantity, target(row, 0)?, counted))
    })
    .await?;
    if counting.is_empty() {
        return Ok(Site::default());
    }
    let edges = Edges::of(network, counting.iter().map(|place| place.1));
    if let Some(place) = counting.iter().find(|place| !edges.has(place.1)) {
        return Err(content(format!("a measurement counts at {:?}, which the network does not have", place.1)));
    }
    Ok(edges.site(counting.into_iter()))
}

/// Writes the register in place of the one that is there. The tables' layer exists exactly if there are measurements.
pub(crate) async fn write(c: &mut SqliteConnection, register: &Register, time: &str) -> Sql<()> {
    for sql in [
        "DELETE FROM evidence_place",
        "DELETE FROM evidence",
        "DELETE FROM gpkg_geometry_columns WHERE table_name = 'evidence'",
        "DELETE FROM gpkg_contents WHERE table_name IN ('evidence', 'evidence_place')",
    ] {
        sqlx::query(sql).execute(&mut *c).await?;
    }
    let mut bulk = Bulk::new("evidence", 26);
    let mut bounds: Option<Bounds> = None;
    for entry in &register.entries {
        if let Some((_, around)) = entry.row.geometry() {
            bounds = Some(bounds.map_or(around, |known| known.union(around)));
        }
        add(&mut bulk, entry);
        bulk.end_row(c).await?;
    }
    bulk.finish(c).await?;
    let mut bulk = Bulk::new("evidence_place (evidence_no, edge_id, node, from_edge, to_edge, counts)", 6);
    for (no, &(target, counts)) in
        register.entries.iter().flat_map(|entry| entry.places.iter().map(|at| (entry.no, at)))
    {
        let (edge, node, edges) = match target {
            MeasurementTarget::Edge(id) => (Some(id), None, None),
            MeasurementTarget::Corner { node, edges } => (None, Some(node), edges),
            MeasurementTarget::Area(node) => (None, Some(node), None),
        };
        bulk.add(no);
        bulk.add(edge);
        bulk.add(node.map(NodeId::get));
        bulk.add(edges.map(|edges| edges[0]));
        bulk.add(edges.map(|edges| edges[1]));
        bulk.add(counts);
        bulk.end_row(c).await?;
    }
    bulk.finish(c).await?;
    // Numbers of removed measurements are not given again.
    sqlx::query("DELETE FROM sqlite_sequence WHERE name = 'evidence'").execute(&mut *c).await?;
    if register.last_no > 0 {
        let sql = "INSERT INTO sqlite_sequence (name, seq) VALUES ('evidence', ?)";
        sqlx::query(sql).bind(register.last_no).execute(&mut *c).await?;
    }
    if register.entries.is_empty() { Ok(()) } else { add_layers(c, bounds, time).await }
}

fn add(bulk: &mut Bulk, entry: &Entry) {
    let row = &entry.row;
    let columns = row.columns();
    bulk.add(entry.no);
    bulk.add(columns.geom);
    bulk.add(entry.file.as_str());
    bulk.add(i64::try_from(row.number).unwrap_or(i64::MAX));
    bulk.add(row.id.as_deref());
    bulk.add(row.quantity.name());
    bulk.add(columns.value);
    bulk.add(row.sigma);
    bulk.add(row.lower());
    bulk.add(columns.vehicle);
    bulk.add(row.along.name());
    bulk.add(columns.way_id);
    bulk.add(columns.nodes.map(|nodes| nodes[0].get()));
    bulk.add(columns.nodes.map(|nodes| nodes[1].get()));
    bulk.add(columns.edge_id);
    bulk.add(columns.junction.map(NodeId::get));
    bulk.add(columns.edges.map(|edges| edges[0]));
    bulk.add(columns.edges.map(|edges| edges[1]));
    bulk.add(row.source.as_str());
    for text in [&row.date, &row.licence, &row.name, &row.note] {
        bulk.add(text.as_deref());
    }
    bulk.add(entry.state.name());
    bulk.add(entry.usage().map(Named::name));
    bulk.add(entry.why.as_deref());
}

/// Registers the measurements as a layer, and their places as a table.
async fn add_layers(c: &mut SqliteConnection, bounds: Option<Bounds>, time: &str) -> Sql<()> {
    let layer = LayerTable { table: "evidence", geometries: "GEOMETRY", description: "Measurements", bounds };
    layer.add(c, time).await?;
    let sql = "INSERT INTO gpkg_contents (table_name, data_type, identifier, description, last_change) \
               VALUES ('evidence_place', 'attributes', 'evidence_place', 'Where measurements belong', ?)";
    sqlx::query(sql).bind(time).execute(c).await?;
    Ok(())
}
