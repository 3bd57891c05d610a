//! A guard over pieces of work that take unusually long: a stroke, a turn, a search.
//!
//! [`guarded`] runs a piece of work under a [`Patience`]. Long loops in the work call [`poll`]. When the work has used more processor time
//! than its patience allows, the next poll unwinds to the guard, which returns [`TookTooLong`]. [`standing`] lists the work that has run for
//! long, so that a program can name it. Work that ends in time has the same result as without a guard.
//!
//! A program sets its patience once ([`set_patience`]); the library guards its strokes, turns and searches with [`patience`].
//!
//! Processor time is that of the thread. Where the system does not tell it, the time that passed counts.

use std::cell::{Cell, RefCell};
use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError, Weak};
use std::time::{Duration, Instant};

/// How long a piece of work may take, in processor time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Patience {
    /// From then on [`standing`] lists the work.
    pub name_after: Duration,
    /// From then on [`poll`] ends the work.
    pub end_after: Duration,
}

impl Patience {
    /// For a stroke or turn of a whole region: named after a minute, ended after ten.
    pub const REGION: Self = Self::seconds(60, 600);
    /// For a piece of work that somebody waits for: named after ten seconds, ended after two minutes.
    pub const ANSWER: Self = Self::seconds(10, 120);

    /// Patience in whole seconds.
    #[must_use]
    pub const fn seconds(name_after: u64, end_after: u64) -> Self {
        Self { name_after: Duration::from_secs(name_after), end_after: Duration::from_secs(end_after) }
    }
}

/// The program's patience in milliseconds: named after, ended after.
static PATIENCE_MS: [AtomicU64; 2] = [AtomicU64::new(60_000), AtomicU64::new(600_000)];

/// Sets the patience of this process. Until then it is [`Patience::REGION`].
pub fn set_patience(patience: Patience) {
    for (slot, duration) in PATIENCE_MS.iter().zip([patience.name_after, patience.end_after]) {
        slot.store(u64::try_from(duration.as_millis()).unwrap_or(u64::MAX), Ordering::Relaxed);
    }
}

/// The patience of this process.
#[must_use]
pub fn patience() -> Patience {
    let [name_after, end_after] =
        PATIENCE_MS.each_ref().map(|slot| Duration::from_millis(slot.load(Ordering::Relaxed)));
    Patience { name_after, end_after }
}

/// A piece of work as a person knows it, such as `turn 123 of 4,567 (from edge 99)`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Work {
    /// What it is: `stroke`, `turn`, `route`.
    pub what: &'static str,
    /// Its number, counted from 1, and how many there are; 0 where they are not counted.
    pub number: u64,
    /// See [`Self::number`].
    pub of: u64,
    /// The id of its first edge.
    pub edge: Option<i64>,
}

impl Work {
    /// Work that is not counted.
    #[must_use]
    pub const fn only(what: &'static str) -> Self {
        Self { what, number: 0, of: 0, edge: None }
    }
}

impl fmt::Display for Work {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.what)?;
        if self.of > 0 {
            write!(f, " {} of {}", Grouped(self.number), Grouped(self.of))?;
        }
        self.edge.map_or(Ok(()), |edge| write!(f, " (from edge {edge})"))
    }
}

/// A number with a comma before every third digit.
struct Grouped(u64);

impl fmt::Display for Grouped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0 >= 1000 { write!(f, "{},{:03}", Self(self.0 / 1000), self.0 % 1000) } else { write!(f, "{}", self.0) }
    }
}

/// The error of work that used up its patience.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("took too long")]
pub struct TookTooLong;

/// Work that has run for longer than [`Patience::name_after`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlowWork {
    /// The work.
    pub work: Work,
    /// Its number among all pieces of work of this process: the same in each list.
    pub id: u64,
    /// How long it has run, in processor time.
    pub ran: Duration,
}

