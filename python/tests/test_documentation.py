"""Examples in docstrings run, every public name is described, and the type stubs agree with the compiled classes."""

import doctest
import inspect
import subprocess
import sys
from pathlib import Path

import netcert
import pytest

SETTINGS = Path(__file__).resolve().parents[1] / "pyproject.toml"


def described():
    """Public classes and functions with their own members."""
    yield "netcert", netcert
    for name in netcert.__all__:
        value = getattr(netcert, name)
        if name == "__version__" or inspect.ismodule(value):
            continue
        yield name, value
        if inspect.isclass(value) and not issubclass(value, Exception):
            members = vars(value).items()
            yield from ((f"{name}.{member}", found) for member, found in members if not member.startswith("_"))


@pytest.mark.parametrize(("name", "value"), list(described()))
def test_each_public_name_is_described_and_its_examples_run(name, value):
    text = inspect.getdoc(value)
    known = name.split(".")[0] in ("CertifiedSet", "Part", "Obstacle", "NamedPlace", "Condition") and "." in name
    assert text or known, f"{name} has no docstring"
    test = doctest.DocTestParser().get_doctest(text or "", {}, name, None, None)
    flags = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
    runner = doctest.DocTestRunner(optionflags=flags)
    assert runner.run(test).failed == 0


def test_stubs_agree_with_the_compiled_classes(tmp_path):
    command = [sys.executable, "-m", "mypy.stubtest", "netcert._netcert", "--mypy-config-file", SETTINGS]
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_package_is_typed(tmp_path):
    command = [sys.executable, "-m", "mypy", "--config-file", SETTINGS]
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
