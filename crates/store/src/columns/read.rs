//! Reads values from the columns of rows.

use std::ops::Range;

use futures_util::TryStreamExt as _;
use sqlx::sqlite::{SqliteConnection, SqliteRow};
use sqlx::{Row as _, Sqlite};

use crate::network::EdgeNo;
use crate::osm::LonLat;
use crate::verdict::Verdict;
use crate::words::Named;
use netcert_roads::turns::TurnNo;

use crate::columns::names::verdict_of;
use crate::error::content;
use crate::file::blob;

type Sql<T> = Result<T, sqlx::Error>;

/// All rows of a statement, each read by `read`.
pub(crate) async fn rows<T>(
    c: &mut SqliteConnection,
    sql: &'static str,
    mut read: impl FnMut(&SqliteRow) -> Sql<T>,
) -> Sql<Vec<T>> {
    let mut all = Vec::new();
    let mut stream = sqlx::query::<Sqlite>(sql).fetch(c);
    while let Some(row) = stream.try_next().await? {
        all.push(read(&row)?);
    }
    Ok(all)
}

/// The range from the number in a column to that in the next.
pub(crate) fn range(row: &SqliteRow, column: usize) -> Sql<Range<u32>> {
    Ok(row.try_get(column)?..row.try_get(column + 1)?)
}

/// The index of a number that counts from 1 in the database. The index must be below `length`.
pub(crate) fn index(row: &SqliteRow, column: usize, length: usize) -> Sql<u32> {
    let number: i64 = row.try_get(column)?;
    let index = number.checked_sub(1).and_then(|index| u32::try_from(index).ok());
    index
        .filter(|&index| (index as usize) < length)
        .ok_or_else(|| content(format!("row {number} is referred to, but missing")))
}

/// The edge that has this `fid`.
pub(crate) fn edge_of(fid: u32) -> EdgeNo {
    EdgeNo::new(fid.saturating_sub(1))
}

/// The turn that has this `fid`.
pub(crate) fn turn_of(fid: u32) -> TurnNo {
    TurnNo::new(fid.saturating_sub(1))
}

/// The value of the word in a column.
pub(crate) fn word<T: Named>(row: &SqliteRow, column: usize) -> Sql<T> {
    let word: &str = row.try_get(column)?;
    T::named(word).ok_or_else(|| content(format!("`{word}` is not a word that netcert writes")))
}

/// The value of the word in a column, or `None` for null.
pub(crate) fn word_or_none<T: Named>(row: &SqliteRow, column: usize) -> Sql<Option<T>> {
    if row.try_get::<Option<&str>, _>(column)?.is_none() { Ok(None) } else { word(row, column).map(Some) }
}

/// The verdict of the number in a column; `of` names the row in errors.
pub(crate) fn verdict(row: &SqliteRow, column: usize, of: impl FnOnce() -> String) -> Sql<Verdict> {
    let number: i64 = row.try_get(column)?;
    verdict_of(number).ok_or_else(|| content(format!("verdict {number} of {}", of())))
}

/// The positions of the geometry in a column; `of` names the row in errors.
pub(crate) fn line(row: &SqliteRow, column: usize, of: impl FnOnce() -> String) -> Sql<Vec<LonLat>> {
    blob::decode(row.try_get(column)?).ok_or_else(|| content(format!("the geometry of {}", of())))
}

/// A column in centimetres, as metres.
pub(crate) fn centimetres(row: &SqliteRow, column: usize) -> Sql<Option<f64>> {
    Ok(row.try_get::<Option<i64>, _>(column)?.map(|cm| cm as f64 / 100.0))
}
