//! Shows the progress of a run on standard error. On a terminal each stage has a bar. At the end each stage has a line with
//! time, items and rate, followed by the items that were left out, with reasons.

use std::io;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};
use netcert::account::AccountRow;
use netcert::pipeline::Summary;
use netcert::reporter::Reporter;

use super::output::{grouped, tell};
use super::table::Table;

/// The output for people. Bars are hidden if standard error is no terminal.
pub(crate) struct Progress {
    quiet: bool,
    bar: Mutex<Option<ProgressBar>>,
}

impl Progress {
    pub(crate) fn new(quiet: bool) -> Self {
        Self { quiet, bar: Mutex::default() }
    }

    /// Prints a line, unless `--quiet` is given.
    pub(crate) fn say(&self, text: &str) {
        if self.quiet {
            return;
        }
        match &*self.bar.lock().unwrap_or_else(PoisonError::into_inner) {
            Some(bar) => bar.suspend(|| tell(text)),
            None => tell(text),
        }
    }

    /// Prints the summary at the end of a run.
    pub(crate) fn summary(&self, summary: &Summary) {
        if self.quiet {
            return;
        }
        let mut table = Table::new(&["stage", ">time", ">items", "", ">rate"]);
        for stage in &summary.stages {
            let rate = if stage.seconds > 0.0 { stage.items as f64 / stage.seconds } else { 0.0 };
            table.row([
                stage.stage.to_owned(),
                format!("{:.2} s", stage.seconds),
                grouped(stage.items),
                stage.what.to_owned(),
                format!("{}/s", grouped(rate as u64)),
            ]);
        }
        // A failed write to standard error is ignored, as in `tell`.
        let _ = table.write(&mut io::stderr().lock(), "  ");
        for line in refusals(&summary.account) {
            tell(&format!("  {line}"));
        }
    }
}

/// One line for each kind of item, such as `read: 12 of 340 ways left out: construction 7, no_nodes 5`.
pub(crate) fn refusals(account: &[AccountRow]) -> Vec<String> {
    let same = |a: &AccountRow, b: &AccountRow| a.stage == b.stage && a.item == b.item;
    let totals = account.iter().filter(|row| row.outcome == "read");
    let line = |total: &AccountRow| {
        let mut left: Vec<_> = account.iter().filter(|row| same(row, total) && row.outcome == "left_out").collect();
        left.sort_by(|a, b| (b.count, &a.reason).cmp(&(a.count, &b.reason)));
        let sum: u64 = left.iter().map(|row| row.count).sum();
        let why: Vec<_> = left.iter().map(|row| format!("{} {}", row.reason, grouped(row.count))).collect();
        let AccountRow { stage, item, count, .. } = total;
        (sum > 0)
            .then(|| format!("{stage}: {} of {} {item}s left out: {}", grouped(sum), grouped(*count), why.join(", ")))
    };
    totals.filter_map(line).collect()
}

impl Reporter for Progress {
    fn begin(&self, stage: &'static str, total: u64) {
        let bar = if self.quiet {
            ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::hidden())
        } else if total == 0 {
            ProgressBar::new_spinner()
        } else {
            ProgressBar::new(total)
        };
        let template = match (total, stage) {
            (0, _) => "{prefix:>12} {spinner} {elapsed}",
            (_, "certificates") => "{prefix:>12} [{bar:30}] {human_pos}/{human_len} edges, {eta} left",
            (_, "turns" | "edges" | "survey") => "{prefix:>12} [{bar:30}] {human_pos}/{human_len}, {eta} left",
            _ => "{prefix:>12} [{bar:30}] {bytes}/{total_bytes}, {eta} left",
        };
        let style = ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
        bar.set_style(style.progress_chars("=> "));
        bar.set_prefix(stage);
        bar.enable_steady_tick(Duration::from_millis(200));
        let mut slot = self.bar.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(before) = slot.replace(bar) {
            before.finish_and_clear();
        }
    }

    fn advance(&self, done: u64) {
        if let Some(bar) = &*self.bar.lock().unwrap_or_else(PoisonError::into_inner) {
            bar.set_position(done);
        }
    }

    fn end(&self) {
        if let Some(bar) = self.bar.lock().unwrap_or_else(PoisonError::into_inner).take() {
            bar.finish_and_clear();
        }
    }

    fn note(&self, text: &str) {
        self.say(&format!("note: {text}"));
    }
}

/// A duration in words for people.
pub(crate) fn human(seconds: f64) -> String {
    if seconds < 60.0 { format!("{seconds:.1} s") } else { HumanDuration(Duration::from_secs_f64(seconds)).to_string() }
}
