//! Overture as a source: segments and connectors of the transportation theme become the same [`Extract`] as an OpenStreetMap file.
//!
//! Connectors are read first, then segments, row group by row group on all threads. The result depends neither on the number of threads
//! nor on names and order of the files. Rules become the facts that tags become (`rules/`). A damaged file is an error, never a shorter
//! result.

#[cfg(test)]
use netcert_base::{vehicle, verdict};
use netcert_files::{folders, outside};
use netcert_osm::{osm, shape};
use netcert_rows as rows;

mod account;
mod connectors;
mod error;
mod files;
mod gather;
mod geojson;
mod geometry;
mod ids;
mod line;
mod parquet;
mod record;
mod rules;
mod segment;
mod turns;

use std::path::Path;

pub use account::Account;
pub use error::{FilePosition, OvertureError, OvertureProblem};
pub use files::{hash, is_source};

use crate::osm::Extract;
use crate::rows::SegmentRow;
use connectors::Connectors;
use files::Format;
use geojson::{DrawnFile, FeatureKind};
use ids::FeatureKey;
use parquet::{Kind, ParquetTable};
use segment::{RoadSegment, SegmentFeature};

/// What was read.
#[derive(Debug)]
pub struct Read {
    /// Roads. Of its own account only hash and box are filled.
    pub extract: Extract,
    /// What became of everything read.
    pub account: Account,
    /// The segment of each way, by way.
    pub segments: Vec<SegmentRow>,
}

/// Reads files of segments and of connectors, or folders of them. `progress` gets the name of each stage.
///
/// # Errors
/// [`OvertureError`] if a file is damaged, has another schema, or connectors or segments are missing.
pub fn read(inputs: &[&Path], progress: &dyn Fn(&'static str)) -> Result<Read, OvertureError> {
    let first = inputs.first().copied().unwrap_or(Path::new(""));
    let (files, hash) = files::find(inputs)?;
    let mut tables = Vec::new();
    for (path, _) in files.iter().filter(|(_, format)| *format == Format::Parquet) {
        tables.push(ParquetTable::open(path)?);
    }
    let drawn = files.iter().filter(|(_, format)| *format != Format::Parquet).map(|(path, format)| {
        let sequence = *format == Format::GeoJsonSequence;
        DrawnFile { path: path.clone(), sequence }
    });
    let drawn: Vec<DrawnFile> = drawn.collect();

    progress("connectors");
    let connectors = read_connectors(&tables, &drawn, first)?;
    progress("segments");
    let mut account = Account::default();
    let roads = read_roads(&tables, &drawn, &connectors, &mut account)?;

    let (mut extract, segments) = gather::extract(roads, &connectors, &mut account, first)?;
    extract.account.blake3 = hash;
    // Segments of a download by box reach beyond it, and their connectors there are missing. The box is then where the data end.
    if account.has_noted(account::CONNECTOR, "missing") {
        let nanodegrees = |bounds: [i32; 4]| bounds.map(|side| i64::from(side) * 100);
        extract.account.header.bbox_nanodegrees = connectors.bounds().map(nanodegrees);
    }
    Ok(Read { extract, account, segments })
}

/// The connectors of all files. Fails if there are no connectors or no segments, of which `first` is told.
fn read_connectors(
    tables: &[ParquetTable<'_>],
    drawn: &[DrawnFile],
    first: &Path,
) -> Result<Connectors, OvertureError> {
    let mut connectors = Connectors::default();
    let (mut of_connectors, mut of_segments) = (false, false);
    for table in tables.iter().filter(|table| table.kind == Kind::Connectors) {
        of_connectors = true;
        let groups = table.each(|some, record| {
            let place = geometry::point(&record.geometry).map_err(|problem| (Some(record.id.clone()), problem))?;
            some.push((FeatureKey::connector(&record.id), place));
            Ok(())
        })?;
        groups.into_iter().for_each(|some| connectors.add(some));
    }
    for file in drawn {
        geojson::each(file, &mut |feature| {
            match feature.kind().map_err(|problem| (feature.id().ok(), problem))? {
                FeatureKind::Connector => of_connectors = true,
                FeatureKind::Segment => {
                    of_segments = true;
                    return Ok(());
                }
            }
            let (id, place) = id_and(feature, |feature| geometry::of_json(&feature.geometry, "Point"))?;
            connectors.add(place.first().map(|place| (FeatureKey::connector(&id), *place)).into_iter().collect());
            Ok(())
        })?;
    }
    of_segments |= tables.iter().any(|table| table.kind == Kind::Segments);
    for (there, problem) in [(of_segments, OvertureProblem::NoSegments), (of_connectors, OvertureProblem::NoConnectors)]
    {
        if !there {
            return Err(OvertureError::of_file(first, problem));
        }
    }
    Ok(connectors)
}

/// The roads of all segments. What becomes of each segment is added to the account.
fn read_roads(
    tables: &[ParquetTable<'_>],
    drawn: &[DrawnFile],
    connectors: &Connectors,
    account: &mut Account,
) -> Result<Vec<RoadSegment>, OvertureError> {
    let mut roads = Vec::new();
    for table in tables.iter().filter(|table| table.kind == Kind::Segments) {
        let groups = table.each(|some: &mut Vec<(Option<RoadSegment>, Account)>, record| {
            let id = record.id.clone();
            let road = || {
                let segment = record::Segment::read(record.columns)?;
                let places = geometry::line(&record.geometry)?;
                made(SegmentFeature { id: record.id, places, segment }, connectors)
            };
            some.push(road().map_err(|problem| (Some(id), problem))?);
            Ok(())
        })?;
        for (road, of_road) in groups.into_iter().flatten() {
            roads.extend(road);
            account.add(&of_road);
        }
    }
    for file in drawn {
        geojson::each(file, &mut |feature| {
            if feature.kind().map_err(|problem| (feature.id().ok(), problem))? != FeatureKind::Segment {
                return Ok(());
            }
            let (id, (places, segment)) = id_and(feature, |feature| {
                let places = geometry::of_json(&feature.geometry, "LineString")?;
                Ok((places, record::Segment::read(std::mem::take(&mut feature.properties))?))
            })?;
            let (road, of_road) = made(SegmentFeature { id: id.clone(), places, segment }, connectors)
                .map_err(|problem| (Some(id), problem))?;
            roads.extend(road);
            account.add(&of_road);
            Ok(())
        })?;
    }
    Ok(roads)
}

fn made(feature: SegmentFeature, connectors: &Connectors) -> Result<(Option<RoadSegment>, Account), OvertureProblem> {
    let mut account = Account::default();
    Ok((RoadSegment::of(feature, connectors, &mut account)?, account))
}

/// The id of a feature, and what `read` makes of it.
fn id_and<T>(
    mut feature: geojson::Feature,
    read: impl FnOnce(&mut geojson::Feature) -> Result<T, OvertureProblem>,
) -> Result<(String, T), (Option<String>, OvertureProblem)> {
    let id = feature.id().map_err(|problem| (None, problem))?;
    match read(&mut feature) {
        Ok(value) => Ok((id, value)),
        Err(problem) => Err((Some(id), problem)),
    }
}
