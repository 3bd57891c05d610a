//! What the independent checker says of a certificate file.

use std::path::PathBuf;

use netcert::check::{self, Outcome};
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;

use crate::{error, work};

/// A certificate of a million stations has about 700 MB.
const MOST_BYTES: u64 = 1 << 30;

/// Checks a certificate file with code that is independent of the code that made it.
///
/// Raises OSError if the file cannot be read. A file that is no certificate is a report that is not confirmed.
#[pyfunction]
pub(crate) fn verify(py: Python<'_>, path: PathBuf) -> PyResult<Report> {
    let cannot = |e: std::io::Error| error::of_io(&path, "cannot read the certificate", &e);
    let bytes = std::fs::metadata(&path).map_err(cannot)?.len();
    if bytes > MOST_BYTES {
        return Err(PyOSError::new_err(format!("{}: {bytes} bytes are too many for a certificate", path.display())));
    }
    let text = std::fs::read_to_string(&path).map_err(cannot)?;
    Ok(Report(work::run(py, |_| check::certificate(&text))?))
}

/// What the independent checker says of a certificate.
#[pyclass(frozen, module = "netcert")]
pub(crate) struct Report(pub(crate) check::Report);

#[pymethods]
impl Report {
    /// Whether every claim is confirmed.
    #[getter]
    fn confirmed(&self) -> bool {
        self.0.confirmed()
    }

    /// The claims: pairs of a name and "confirmed", "not confirmed" or "malformed".
    #[getter]
    fn claims(&self) -> Vec<(String, &'static str)> {
        let word = |outcome: &Outcome| match outcome {
            Outcome::Confirmed | Outcome::Remarked(_) => "confirmed",
            Outcome::NotConfirmed(_) => "not confirmed",
            Outcome::Malformed(_) => "malformed",
        };
        self.0.claims.iter().map(|(claim, outcome)| (claim.clone(), word(outcome))).collect()
    }

    /// What is wrong with claims that are not confirmed, and remarks, in words.
    #[getter]
    fn findings(&self) -> Vec<String> {
        let found = |(claim, outcome): &(String, Outcome)| match outcome {
            Outcome::Confirmed => Vec::new(),
            Outcome::Remarked(findings) | Outcome::NotConfirmed(findings) => {
                findings.iter().map(|f| format!("{}: {}", f.claim, f.detail)).collect()
            }
            Outcome::Malformed(why) => vec![format!("{claim}: malformed: {why}")],
        };
        self.0.claims.iter().flat_map(found).collect()
    }

    /// Conditions under which the certificate holds. Nothing here says that they hold.
    #[getter]
    fn conditions(&self) -> Vec<String> {
        self.0.conditions.clone()
    }

    /// Members of the file that its format does not have.
    #[getter]
    fn unknown(&self) -> Vec<String> {
        self.0.unknown.clone()
    }

    fn __repr__(&self) -> String {
        let refuted = self.0.claims.iter().filter(|(_, outcome)| !outcome.holds()).count();
        match refuted {
            0 => format!("<Report: {} claims, all confirmed>", self.0.claims.len()),
            _ => format!("<Report: {refuted} of {} claims not confirmed>", self.0.claims.len()),
        }
    }
}
