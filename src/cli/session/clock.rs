//! The clock behind every time stamp that is written into a file. `SOURCE_DATE_EPOCH`
//! (https://reproducible-builds.org/specs/source-date-epoch/) stops this clock, so that the same input gives the same bytes.

use anyhow::Context as _;
use jiff::Timestamp;

const VARIABLE: &str = "SOURCE_DATE_EPOCH";

#[derive(Clone, Copy)]
pub(crate) struct Clock {
    stopped_at: Option<Timestamp>,
}

impl Clock {
    pub(crate) fn from_environment() -> anyhow::Result<Self> {
        let Some(text) = std::env::var_os(VARIABLE) else { return Ok(Self { stopped_at: None }) };
        let seconds = text.to_str().and_then(|text| text.parse::<i64>().ok());
        let stopped_at = seconds.and_then(|seconds| Timestamp::from_second(seconds).ok());
        let stopped_at = stopped_at
            .with_context(|| format!("{VARIABLE}={}: give whole seconds since 1970, or unset it", text.display()))?;
        Ok(Self { stopped_at: Some(stopped_at) })
    }

    /// The time now in UTC, such as `2026-11-21T08:00:00.000Z`.
    pub(crate) fn now(&self) -> String {
        let now = self.stopped_at.unwrap_or_else(Timestamp::now);
        now.strftime("%Y-%m-%dT%H:%M:%S%.3fZ").to_string()
    }
}
