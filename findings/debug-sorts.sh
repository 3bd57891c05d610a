#!/usr/bin/env bash
# In a debug build, geo's unions of polygons ask the operating system for the number of processors at every sort, however short.
# A good guess is that a debug build does the same work as a release build, only slower.
#
# Behaviour (geo 0.33.1 with its default feature `multithreading`; i_overlay 4.5.2, i_key_sort 0.10.3; Linux): i_key_sort sorts on several
# threads from 65,536 values on. Built with debug assertions it does so for any number of values, and first calls
# `std::thread::available_parallelism`, which opens the files of the control groups. A union of two polygons of 64 corners then asks several times, and
# takes many times as long as with debug assertions off for i_key_sort alone.
#
# Output seen on 2026-11-30, on two cores:
#   debug build: a union of two discs asks 3 times for the number of processors, and takes 1150.7 µs
#   debug build, i_key_sort without debug assertions: a union of two discs asks 0 times for the number of processors, and takes 110.4 µs
#   release build: a union of two discs asks 0 times for the number of processors, and takes 86.0 µs
#
# Needs cargo and Linux. Fails if the behaviour is another one.
#
# Users of netcert who build it for debugging, and its tests, make such unions for every turn: a fifteenth of their processor time went into
# that question. netcert's Cargo.toml turns debug assertions off for i_key_sort.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
mkdir src
cat >Cargo.toml <<'TOML'
[package]
name = "sorts"
version = "0.0.0"
edition = "2021"
[workspace]
[dependencies]
geo = "=0.33.1"
i_overlay = "=4.5.2"
i_key_sort = "=0.10.3"
[profile.dev]
opt-level = 1
[profile.quiet]
inherits = "dev"
[profile.quiet.package.i_key_sort]
debug-assertions = false
TOML
cat >src/main.rs <<'RUST'
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use geo::{BooleanOps, LineString, Polygon};

static ASKED: AtomicU64 = AtomicU64::new(0);

/// Stands in for the C library's: the standard library asks it for the number of processors.
#[no_mangle]
pub extern "C" fn sched_getaffinity(_: i32, _: usize, set: *mut u8) -> i32 {
    ASKED.fetch_add(1, Ordering::Relaxed);
    unsafe { *set = 3 };
    0
}

/// A polygon of 64 corners.
fn disc(x: f64) -> Polygon {
    let corner = |k: u32| (x + (f64::from(k) / 64.0 * std::f64::consts::TAU).cos(), (f64::from(k) / 64.0 * std::f64::consts::TAU).sin());
    Polygon::new(LineString::from_iter((0..64).map(corner)), Vec::new())
}

fn main() {
    let (a, b) = (disc(0.0), disc(1.0));
    a.union(&b);
    let (before, begun) = (ASKED.load(Ordering::Relaxed), Instant::now());
    let unions = 2000;
    for _ in 0..unions {
        assert_eq!(a.union(&b).0.len(), 1);
    }
    let asked = ASKED.load(Ordering::Relaxed) - before;
    println!("{} {:.1}", asked / unions, begun.elapsed().as_secs_f64() * 1e6 / unions as f64);
}
RUST
cargo build --quiet
cargo build --quiet --profile quiet
cargo build --quiet --release
show() {
    read -r asked micros < <("target/$1/sorts")
    echo "$2: a union of two discs asks $asked times for the number of processors, and takes $micros µs"
    seen="$seen $asked"
}
seen=""
show debug "debug build"
show quiet "debug build, i_key_sort without debug assertions"
show release "release build"
read -r debug quiet release <<<"$seen"
# EXPECTED: several times, never, never.
if [ "$debug" -gt 0 ] && [ "$quiet" = 0 ] && [ "$release" = 0 ]; then
    echo "as described"
else
    echo "the behaviour has changed" >&2
    exit 1
fi
