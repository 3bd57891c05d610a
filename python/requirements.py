"""Prints what the package needs, with what one of its extras needs: `python requirements.py test`."""

import re
import sys
from pathlib import Path

import tomllib


def needed(project: dict, extra: str) -> set[str]:
    """What an extra names. An extra may name others of the same package."""
    found = set()
    for requirement in project["optional-dependencies"][extra]:
        own = re.fullmatch(rf"{project['name']}\[(.+)\]", requirement)
        found |= needed(project, own[1]) if own else {requirement}
    return found


project = tomllib.loads(Path(__file__).with_name("pyproject.toml").read_text())["project"]
print(*sorted(needed(project, sys.argv[1]) | set(project["dependencies"])))
