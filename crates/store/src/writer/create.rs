//! Begins a new database, and reads of the older one what must not be lost.

use std::path::Path;

use sqlx::sqlite::{SqliteConnectOptions, SqliteConnection};

use crate::osm::facts::Policy;
use crate::words::{Named, verdict_words};
use netcert_rows::settings::Settings;

use crate::columns::names::{VERDICTS, corridor_no};
use crate::database::Database;
use crate::error::StoreError;
use crate::file::companions::has_journal;
use crate::file::schema::{BEFORE_DATA, migrate};
use crate::file::session::Session;
use crate::file::unfinished_file::UnfinishedFile;
use crate::register::evidence::Register;
use crate::results::settings;
use crate::results::write_order::CertificateSorter;
use crate::roads::map_changes::MapChanges;
use crate::roads::network_rows::{MapRows, NetworkRows};
use crate::roads::network_thread::NewNetwork;
use crate::writer::Writer;

type Sql<T> = Result<T, sqlx::Error>;

/// Size of a page, bytes. Writing 5 M rows of 56 bytes took 2.69 s, 2.46 s and 2.31 s with pages of 4 (the default), 8 and
/// 16 KiB. Larger pages make the look-up of single edges slower.
const PAGE_BYTES: u32 = 8192;

impl Database {
    /// Begins a new database that will replace an older database at `path`. Refuses to replace a file that netcert did not
    /// make, unless it is empty. All certificates must be made with `settings`, except its policy.
    pub fn create(path: &Path, settings: &Settings) -> Result<Writer, StoreError> {
        let refused = |detail| StoreError::SettingsRefused { path: path.to_owned(), detail };
        let written = settings.written().map_err(refused)?;
        let under = |&policy: &Policy| Settings { policy, ..settings.clone() }.written();
        let by_policy: Vec<String> = Policy::ALL.iter().map(under).collect::<Result<_, _>>().map_err(refused)?;
        let mut older = None;
        if path.exists() && !holds_nothing(path) {
            // Opening also rolls back the changes of a killed `certify`, so that its journal is no longer needed.
            match Self::open_to_change(path) {
                Ok(mut old) => {
                    older = Some(old.register().and_then(|register| Ok((register, old.register_state()?))));
                    old.close()?;
                }
                Err(StoreError::NotSqlite(_) | StoreError::NotNetcert(_)) => {
                    return Err(StoreError::InTheWay(path.to_owned()));
                }
                Err(busy @ StoreError::Busy(_)) => return Err(busy),
                // An old or damaged database of netcert, which the new one replaces.
                Err(other) => older = has_measurements(path).then_some(Err(other)),
            }
        }
        let part = UnfinishedFile::create(path)?;
        let mut session = Session::open(path, &part.options().page_size(PAGE_BYTES))?;
        session.run(async |c| {
            migrate(c, Some(BEFORE_DATA)).await?;
            sqlx::query("BEGIN").execute(&mut *c).await?;
            add_words(c).await?;
            settings::keep(c, &written).await
        })?;
        let at = |e| StoreError::io(path, e);
        Ok(Writer {
            network: NewNetwork::Gathering(session, Box::new(NetworkRows::create(&part.path).map_err(at)?)),
            settings: by_policy,
            vehicles: Vec::new(),
            account: Vec::new(),
            map_rows: MapRows::create(&part.path).map_err(at)?,
            certificates: CertificateSorter::create(&part.path).map_err(at)?,
            turns: None,
            older,
            evidence: Register::default(),
            map_changes: MapChanges::default(),
            segments: Vec::new(),
            part,
        })
    }
}

/// Whether a database that this program cannot use has measurements. In doubt it has none.
fn has_measurements(path: &Path) -> bool {
    let options = SqliteConnectOptions::new().filename(path).read_only(true);
    let count = Session::open(path, &options).and_then(|mut session| {
        session.run(async |c| sqlx::query_scalar::<_, i64>("SELECT count(*) FROM evidence").fetch_one(c).await)
    });
    count.is_ok_and(|count| count > 0)
}

/// Whether a file has no bytes, as `mktemp` makes it, and no journal beside it.
fn holds_nothing(path: &Path) -> bool {
    !has_journal(path) && path.metadata().is_ok_and(|file| file.is_file() && file.len() == 0)
}

/// Inserts the words of verdicts and policies beside their numbers.
async fn add_words(c: &mut SqliteConnection) -> Sql<()> {
    for &(no, verdict) in VERDICTS {
        let (verdict, reason) = verdict_words(verdict);
        let insert = sqlx::query("INSERT INTO verdict VALUES (?, ?, ?)").bind(no).bind(verdict);
        insert.bind((!reason.is_empty()).then_some(reason)).execute(&mut *c).await?;
    }
    for &policy in Policy::ALL {
        let insert = sqlx::query("INSERT INTO corridor VALUES (?, ?)").bind(corridor_no(policy));
        insert.bind(policy.name()).execute(&mut *c).await?;
    }
    Ok(())
}
