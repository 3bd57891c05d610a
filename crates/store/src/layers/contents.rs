//! The layers and the tables without geometry that other programs list. GDAL lists every table of a file unless some are registered as
//! `attributes`; then it lists only registered tables, and the tables that only netcert reads stay hidden.

use sqlx::sqlite::SqliteConnection;

use netcert_rows::Bounds;

type Sql<T> = Result<T, sqlx::Error>;

/// The tables that people read beside the layers, with their descriptions.
const TABLES: [(&str, &str); 6] = [
    ("certificate", "Certificates of edges, one row an edge, vehicle and corridor"),
    ("permit", "Edges that a vehicle may use, one row an edge, vehicle and corridor"),
    ("turn_certificate", "Certificates of turns, one row a turn, vehicle and corridor"),
    ("vehicle", "Vehicles that are certified here"),
    ("run", "Runs of the program that made this file"),
    ("account", "What became of every object read"),
];

/// Registers the tables, and the table of styles in the way of QGIS.
pub(crate) async fn add_tables(c: &mut SqliteConnection, time: &str) -> Sql<()> {
    for (table, description) in TABLES {
        add(c, table, description, time, None).await?;
    }
    add(c, "layer_styles", "", time, Some(0)).await
}

async fn add(c: &mut SqliteConnection, table: &str, description: &str, time: &str, srs_id: Option<i32>) -> Sql<()> {
    let sql = "INSERT INTO gpkg_contents (table_name, data_type, identifier, description, last_change, srs_id) \
               VALUES (?1, 'attributes', ?1, ?2, ?3, ?4)";
    sqlx::query(sql).bind(table).bind(description).bind(time).bind(srs_id).execute(c).await?;
    Ok(())
}

/// Sets the time of the last change of the registered tables.
pub(crate) async fn touch_tables(c: &mut SqliteConnection, time: &str) -> Sql<()> {
    let sql = "UPDATE gpkg_contents SET last_change = ? WHERE data_type = 'attributes'";
    sqlx::query(sql).bind(time).execute(c).await?;
    Ok(())
}

/// A table or view that is a layer: it has a column `geom`.
pub(crate) struct LayerTable<'a> {
    /// Name of the table or view, and of the layer.
    pub(crate) table: &'a str,
    /// The type of its geometries, in the words of GeoPackage.
    pub(crate) geometries: &'a str,
    /// What it shows, for people.
    pub(crate) description: &'a str,
    /// The box around it. `None` if it is empty.
    pub(crate) bounds: Option<Bounds>,
}

impl LayerTable<'_> {
    /// Registers the layer. `time` is the time of its last change.
    pub(crate) async fn add(&self, c: &mut SqliteConnection, time: &str) -> Sql<()> {
        let Self { table, geometries, description, bounds } = *self;
        sqlx::query("INSERT INTO gpkg_contents VALUES (?, 'features', ?, ?, ?, ?, ?, ?, ?, 4326)")
            .bind(table)
            .bind(table)
            .bind(description)
            .bind(time)
            .bind(bounds.map(|b| b.west))
            .bind(bounds.map(|b| b.south))
            .bind(bounds.map(|b| b.east))
            .bind(bounds.map(|b| b.north))
            .execute(&mut *c)
            .await?;
        sqlx::query("INSERT INTO gpkg_geometry_columns VALUES (?, 'geom', ?, 4326, 0, 0)")
            .bind(table)
            .bind(geometries)
            .execute(c)
            .await?;
        Ok(())
    }
}
