"""Assignment of the parts of a file's boundary to the surfaces of a domain."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from rigidfluid.core.scene.patterns import PRINTABLE
from rigidfluid.core.scene.spelling import suggestion
from rigidfluid.errors import SceneError

Labels = int | str | tuple[int | str, ...]
"""Numbers or names that a file gives to parts of a boundary."""

AT = "domain.faces"
_SHOWN = 12


@dataclass(frozen=True)
class Part:
    """A part of the boundary as a file knows it: its ``number``, its ``name`` if it has one, and what it looks like."""

    number: int
    name: str | None
    look: str


def surface_names(parts: Sequence[Part], faces: Mapping[str, Labels] | None) -> list[str]:
    """Name of the surface that each part belongs to, by ``faces``, or by the file's names if they are None.

    Raises SceneError if a label is not in the file, a part belongs to no surface or to two, or a name cannot be one.
    """
    found = _names_by_file(parts) if faces is None else _names_by_scene(parts, faces)
    for name in found:
        if name == "all" or not name:
            raise SceneError(AT, f"a surface named {name!r}", "a name other than 'all'", "Rename it.")
        if not re.fullmatch(PRINTABLE, name):
            raise SceneError(AT, f"a surface named {name!r}", "a name without control characters", "Rename it.")
    return found


def order_surfaces(names: Sequence[str], faces: Mapping[str, Labels] | None) -> list[str]:
    """The surfaces, each once: as the scene lists them, else as the file does."""
    return list(dict.fromkeys(names if faces is None else faces))


def _names_by_file(parts: Sequence[Part]) -> list[str]:
    nameless = [part for part in parts if not part.name]
    if nameless:
        remedy = "Give all of them names: `faces = { wall = [1, 2], inflow = 3 }`."
        raise SceneError(AT, f"nothing, and no names in the file for {list_parts(nameless)}", "a name for each", remedy)
    return [part.name or "" for part in parts]


def _names_by_scene(parts: Sequence[Part], faces: Mapping[str, Labels]) -> list[str]:
    names: list[str] = [""] * len(parts)
    for name, label in _labels(faces):
        chosen = [i for i, part in enumerate(parts) if label in (part.number, part.name)]
        if not chosen:
            known = [part.name for part in parts if part.name] if isinstance(label, str) else []
            remedy = suggestion(str(label), known) or "Correct it."
            raise SceneError(f"{AT}.{name}", f"{label!r}, which is not in the file", list_parts(parts), remedy)
        for i in chosen:
            if names[i] not in ("", name):
                found = f"{label!r}, which belongs to {names[i]!r} already"
                raise SceneError(f"{AT}.{name}", found, "each part in one surface", "Take it out of one of them.")
            names[i] = name
    missing = [part for part, name in zip(parts, names, strict=True) if not name]
    if missing:
        raise SceneError(
            AT, f"no surface for {list_parts(missing)}", "all parts of the boundary", "Add them to a surface."
        )
    return names


def _labels(faces: Mapping[str, Labels]) -> Iterator[tuple[str, int | str]]:
    for name, labels in faces.items():
        for label in labels if isinstance(labels, tuple) else (labels,):
            yield name, label


def list_parts(parts: Sequence[Part]) -> str:
    """The parts as messages show them."""
    shown = "; ".join(f"{part.number}{f' {part.name!r}' if part.name else ''} ({part.look})" for part in parts[:_SHOWN])
    return shown + (f"; and {len(parts) - _SHOWN} more" if len(parts) > _SHOWN else "")
