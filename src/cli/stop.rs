//! Being asked to stop: Ctrl-C, or a polite kill.

/// Returns when that happens. Where signals cannot be heard, never.
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

/// Calls this when it happens, and ends the program with the number that shells give to Ctrl-C.
pub(super) fn when_stopped(clear: impl FnOnce() + Send + 'static) {
    std::thread::spawn(move || {
        let Ok(runtime) = tokio::runtime::Builder::new_current_thread().enable_all().build() else { return };
        runtime.block_on(stop());
        clear();
        std::process::exit(130);
    });
}
