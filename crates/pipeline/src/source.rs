//! Reads a source, whatever it is: an OpenStreetMap extract, with changes or without, or files of Overture.

use std::path::Path;
use std::sync::{Mutex, PoisonError};

use super::error::RunError;
use super::summary::Summary;
use crate::account::AccountRow;
use crate::osm::changes::Changes;
use crate::osm::pbf::{HeaderInfo, ReadError};
use crate::osm::{self, Extract};
use crate::reporter::Reporter;
use crate::rows::SegmentRow;

/// The member of a run's parameters that says what was read, if it was no extract.
pub(super) const SOURCE: &str = "source";
/// Its value for files of Overture.
pub(super) const OVERTURE: &str = "overture";

/// What a source says of itself.
#[derive(Debug, Clone, Default)]
pub(super) struct SourceDescription {
    pub(super) header: HeaderInfo,
    /// Hash of its content.
    pub(super) blake3: String,
    /// By way: the segment of Overture. `None` for an extract.
    pub(super) segments: Option<Vec<SegmentRow>>,
}

/// Where a map comes from.
#[derive(Clone, Copy)]
pub(super) struct MapSource<'a> {
    /// An extract; or files or folders of Overture.
    pub(super) inputs: &'a [&'a Path],
    /// What is applied to the extract.
    pub(super) changes: &'a Changes,
}

/// What was read of a source.
struct Content {
    extract: Extract,
    account: Vec<AccountRow>,
    /// Number of ways or segments, and their name.
    read: (u64, &'static str),
    /// Those left out, by reason.
    left_out: Vec<(&'static str, u64)>,
    segments: Option<Vec<SegmentRow>>,
}

/// Reads a source and fills the first stage of the summary.
pub(super) fn read(
    source: MapSource<'_>,
    reporter: &dyn Reporter,
    summary: &mut Summary,
) -> Result<(Extract, SourceDescription), RunError> {
    let clock = std::time::Instant::now();
    let MapSource { inputs, changes } = source;
    let Content { extract, account, read, left_out, segments } = match of_overture(inputs, changes, reporter)? {
        Some(content) => content,
        None => of_osm(inputs, changes, reporter)?,
    };
    summary.account.extend(account);
    summary.stage("read", clock, read.0, read.1);
    let origin =
        SourceDescription { header: extract.account.header.clone(), blake3: extract.account.blake3.clone(), segments };
    if extract.ways.is_empty() {
        let left_out = left_out.iter().map(|(why, n)| format!("{why} {n}")).collect::<Vec<_>>().join(", ");
        let account = if left_out.is_empty() { format!("no {} at all", read.1) } else { left_out };
        return Err(RunError::NoRoads { path: inputs.first().copied().unwrap_or(Path::new("")).to_owned(), account });
    }
    Ok((extract, origin))
}

fn of_osm(inputs: &[&Path], changes: &Changes, reporter: &dyn Reporter) -> Result<Content, RunError> {
    let [input] = inputs else {
        let names = inputs.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ");
        return Err(RunError::Misfit(format!(
            "{names}: one extract makes a database; merge several with `osmium merge`. Only Overture's files can be several"
        )));
    };
    let extract = read_reporting(input, changes, reporter)?;
    let read = &extract.account;
    Ok(Content {
        account: read.rows(),
        read: (read.ways_read, "ways"),
        left_out: read.ways_left_out.iter().map(|(why, n)| (*why, *n)).collect(),
        segments: None,
        extract,
    })
}

fn read_reporting(input: &Path, changes: &Changes, reporter: &dyn Reporter) -> Result<Extract, ReadError> {
    let begun = Mutex::new(None);
    let extract = osm::pbf::read_changed_extract(input, changes, &|p| {
        let mut begun = begun.lock().unwrap_or_else(PoisonError::into_inner);
        if *begun != Some(p.stage) {
            reporter.begin(p.stage.name(), p.total);
            *begun = Some(p.stage);
        }
        reporter.advance(p.done);
    });
    reporter.end();
    extract
}

#[cfg(not(feature = "overture"))]
fn of_overture(_: &[&Path], _: &Changes, _: &dyn Reporter) -> Result<Option<Content>, RunError> {
    Ok(None)
}

/// The source if one of the inputs is Overture's.
#[cfg(feature = "overture")]
fn of_overture(inputs: &[&Path], changes: &Changes, reporter: &dyn Reporter) -> Result<Option<Content>, RunError> {
    if !inputs.iter().any(|input| crate::overture::is_source(input)) {
        return Ok(None);
    }
    if !changes.is_empty() {
        return Err(RunError::Misfit(no_changes(inputs[0])));
    }
    let begun = std::cell::Cell::new("");
    let read = crate::overture::read(inputs, &|stage| {
        if begun.replace(stage) != stage {
            reporter.begin(stage, 0);
        }
    });
    reporter.end();
    let crate::overture::Read { extract, account, segments } = read?;
    Ok(Some(Content {
        account: account.rows(),
        read: (account.segments_read(), "segments"),
        left_out: account.segments_left_out().collect(),
        segments: Some(segments),
        extract,
    }))
}

/// Why changes of OpenStreetMap do not fit.
pub(super) fn no_changes(what: &Path) -> String {
    format!(
        "{}: it comes from Overture's files, and changes of OpenStreetMap do not fit them; fetch the newer release and give its folder as \
         --new-extract",
        what.display()
    )
}

/// The name of a source for the `run` record.
pub(super) fn name(inputs: &[&Path]) -> String {
    let name = |path: &&Path| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    inputs.iter().map(name).collect::<Vec<_>>().join(", ")
}

/// Seconds since 1970 as a time stamp, such as `2026-11-21T08:00:00Z`.
pub(super) fn utc(seconds: i64) -> Option<String> {
    jiff::Timestamp::from_second(seconds).ok().map(|t| t.to_string())
}
