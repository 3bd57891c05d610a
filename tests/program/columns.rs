//! Compares `docs/columns.md` with a database and its exports: the columns must be the same, and every value in its range.

use std::collections::{BTreeMap, BTreeSet};

use parquet::file::reader::{FileReader as _, SerializedFileReader};
use sqlx::sqlite::SqliteConnection;
use sqlx::{AssertSqlSafe, Connection as _, Row as _};

use netcert_testing::program::WorkFolder;

const PAGE: &str = include_str!("../../docs/columns.md");
const VEHICLE: &str = "AU-SEMI19";

/// Table and column.
type Name = (String, String);

/// The values that a column may have.
#[derive(Debug, Clone, PartialEq)]
struct Rule {
    range: Range,
    may_be_missing: bool,
}

#[derive(Debug, Clone, PartialEq)]
enum Range {
    Number {
        whole: bool,
        low: f64,
        above: bool,
        high: f64,
    },
    Words(Vec<String>),
    Flag,
    Json,
    Time,
    Hash,
    /// Anything: texts, geometries, lists.
    Any,
}

fn number(text: &str) -> f64 {
    text.trim().parse().unwrap_or_else(|_| panic!("{text:?} is no number"))
}

impl Rule {
    fn of(cell: &str) -> Self {
        let plain = cell.strip_suffix(", or none");
        let (text, may_be_missing) = (plain.unwrap_or(cell), plain.is_some());
        let range = match text {
            "yes or no" => Range::Flag,
            "JSON" => Range::Json,
            "time" => Range::Time,
            "hash" => Range::Hash,
            "text" | "line" | "box" | "bytes" | "list" => Range::Any,
            words if words.starts_with('`') => {
                Range::Words(words.split(", ").map(|word| word.trim_matches('`').to_owned()).collect())
            }
            numbers => Self::numbers(numbers),
        };
        Self { range, may_be_missing }
    }

    fn numbers(text: &str) -> Range {
        let (whole, rest) = text.strip_prefix("whole").map_or((false, text), |rest| (true, rest.trim()));
        let (low, above, high) = match (rest.strip_prefix('≥'), rest.strip_prefix('>'), rest.split_once(" to ")) {
            _ if rest.is_empty() => (f64::NEG_INFINITY, false, f64::INFINITY),
            (Some(low), ..) => (number(low), false, f64::INFINITY),
            (_, Some(low), _) => (number(low), true, f64::INFINITY),
            (.., Some((low, high))) => (number(low), false, number(high)),
            _ => panic!("{text:?} is no range"),
        };
        Range::Number { whole, low, above, high }
    }

    fn allows(&self, value: Option<&str>) -> bool {
        let Some(text) = value else { return self.may_be_missing };
        match &self.range {
            &Range::Number { whole, low, above, high } => text.parse::<f64>().is_ok_and(|number| {
                (!whole || text.parse::<i64>().is_ok()) && (low..=high).contains(&number) && !(above && number <= low)
            }),
            Range::Words(words) => words.iter().any(|word| word == text),
            Range::Flag => ["0", "1", "true", "false"].contains(&text),
            Range::Json => serde_json::from_str::<serde_json::Value>(text).is_ok(),
            Range::Time => text.parse::<jiff::Timestamp>().is_ok(),
            Range::Hash => text.len() == 64 && text.bytes().all(|b| b.is_ascii_hexdigit()),
            Range::Any => true,
        }
    }
}

/// Names in backquotes.
fn quoted(cell: &str) -> impl Iterator<Item = &str> {
    cell.split('`').skip(1).step_by(2)
}

fn page() -> BTreeMap<Name, Rule> {
    let mut rules = BTreeMap::new();
    for line in PAGE.lines().filter(|line| line.starts_with("| `")) {
        let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
        let [columns, tables, _, range, _] = cells[..] else { panic!("not five cells: {line}") };
        for table in quoted(tables) {
            for column in quoted(columns) {
                let name = (table.to_owned(), column.to_owned());
                assert!(rules.insert(name, Rule::of(range)).is_none(), "twice on the page: {table}.{column}");
            }
        }
    }
    rules
}

/// The values found in each column. The set is empty if only the column's name is known.
type Found = BTreeMap<Name, BTreeSet<Option<String>>>;

fn add_table(found: &mut Found, table: &str, head: &[&str], rows: impl Iterator<Item = Vec<Option<String>>>) {
    for column in head {
        found.entry((table.to_owned(), (*column).to_owned())).or_default();
    }
    for row in rows {
        assert_eq!(row.len(), head.len(), "{table}");
        for (column, value) in head.iter().zip(row) {
            found.entry((table.to_owned(), (*column).to_owned())).or_default().insert(value);
        }
    }
}

