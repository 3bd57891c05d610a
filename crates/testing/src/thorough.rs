//! How many cases a test looks at: few in `./check`, all where `NETCERT_THOROUGH` is set, as in `.ci/run whole`.

/// Whether tests look at all of their cases.
#[must_use]
pub fn thorough() -> bool {
    std::env::var_os("NETCERT_THOROUGH").is_some()
}

/// `all` where tests look at all of their cases, else `usual`.
pub fn cases<T>(usual: T, all: T) -> T {
    if thorough() { all } else { usual }
}
