//! Listens, accepts connections and stops. The number of connections, their duration and the size of their headers are
//! bounded.
//!
//! When the server stops, it accepts no more connections. Requests in progress get their answer if it is ready within the
//! bound on time; then the other connections are cut.

use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::pin::pin;
use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::net::{TcpListener, TcpStream};
use tokio::runtime::Runtime;
use tokio::sync::{Semaphore, watch};
use tokio::task::JoinSet;

use super::app::App;
use super::older::{OlderState, common};
use super::options::{Editing, Limits, ServerOptions};
use super::region::{Identity, RegionState};
use super::routes;
use super::state::ServedState;
use crate::store::StoreError;
use crate::words::Named as _;

/// The greatest size of request line and headers, bytes. A larger request is answered with 431.
const MOST_HEAD_BYTES: usize = 16 << 10;
/// The pause after an error of `accept`, such as no file handle left. Meanwhile some connections end.
const PAUSE: Duration = Duration::from_millis(100);
/// The delay before the rest is loaded, for other vehicles and the search. By then the first map is likely to be shown.
const WARM_UP_AFTER: Duration = Duration::from_secs(1);

/// Why the server cannot start.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ServeError {
    /// The database cannot be opened.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The older database is the served one.
    #[error(
        "{0}: --before names the database that is served; name an older one, such as a copy made before `netcert update`"
    )]
    SameFile(PathBuf),
    /// No vehicle is certified under the same policy in both databases.
    #[error(
        "no vehicle is certified under the same corridor in both databases, so there is nothing to compare; {}; {}; \
         `netcert certify --db FILE --vehicle ID` adds one", .0[0], .0[1]
    )]
    NothingInCommon(Box<[String; 2]>),
    /// Other machines could reach the address, and that was not allowed.
    #[error(
        "{0}: other machines could reach this address, and the server has no log-in and no encryption; add \
         --allow-remote to listen there anyway"
    )]
    Remote(SocketAddr),
    /// Other machines could reach the address and change the database.
    #[error(
        "--edit: with --allow-remote other machines could change the database; --edit-token FILE names the token that they \
         must send"
    )]
    RemoteEditing,
    /// The database is to be changed, and this user may not write to it.
    #[error("{db}: it cannot be written, so --edit can change nothing there: {source}")]
    ReadOnly {
        /// The database.
        db: PathBuf,
        /// The system's error.
        source: std::io::Error,
    },
    /// The port is taken, or this user may not listen on it.
    #[error("{addr}: cannot listen: {source}; --addr 127.0.0.1:0 picks a free port")]
    Listen {
        /// The requested address.
        addr: SocketAddr,
        /// The system's error.
        source: std::io::Error,
    },
    /// The system refused something else.
    #[error("cannot serve: {0}")]
    System(#[from] std::io::Error),
}

/// A server that is listening.
pub struct Server {
    runtime: Runtime,
    listener: TcpListener,
    address: SocketAddr,
    router: Router,
    limits: Limits,
    app: Arc<App>,
}

impl Server {
    /// Opens the database and the port.
    ///
    /// # Errors
    /// A database or the port cannot be opened. The older database is the served one, or has no vehicle in common with it. The address
    /// is not loopback and `allow_remote` is false. Changes are allowed to everybody, or cannot be written.
    pub fn bind(mut options: ServerOptions) -> Result<Self, ServeError> {
        if !options.addr.ip().is_loopback() && !options.allow_remote {
            return Err(ServeError::Remote(options.addr));
        }
        if options.editing == Editing::Local && options.allow_remote {
            return Err(ServeError::RemoteEditing);
        }
        if options.editing != Editing::Off {
            let writable = std::fs::OpenOptions::new().append(true).open(&options.db).map(drop);
            writable.map_err(|source| ServeError::ReadOnly { db: options.db.clone(), source })?;
        }
        let older = options.before.as_deref().map(|before| older(before, &options.db)).transpose()?;
        let region = RegionState::open(&options.db)?.holding(options.limits.held_edges);
        let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().thread_name("serve").build()?;
        let listen = |source| ServeError::Listen { addr: options.addr, source };
        let listener = runtime.block_on(TcpListener::bind(options.addr)).map_err(listen)?;
        let address = listener.local_addr()?;
        options.addr = address;
        let limits = options.limits;
        let app = Arc::new(App::new(options, ServedState::new(region, older)));
        let router = routes::router(Arc::clone(&app));
        Ok(Self { runtime, listener, address, router, limits, app })
    }