/// All columns that a user's program may read. Columns of the GeoPackage standard are left out.
async fn database(place: &WorkFolder) -> Found {
    let mut c = SqliteConnection::connect(place.path("demo.gpkg").to_str().unwrap()).await.unwrap();
    let tables = "SELECT name FROM sqlite_schema WHERE type IN ('table', 'view') AND name NOT LIKE 'gpkg\\_%' ESCAPE '\\' \
                  AND name NOT LIKE 'rtree\\_%' ESCAPE '\\' AND name NOT LIKE 'sqlite\\_%' ESCAPE '\\'";
    let tables: Vec<String> = sqlx::query_scalar(tables).fetch_all(&mut c).await.unwrap();
    let mut found = Found::new();
    for table in tables {
        let columns: Vec<String> =
            sqlx::query_scalar("SELECT name FROM pragma_table_xinfo(?)").bind(&table).fetch_all(&mut c).await.unwrap();
        let shown = if table.starts_with("permit_") { "permit_…".to_owned() } else { table.clone() };
        for column in columns {
            // The content of blobs is not checked.
            let sql = format!(
                "SELECT DISTINCT CASE typeof(\"{column}\") WHEN 'blob' THEN 'bytes' ELSE CAST(\"{column}\" AS TEXT) END \
                 FROM \"{table}\""
            );
            let rows = sqlx::query(AssertSqlSafe(sql)).fetch_all(&mut c).await.unwrap();
            let values = found.entry((shown.clone(), column)).or_default();
            values.extend(rows.iter().map(|row| row.get::<Option<String>, _>(0)));
        }
    }
    c.close().await.unwrap();
    found
}

/// The drawn region has no comma and no quote in any cell.
fn csv(found: &mut Found, table: &str, text: &str) {
    let cells = |line: &str| -> Vec<Option<String>> {
        line.split(',')
            .map(|cell| cell.trim_matches('"'))
            .map(|cell| (!cell.is_empty()).then(|| cell.to_owned()))
            .collect()
    };
    let mut lines = text.lines();
    let head: Vec<&str> = lines.next().unwrap().split(',').collect();
    add_table(found, table, &head, lines.map(cells));
}

/// Tables of the script that loads them, and the rows that it loads.
fn pgrouting(found: &mut Found, place: &WorkFolder) {
    let script = String::from_utf8(place.read("pgrouting/load.sql")).unwrap();
    for part in script.split("CREATE TABLE ").skip(1) {
        let (table, rest) = part.split_once(" (").unwrap();
        let body = rest.split_once(");").unwrap().0;
        let columns: Vec<&str> = body.split(",\n").map(|column| column.split_whitespace().next().unwrap()).collect();
        add_table(found, table, &columns, std::iter::empty());
    }
    for line in script.lines().filter_map(|line| line.strip_prefix("\\copy ")) {
        let (into, file) = line.split_once(" FROM '").unwrap();
        let Some((table, columns)) = into.split_once(" (") else { continue };
        let columns: Vec<&str> = columns.trim_end_matches(')').split(", ").collect();
        let text = String::from_utf8(place.read(&format!("pgrouting/{}", file.trim_end_matches('\'')))).unwrap();
        let row = |line: &str| line.split('\t').map(|cell| (cell != "\\N").then(|| cell.to_owned())).collect();
        add_table(found, table, &columns, text.lines().map(row).collect::<Vec<_>>().into_iter());
    }
}

fn everything() -> Found {
    let place = WorkFolder::with_demo();
    for target in ["csv", "geoparquet", "pgrouting"] {
        place.netcert(&format!("export {target} --vehicle {VEHICLE} --out {target}")).succeeds();
    }
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
    let mut found = runtime.block_on(database(&place));
    for table in ["edges", "turns"] {
        csv(&mut found, table, &String::from_utf8(place.read(&format!("csv/{table}.csv"))).unwrap());
        let file = std::fs::File::open(place.path(&format!("geoparquet/{table}.parquet"))).unwrap();
        let reader = SerializedFileReader::new(file).unwrap();
        let schema = reader.metadata().file_metadata().schema();
        let columns: Vec<&str> = schema.get_fields().iter().map(|field| field.name()).collect();
        add_table(&mut found, table, &columns, std::iter::empty());
    }
    for (table, turns) in [("edges", ""), ("turns", " --turns")] {
        let answer = place
            .netcert(&format!("query --vehicle {VEHICLE} --relative-to AU-ATRIPLE53 --format csv{turns}"))
            .succeeds();
        csv(&mut found, table, &answer.out());
    }
    pgrouting(&mut found, &place);
    found
}

