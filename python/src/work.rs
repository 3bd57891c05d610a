//! Runs long work without the interpreter's lock, so that other Python threads go on and Ctrl-C is heard.
//!
//! The work runs on threads that stay, because the kernel keeps buffers on each. `RAYON_NUM_THREADS` says how many there are.

use std::mem::ManuallyDrop;
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use netcert::stop::Stop;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

/// How often Python is asked for signals while work runs.
const POLL: Duration = Duration::from_millis(50);

/// The threads, and the process that has them. A process that was forked has none of its parent's threads, so it makes its own. The
/// parent's are never dropped: dropping waits for threads that are not there.
static POOL: Mutex<Option<(u32, ManuallyDrop<Arc<ThreadPool>>)>> = Mutex::new(None);

fn pool() -> PyResult<Arc<ThreadPool>> {
    let mut known = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    let process = std::process::id();
    if let Some((owner, pool)) = &*known
        && *owner == process
    {
        return Ok(Arc::clone(pool));
    }
    let made = ThreadPoolBuilder::new().thread_name(|number| format!("netcert-{number}")).build();
    let made = Arc::new(made.map_err(|error| PyRuntimeError::new_err(format!("netcert's threads: {error}")))?);
    *known = Some((process, ManuallyDrop::new(Arc::clone(&made))));
    Ok(made)
}

/// Runs `work` and returns its result. If a signal handler of Python raises, as Ctrl-C does, the work is cancelled and the exception is
/// returned.
pub(crate) fn run<T: Send>(py: Python<'_>, work: impl FnOnce(&Stop) -> T + Send) -> PyResult<T> {
    let pool = pool()?;
    let stop = &Stop::default();
    let (sender, receiver) = sync_channel(1);
    let waited = py.detach(move || {
        pool.in_place_scope(|scope| {
            scope.spawn(move |_| {
                // Nobody listens any more if the call was interrupted.
                let _ = sender.send(work(stop));
            });
            loop {
                match receiver.recv_timeout(POLL) {
                    Ok(result) => return Ok(Some(result)),
                    // The work panicked. Leaving the scope passes the panic on.
                    Err(RecvTimeoutError::Disconnected) => return Ok(None),
                    Err(RecvTimeoutError::Timeout) => {
                        #[allow(clippy::redundant_closure_for_method_calls)] // the method is for one lifetime only
                        let signals = Python::attach(|py| py.check_signals());
                        if let Err(interrupt) = signals {
                            stop.tell();
                            return Err(interrupt);
                        }
                    }
                }
            }
        })
    })?;
    waited.ok_or_else(|| PyRuntimeError::new_err("the work ended without a result"))
}
