"""What parts import of the rest is what docs/plugins.md allows, and nothing else."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SOURCE = ROOT / "src" / "rigidfluid"
SHARED = {"backends": {"taylor_hood"}, "detectors": {"marching"}, "forces": set(), "bodies": set()}
"""Of each room of parts, the rooms of what they share; those import nothing of any part."""
ROOMS = [*SHARED, "taylor_hood", "marching"]


def allowed() -> set[str]:
    page = (ROOT / "docs" / "plugins.md").read_text(encoding="utf-8")
    sentence = re.search(r"A part may import (.*?)It must not", page, re.DOTALL)
    assert sentence
    return set(re.findall(r"`core\.(\w+)`", sentence[1]))


def imported(folder: Path) -> Iterator[list[str]]:
    """The modules of rigidfluid that files of a folder name, each in its parts."""
    for file in folder.rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.module and node.module.startswith("rigidfluid."):
                yield node.module.split(".")[1:]


@pytest.mark.parametrize("room", ROOMS)
def test_parts_import_what_the_page_allows(room: str) -> None:
    found = list(imported(SOURCE / room))
    assert {names[1] for names in found if names[0] == "core"} <= allowed()
    rooms = {names[0] for names in found} - {"core", "errors", "hookspecs", room}
    assert rooms <= SHARED.get(room, set())


@pytest.mark.parametrize("plugin", ["coal", "ngsolve"])
def test_plugins_import_what_the_page_allows(plugin: str) -> None:
    found = list(imported(ROOT / "plugins" / f"rigidfluid-{plugin}" / "src"))
    assert {names[1] for names in found if names[0] == "core"} <= allowed()
    assert {names[0] for names in found} <= {"core", "errors", "hookspecs", "taylor_hood"}


def test_the_page_allows_no_more_than_is_needed() -> None:
    folders = [*(SOURCE / room for room in ROOMS), *ROOT.glob("plugins/*/src")]
    assert allowed() == {names[1] for folder in folders for names in imported(folder) if names[0] == "core"}
