//! Reacts to requests to stop: Ctrl-C, and on Unix SIGTERM and the end of the terminal.

use std::sync::{Mutex, Once, PoisonError, mpsc};

use crate::cli::output::tell;

/// Returns when the program is asked to stop. Never returns if the system offers no such signal.
pub(crate) async fn stop() {
    listen().await;
}

/// Listens for requests to stop from now on, not only once the future is polled. Must be called within a runtime.
#[cfg(unix)]
fn listen() -> impl Future<Output = ()> {
    use tokio::signal::unix::{SignalKind, signal};
    let signals = [SignalKind::interrupt(), SignalKind::terminate()].map(|kind| signal(kind).ok());
    let hangup = if hangup_counts() { signal(SignalKind::hangup()).ok() } else { None };
    async move {
        let [interrupt, terminate] = signals;
        let [interrupted, terminated, hung_up] = [interrupt, terminate, hangup].map(|signal| async {
            match signal {
                Some(mut signal) => drop(signal.recv().await),
                None => std::future::pending().await,
            }
        });
        tokio::select! {
            () = interrupted => {}
            () = terminated => {}
            () = hung_up => {}
        }
    }
}

/// Whether the end of the terminal ends the program. `nohup` asks the system to ignore that signal, and listening would undo it. Only Linux
/// tells, as bit 0 of a number in hexadecimal.
#[cfg(unix)]
fn hangup_counts() -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).is_some_and(|mask| mask & 1 == 0)
}

/// Listens for requests to stop once the future is polled.
#[cfg(not(unix))]
async fn listen() {
    if tokio::signal::ctrl_c().await.is_err() {
        std::future::pending::<()>().await;
    }
}

type Clear = Box<dyn FnOnce() + Send>;

/// What is to be cleared, and what to say, when the program is asked to stop.
static ON_STOP: Mutex<(Vec<Clear>, &str)> = Mutex::new((Vec::new(), ""));
static LISTENS: Once = Once::new();

/// When the program is asked to stop, calls `clear` too before it exits. Returns once the program listens, so that nothing made afterwards
/// is left behind.
pub(crate) fn when_stopped(clear: impl FnOnce() + Send + 'static) {
    ON_STOP.lock().unwrap_or_else(PoisonError::into_inner).0.push(Box::new(clear));
    LISTENS.call_once(begin);
}

/// From now on a request to stop ends the program at once, with a line that ends in `then`: what becomes of the work.
pub(crate) fn say_when_stopped(then: &'static str) {
    ON_STOP.lock().unwrap_or_else(PoisonError::into_inner).1 = then;
    LISTENS.call_once(begin);
}

/// Listens on a thread of its own, which exits with 130, the status that shells give to Ctrl-C.
fn begin() {
    let (listens, ready) = mpsc::channel();
    std::thread::spawn(move || {
        let Ok(runtime) = tokio::runtime::Builder::new_current_thread().enable_all().build() else { return };
        runtime.block_on(async {
            let stopped = listen();
            let _ = listens.send(());
            stopped.await;
        });
        let (clear, then) = {
            let mut on_stop = ON_STOP.lock().unwrap_or_else(PoisonError::into_inner);
            (std::mem::take(&mut on_stop.0), on_stop.1)
        };
        clear.into_iter().for_each(|clear| clear());
        tell(&format!("stopped before it finished{then}"));
        std::process::exit(130);
    });
    // An error means that the thread cannot listen; the run goes on without.
    let _ = ready.recv();
}
