"""The notebook runs on a real extract."""

import os

import nbclient
import nbformat
from conftest import ROOT, extract

NOTEBOOK = ROOT / "docs/how-to/region.ipynb"


def test_the_notebook_runs(run, tmp_path, monkeypatch):
    region = tmp_path / "sydney.gpkg"
    run("ingest", "-q", extract("sydney_au.osm.pbf"), "--db", region, "--corridor", "carriageway", "--vehicle", "AU-SEMI19", "--no-turns")
    monkeypatch.setenv("NETCERT_REGION", str(region))
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    nbclient.NotebookClient(notebook, timeout=600, resources={"metadata": {"path": str(tmp_path)}}).execute()
    kept = os.environ.get("NETCERT_NOTEBOOK_OUT")
    if kept:
        nbformat.write(notebook, kept)
    pictures = [output for cell in notebook.cells for output in cell.get("outputs", []) if "image/png" in output.get("data", {})]
    assert len(pictures) >= 3
