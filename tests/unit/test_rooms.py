"""Where modules of core lie, and in which direction they import each other."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest
from paths import ROOT

import rigidfluid

SOURCE = Path(rigidfluid.__file__).parent
BELOW = {
    "geometry": "",
    "fluid": "geometry",
    "model": "scene fluid geometry",
    "mechanics": "model geometry",
    "joints": "mechanics model geometry",
    "scene": "",
    "nested": "mechanics scene model geometry",
    "output": "model geometry",
    "mesh": "mechanics model geometry",
    "contact": "mechanics model geometry",
    "coupling": "contact mechanics model geometry",
    "setup": "contact mesh joints mechanics nested scene model fluid geometry",
    "seeding": "contact mechanics nested scene model geometry",
    "case": "setup seeding contact mesh joints mechanics nested scene model fluid geometry",
    "run": "case setup mesh coupling contact output mechanics nested scene model fluid geometry",
}

PARTS = {
    "backends": "core.mesh taylor_hood",
    "bodies": "",
    "detectors": "core.contact marching",
    "forces": "core.contact",
    "domains": "core.contact core.mesh core.nested core.scene registry",
    "mechanisms": "core.nested core.scene registry",
    "joints": "core.joints core.nested core.scene",
    "size_fields": "core.mesh core.scene",
    "materials": "core.nested core.scene",
}
"""What built-in parts import besides the model and mechanics; obstacles of domains, components of mechanisms and drives
of joints are tables in a scene."""

WITHIN = {
    "core/contact": {"pairs": "", "laws": "pairs", "path": "laws pairs"},
    "core/mesh": {"size": "", "generation": "size", "adaptation": "generation size"},
    "taylor_hood": {
        "elements": "",
        "system": "elements",
        "linear_solver": "system elements",
        "stepping": "system elements",
    },
}
"""Rooms within rooms, and which others of the same room each imports, besides modules that are in none of them."""

POST = {"reports": ""} | dict.fromkeys(("movies", "insertion", "statistics", "studies", "comparison"), "reports")
"""What each room of post imports from it, besides modules that are in none of them."""


def imports(path: Path) -> Iterator[str]:
    """All that a module imports from rigidfluid, for type checkers and within functions too."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        names = [node.module or ""] if isinstance(node, ast.ImportFrom) else []
        names += [name.name for name in node.names] if isinstance(node, ast.Import) else []
        yield from (name for name in names if name.startswith("rigidfluid."))


@pytest.mark.parametrize("room", BELOW)
def test_a_room_imports_from_those_below_alone(room: str) -> None:
    allowed = {room, *BELOW[room].split()}
    paths = sorted((SOURCE / "core" / room).rglob("*.py"))
    assert paths
    rooms = {str(path): {name.split(".")[2] for name in imports(path) if ".core." in name} for path in paths}
    assert {name: above for name, found in rooms.items() if (above := found - allowed)} == {}


@pytest.mark.parametrize(("room", "within"), [(room, within) for room in WITHIN for within in WITHIN[room]])
def test_a_room_within_a_room_imports_from_those_below_alone(room: str, within: str) -> None:
    prefix = f"rigidfluid.{room.replace('/', '.')}."
    paths = sorted((SOURCE / room / within).rglob("*.py"))
    assert len(paths) > 1
    names = {name.removeprefix(prefix).split(".")[0] for path in paths for name in imports(path) if prefix in name}
    assert names & WITHIN[room].keys() <= {within, *WITHIN[room][within].split()}


@pytest.mark.parametrize("room", WITHIN)
def test_modules_beside_rooms_within_a_room_are_few(room: str) -> None:
    beside = [path for path in (SOURCE / room).glob("*.py") if path.name != "__init__.py"]
    assert len(beside) <= 7


def test_core_has_no_other_modules() -> None:
    assert {path.stem for path in (SOURCE / "core").iterdir() if not path.name.startswith("__")} == set(BELOW)


def test_core_knows_no_plug_in_and_nothing_above_it() -> None:
    beside = {"errors", "registry", "hookspecs", "regular_file", "python_process", "described", "error_text"}
    homes = {name.split(".")[1] for path in (SOURCE / "core").rglob("*.py") for name in imports(path)}
    assert homes - {"core"} <= beside


@pytest.mark.parametrize("kind", PARTS)
def test_built_in_parts_import_neither_each_other_nor_the_loop(kind: str) -> None:
    names = {name for path in (SOURCE / kind).rglob("*.py") for name in imports(path)}
    rooms = {".".join(name.split(".")[1:3]) if ".core." in name else name.split(".")[1] for name in names}
    assert rooms <= {
        kind,
        "core.geometry",
        "core.fluid",
        "core.model",
        "core.mechanics",
        "errors",
        "regular_file",
        "python_process",
        "hookspecs",
        *PARTS[kind].split(),
    }


def test_those_who_read_write_or_vary_tables_import_the_scene_and_nobody_else() -> None:
    importers = []
    for path in SOURCE.rglob("*.py"):
        nodes = [node for node in ast.walk(ast.parse(path.read_text("utf-8"))) if isinstance(node, ast.ImportFrom)]
        importers += [str(path.relative_to(SOURCE))] * ("Scene" in {name.name for node in nodes for name in node.names})
    others = {name for name in importers if not name.startswith(("core/case/", "post/studies/", "post/comparison/"))}
    assert others == {"__init__.py", "api.py", "core/setup/model.py"}
    assert len(importers) <= 12


def test_nothing_imports_the_command_line_and_what_is_for_commands_alone() -> None:
    paths = [path for path in SOURCE.rglob("*.py") if path.name != "__main__.py" and path.parent.name != "cli"]
    beside = ("rigidfluid.cli", "rigidfluid.commands", "rigidfluid.plugin_commands")
    assert [path.name for path in paths if any(name.startswith(beside) for name in imports(path))] == []


@pytest.mark.parametrize("room", POST)
def test_a_room_of_post_imports_reports_alone(room: str) -> None:
    names = [name.split(".") for path in (SOURCE / "post" / room).rglob("*.py") for name in imports(path)]
    others = {name[2] for name in names if name[1] == "post" and (SOURCE / "post" / name[2]).is_dir()}
    assert others <= {room, *POST[room].split()}


def test_every_room_is_in_the_table_of_rooms() -> None:
    table = (SOURCE.parents[1] / "ARCHITECTURE.md").read_text(encoding="utf-8")
    rooms = {path.name + "/" * path.is_dir() for path in SOURCE.iterdir() if not path.name.startswith(("_", "py."))}
    assert [room for room in sorted(rooms) if f"`{room}" not in table] == []


def test_no_room_is_more_than_twelve_hundredths_of_all() -> None:
    def lines(folder: Path) -> int:
        return sum(len(path.read_text(encoding="utf-8").splitlines()) for path in folder.rglob("*.py"))

    roofs = SOURCE, SOURCE / "core", SOURCE / "post"
    rooms = {path for roof in roofs for path in roof.iterdir() if path.is_dir()} - {SOURCE / "core"}
    sizes = {room.name: lines(room) / lines(SOURCE) for room in rooms}
    assert {name: size for name, size in sizes.items() if size > 0.12} == {}


def test_a_folder_of_unit_tests_mirrors_a_room_or_a_folder_beside_the_sources() -> None:
    tests = ROOT / "tests" / "unit"
    folders = {path.parent.relative_to(tests) for path in tests.rglob("test_*.py")}
    beside = {Path("docs"), Path("benchmarks"), Path("support"), Path("tools")}
    assert {str(folder) for folder in folders - beside if not (SOURCE / folder).is_dir()} == set()
