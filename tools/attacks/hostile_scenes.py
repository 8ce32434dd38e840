"""Hostile scenes and settings: whole ones from the JSON Schema of scenes, and the shipped ones with a few changes."""

from __future__ import annotations

import copy
import functools
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from hypothesis import strategies as st

from attacks.schema_values import SchemaValues, formulas, hostile_values, numbers
from rigidfluid.core.scene.toml_file import read_toml

SCENES = Path(__file__).resolve().parents[2] / "scenes"
BASES = (
    "dry_bounce", "dfg_cylinder", "dumbbell_in_shear", "falling_disk", "falling_disk_window", "falling_sphere",
    "periodic_channel", "settling_cylinder", "slider", "several_laws", "squeezed_film", "stenosis", "swimmer",
    "swimmer_3d", "two_disks", "two_spheres", "vortex_induced", "falling_ellipsoid", "ellipse_in_channel",
)  # fmt: skip
"""Shipped scenes that are checked in a second, and name all kinds of parts between them."""

Path_ = tuple[str | int, ...]
Hostile = tuple[str, Any]
"""What was done, and the tables."""


@functools.cache
def schema_values() -> SchemaValues:
    """The schema of what is installed."""
    return SchemaValues()


@functools.cache
def base(name: str) -> dict[str, Any]:
    """Tables of a shipped scene; not to be changed."""
    return read_toml(SCENES / f"{name}.toml")


def leaves(value: Any, path: Path_ = ()) -> Iterator[Path_]:
    """Paths of all tables, lists and values in a table."""
    if isinstance(value, dict | list) and len(path) < 8:
        for key, inner in value.items() if isinstance(value, dict) else enumerate(value):
            yield (*path, key)
            yield from leaves(inner, (*path, key))


@st.composite
def generated_scenes(draw: st.DrawFn) -> Hostile:
    """Whole scenes that the schema allows, and shipped ones with a table or two from there."""
    made = draw(schema_values().scene())
    if draw(st.integers(0, 3)) == 0:
        return "generated", made
    name, taken = draw(st.sampled_from(BASES)), draw(st.lists(st.sampled_from(sorted(made)), min_size=1, max_size=2))
    return f"{name} with {', '.join(taken)} generated", base(name) | {table: made[table] for table in taken}


@st.composite
def changed_scenes(draw: st.DrawFn) -> Hostile:
    """A shipped scene with one to three changes."""
    name = draw(st.sampled_from(BASES))
    tables = copy.deepcopy(base(name))
    done = [draw(_change(tables)) for _ in range(draw(st.sampled_from([1, 1, 1, 2, 3])))]
    return f"{name}: {', '.join(done)}", tables


@st.composite
def _change(draw: st.DrawFn, tables: dict[str, Any]) -> str:
    """Change the tables in one place, and say what was done."""
    kind = draw(st.sampled_from(["scaled"] * 3 + ["hostile", "allowed", "removed", "added", "doubled", "misspelt"]))
    path = draw(st.sampled_from([path for path in leaves(tables) if kind != "scaled" or is_number(at(tables, path))]))
    inside = at(tables, path[:-1])
    return ".".join(map(str, path)) + draw(_changed_entry(inside, path[-1], path, kind))


def at(tables: Any, path: Path_) -> Any:
    """The value at a path."""
    return functools.reduce(lambda inside, key: inside[key], path, tables)


def is_number(value: Any) -> bool:
    """Whether a value can be scaled."""
    return isinstance(value, float | int) and not isinstance(value, bool)


@st.composite
def _changed_entry(draw: st.DrawFn, inside: Any, key: Any, path: Path_, kind: str) -> str:
    """Change one entry of a table or a list."""
    value = inside[key]
    if kind == "scaled":
        inside[key] = value * draw(st.sampled_from([-1, 0, 0.5, 0.9, 1.1, 2, 3, 0.1, 10, 1e-3, 1e3, 1e-8, 1e8, 1e20]))
    elif kind == "removed":
        del inside[key]
    elif kind == "misspelt" and isinstance(inside, dict):
        inside[key + draw(st.sampled_from(["s", "_", ".", "\n", " ", "é"]))] = inside.pop(key)
    elif kind == "added" and isinstance(value, dict):
        known = schema_values().keys_of(schema_values().at(path)) or {"key": {}}
        new = draw(st.sampled_from(sorted(known)))
        value[new] = copy.deepcopy(draw(schema_values().values(known[new])))
        return f".{new} added {shown(value[new])}"
    elif kind == "doubled" and isinstance(inside, list):
        inside.append(copy.deepcopy(value))
    else:
        allowed = schema_values().values(schema_values().at(path))
        inside[key] = copy.deepcopy(draw(allowed if kind == "allowed" else hostile_values))
    return f" {kind} {shown(inside[key]) if kind not in ('removed', 'misspelt') else ''}"


@st.composite
def changed_texts(draw: st.DrawFn) -> Hostile:
    """The text of a shipped scene file with damaged characters or lines."""
    name = draw(st.sampled_from(BASES))
    text = (SCENES / f"{name}.toml").read_bytes()
    at = draw(st.integers(0, len(text)))
    put = draw(
        st.one_of(st.binary(max_size=6), st.sampled_from([b"[", b"]]", b"=", b'"', b"\n", b"\xff\xfe", b"[[" * 2000]))
    )
    cut = draw(st.sampled_from([0, 1, 5, 100, 10_000]))
    return f"{name}.toml: {len(put)} bytes in the place of {cut} at {at}", text[:at] + put + text[at + cut :]


@st.composite
def settings(draw: st.DrawFn) -> tuple[str, list[str]]:
    """A shipped scene's name, and one or two assignments as after ``--set``."""
    name = draw(st.sampled_from(BASES))
    return name, [draw(_setting(name)) for _ in range(draw(st.sampled_from([1, 1, 1, 2])))]


@st.composite
def _setting(draw: st.DrawFn, name: str) -> str:
    """A key that is there, or may be, or is none, and a value."""
    known = draw(st.sampled_from(list(leaves(base(name)))))
    path = ".".join(map(str, known))
    if draw(st.integers(0, 3)) == 0:
        path = draw(
            st.sampled_from([path + ".x", path + ".0", path + ".-1", path.upper(), "", ".", path + "=", "body.99.x"])
        )
    value = schema_values().values(schema_values().at(known))
    text = draw(st.one_of(value.map(toml), hostile_values.map(toml), numbers.map(str), formulas, st.text(max_size=12)))
    return f"{path}={text}"


def toml(value: Any) -> str:
    """A value as TOML writes it, or nearly."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key or 'x'} = {toml(inner)}" for key, inner in value.items()) + "}"
    if isinstance(value, list):
        return "[" * value.count([]) + "[" + ", ".join(map(toml, value)) + "]"
    if isinstance(value, str):
        return json.dumps(value)
    return "nan" if value != value else str(value).lower()


def shown(value: Any) -> str:
    """A value in a few characters."""
    text = repr(value)
    return text if len(text) < 80 else f"{text[:60]}… ({len(text)} characters)"
