//! Shows the progress of a run on standard error. On a terminal each stage has a bar, elsewhere a line when it begins and one every 30 s.
//! Work that takes unusually long is named. At the end each stage has a line with time, items and rate, followed by the items that were
//! left out, with reasons.

use std::collections::HashMap;
use std::io::{self, IsTerminal as _};
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use anyhow::anyhow;
use indicatif::{ProgressBar, ProgressStyle};
use netcert::account::AccountRow;
use netcert::pipeline::Summary;
use netcert::reporter::Reporter;
use netcert::stop::Stop;
use netcert::watch::{self, Patience};

use crate::cli::output::table::Table;
use crate::cli::output::{grouped, human, tell};
use crate::cli::session::stage::Stage;

/// Seconds between two lines of a stage where no bar can be shown.
const LINE_EVERY: Duration = Duration::from_secs(30);
/// How often the watcher looks.
const LOOK_EVERY: Duration = Duration::from_millis(500);

/// The output for people.
pub(crate) struct Progress {
    quiet: bool,
    shown: Arc<Mutex<Shown>>,
    /// The watcher ends when this is dropped.
    _watched: Sender<()>,
}

/// Work that is told to stop when it takes longer than the program's patience.
struct Bounded {
    what: &'static str,
    stop: Stop,
    began: Instant,
    named: bool,
}

/// What is shown of the stage that runs.
#[derive(Default)]
struct Shown {
    quiet: bool,
    terminal: bool,
    bounded: Vec<Bounded>,
    bar: Option<ProgressBar>,
    stage: Option<Stage>,
}

impl Shown {
    fn say(&self, text: &str) {
        match &self.bar {
            _ if self.quiet => {}
            Some(bar) => bar.suspend(|| tell(text)),
            None => tell(text),
        }
    }

    /// Names work that takes long, and tells it to stop when the patience is used up.
    fn look_at_bounded(&mut self) {
        let Patience { name_after, end_after } = watch::patience();
        let mut bounded = std::mem::take(&mut self.bounded);
        for work in &mut bounded {
            let ran = work.began.elapsed();
            if ran >= name_after && !std::mem::replace(&mut work.named, true) {
                self.say(&format!("still at the {}, after {}", work.what, human(ran.as_secs_f64())));
            }
            if ran >= end_after {
                work.stop.tell();
            }
        }
        self.bounded = bounded;
    }

    fn begin(&mut self, stage: &'static str, total: u64) {
        if !self.terminal {
            let stage = Stage::begin(stage, total, Instant::now());
            tell(&stage.first_line());
            self.stage = Some(stage);
            return;
        }
        let bar = if total == 0 { ProgressBar::new_spinner() } else { ProgressBar::new(total) };
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
        if let Some(before) = self.bar.replace(bar) {
            before.finish_and_clear();
        }
    }
}

fn locked(shown: &Mutex<Shown>) -> MutexGuard<'_, Shown> {
    shown.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Prints the lines of stages and names long work, until the other end of the channel is gone.
fn watch(shown: &Mutex<Shown>, ended: &mpsc::Receiver<()>) {
    // Work that is named already, with the time after which it is named again.
    let mut named: HashMap<u64, Duration> = HashMap::new();
    while ended.recv_timeout(LOOK_EVERY) == Err(RecvTimeoutError::Timeout) {
        let standing = watch::standing();
        named.retain(|id, _| standing.iter().any(|standing| standing.id == *id));
        let mut shown = locked(shown);
        for standing in standing {
            let again = named.entry(standing.id).or_insert(standing.ran);
            if standing.ran >= *again {
                *again = standing.ran * 2;
                shown.say(&format!("still at {}, after {}", standing.work, human(standing.ran.as_secs_f64())));
            }
        }
        shown.look_at_bounded();
        if let Some(line) = shown.stage.as_mut().and_then(|stage| stage.line(Instant::now(), LINE_EVERY)) {
            tell(&line);
        }
    }
}

impl Progress {
    pub(crate) fn new(quiet: bool) -> Self {
        let terminal = io::stderr().is_terminal();
        let shown = Arc::new(Mutex::new(Shown { quiet, terminal, ..Shown::default() }));
        let (sender, ended) = mpsc::channel();
        let watched = Arc::clone(&shown);
        std::thread::spawn(move || watch(&watched, &ended));
        Self { quiet, shown, _watched: sender }
    }

    /// Prints a line, unless `--quiet` is given.
    pub(crate) fn say(&self, text: &str) {
        locked(&self.shown).say(text);
    }

    /// Runs work that somebody waits for. When it takes longer than the program's patience it is told to stop, and the error says so.
    pub(crate) fn in_time<T>(
        &self,
        what: &'static str,
        work: impl FnOnce(&Stop) -> anyhow::Result<T>,
    ) -> anyhow::Result<T> {
        let stop = Stop::default();
        let bounded = Bounded { what, stop: stop.clone(), began: Instant::now(), named: false };
        locked(&self.shown).bounded.push(bounded);
        let result = work(&stop);
        locked(&self.shown).bounded.pop();
        result.map_err(|error| {
            let seconds = watch::patience().end_after.as_secs();
            if stop.told() {
                anyhow!(
                    "the {what} took longer than {seconds} s and was ended; `--patience SECONDS` gives it more time"
                )
            } else {
                error
            }
        })
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
        if !self.quiet {
            locked(&self.shown).begin(stage, total);
        }
    }

    fn advance(&self, done: u64) {
        let mut shown = locked(&self.shown);
        if let Some(bar) = &shown.bar {
            bar.set_position(done);
        }
        if let Some(stage) = &mut shown.stage {
            stage.advance(done);
        }
    }

    fn end(&self) {
        let mut shown = locked(&self.shown);
        shown.stage = None;
        if let Some(bar) = shown.bar.take() {
            bar.finish_and_clear();
        }
    }

    fn note(&self, text: &str) {
        self.say(&format!("note: {text}"));
    }
}