    /// The address that the server listens on.
    #[must_use]
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Serves until `stop` completes. Then it stops as the module's description says.
    pub fn run(self, stop: impl Future<Output = ()>) {
        let Self { runtime, listener, router, limits, app, .. } = self;
        runtime.spawn(async move {
            app.first_map().await;
            app.prepare().await;
            tokio::time::sleep(WARM_UP_AFTER).await;
            app.warm_up().await;
        });
        runtime.block_on(accept(listener, router, limits, stop));
        // Work that nobody waits for any more is cut.
        runtime.shutdown_timeout(Duration::from_millis(200));
    }
}

/// Opens the older database. The two must be two files with a vehicle in common; otherwise there is nothing to compare.
fn older(before: &Path, db: &Path) -> Result<OlderState, ServeError> {
    let canonical = |path: &Path| std::fs::canonicalize(path).ok();
    let same_path = canonical(before).is_some_and(|path| canonical(db) == Some(path));
    if same_path || Identity::of(before)?.same_file(&Identity::of(db)?) {
        return Err(ServeError::SameFile(before.to_owned()));
    }
    let (old, new) = (RegionState::open(before)?, RegionState::open(db)?);
    if common(&old.sets, &new.sets).is_empty() {
        return Err(ServeError::NothingInCommon(Box::new([listed(before, &old), listed(db, &new)])));
    }
    Ok(old.into())
}

/// A database with the sets of certificates that it has.
fn listed(path: &Path, region: &RegionState) -> String {
    let sets: Vec<String> =
        region.sets.iter().map(|set| format!("{} ({})", set.vehicle_id, set.policy.name())).collect();
    format!("{}: {}", path.display(), if sets.is_empty() { "none".to_owned() } else { sets.join(", ") })
}

async fn accept(listener: TcpListener, router: Router, limits: Limits, stop: impl Future<Output = ()>) {
    let mut stop = pin!(stop);
    let places = Arc::new(Semaphore::new(limits.connections.max(1)));
    let (stopping, stopped) = watch::channel(false);
    let mut all = JoinSet::new();
    loop {
        let next = async {
            let place = Arc::clone(&places).acquire_owned().await;
            (place, listener.accept().await)
        };
        let (place, accepted) = tokio::select! {
            () = &mut stop => break,
            Some(_) = all.join_next(), if !all.is_empty() => continue,
            next = next => next,
        };
        let (Ok(place), Ok((stream, _))) = (place, accepted) else {
            tokio::time::sleep(PAUSE).await;
            continue;
        };
        let (router, stopped) = (router.clone(), stopped.clone());
        all.spawn(async move {
            connection(stream, router, limits, stopped).await;
            drop(place);
        });
    }
    drop(listener);
    // Sending fails if no connection is left, which is no error.
    let _ = stopping.send(true);
    let ended = async { while all.join_next().await.is_some() {} };
    let _ = tokio::time::timeout(limits.stop_time, ended).await;
}

async fn connection(stream: TcpStream, router: Router, limits: Limits, mut stopped: watch::Receiver<bool>) {
    let _ = stream.set_nodelay(true); // slower without, not wrong
    let mut http = http1::Builder::new();
    http.timer(TokioTimer::new()).header_read_timeout(limits.header_time).max_buf_size(MOST_HEAD_BYTES);
    let service = TowerToHyperService::new(router);
    let mut connection = pin!(http.serve_connection(TokioIo::new(stream), service));
    let over = async {
        tokio::select! {
            _ = stopped.wait_for(|stopped| *stopped) => {}
            () = tokio::time::sleep(limits.connection_time) => {}
        }
    };
    // An error here means that the client went away or sent no HTTP. The server ignores it.
    tokio::select! {
        _ = connection.as_mut() => return,
        () = over => connection.as_mut().graceful_shutdown(),
    }
    let _ = tokio::time::timeout(limits.connection_time.min(Duration::from_secs(60)), connection).await;
}
