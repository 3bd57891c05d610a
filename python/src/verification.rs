//! The independent checker's opinion of a database.

use netcert::verify::{Complaint, Verification as Found};
use netcert::words::Named;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// What the independent checker says of the certificates of a database.
#[pyclass(frozen, module = "netcert")]
pub(crate) struct Verification(pub(crate) Found);

fn words(Complaint { grade, detail }: Complaint) -> String {
    format!("{}: {detail}", grade.word())
}

#[pymethods]
impl Verification {
    /// Whether every claim is confirmed.
    #[getter]
    fn confirmed(&self) -> bool {
        self.0.confirmed()
    }

    /// Numbers of certificates: a dict for each vehicle, corridor policy, kind ("edge" or "turn") and verdict.
    #[getter]
    fn counts<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        let each = self.0.sets.iter().flat_map(|checked| checked.by_verdict().into_iter().map(move |of| (checked, of)));
        each.map(|(checked, (verdict, numbers))| {
            let row = PyDict::new(py);
            row.set_item("vehicle_id", &checked.vehicle_id)?;
            row.set_item("corridor", checked.policy.name())?;
            row.set_item("of", checked.kind.word())?;
            row.set_item("verdict", verdict)?;
            for (name, number) in ["confirmed", "not_confirmed", "malformed"].into_iter().zip(numbers) {
                row.set_item(name, number)?;
            }
            Ok(row)
        })
        .collect()
    }

    /// What is wrong with claims that are not confirmed, in words.
    #[getter]
    fn complaints(&self) -> Vec<String> {
        self.0.complaints().map(words).collect()
    }

    /// What is displayed and is not so, beside claims that are confirmed, in words.
    #[getter]
    fn remarks(&self) -> Vec<String> {
        self.0.remarks().map(words).collect()
    }

    fn __repr__(&self) -> String {
        let claims: usize = self.0.sets.iter().map(|checked| checked.report.rows.len()).sum();
        match self.0.complaints().count() {
            0 => format!("<Verification: {claims} certificates, all confirmed>"),
            refuted => format!("<Verification: {refuted} claims not confirmed, of {claims} certificates>"),
        }
    }
}
