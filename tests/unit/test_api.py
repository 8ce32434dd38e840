"""The public face of the library."""

from __future__ import annotations

import ast
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest
from paths import ROOT

from rigidfluid import api

SOURCE = Path(api.__file__).parent
PUBLIC = ("rigidfluid.api", "rigidfluid.commands", "rigidfluid.testing", "rigidfluid.taylor_hood")
HEAVY = {"numba", "h5py", "netgen", "skfem", "matplotlib", "pypardiso"}

BUILT_IN = (
    *(("backends", "rigidfluid_fluid_backends"), ("detectors", "rigidfluid_detectors")),
    *(("forces", "rigidfluid_force_laws"), ("bodies", "rigidfluid_bodies"), ("domains", "rigidfluid_domains")),
    *(("mechanisms", "rigidfluid_mechanisms"), ("joints", "rigidfluid_joints")),
    *(("size_fields", "rigidfluid_size_fields"), ("materials", "rigidfluid_materials")),
)
"""Rooms of built-in parts, and the hook of each."""


def test_every_name_is_there() -> None:
    assert [name for name in api.__all__ if getattr(api, name, None) is None] == []


def test_another_name_is_refused() -> None:
    with pytest.raises(AttributeError, match="nobody"):
        api.nobody  # noqa: B018


def test_plug_ins_that_import_it_load_no_heavy_library() -> None:
    command = [sys.executable, "-c", "import sys, rigidfluid.api; print(*sys.modules)"]
    assert HEAVY & set(subprocess.run(command, capture_output=True, text=True, check=True).stdout.split()) == set()


@pytest.mark.parametrize(
    "path", sorted(ROOT.glob("plugins/*/src/*/*.py")), ids=lambda path: f"{path.parent.name}.{path.stem}"
)
def test_the_plug_ins_beside_import_from_it_alone(path: Path) -> None:
    nodes = ast.walk(ast.parse(path.read_text(encoding="utf-8")))
    homes = {node.module for node in nodes if isinstance(node, ast.ImportFrom) and node.module}
    assert {home for home in homes if home.split(".")[0] == "rigidfluid" and not home.startswith(PUBLIC)} == set()


def test_a_model_can_be_made_of_all_built_in_parts() -> None:
    hooks = [getattr(import_module(f"rigidfluid.{room}"), hook) for room, hook in BUILT_IN]
    parts = {part for hook in hooks for part in hook()}
    needed = parts | {part.Options for part in parts}
    assert {one.__name__ for one in needed} - set(api.__all__) == set()
    assert {one for one in needed if getattr(api, one.__name__) is not one} == set()


MADE_OF_TABLES = (
    *("domains/box.py", "domains/channel.py", "domains/stenosis.py"),
    *("joints/ball.py", "joints/hinge.py", "joints/one_coordinate.py", "joints/rod.py", "joints/slider.py"),
    *("mechanisms/articulated.py", "mechanisms/three_sphere_swimmer.py"),
)
"""Built-in parts that a plug-in could have written: with obstacles, strokes, tables of bodies."""


@pytest.mark.parametrize("path", MADE_OF_TABLES)
def test_built_in_parts_use_of_the_rest_what_it_offers(path: str) -> None:
    nodes = list(ast.walk(ast.parse((SOURCE / path).read_text(encoding="utf-8"))))
    own = f"rigidfluid.{path.split('/')[0]}."
    taken = [
        node for node in nodes if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("rigidfluid.")
    ]
    names = {name.name for node in taken if not (node.module or "").startswith(own) for name in node.names}
    assert names
    assert names - set(api.__all__) == set()


def test_the_built_in_repulsions_derive_from_what_it_offers() -> None:
    laws = import_module("rigidfluid.forces").rigidfluid_force_laws()
    repulsions = [law for law in laws if issubclass(law, api.Repulsion)]
    assert len(repulsions) == 4
    bases = {base.__name__ for law in repulsions for base in (*law.__bases__, *law.Options.__bases__)}
    assert bases - set(api.__all__) == set()
