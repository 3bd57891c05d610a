//! Writes and reads the tables of turn restrictions.

use sqlx::Row as _;
use sqlx::sqlite::SqliteConnection;

use crate::network::{EdgeNo, ForbiddenSequence, PortionRestriction};
use crate::osm::facts::RestrictionKind;

use crate::columns::read::{index, range, rows};
use crate::error::content;
use crate::file::bulk::Bulk;

type Sql<T> = Result<T, sqlx::Error>;

/// A network's restrictions: [`crate::network::Network::restrictions`] and the edges that they refer to.
#[derive(Debug, Clone, Default)]
pub(crate) struct Restrictions {
    pub(crate) all: Vec<ForbiddenSequence>,
    pub(crate) edges: Vec<EdgeNo>,
}

/// Inserts the restrictions in their order in the whole network. Their edges must be in the database already.
pub(crate) async fn insert(c: &mut SqliteConnection, restrictions: &mut [PortionRestriction]) -> Sql<()> {
    restrictions.sort_by(|a, b| (a.rule, &a.edges).cmp(&(b.rule, &b.edges)));
    let mut bulk = Bulk::new("restriction", 6);
    let mut end = 0;
    for (no, PortionRestriction { restriction, edges, .. }) in (1_i64..).zip(restrictions.iter()) {
        bulk.add(no);
        bulk.add(restriction.relation_id);
        bulk.add(restriction.kind.name());
        bulk.add(restriction.conditional);
        bulk.add(end);
        end += edges.len() as i64;
        bulk.add(end);
        bulk.end_row(c).await?;
    }
    bulk.finish(c).await?;
    let mut bulk = Bulk::new("restriction_edge", 2);
    for (position, &edge) in (1_i64..).zip(restrictions.iter().flat_map(|restriction| &restriction.edges)) {
        bulk.add(position);
        bulk.add(i64::from(edge) + 1);
        bulk.end_row(c).await?;
    }
    bulk.finish(c).await
}

/// Replaces all restrictions.
pub(crate) async fn replace(c: &mut SqliteConnection, restrictions: &mut [PortionRestriction]) -> Sql<()> {
    sqlx::query("DELETE FROM restriction_edge").execute(&mut *c).await?;
    sqlx::query("DELETE FROM restriction").execute(&mut *c).await?;
    insert(c, restrictions).await
}

/// Reads the restrictions of a network with this number of edges.
pub(crate) async fn read(c: &mut SqliteConnection, edges: usize) -> Sql<Restrictions> {
    let sql = "SELECT fid FROM restriction_edge ORDER BY position";
    let sequence = rows(c, sql, |row| index(row, 0, edges).map(EdgeNo::new)).await?;
    let sql = "SELECT relation_id, kind, conditional, edge_start, edge_end FROM restriction ORDER BY restriction_no";
    let all = rows(c, sql, |row| {
        let kind: &str = row.try_get(1)?;
        let kind = RestrictionKind::named(kind).ok_or_else(|| content(format!("`{kind}` is no turn restriction")))?;
        let edges = range(row, 3)?;
        if edges.start.saturating_add(2) > edges.end || edges.end as usize > sequence.len() {
            return Err(content("a turn restriction points outside its table"));
        }
        Ok(ForbiddenSequence { relation_id: row.try_get(0)?, kind, conditional: row.try_get(2)?, edges })
    })
    .await?;
    Ok(Restrictions { all, edges: sequence })
}
