//! Reacts to requests to stop: Ctrl-C, and SIGTERM on Unix.

/// Returns when the program is asked to stop. Never returns if the system offers no such signal.
pub(super) async fn stop() {
    let interrupted = async {
        if tokio::signal::ctrl_c().await.is_err() {
            std::future::pending::<()>().await;
        }
    };
    #[cfg(unix)]
    {
        use tokio::signal::unix::{SignalKind, signal};
        if let Ok(mut terminated) = signal(SignalKind::terminate()) {
            tokio::select! {
                () = interrupted => {}
                _ = terminated.recv() => {}
            }
            return;
        }
    }
    interrupted.await;
}

/// When the program is asked to stop, calls `clear` and exits with 130, the status that shells give to Ctrl-C.
pub(super) fn when_stopped(clear: impl FnOnce() + Send + 'static) {
    std::thread::spawn(move || {
        let Ok(runtime) = tokio::runtime::Builder::new_current_thread().enable_all().build() else { return };
        runtime.block_on(stop());
        clear();
        std::process::exit(130);
    });
}
