"""The header of every kind of export is what its schema says."""

import json
from pathlib import Path

import jsonschema
import pytest

from conftest import ROOT

SCHEMA = json.loads((ROOT / "docs/export/netcert.schema.json").read_text())


@pytest.fixture(scope="module")
def judge() -> jsonschema.Draft202012Validator:
    jsonschema.Draft202012Validator.check_schema(SCHEMA)
    return jsonschema.Draft202012Validator(SCHEMA)


def written(run, demo_path: Path, out: Path, target: str, *options: str) -> dict:
    what = ("--db", demo_path, "--corridor", "carriageway", "--vehicle", "AU-SEMI19")
    run("export", target, "-q", *what, "--out", out, *options)
    return json.loads((out / "netcert.json").read_text())


@pytest.mark.parametrize("target", ["csv", "geojson", "geoparquet", "flatgeobuf", "pgrouting"])
def test_the_header_of_an_export_is_as_described(run, demo_path, tmp_path, judge, target):
    judge.validate(written(run, demo_path, tmp_path / target, target))


def test_a_time_and_a_reference_vehicle_are_described_too(run, demo_path, tmp_path, judge):
    options = ("--at", "2026-12-01T08:00", "--relative-to", "AGV-TUG4")
    header = written(run, demo_path, tmp_path / "csv", "csv", *options)
    judge.validate(header)
    assert header["permit"]["at"] == "2026-12-01T08:00:00"
    assert header["relative_to"]["id"] == "AGV-TUG4"


def test_what_the_schema_does_not_describe_is_refused(run, demo_path, tmp_path, judge):
    header = written(run, demo_path, tmp_path / "csv", "csv")
    for name in SCHEMA["required"]:
        assert not judge.is_valid({key: value for key, value in header.items() if key != name}), name
    permit = header["permit"]
    for inner in (header, header["vehicle"], permit, permit["edges"], header["evidence"], header["input"]):
        inner["undescribed"] = 1
        assert not judge.is_valid(header)
        del inner["undescribed"]
    judge.validate(header)
