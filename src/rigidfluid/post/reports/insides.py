"""Colours inside bodies that conduct a scalar, as in the fluid around them."""

from __future__ import annotations

from pathlib import Path

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.post.reports.results import Results
from rigidfluid.post.reports.section import Section
from rigidfluid.post.reports.view_plane import ViewPlane


def inside_section(results: Results, path: Path, plane: ViewPlane, through: FloatArray) -> Section | None:
    """Section of the scalar inside bodies, by the ``path`` of the fluid's fields at that time and a ``plane`` through a
    point (d,); None where it cuts no body that conducts."""
    fields = results.insides(path)
    if fields is None:
        return None
    section = Section.cut(fields, plane, through)
    return section if len(section.fields.cells) else None
