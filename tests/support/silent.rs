//! A progress reporter that prints nothing.

use netcert::reporter::Reporter;

pub(crate) struct Silent;

impl Reporter for Silent {
    fn begin(&self, _: &'static str, _: u64) {}
    fn advance(&self, _: u64) {}
    fn end(&self) {}
    fn note(&self, _: &str) {}
}
