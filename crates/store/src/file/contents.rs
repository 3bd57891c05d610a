//! The tables without geometry that other programs list. GDAL lists every table of a file unless some are registered as
//! `attributes`; then it lists only registered tables, and the tables that only netcert reads stay hidden.

use sqlx::sqlite::SqliteConnection;

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
