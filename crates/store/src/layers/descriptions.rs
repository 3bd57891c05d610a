//! What the columns of layers and tables mean, and which values they may have, in the tables of the extension `gpkg_schema` (GeoPackage
//! 1.3, clause F.9). GDAL and QGIS show both. The words are those of `docs/columns.md`, which a test compares with databases.

use std::sync::LazyLock;

use sqlx::sqlite::SqliteConnection;

type Sql<T> = Result<T, sqlx::Error>;

const PAGE: &str = include_str!("../../../../docs/columns.md");

/// The page's name for every layer of permits.
const PERMIT_LAYER: &str = "permit_…";

/// What is described, in the page's names: layers, and tables that other programs list.
const DESCRIBED: [&str; 12] = [
    "edge",
    PERMIT_LAYER,
    "turn",
    "junction",
    "evidence",
    "evidence_place",
    "certificate",
    "permit",
    "turn_certificate",
    "vehicle",
    "run",
    "account",
];

/// The values that a column may have, apart from none.
#[derive(Debug, Clone, PartialEq)]
enum ColumnRange {
    Numbers { low: f64, with_low: bool, high: f64 },
    Words(Vec<&'static str>),
}

/// A column of a table, in the words of the page.
#[derive(Debug, Clone, PartialEq)]
struct ColumnDescription {
    table: &'static str,
    column: &'static str,
    description: Option<String>,
    /// The range, and its name in the database.
    constraint: Option<(String, ColumnRange)>,
}

static COLUMNS: LazyLock<Vec<ColumnDescription>> =
    LazyLock::new(|| PAGE.lines().filter(|line| line.starts_with("| `")).flat_map(described).collect());

/// The columns of a line of the page.
fn described(line: &'static str) -> Vec<ColumnDescription> {
    let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
    let &[columns, tables, unit, range, words] = &*cells else { return Vec::new() };
    let tables: Vec<&str> = quoted(tables).filter(|table| DESCRIBED.contains(table)).collect();
    let Some((&table, column)) = tables.first().zip(quoted(columns).next()) else { return Vec::new() };
    // Columns of one line share a constraint, which has the name of the first of them.
    let name = format!("netcert_{}_{column}", if table == PERMIT_LAYER { "permit_layer" } else { table });
    let constraint = ColumnRange::of(range).map(|range| (name, range));
    let description = in_plain_words(words, unit);
    let of = |table, column| {
        let (description, constraint) = (description.clone(), constraint.clone());
        ColumnDescription { table, column, description, constraint }
    };
    tables
        .into_iter()
        .flat_map(|table| quoted(columns).map(move |column| (table, column)))
        .map(|(t, c)| of(t, c))
        .collect()
}

/// Names in backquotes.
fn quoted(cell: &'static str) -> impl Iterator<Item = &'static str> {
    cell.split('`').skip(1).step_by(2)
}

/// The meaning and the unit, without links and backquotes.
fn in_plain_words(words: &str, unit: &str) -> Option<String> {
    let mut plain = String::new();
    let mut rest = words;
    // `[text](address)`
    while let Some((before, text, after)) = rest.split_once('[').and_then(|(before, link)| {
        let (text, address) = link.split_once("](")?;
        Some((before, text, address.split_once(')')?.1))
    }) {
        plain += before;
        plain += text;
        rest = after;
    }
    plain += rest;
    plain.retain(|c| c != '`');
    if !unit.is_empty() {
        if !plain.is_empty() {
            plain += if plain.ends_with('.') { " " } else { ". " };
        }
        plain += &format!("Unit: {unit}");
    }
    (!plain.is_empty()).then_some(plain)
}

impl ColumnRange {
    /// The range in a cell of the page. `None` if anything may stand there.
    fn of(cell: &'static str) -> Option<Self> {
        let cell = cell.strip_suffix(", or none").unwrap_or(cell);
        if cell.starts_with('`') {
            return Some(Self::Words(quoted(cell).collect()));
        }
        let text = cell.strip_prefix("whole").unwrap_or(cell).trim();
        let number = |text: &str| text.trim().parse::<f64>().ok();
        let without_end = |low, with_low| Self::Numbers { low, with_low, high: f64::INFINITY };
        if let Some(low) = text.strip_prefix('≥') {
            return number(low).map(|low| without_end(low, true));
        }
        if let Some(low) = text.strip_prefix('>') {
            return number(low).map(|low| without_end(low, false));
        }
        let (low, high) = text.split_once(" to ")?;
        Some(Self::Numbers { low: number(low)?, with_low: true, high: number(high)? })
    }
}

/// Describes the columns of all layers and tables that are listed and have no descriptions yet, and forgets those that are gone. A database of
/// netcert 0.2 has no place for descriptions, and stays as it is.
pub(crate) async fn describe(c: &mut SqliteConnection) -> Sql<()> {
    let there =
        "SELECT count(*) FROM sqlite_schema WHERE name IN ('gpkg_data_columns', 'gpkg_data_column_constraints')";
    if sqlx::query_scalar::<_, i64>(there).fetch_one(&mut *c).await? < 2 {
        return Ok(());
    }
    let gone = "DELETE FROM gpkg_data_columns WHERE table_name NOT IN (SELECT table_name FROM gpkg_contents)";
    sqlx::query(gone).execute(&mut *c).await?;
    let new = "SELECT table_name, table_name IN (SELECT layer FROM certified_set) FROM gpkg_contents \
               WHERE table_name NOT IN (SELECT table_name FROM gpkg_data_columns) ORDER BY table_name";
    let new: Vec<(String, bool)> = sqlx::query_as(new).fetch_all(&mut *c).await?;
    for (table, is_permit_layer) in new {
        let name = if is_permit_layer { PERMIT_LAYER } else { &*table };
        for column in COLUMNS.iter().filter(|column| column.table == name) {
            add(c, &table, column).await?;
        }
    }
    // A layer that comes and goes leaves nothing. Constraints of other programs have other names.
    let unused = "DELETE FROM gpkg_data_column_constraints WHERE constraint_name LIKE 'netcert\\_%' ESCAPE '\\' AND constraint_name \
                  NOT IN (SELECT constraint_name FROM gpkg_data_columns WHERE constraint_name NOT NULL)";
    sqlx::query(unused).execute(c).await?;
    Ok(())
}

async fn add(c: &mut SqliteConnection, table: &str, column: &ColumnDescription) -> Sql<()> {
    let ColumnDescription { column, description, constraint, .. } = column;
    if description.is_none() && constraint.is_none() {
        return Ok(());
    }
    sqlx::query("INSERT INTO gpkg_data_columns VALUES (?, ?, NULL, NULL, ?, NULL, ?)")
        .bind(table)
        .bind(*column)
        .bind(description)
        .bind(constraint.as_ref().map(|(name, _)| name))
        .execute(&mut *c)
        .await?;
    match constraint {
        Some((name, ColumnRange::Words(words))) => {
            for word in words {
                constrain(c, name, Some(word), None).await?;
            }
        }
        Some((name, ColumnRange::Numbers { low, with_low, high })) => {
            constrain(c, name, None, Some((*low, *with_low, *high))).await?;
        }
        None => {}
    }
    Ok(())
}

/// Adds a word or a range to a constraint, if it is not there yet.
async fn constrain(
    c: &mut SqliteConnection,
    name: &str,
    word: Option<&str>,
    range: Option<(f64, bool, f64)>,
) -> Sql<()> {
    let sql = "INSERT INTO gpkg_data_column_constraints SELECT ?1, ?2, ?3, ?4, ?5, ?6, ?7, NULL \
               WHERE NOT EXISTS (SELECT 1 FROM gpkg_data_column_constraints WHERE constraint_name = ?1 AND value IS ?3)";
    sqlx::query(sql)
        .bind(name)
        .bind(if word.is_some() { "enum" } else { "range" })
        .bind(word)
        .bind(range.map(|range| range.0))
        .bind(range.map(|range| range.1))
        .bind(range.map(|range| range.2))
        .bind(range.map(|range| range.2.is_finite()))
        .execute(c)
        .await?;
    Ok(())
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn of(table: &str, column: &str) -> &'static ColumnDescription {
        COLUMNS.iter().find(|known| known.table == table && known.column == column).unwrap()
    }

    #[test]
    fn the_page_gives_words_units_and_ranges() {
        let length = of("edge", "length_m");
        let words = "length along the smoothed centreline; without a centreline, along the map's line. Unit: m";
        assert_eq!(length.description.as_deref(), Some(words));
        let from_0 = ColumnRange::Numbers { low: 0.0, with_low: true, high: f64::INFINITY };
        assert_eq!(length.constraint, Some(("netcert_edge_length_m".to_owned(), from_0)));
        let lanes = ColumnRange::Numbers { low: 1.0, with_low: true, high: 255.0 };
        assert_eq!(of("edge", "lanes").constraint.as_ref().unwrap().1, lanes);
        let width = ColumnRange::Numbers { low: 0.0, with_low: false, high: f64::INFINITY };
        assert_eq!(of(PERMIT_LAYER, "width_m").constraint, Some(("netcert_permit_layer_width_m".to_owned(), width)));
        let directions = ColumnRange::Words(vec!["forward", "backward"]);
        assert_eq!(of("edge", "direction").constraint, Some(("netcert_edge_direction".to_owned(), directions)));
        // No word for it beside the unit; no range; a link in the words.
        assert_eq!(of("certificate", "verdict").description, None);
        assert_eq!(of("edge", "name").constraint, None);
        let way = "the way in OpenStreetMap, or the number of a segment (Overture)";
        assert_eq!(of("edge", "way_id").description.as_deref(), Some(way));
        assert_eq!(
            of("turn_certificate", "need_flare_m").constraint.as_ref().unwrap().0,
            "netcert_turn_certificate_need_flare_m"
        );
    }

    #[test]
    fn each_table_is_on_the_page_and_no_constraint_has_two_meanings() {
        for table in DESCRIBED {
            assert!(COLUMNS.iter().filter(|column| column.table == table).count() > 2, "{table}");
        }
        let mut ranges = std::collections::BTreeMap::new();
        for (name, range) in COLUMNS.iter().filter_map(|column| column.constraint.as_ref()) {
            assert_eq!(ranges.entry(name).or_insert(range), &range, "{name}");
        }
        let plain = |text: &String| !text.contains(['`', '[', ']', '|']);
        assert!(COLUMNS.iter().filter_map(|column| column.description.as_ref()).all(plain));
    }
}
