//! Stops long statements when the caller is told to stop.

use crate::database::Database;
use crate::error::StoreError;
use crate::stop::Stop;

/// Number of instructions of SQLite's virtual machine between two checks, some ten microseconds.
const INSTRUCTIONS: i32 = 1000;

impl Database {
    /// From now on, a statement fails soon after `stop` is told. Drop the connection after such a failure.
    ///
    /// # Errors
    /// The connection is broken.
    pub fn stop_when_told(&mut self, stop: &Stop) -> Result<(), StoreError> {
        let stop = stop.clone();
        self.session.run(async |c| {
            c.lock_handle().await?.set_progress_handler(INSTRUCTIONS, move || !stop.told());
            Ok(())
        })
    }

    /// From now on, statements run to their ends again.
    ///
    /// # Errors
    /// The connection is broken.
    pub fn never_stop(&mut self) -> Result<(), StoreError> {
        self.session.run(async |c| {
            c.lock_handle().await?.remove_progress_handler();
            Ok(())
        })
    }
}
