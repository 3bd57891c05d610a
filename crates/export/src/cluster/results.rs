//! The results of tasks: every Parquet file below a folder.
//!
//! | column | what |
//! | --- | --- |
//! | `task`, `stage` | the task's number; `strokes` or `turns` |
//! | `job` | for which vehicles, and how: the same text in every row |
//! | `work` | the certificates, or no value if the task failed |
//! | `error` | why the task failed |

use std::fs::File;
use std::path::{Path, PathBuf};

use parquet::file::reader::SerializedFileReader;
use parquet::record::reader::RowIter;
use parquet::record::{Field, Row};

use super::FolderError;
use crate::folders::files_below;
use crate::pipeline::TaskResult;
use crate::store::CheckpointStage;

/// The results in a folder, file by file.
pub struct Results {
    files: std::vec::IntoIter<PathBuf>,
    open: Option<(PathBuf, RowIter<'static>)>,
    /// The job of the first row.
    job: Option<String>,
    /// The first row, read before the others to know the job.
    first: Option<TaskResult>,
    /// Tasks that failed, each with its stage and the reason.
    pub failed: Vec<(u32, &'static str, String)>,
}

impl Results {
    /// Opens the results below a folder.
    ///
    /// # Errors
    /// The folder or a file cannot be read, or there is no result.
    pub fn open(folder: &Path) -> Result<Self, FolderError> {
        let mut files = Vec::new();
        if folder.exists() {
            files = parquet_files(folder)?;
        }
        let mut results = Self { files: files.into_iter(), open: None, job: None, first: None, failed: Vec::new() };
        results.first = results.read()?;
        if results.first.is_none() {
            let detail = "no results in this folder; `netcert.spark.certify` writes them".to_owned();
            return Err(FolderError::Damaged { path: folder.to_owned(), detail });
        }
        Ok(results)
    }

    /// The job that the results belong to.
    #[must_use]
    pub fn job(&self) -> &str {
        self.job.as_deref().unwrap_or_default()
    }

    fn read(&mut self) -> Result<Option<TaskResult>, FolderError> {
        loop {
            if let Some((path, rows)) = &mut self.open {
                let damaged = |detail: String, path: &Path| FolderError::Damaged { path: path.to_owned(), detail };
                if let Some(row) = rows.next() {
                    let row = row.map_err(|e| damaged(e.to_string(), path))?;
                    let (result, job, error) = result(&row).map_err(|detail| damaged(detail, path))?;
                    if *self.job.get_or_insert_with(|| job.clone()) != job {
                        let detail = "results of several jobs are in this folder; certify into an empty one";
                        return Err(damaged(detail.to_owned(), path));
                    }
                    if result.work.is_none() {
                        self.failed.push((result.part.1, stage_name(result.part.0), error));
                    }
                    return Ok(Some(result));
                }
            }
            let Some(path) = self.files.next() else { return Ok(None) };
            let file = File::open(&path).map_err(|source| FolderError::Io { path: path.clone(), source })?;
            let reader = SerializedFileReader::new(file)
                .map_err(|e| FolderError::Damaged { path: path.clone(), detail: e.to_string() })?;
            self.open = Some((path, RowIter::from_file_into(Box::new(reader))));
        }
    }
}

impl Iterator for Results {
    type Item = Result<TaskResult, FolderError>;

    fn next(&mut self) -> Option<Self::Item> {
        if let Some(first) = self.first.take() {
            return Some(Ok(first));
        }
        self.read().transpose()
    }
}

fn stage_name(stage: CheckpointStage) -> &'static str {
    match stage {
        CheckpointStage::Strokes => "strokes",
        CheckpointStage::Turns => "turns",
    }
}

/// A row's result, its job, and why it failed.
fn result(row: &Row) -> Result<(TaskResult, String, String), String> {
    let (mut task, mut stage, mut job, mut work, mut error) = (None, None, None, None, String::new());
    for (name, field) in row.get_column_iter() {
        match (name.as_str(), field) {
            ("task", &Field::Int(number)) => task = u32::try_from(number).ok(),
            ("task", &Field::Long(number)) => task = u32::try_from(number).ok(),
            ("stage", Field::Str(name)) => {
                stage = [CheckpointStage::Strokes, CheckpointStage::Turns]
                    .into_iter()
                    .find(|&stage| stage_name(stage) == name);
            }
            ("job", Field::Str(text)) => job = Some(text.clone()),
            ("work", Field::Bytes(bytes)) => work = Some(bytes.data().to_vec()),
            ("error", Field::Str(text)) => error.clone_from(text),
            _ => {}
        }
    }
    let missing = |name: &str| format!("a row has no usable `{name}`; `netcert.spark.certify` writes such tables");
    let part = (stage.ok_or_else(|| missing("stage"))?, task.ok_or_else(|| missing("task"))?);
    Ok((TaskResult { part, work }, job.ok_or_else(|| missing("job"))?, error))
}

/// Parquet files below a folder, sorted. Names that begin with `.` or `_` are an engine's own.
fn parquet_files(folder: &Path) -> Result<Vec<PathBuf>, FolderError> {
    let mut files = files_below(folder, &|name| !name.starts_with(['.', '_']))
        .map_err(|(path, source)| FolderError::Io { path, source })?;
    files.retain(|path| path.extension().is_some_and(|end| end == "parquet"));
    Ok(files)
}