/// A running piece of work.
struct Running {
    work: Work,
    id: u64,
    patience: Patience,
    began: Instant,
    clock: Clock,
}

impl Running {
    /// How long it has run, if that is at least `limit`.
    fn ran(&self, limit: Duration) -> Option<Duration> {
        // Work has no more processor time than time has passed. The latter is cheaper to read.
        let passed = self.began.elapsed();
        if passed < limit { None } else { Some(self.clock.ran(passed)).filter(|ran| *ran >= limit) }
    }
}

thread_local! {
    /// What this thread works on, the innermost last.
    static CURRENT: RefCell<Vec<Arc<Running>>> = const { RefCell::new(Vec::new()) };
    /// Polls until the clock is read again.
    static UNREAD: Cell<u32> = const { Cell::new(0) };
    /// How often the clock was read.
    static READ: Cell<u64> = const { Cell::new(0) };
}

static ALL: Mutex<Vec<Weak<Running>>> = Mutex::new(Vec::new());
static IDS: AtomicU64 = AtomicU64::new(0);

/// Polls for each reading of the clock.
const POLLS: u32 = 64;

/// Runs work under a patience.
///
/// # Errors
/// [`TookTooLong`] if a [`poll`] ended the work.
pub fn guarded<T>(work: Work, patience: Patience, run: impl FnOnce() -> T) -> Result<T, TookTooLong> {
    let id = IDS.fetch_add(1, Ordering::Relaxed);
    let running = Arc::new(Running { work, id, patience, began: Instant::now(), clock: Clock::now() });
    {
        let mut all = ALL.lock().unwrap_or_else(PoisonError::into_inner);
        if all.len() == all.capacity() {
            all.retain(|running| running.strong_count() > 0);
        }
        all.push(Arc::downgrade(&running));
    }
    CURRENT.with_borrow_mut(|current| current.push(running));
    // Only a value that nobody uses any more is left broken: that of the ended work.
    let result = catch_unwind(AssertUnwindSafe(run));
    CURRENT.with_borrow_mut(Vec::pop);
    result.or_else(|panic| if panic.is::<TookTooLong>() { Err(TookTooLong) } else { resume_unwind(panic) })
}

/// Ends this thread's work if it has used up its patience. Cheap enough for inner loops.
pub fn poll() {
    let unread = UNREAD.get();
    if unread > 0 {
        UNREAD.set(unread - 1);
    } else {
        UNREAD.set(POLLS - 1);
        read();
    }
}

#[cold]
fn read() {
    READ.set(READ.get() + 1);
    let ends = |running: &Arc<Running>| running.ran(running.patience.end_after).is_some();
    if CURRENT.with_borrow(|current| current.last().is_some_and(ends)) {
        // No panic hook prints this unwinding.
        resume_unwind(Box::new(TookTooLong));
    }
}

/// A measure of the work that this thread has done: about how often it called [`poll`]. It does not depend on the machine's speed.
#[must_use]
pub fn counted() -> u64 {
    READ.get() * u64::from(POLLS)
}

/// The work of all threads that has run for longer than its [`Patience::name_after`], the oldest first.
#[must_use]
pub fn standing() -> Vec<SlowWork> {
    let all = ALL.lock().unwrap_or_else(PoisonError::into_inner);
    let mut long: Vec<SlowWork> = all
        .iter()
        .filter_map(Weak::upgrade)
        .filter_map(|running| {
            let ran = running.ran(running.patience.name_after)?;
            Some(SlowWork { work: running.work, id: running.id, ran })
        })
        .collect();
    long.sort_unstable_by_key(|standing| standing.id);
    long
}

/// The processor time of a thread since a moment, which other threads may read, too.
#[cfg(target_os = "linux")]
struct Clock {
    thread: i32,
    began: Duration,
}

#[cfg(target_os = "linux")]
impl Clock {
    fn now() -> Self {
        let now = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
        let began = Duration::try_from(now).unwrap_or_default();
        Self { thread: rustix::thread::gettid().as_raw_nonzero().get(), began }
    }