#[test]
fn the_page_names_every_column_and_its_ranges_hold() {
    let (rules, found) = (page(), everything());
    let names = |missing: Vec<&Name>| -> Vec<String> { missing.iter().map(|(t, c)| format!("{t}.{c}")).collect() };
    let undocumented: Vec<&Name> = found.keys().filter(|name| !rules.contains_key(*name)).collect();
    assert!(undocumented.is_empty(), "not on the page: {:?}", names(undocumented));
    let gone: Vec<&Name> = rules.keys().filter(|name| !found.contains_key(*name)).collect();
    assert!(gone.is_empty(), "on the page alone: {:?}", names(gone));
    let mut outside = Vec::new();
    let mut checked = 0;
    for (name, values) in &found {
        for value in values {
            checked += 1;
            if !rules[name].allows(value.as_deref()) {
                outside.push(format!("{}.{} = {value:?}, {:?}", name.0, name.1, rules[name]));
            }
        }
    }
    assert!(outside.is_empty(), "out of range:\n{}", outside.join("\n"));
    assert!(checked > 10_000, "{checked} values");
}

/// A column's description in the database, with the values of its constraint: the ends of a range, or words.
#[derive(Debug, Default)]
struct DescribedColumn {
    description: Option<String>,
    ranges: Vec<(f64, bool, f64)>,
    words: BTreeSet<String>,
}

/// The descriptions of all columns that the database has.
async fn descriptions(place: &WorkFolder) -> BTreeMap<Name, DescribedColumn> {
    let mut c = SqliteConnection::connect(place.path("demo.gpkg").to_str().unwrap()).await.unwrap();
    let sql = "SELECT table_name, column_name, d.description, value, CAST(min AS REAL), min_is_inclusive, CAST(max AS REAL) \
               FROM gpkg_data_columns AS d LEFT JOIN gpkg_data_column_constraints USING (constraint_name)";
    let mut all = BTreeMap::<Name, DescribedColumn>::new();
    for row in sqlx::query(sql).fetch_all(&mut c).await.unwrap() {
        let table: String = row.get(0);
        let shown = if table.starts_with("permit_") { "permit_…".to_owned() } else { table };
        let column = all.entry((shown, row.get(1))).or_default();
        column.description = row.get(2);
        column.words.extend(row.get::<Option<String>, _>(3));
        let ends = row.get::<Option<f64>, _>(4).zip(row.get::<Option<f64>, _>(6));
        column.ranges.extend(ends.map(|(low, high)| (low, row.get::<bool, _>(5), high)));
    }
    c.close().await.unwrap();
    all
}

/// The extension gpkg_schema of the database says what the page says.
#[test]
fn descriptions_in_the_database_are_those_of_the_page() {
    let place = WorkFolder::with_demo();
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
    let (rules, found) = (page(), runtime.block_on(descriptions(&place)));
    let tables: BTreeSet<&str> = found.keys().map(|name| name.0.as_str()).collect();
    let listed = [
        "account",
        "certificate",
        "edge",
        "junction",
        "permit",
        "permit_…",
        "run",
        "turn",
        "turn_certificate",
        "vehicle",
    ];
    assert_eq!(tables, BTreeSet::from(listed));
    let mut ranges = 0;
    for (name, rule) in rules.iter().filter(|(name, _)| tables.contains(name.0.as_str())) {
        let none = DescribedColumn::default();
        let described = found.get(name).unwrap_or(&none);
        match &rule.range {
            &Range::Number { low, above, high, .. } if low.is_finite() => {
                ranges += 1;
                // Every layer of permits has the same.
                assert!(!described.ranges.is_empty(), "{name:?}: {described:?}");
                assert!(described.ranges.iter().all(|range| *range == (low, !above, high)), "{name:?}: {described:?}");
            }
            Range::Words(words) => assert_eq!(described.words, words.iter().cloned().collect(), "{name:?}"),
            _ => assert!(described.ranges.is_empty() && described.words.is_empty(), "{name:?}: {described:?}"),
        }
        // The unit is the third cell of the page.
        if name.1.ends_with("_m") {
            let words = described.description.as_deref().unwrap_or_default();
            assert!(words.ends_with("Unit: m"), "{name:?}: {words}");
        }
    }
    assert!(ranges > 60, "{ranges}");
}

#[test]
fn a_range_lets_nothing_else_pass() {
    for (range, yes, no) in [
        ("whole ≥ 1", &["1", "9223372036854775807"][..], &["0", "1.5", "one", "NULL"][..]),
        ("> 0, or none", &["0.1", "NULL"], &["0", "-1"]),
        ("-180 to 180", &["-180", "0.5"], &["180.1", "NULL"]),
        ("`left`, `right`", &["left"], &["up", "", "NULL"]),
        ("yes or no", &["0", "true"], &["2", "yes"]),
        ("time", &["2026-11-21T08:00:00.000Z"], &["2026-11-21 08:00:00"]),
        ("hash, or none", &["NULL"], &["abc"]),
        ("JSON", &["{}"], &["{"]),
    ] {
        let rule = Rule::of(range);
        let allows = |value: &&str| rule.allows((*value != "NULL").then_some(*value));
        assert!(yes.iter().all(allows) && !no.iter().any(allows), "{range}");
    }
}
