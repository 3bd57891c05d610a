"""What the tests share: the region that ships, certified by the program."""

import os
import subprocess
from pathlib import Path

import netcert
import pytest

ROOT = Path(__file__).resolve().parents[2]
# The region is small and certifies in seconds for a vehicle that fits almost everywhere and one that does not.
VEHICLES = ("AU-SEMI19", "AGV-TUG4")


def note_skipped(report: pytest.TestReport | pytest.CollectReport) -> None:
    """Notes what is skipped, where `.ci/run` asks for it. It decides by the reason, so it has to know new reasons."""
    listed = os.environ.get("NETCERT_SKIPPED")
    if report.skipped and listed and isinstance(report.longrepr, tuple):
        with open(listed, "a", encoding="utf-8") as out:
            out.write(f"test in Python\t{report.nodeid}: {report.longrepr[2]}\n")


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    note_skipped(report)


def pytest_collectreport(report: pytest.CollectReport) -> None:
    """A file is skipped whole before its tests are found."""
    note_skipped(report)


def program() -> Path:
    """The program: that of `NETCERT`, or the one that the tests of Rust have built."""
    known = [os.environ.get("NETCERT"), ROOT / "target/debug/netcert", ROOT / "target/release/netcert"]
    for path in filter(None, known):
        if Path(path).exists():
            return Path(path)
    pytest.fail("no program: build it with `cargo build`, or name it in NETCERT")


def extract(name: str) -> Path:
    """A real extract, from `NETCERT_EXTRACTS` or beside the project."""
    folder = Path(os.environ.get("NETCERT_EXTRACTS", ROOT.parent / "shared/extracts"))
    if not (folder / name).exists():
        pytest.skip(f"no {folder / name}: NETCERT_EXTRACTS names the folder with extracts")
    return folder / name


@pytest.fixture(scope="session")
def run():
    """Runs the program and returns what it writes."""

    def run(*arguments: object) -> str:
        done = subprocess.run([program(), *map(str, arguments)], check=True, capture_output=True, text=True)
        return done.stdout

    return run


@pytest.fixture(scope="session")
def demo_path(run, tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("region") / "demo.gpkg"
    extract = ROOT / "data/demo.osm.pbf"
    run("ingest", "-q", extract, "--db", path, "--corridor", "carriageway", "--vehicle", *VEHICLES)
    return path


@pytest.fixture
def demo(demo_path) -> netcert.Region:
    return netcert.open(demo_path)


@pytest.fixture(scope="session")
def catalogue() -> netcert.Catalogue:
    return netcert.vehicles()


@pytest.fixture
def bend() -> netcert.Corridor:
    """A corridor with a bend that a semi-trailer just takes."""
    return netcert.Corridor([[0, 0], [60, 0], [120, 15]], width_m=7.0)
