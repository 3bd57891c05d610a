//! A hash of every table's content. It depends on the rows and the schema alone, not on pages, free space or the order in which rows
//! were written, so `VACUUM` leaves it as it is. `docs/how-to/sign.md` has the form to the byte.
//!
//! Rows are read one by one: memory does not grow with the file.

use std::collections::BTreeMap;

use rusqlite::types::ValueRef;
use rusqlite::{Connection, Result};
use sha2::{Digest as _, Sha256};

/// The name under which the schema's own rows are hashed: views, triggers and indices count, too.
const SCHEMA: &str = "sqlite_schema";

/// SHA-256 of each table, by its name. Without the table `except`, and without tables of SQLite itself, whose rows say nothing of
/// the region. The content of a virtual table is in its shadow tables.
pub(crate) fn of_tables(db: &Connection, except: &str) -> Result<BTreeMap<String, String>> {
    let mut digests = BTreeMap::new();
    let all = "SELECT name FROM pragma_table_list WHERE schema = 'main' AND type IN ('table', 'shadow') \
               AND name NOT LIKE 'sqlite\\_%' ESCAPE '\\' AND name <> ?1";
    let names: Vec<String> = db.prepare(all)?.query_map([except], |row| row.get(0))?.collect::<Result<_>>()?;
    for name in names {
        let (columns, order) = columns(db, &name)?;
        digests.insert(name.clone(), of_rows(db, &name, &columns, &order)?);
    }
    let own = "sqlite_schema WHERE name NOT LIKE 'sqlite\\_%' ESCAPE '\\'";
    let columns = ["type", "name", "tbl_name", "sql"].map(str::to_owned);
    digests.insert(SCHEMA.to_owned(), of_select(db, SCHEMA, own, &columns, &columns[..2])?);
    Ok(digests)
}

/// The stored columns of a table in order, and those of its primary key; all of them if it has none.
fn columns(db: &Connection, table: &str) -> Result<(Vec<String>, Vec<String>)> {
    let sql = "SELECT name, pk FROM pragma_table_xinfo(?1) WHERE hidden = 0 ORDER BY cid";
    let all: Vec<(String, usize)> =
        db.prepare(sql)?.query_map([table], |row| Ok((row.get(0)?, row.get(1)?)))?.collect::<Result<_>>()?;
    let mut key: Vec<&(String, usize)> = all.iter().filter(|(_, pk)| *pk > 0).collect();
    key.sort_by_key(|(_, pk)| *pk);
    let key: Vec<String> = key.into_iter().map(|(name, _)| name.clone()).collect();
    let names: Vec<String> = all.iter().map(|(name, _)| name.clone()).collect();
    let order = if key.is_empty() { names.clone() } else { key };
    Ok((names, order))
}

fn of_rows(db: &Connection, table: &str, columns: &[String], order: &[String]) -> Result<String> {
    of_select(db, table, &quoted(table), columns, order)
}

/// The hash of the rows that `FROM from` gives.
fn of_select(db: &Connection, name: &str, from: &str, columns: &[String], order: &[String]) -> Result<String> {
    let list = |names: &[String]| names.iter().map(|name| quoted(name)).collect::<Vec<_>>().join(", ");
    let mut hasher = Sha256::new();
    text(&mut hasher, b'T', name.as_bytes());
    columns.iter().for_each(|column| text(&mut hasher, b'T', column.as_bytes()));
    let mut select = db.prepare(&format!("SELECT {} FROM {from} ORDER BY {}", list(columns), list(order)))?;
    let mut rows = select.query([])?;
    while let Some(row) = rows.next()? {
        hasher.update(b"R");
        for k in 0..columns.len() {
            value(&mut hasher, row.get_ref(k)?);
        }
    }
    Ok(hasher.finalize().iter().map(|byte| format!("{byte:02x}")).collect())
}

/// One letter for the type, then the value: 8 bytes with the highest first, or a length in that form and the bytes.
fn value(hasher: &mut Sha256, value: ValueRef<'_>) {
    match value {
        ValueRef::Null => hasher.update(b"N"),
        ValueRef::Integer(number) => {
            hasher.update(b"I");
            hasher.update(number.to_be_bytes());
        }
        ValueRef::Real(number) => {
            hasher.update(b"F");
            hasher.update(number.to_be_bytes());
        }
        ValueRef::Text(bytes) => text(hasher, b'T', bytes),
        ValueRef::Blob(bytes) => text(hasher, b'B', bytes),
    }
}

fn text(hasher: &mut Sha256, letter: u8, bytes: &[u8]) {
    hasher.update([letter]);
    hasher.update((bytes.len() as u64).to_be_bytes());
    hasher.update(bytes);
}

fn quoted(name: &str) -> String {
    format!("\"{}\"", name.replace('"', "\"\""))
}
