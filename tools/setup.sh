#!/bin/sh
# Sourced by ./demo and ./check: gets what building needs (a C++ compiler, cmake and the sqlite3 program for PROJ), or says in
# one line what to install. Installs Debian packages as root or by sudo without a password; cmake alone also from PyPI.

missing=""
command -v c++ >/dev/null 2>&1 || missing="$missing g++"
command -v cc >/dev/null 2>&1 || missing="$missing gcc"
command -v cmake >/dev/null 2>&1 || missing="$missing cmake"
command -v make >/dev/null 2>&1 || missing="$missing make"
command -v sqlite3 >/dev/null 2>&1 || missing="$missing sqlite3"

if [ -n "$missing" ] && command -v apt-get >/dev/null 2>&1; then
    as_root=""
    [ "$(id -u)" = 0 ] || as_root="sudo -n"
    if [ -z "$as_root" ] || sudo -n true 2>/dev/null; then
        echo "installing:$missing" >&2
        # shellcheck disable=SC2086
        { $as_root apt-get update -qq && DEBIAN_FRONTEND=noninteractive $as_root apt-get install -y -qq $missing; } >&2 || true
    fi
fi
if ! command -v cmake >/dev/null 2>&1 && command -v python3 >/dev/null 2>&1; then
    tools="$PWD/target/tools"
    python3 -m pip install --quiet --target "$tools" cmake >&2 2>/dev/null || true
    if [ -x "$tools/bin/cmake" ]; then
        export PYTHONPATH="$tools${PYTHONPATH:+:$PYTHONPATH}" PATH="$tools/bin:$PATH"
    fi
fi
for program in c++ cc cmake make sqlite3; do
    if ! command -v "$program" >/dev/null 2>&1; then
        echo "netcert needs '$program' to build PROJ: sudo apt-get install g++ cmake make sqlite3" >&2
        exit 1
    fi
done
if ! command -v cargo >/dev/null 2>&1; then
    [ -x "$HOME/.cargo/bin/cargo" ] && export PATH="$HOME/.cargo/bin:$PATH"
fi
needed=$(sed -n 's/^rust-version = "\(.*\)"/\1/p' Cargo.toml)
if ! command -v cargo >/dev/null 2>&1; then
    echo "netcert needs Rust $needed or newer: https://rustup.rs" >&2
    exit 1
fi
# Such as `rustc 1.95.0 (59807616e 2026-04-14)`. Where rustup has no toolchain, its rustc fails and says what to type.
found=$(rustc --version) || exit 1
found=${found#rustc }
found=${found%%[ -]*}
if [ "$(printf '%s\n' "$needed" "$found" | sort -V | head -n 1)" != "$needed" ]; then
    echo "netcert needs Rust $needed or newer, this is $found: rustup update stable && rustup default stable" >&2
    exit 1
fi
