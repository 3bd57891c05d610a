"""The pages on vehicle files, Python and Spark, typed line by line from top to bottom.

Blocks ```sh are typed into a shell, except lines that install something. Blocks ```python are examples with their answers.
"""

import doctest
import os
import re
import shutil
import subprocess

import pytest
from conftest import ROOT, program

INSTALLS = ("pip install", "apt-get install", "sudo apt-get install")


def blocks(page):
    text = (ROOT / "docs/how-to" / page).read_text(encoding="utf-8")
    return re.findall(r"^```(sh|python)\n(.*?)^```$", text, re.DOTALL | re.MULTILINE)


@pytest.mark.parametrize("page", ["vehicle.md", "python.md", "spark.md", "dataset.md"])
def test_a_page_does_what_it_says(page, tmp_path, monkeypatch):
    if page == "spark.md":
        pytest.importorskip("pyspark", reason="pip install pyspark")
        if shutil.which("java") is None:
            pytest.skip("no Java: apt-get install openjdk-17-jre-headless")
    (tmp_path / "data").symlink_to(ROOT / "data")
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin/netcert").symlink_to(program())
    monkeypatch.setenv("PATH", f"{tmp_path / 'bin'}{os.pathsep}{os.environ['PATH']}")
    monkeypatch.chdir(tmp_path)
    names = {}
    flags = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
    typed = 0
    for language, block in blocks(page):
        if language == "sh":
            lines = [line for line in block.splitlines() if not line.startswith(INSTALLS)]
            subprocess.run(["bash", "-euo", "pipefail", "-c", "\n".join(lines)], check=True)
            continue
        test = doctest.DocTestParser().get_doctest(block, names, page, None, None)
        typed += len(test.examples)
        assert doctest.DocTestRunner(optionflags=flags).run(test, clear_globs=False).failed == 0
        names = test.globs
    assert typed >= 5
