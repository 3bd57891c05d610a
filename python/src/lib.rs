//! The compiled half of the Python package `netcert`: classes over the library's own types.
//!
//! Python code in `python/netcert/` has what needs other Python packages: tables, plots, maps. `python/netcert/_netcert.pyi` has the types.
//!
//! | file | for |
//! | --- | --- |
//! | `work` | long work without the interpreter's lock, which Ctrl-C cancels |
//! | `error` | the library's errors as exceptions, with the same words |
//! | `vehicle` | vehicles and catalogues |
//! | `corridor` | corridors from arrays |
//! | `certificate` | one vehicle on one corridor |
//! | `many` | many vehicles on many corridors, as rows |
//! | `report` | what the independent checker says of a certificate file |
//! | `verification` | what the independent checker says of a database |
//! | `rows` | rows of edges and turns as Arrow |
//! | `region` | a database |
//! | `filters` | which of its rows a table has |
//! | `explanation` | why an edge or turn is safe or unsafe |
//! | `answer` | routes, or what blocks them |
//! | `tasks` | parts of a region on machines of a cluster |

// Python hands arguments over by value.
#![allow(clippy::needless_pass_by_value)]

mod answer;
mod arguments;
mod certificate;
mod corridor;
mod error;
mod explanation;
mod filters;
mod many;
mod region;
mod report;
mod rows;
mod tasks;
mod vehicle;
mod verification;
mod work;

use pyo3::prelude::*;
use serde_json::Value;

/// Compiled classes and functions of netcert.
#[pymodule]
mod _netcert {
    #[pymodule_export]
    use crate::answer::Answer;
    #[pymodule_export]
    use crate::certificate::{Certificate, Limiting, Tube, certify};
    #[pymodule_export]
    use crate::corridor::Corridor;
    #[pymodule_export]
    use crate::explanation::Explanation;
    #[pymodule_export]
    use crate::many::certify_many;
    #[pymodule_export]
    use crate::region::RegionFile;
    #[pymodule_export]
    use crate::report::{Report, verify};
    #[pymodule_export]
    use crate::rows::RowBatches;
    #[pymodule_export]
    use crate::tasks::{certify_strokes, certify_turns, write_job};
    #[pymodule_export]
    use crate::vehicle::{Catalogue, Unit, Vehicle, vehicles};
    #[pymodule_export]
    use crate::verification::Verification;

    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        crate::vehicle::register(module.py())?;
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}

/// A JSON value as Python's dicts, lists, numbers and texts.
fn as_python<'py>(py: Python<'py>, value: &Value) -> PyResult<Bound<'py, PyAny>> {
    py.import("json")?.call_method1("loads", (value.to_string(),))
}
