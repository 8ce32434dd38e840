"""Refuse lower bounds in pyproject.toml that are not the versions installed here, among the lowest that go together.

    .venv-lowest/bin/python tools/lowest.py

A bound that was withdrawn, or that another package's excludes, claims what nobody has tried.
"""

from __future__ import annotations

import sys
import tomllib
from collections.abc import Iterator
from importlib import metadata
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from packaging.version import Version

ROOT = Path(__file__).resolve().parents[1]
PROJECTS = (ROOT / "pyproject.toml", *sorted(ROOT.glob("plugins/*/pyproject.toml")))


def requirements() -> Iterator[Requirement]:
    """What rigidfluid, its extras and its plug-ins ask for on this machine, but for each other."""
    for file in PROJECTS:
        project = tomllib.loads(file.read_text(encoding="utf-8"))["project"]
        for texts in (project["dependencies"], *project.get("optional-dependencies", {}).values()):
            for wanted in map(Requirement, texts):
                if wanted.name != "rigidfluid" and (wanted.marker is None or wanted.marker.evaluate()):
                    yield wanted


def lower_bound(wanted: Requirement) -> Version:
    """Lowest version that a requirement names; raises ValueError where it names none."""
    (bound,) = (Version(one.version) for one in wanted.specifier if one.operator == ">=")
    return bound


def main() -> int:
    """1 where something is installed in a version above its bound."""
    installed = {canonicalize_name(found.name): found.version for found in metadata.distributions()}
    above = [
        f"{wanted}: the lowest that can be installed is {installed[wanted.name]}; raise the bound to it"
        for wanted in requirements()
        if wanted.name in installed and Version(installed[wanted.name]) != lower_bound(wanted)
    ]
    print("\n".join(above) or "every bound is what is installed")
    return int(bool(above))


if __name__ == "__main__":
    sys.exit(main())
