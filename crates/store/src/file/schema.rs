//! The schema: the files of `migrations/` in order, embedded in the program.

use std::sync::LazyLock;

use sqlx::SqlSafeStr as _;
use sqlx::migrate::{MigrateError, Migration, MigrationType, Migrator};
use sqlx::sqlite::SqliteConnection;

/// Version, description and statements of each migration. `after data` creates the triggers of the spatial index. The triggers
/// call functions that only spatial programs have (`ST_IsEmpty`), so netcert inserts all rows of `edge` before it.
const FILES: &[(i64, &str, &str)] = &[
    (1, "geopackage", include_str!("../../../../migrations/0001_geopackage.sql")),
    (2, "network", include_str!("../../../../migrations/0002_network.sql")),
    (3, "certificates", include_str!("../../../../migrations/0003_certificates.sql")),
    (4, "after data", include_str!("../../../../migrations/0004_after_data.sql")),
    (5, "plans", include_str!("../../../../migrations/0005_plans.sql")),
    (6, "restrictions", include_str!("../../../../migrations/0006_restrictions.sql")),
    (7, "turns", include_str!("../../../../migrations/0007_turns.sql")),
    (8, "turn plans", include_str!("../../../../migrations/0008_turn_plans.sql")),
    (9, "areas", include_str!("../../../../migrations/0009_areas.sql")),
    (10, "evidence", include_str!("../../../../migrations/0010_evidence.sql")),
    (11, "junctions", include_str!("../../../../migrations/0011_junctions.sql")),
    (12, "map changes", include_str!("../../../../migrations/0012_map_changes.sql")),
    (13, "segments", include_str!("../../../../migrations/0013_segments.sql")),
    (14, "backdrop", include_str!("../../../../migrations/0014_backdrop.sql")),
    (15, "signatures", include_str!("../../../../migrations/0015_signatures.sql")),
    (16, "column descriptions", include_str!("../../../../migrations/0016_column_descriptions.sql")),
];

/// The first migration that a database may lack: what is missing then is for other programs only.
const DISPENSABLE_FROM: i64 = 16;

/// Hashes of earlier texts of migrations, as sqlx makes them (SHA-384): the database serves this program as well.
/// 2 of netcert 0.2: no column `supposed_lanes` of `edge`, which no query of the program names.
/// 3 of netcert 0.2: times of runs had the type TEXT.
const EARLIER_TEXTS: &[(i64, &str)] = &[
    (2, "3ec0c4967b59687e6cf821a35d2f1e28a9b81ffcdf2aaa14146d11a46a5f9ff329e299d56199a80d3f56b051e983c988"),
    (3, "024a446caa8ca653238391c071472373aada44000423663e3c4ae907261485b1466b06ab656f44f23f11c4b3d30aed64"),
];

/// What is wrong with the migrations of a database, by version and hash. `None`: this program can use it.
pub(crate) fn fault(applied: &[(i64, Vec<u8>)]) -> Option<String> {
    MIGRATIONS.iter().find_map(|migration| {
        let version = migration.version;
        match applied.iter().find(|row| row.0 == version) {
            Some((_, hash)) if hash[..] == migration.checksum[..] => None,
            Some((_, hash)) => {
                let hash: String = hash.iter().map(|byte| format!("{byte:02x}")).collect();
                (!EARLIER_TEXTS.contains(&(version, &*hash))).then(|| format!("version {version} differs"))
            }
            None => (version < DISPENSABLE_FROM).then(|| format!("version {version} is missing")),
        }
    })
}

/// The table of applied migrations. sqlx uses an existing table. Its own table would have types that GDAL does not know
/// (BIGINT, TIMESTAMP), and GDAL would warn of them at every listing.
const APPLIED: &str = "CREATE TABLE IF NOT EXISTS _sqlx_migrations (
    version INTEGER PRIMARY KEY NOT NULL,
    description TEXT NOT NULL,
    installed_on DATETIME NOT NULL DEFAULT '1970-01-01T00:00:00.000Z',
    success BOOLEAN NOT NULL,
    checksum BLOB NOT NULL,
    execution_time INTEGER NOT NULL
)";

/// The last migration before the bulk of the data.
pub(crate) const BEFORE_DATA: i64 = 3;

/// All migrations of a database of this program.
pub(crate) static MIGRATIONS: LazyLock<Migrator> = LazyLock::new(|| {
    let migration = |&(version, description, statements): &(i64, &'static str, &'static str)| {
        Migration::new(version, description.into(), MigrationType::Simple, statements.into_sql_str(), false)
    };
    Migrator::with_migrations(FILES.iter().map(migration).collect())
});

/// Applies migrations: all of them, or those up to a version. sqlx records in their table when each ran and how long it took, which would make every file different.
/// The table is therefore written again without times, and its old content is erased.
pub(crate) async fn migrate(c: &mut SqliteConnection, up_to: Option<i64>) -> Result<(), sqlx::Error> {
    sqlx::query(APPLIED).execute(&mut *c).await?;
    let done = match up_to {
        Some(version) => MIGRATIONS.run_to(version, &mut *c).await,
        None => MIGRATIONS.run(&mut *c).await,
    };
    done.map_err(|e| match e {
        MigrateError::Execute(e) | MigrateError::ExecuteMigration(e, _) => e,
        other => sqlx::Error::Migrate(Box::new(other)),
    })?;
    sqlx::raw_sql(
        "PRAGMA secure_delete = ON;
         CREATE TEMP TABLE applied AS SELECT version, description, success, checksum FROM main._sqlx_migrations;
         DELETE FROM _sqlx_migrations;
         INSERT INTO _sqlx_migrations SELECT version, description, '1970-01-01T00:00:00.000Z', success, checksum, 0
             FROM temp.applied ORDER BY version;
         DROP TABLE temp.applied;
         PRAGMA secure_delete = OFF;",
    )
    .execute(c)
    .await?;
    Ok(())
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::FILES;

    #[test]
    fn every_file_of_the_folder_is_embedded() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../migrations");
        let mut files: Vec<_> =
            std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        files.sort();
        let named = |(version, description, _): &(i64, &str, &str)| {
            format!("{version:04}_{}.sql", description.replace(' ', "_"))
        };
        assert_eq!(files, FILES.iter().map(named).collect::<Vec<_>>());
    }
}
