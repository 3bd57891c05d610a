//! The lines of a stage where no bar can be shown: files, pipes, logs of other machines.

use std::time::{Duration, Instant};

use indicatif::HumanBytes;

use crate::cli::output::{grouped, human};

/// A stage that runs.
pub(crate) struct Stage {
    name: &'static str,
    /// Items in all, or 0 if unknown.
    total: u64,
    done: u64,
    began: Instant,
    said: Instant,
}

impl Stage {
    pub(crate) fn begin(name: &'static str, total: u64, now: Instant) -> Self {
        Self { name, total, done: 0, began: now, said: now }
    }

    pub(crate) fn advance(&mut self, done: u64) {
        self.done = done.min(self.total);
    }

    /// The line when it begins, such as `certificates: 12,345 edges`.
    pub(crate) fn first_line(&self) -> String {
        if self.total == 0 {
            format!("{} …", self.name)
        } else {
            format!("{}: {} …", self.name, self.items(self.total))
        }
    }

    /// The next line, if the last one was printed at least `every` ago: what is done, its share, and the time left at this pace.
    pub(crate) fn line(&mut self, now: Instant, every: Duration) -> Option<String> {
        if now.saturating_duration_since(self.said) < every {
            return None;
        }
        self.said = now;
        let passed_s = now.saturating_duration_since(self.began).as_secs_f64();
        let so_far = human(passed_s);
        if self.total == 0 {
            return Some(format!("{}: {so_far} so far", self.name));
        }
        let share = self.done as f64 / self.total as f64;
        let left = if self.done == 0 {
            "time left not known yet".to_owned()
        } else {
            format!("{} left", human(passed_s / share - passed_s))
        };
        let (done, total) = (self.items(self.done), self.items(self.total));
        Some(format!("{}: {done} of {total}, {:.0} %, {so_far} so far, {left}", self.name, (100.0 * share).floor()))
    }

    fn items(&self, number: u64) -> String {
        match self.name {
            "certificates" | "edges" | "tasks" => format!("{} edges", grouped(number)),
            "turns" | "survey" | "features" | "ways" => grouped(number),
            _ => HumanBytes(number).to_string(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stage_has_a_line_every_while() {
        let every = Duration::from_secs(30);
        let began = Instant::now();
        let at = |seconds: u64| began + Duration::from_secs(seconds);
        let mut stage = Stage::begin("certificates", 12_345, began);
        assert_eq!(stage.first_line(), "certificates: 12,345 edges …");
        assert_eq!(stage.line(at(29), every), None);
        let nothing = stage.line(at(30), every);
        assert_eq!(
            nothing.as_deref(),
            Some("certificates: 0 edges of 12,345 edges, 0 %, 30.0 s so far, time left not known yet")
        );
        stage.advance(2469);
        assert_eq!(stage.line(at(59), every), None);
        let line = stage.line(at(60), every);
        assert_eq!(
            line.as_deref(),
            Some("certificates: 2,469 edges of 12,345 edges, 20 %, 60 seconds so far, 4 minutes left")
        );
    }

    #[test]
    fn bytes_and_stages_of_unknown_length_have_lines_of_their_own() {
        let began = Instant::now();
        let later = began + Duration::from_secs(45);
        let mut read = Stage::begin("read", 3 << 20, began);
        assert_eq!(read.first_line(), "read: 3.00 MiB …");
        read.advance(9 << 20);
        assert_eq!(
            read.line(later, Duration::ZERO).as_deref(),
            Some("read: 3.00 MiB of 3.00 MiB, 100 %, 45.0 s so far, 0.0 s left")
        );
        let mut network = Stage::begin("network", 0, began);
        assert_eq!(network.first_line(), "network …");
        assert_eq!(network.line(later, Duration::ZERO).as_deref(), Some("network: 45.0 s so far"));
    }
}
