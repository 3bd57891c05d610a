//! How much is tried: what a change needs, or with `NETCERT_THOROUGH` set what the figures in the documentation rest on.

/// One of two amounts.
pub(crate) fn amount<T>(usually: T, thoroughly: T) -> T {
    if std::env::var_os("NETCERT_THOROUGH").is_some() { thoroughly } else { usually }
}
