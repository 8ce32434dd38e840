"""What parts import of the rest is what docs/plugins.md and docs/decisions allow, and nothing else."""

from __future__ import annotations

import ast
import importlib
from collections.abc import Iterator
from pathlib import Path

import pytest
from paths import ROOT

SOURCE = ROOT / "src" / "rigidfluid"
SHARED = {"backends": {"taylor_hood"}, "detectors": {"marching"}, "forces": set(), "bodies": set()}
"""Of each room of parts, the rooms of what they share; those import nothing of any part."""
ROOMS = [*SHARED, "taylor_hood", "marching"]
DATA = {"geometry", "fluid", "model", "mechanics"}
"""Core's rooms of records, shapes and equations, and of what moves bodies."""
NUMERICS = {
    *("contact.pairs.broad_phase", "contact.pairs.near_pairs", "contact.laws.balls", "contact.laws.repulsion"),
    *("mesh.mesh_quality", "mesh.location", "joints.joint_forces"),
}
"""Of core's rooms above `mechanics`, what holds no state, and what two parts would otherwise write twice."""
PUBLIC = {"api", "commands", "testing", "taylor_hood"}


def imported(folder: Path) -> Iterator[list[str]]:
    """The modules of rigidfluid that files of a folder name, each in its parts."""
    for file in folder.rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.module and node.module.startswith("rigidfluid."):
                yield node.module.split(".")[1:]


@pytest.mark.parametrize("room", ROOMS)
def test_built_in_parts_import_data_mechanics_and_numerics(room: str) -> None:
    found = list(imported(SOURCE / room))
    of_core = {".".join(names[1:]) for names in found if names[0] == "core"}
    assert {name for name in of_core if name.split(".")[0] not in DATA} <= NUMERICS
    rooms = {names[0] for names in found} - {"core", "errors", "hookspecs", room}
    assert rooms <= SHARED.get(room, set())


def test_no_more_is_allowed_than_is_needed() -> None:
    used = {".".join(names[1:]) for room in ROOMS for names in imported(SOURCE / room) if names[0] == "core"}
    assert used >= NUMERICS


@pytest.mark.parametrize("plugin", ["coal", "lammps", "ngsolve"])
def test_the_plug_ins_beside_import_what_is_public(plugin: str) -> None:
    found = list(imported(ROOT / "plugins" / f"rigidfluid-{plugin}" / "src"))
    assert {names[0] for names in found} <= PUBLIC


@pytest.mark.parametrize("module", ["rigidfluid", "rigidfluid.api"])
def test_names_that_are_imported_on_first_use_are_listed(module: str) -> None:
    found = importlib.import_module(module)
    assert set(found.__all__) <= set(dir(found))