    fn ran(&self, passed: Duration) -> Duration {
        // Nanoseconds on a processor come first.
        let text = std::fs::read_to_string(format!("/proc/self/task/{}/schedstat", self.thread)).unwrap_or_default();
        let nanoseconds = text.split(' ').next().and_then(|first| first.parse().ok());
        nanoseconds.map_or(passed, |now| Duration::from_nanos(now).saturating_sub(self.began).min(passed))
    }
}

/// Other systems: the time that passed.
#[cfg(not(target_os = "linux"))]
struct Clock;

#[cfg(not(target_os = "linux"))]
impl Clock {
    fn now() -> Self {
        Self
    }

    fn ran(&self, passed: Duration) -> Duration {
        passed
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    /// Works for some processor time, with polls.
    fn busy(time: Duration) -> u64 {
        let (began, mut sum) = (Instant::now(), 0_u64);
        while began.elapsed() < time {
            for i in 0..1000 {
                sum = std::hint::black_box(sum.wrapping_add(i));
            }
            poll();
        }
        sum
    }

    #[test]
    fn work_in_time_has_its_result_and_endless_work_ends() {
        let patience = Patience { name_after: Duration::from_millis(10), end_after: Duration::from_millis(50) };
        assert_eq!(guarded(Work::only("short"), patience, || 7), Ok(7));
        let endless = Work { what: "turn", number: 123, of: 4567, edge: Some(9) };
        let began = Instant::now();
        assert_eq!(guarded(endless, patience, || busy(Duration::from_secs(60))), Err(TookTooLong));
        assert!(began.elapsed() < Duration::from_secs(30));
        // What comes after is not ended.
        assert!(guarded(Work::only("after"), Patience::ANSWER, || busy(Duration::from_millis(100))).is_ok());
        poll();
    }

    #[test]
    fn inner_work_ends_alone() {
        let short = Patience::seconds(0, 0);
        let outer = guarded(Work::only("outer"), Patience::REGION, || {
            let inner = guarded(Work::only("inner"), short, || busy(Duration::from_secs(60)));
            (inner, 5)
        });
        assert_eq!(outer, Ok((Err(TookTooLong), 5)));
    }

    #[test]
    fn long_work_is_named_from_another_thread() {
        let patience = Patience { name_after: Duration::from_millis(20), end_after: Duration::from_secs(60) };
        let work = Work { what: "turn", number: 123, of: 4567, edge: Some(99) };
        let done = std::sync::atomic::AtomicBool::new(false);
        std::thread::scope(|scope| {
            scope.spawn(|| {
                let still = || {
                    while !done.load(Ordering::Relaxed) {
                        busy(Duration::from_millis(1));
                    }
                };
                guarded(work, patience, still).unwrap();
            });
            let named = || standing().into_iter().find(|standing| standing.work == work);
            let began = Instant::now();
            let mut found = None;
            while found.is_none() && began.elapsed() < Duration::from_secs(30) {
                std::thread::sleep(Duration::from_millis(5));
                found = named();
            }
            done.store(true, Ordering::Relaxed);
            let found = found.unwrap();
            assert!(found.ran >= patience.name_after);
            assert_eq!(found.work.to_string(), "turn 123 of 4,567 (from edge 99)");
        });
        assert!(standing().iter().all(|standing| standing.work != work));
    }

    #[test]
    fn other_panics_go_on() {
        let result =
            catch_unwind(|| guarded(Work::only("wrong"), Patience::REGION, || resume_unwind(Box::new("other"))));
        assert_eq!(*result.unwrap_err().downcast::<&str>().unwrap(), "other");
    }

    #[test]
    fn work_is_counted() {
        let before = counted();
        (0..64 * 100).for_each(|_| poll());
        assert!(counted() - before >= 64 * 99);
    }
}
