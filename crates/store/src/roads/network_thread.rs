//! The network in a new database: its rows come, then a thread of its own writes them while the caller goes on.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver};

use crate::error::StoreError;
use crate::file::session::Session;
use crate::roads::network_rows::NetworkRows;
use crate::roads::network_write::{self, Written};

/// A new database, as far as it has come.
pub(crate) enum NewNetwork {
    /// Rows of the network still come.
    Gathering(Session, Box<NetworkRows>),
    /// The rows are complete.
    Writing(Writing),
}

impl NewNetwork {
    /// The rows, while they still come.
    pub(crate) fn rows(&mut self) -> io::Result<&mut NetworkRows> {
        match self {
            Self::Gathering(_, rows) => Ok(rows),
            Self::Writing(_) => Err(io::Error::other("the network is complete already")),
        }
    }

    /// Begins to write the rows, if that has not begun. Temporary files are made beside `scratch`.
    pub(crate) fn write(self, scratch: &Path) -> Result<Writing, StoreError> {
        match self {
            Self::Gathering(session, rows) => Writing::begin(session, *rows, scratch),
            Self::Writing(writing) => Ok(writing),
        }
    }

    /// The connection, with what came of the network.
    pub(crate) fn finish(self, scratch: &Path) -> Result<(Session, Written), StoreError> {
        self.write(scratch)?.finish()
    }

    /// The connection. A network that is being written is written to its end.
    pub(crate) fn without_network(self) -> Result<Session, StoreError> {
        match self {
            Self::Gathering(session, _) => Ok(session),
            Self::Writing(writing) => Ok(writing.finish()?.0),
        }
    }
}

/// A thread that writes the network. Dropping this value stops it and waits for it, so that nothing writes into a file that is given up.
pub(crate) struct Writing {
    path: PathBuf,
    stop: Arc<AtomicBool>,
    done: Receiver<Result<(Session, Written), StoreError>>,
}

impl Writing {
    fn begin(mut session: Session, rows: NetworkRows, scratch: &Path) -> Result<Self, StoreError> {
        let (path, stop) = (session.path.clone(), Arc::new(AtomicBool::new(false)));
        let (stopped, scratch) = (Arc::clone(&stop), scratch.to_owned());
        let (send, done) = mpsc::channel();
        let begun = std::thread::Builder::new().name("network".to_owned()).spawn(move || {
            let written = session.fill_until(&stopped, async |to| network_write::write(to, rows, &scratch).await);
            // Nobody receives it if the database was given up.
            let _ = send.send(written.map(|written| (session, written)));
        });
        match begun {
            Ok(_) => Ok(Self { path, stop, done }),
            Err(e) => Err(StoreError::io(&path, e)),
        }
    }

    fn finish(self) -> Result<(Session, Written), StoreError> {
        // Without an answer the thread has panicked.
        self.done.recv().unwrap_or_else(|_| Err(StoreError::sql(&self.path, sqlx::Error::WorkerCrashed)))
    }
}

impl Drop for Writing {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        // It returns when the thread has ended.
        while self.done.recv().is_ok() {}
    }
}
