//! Styles for QGIS. QGIS finds them in `layer_styles` and applies them when a layer is opened. The files are in
//! `data/styles/`.
//!
//! Styles that users saved are never changed: a layer keeps the user's default style, and removing a layer leaves the user's
//! styles in the table.

use sqlx::sqlite::SqliteConnection;

type Sql<T> = Result<T, sqlx::Error>;

/// The owner of the styles that this program writes.
const OWNER: &str = "netcert";

/// What a layer shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Shows {
    /// The roads, by the source of their width.
    Edges,
    /// The roads that a vehicle may use, by the room that it has.
    Permits,
    /// The turns, by the source of their kerb.
    Turns,
    /// The areas of junctions.
    Junctions,
}

impl Shows {
    /// Name, description and the style itself.
    fn style(self) -> [&'static str; 3] {
        match self {
            Self::Edges => [
                "width source",
                "How well each road's width is known",
                include_str!("../../../../data/styles/edge.qml"),
            ],
            Self::Permits => {
                ["room", "Metres to spare beside the vehicle", include_str!("../../../../data/styles/permit.qml")]
            }
            Self::Turns => {
                ["kerb source", "Where each turn's kerb comes from", include_str!("../../../../data/styles/turn.qml")]
            }
            Self::Junctions => {
                ["area", "What roads and corners cover", include_str!("../../../../data/styles/junction.qml")]
            }
        }
    }
}

/// Adds the style of a layer and replaces an older one of this program.
pub(crate) async fn add(c: &mut SqliteConnection, layer: &str, shows: Shows, time: &str) -> Sql<()> {
    remove(c, layer).await?;
    let [name, description, style] = shows.style();
    let sql = "INSERT INTO layer_styles (f_table_catalog, f_table_schema, f_table_name, f_geometry_column, styleName, \
               styleQML, styleSLD, useAsDefault, description, owner, ui, update_time) \
               SELECT '', '', ?1, 'geom', ?2, ?3, '', NOT EXISTS (SELECT 1 FROM layer_styles \
               WHERE f_table_name = ?1 AND useAsDefault), ?4, ?5, NULL, ?6";
    let insert = sqlx::query(sql).bind(layer).bind(name).bind(style).bind(description);
    insert.bind(OWNER).bind(time).execute(c).await?;
    Ok(())
}

/// Removes the style that this program gave a layer.
pub(crate) async fn remove(c: &mut SqliteConnection, layer: &str) -> Sql<()> {
    let sql = "DELETE FROM layer_styles WHERE f_table_name = ? AND owner = ?";
    sqlx::query(sql).bind(layer).bind(OWNER).execute(c).await?;
    Ok(())
}
