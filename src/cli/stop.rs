//! Reacts to requests to stop: Ctrl-C, and SIGTERM on Unix.

use std::sync::mpsc;

/// Returns when the program is asked to stop. Never returns if the system offers no such signal.
pub(super) async fn stop() {
    listen().await;
}

/// Listens for requests to stop from now on, not only once the future is polled. Must be called within a runtime.
#[cfg(unix)]
fn listen() -> impl Future<Output = ()> {
    use tokio::signal::unix::{SignalKind, signal};
    let signals = [SignalKind::interrupt(), SignalKind::terminate()].map(signal);
    async move {
        let [interrupted, terminated] = signals.map(|signal| async {
            match signal {
                Ok(mut signal) => drop(signal.recv().await),
                Err(_) => std::future::pending().await,
            }
        });
        tokio::select! {
            () = interrupted => {}
            () = terminated => {}
        }
    }
}

/// Listens for requests to stop once the future is polled.
#[cfg(not(unix))]
async fn listen() {
    if tokio::signal::ctrl_c().await.is_err() {
        std::future::pending::<()>().await;
    }
}

/// When the program is asked to stop, calls `clear` and exits with 130, the status that shells give to Ctrl-C. Returns once it listens, so
/// that nothing made afterwards is left behind.
pub(super) fn when_stopped(clear: impl FnOnce() + Send + 'static) {
    let (listens, ready) = mpsc::channel();
    std::thread::spawn(move || {
        let Ok(runtime) = tokio::runtime::Builder::new_current_thread().enable_all().build() else { return };
        runtime.block_on(async {
            let stopped = listen();
            let _ = listens.send(());
            stopped.await;
        });
        clear();
        std::process::exit(130);
    });
    // An error means that the thread cannot listen; the run goes on without.
    let _ = ready.recv();
}
