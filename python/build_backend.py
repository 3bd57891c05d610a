"""Builds the package with maturin, after it has looked for what PROJ is built with.

PROJ is compiled from source. Without a compiler, cmake and the sqlite3 program that takes minutes and then fails with many lines; here it
fails at once with one.
"""

import os
import shutil
import subprocess
import sys

import maturin

# Program, and the Debian package that has it. pip brings cmake.
_NEEDED = {"c++": "g++", "cc": "gcc", "make": "make", "sqlite3": "sqlite3"}


def _prepare() -> None:
    missing = [package for program, package in _NEEDED.items() if shutil.which(program) is None]
    if missing and shutil.which("apt-get") and os.geteuid() == 0:
        quiet = {**os.environ, "DEBIAN_FRONTEND": "noninteractive"}
        subprocess.run(["apt-get", "update", "-qq"], env=quiet, check=False, stdout=sys.stderr)
        subprocess.run(["apt-get", "install", "-y", "-qq", *missing], env=quiet, check=False, stdout=sys.stderr)
        missing = [package for program, package in _NEEDED.items() if shutil.which(program) is None]
    if missing:
        sys.exit(f"netcert needs {', '.join(missing)} to build PROJ: sudo apt-get install {' '.join(missing)}")
    if shutil.which("cargo") is None:
        cargo = os.path.expanduser("~/.cargo/bin")
        if not os.path.exists(os.path.join(cargo, "cargo")):
            sys.exit("netcert needs Rust: https://rustup.rs")
        os.environ["PATH"] = os.pathsep.join([cargo, os.environ.get("PATH", "")])


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    _prepare()
    return maturin.build_wheel(wheel_directory, config_settings, metadata_directory)


def build_editable(wheel_directory, config_settings=None, metadata_directory=None):
    _prepare()
    return maturin.build_editable(wheel_directory, config_settings, metadata_directory)


def build_sdist(sdist_directory, config_settings=None):
    return maturin.build_sdist(sdist_directory, config_settings)


def get_requires_for_build_wheel(config_settings=None):
    return maturin.get_requires_for_build_wheel(config_settings)


def get_requires_for_build_editable(config_settings=None):
    return maturin.get_requires_for_build_editable(config_settings)


def get_requires_for_build_sdist(config_settings=None):
    return maturin.get_requires_for_build_sdist(config_settings)


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    _prepare()
    return maturin.prepare_metadata_for_build_wheel(metadata_directory, config_settings)


def prepare_metadata_for_build_editable(metadata_directory, config_settings=None):
    _prepare()
    return maturin.prepare_metadata_for_build_editable(metadata_directory, config_settings)
