"""The page of an insertion: figures of each surface, and pictures."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import matplotlib

from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Mesh
from rigidfluid.core.output.disk import replace_file
from rigidfluid.post.insertion.figures import Figures, SurfaceFigures
from rigidfluid.post.insertion.pictures import histogram, plane_picture, space_picture
from rigidfluid.post.reports.html import document, grid, picture, table
from rigidfluid.post.reports.style import STYLE, save

PAGE = "insertion.html"
HEADER = (
    "surface", "shape", "facets", "given facets kept", "given vertices kept", "vertices off", "middles off",
    "area", "of the shape", "volume", "of the shape",
)  # fmt: skip


def write_page(figures: Figures, mesh: Mesh, system: System, out: Path) -> list[Path]:
    """Write two pictures and the page that holds them."""
    with matplotlib.rc_context(STYLE):
        draw = plane_picture if system.dimension == 2 else space_picture
        (shown,) = save(draw(mesh, system), out, "mesh", ("png",))
        (cells,) = save(histogram(figures), out, "quality", ("png",))
    caption = "The mesh." if system.dimension == 2 else "The boundary, and a slice through the cells at the bodies."
    parts = [
        "<p>Lengths are those of the scene. Distances are the largest ones of all vertices, and of the middles of all "
        "facets, from the exact shape.</p>",
        table(_summary(figures)),
        picture(shown, caption),
        "<h2>Surfaces</h2>",
        grid(HEADER, map(surface_row, figures.surfaces)),
        "<p>Facets of flat walls may be re-meshed in their plane. A given facet that is not kept has been halved.</p>",
        "<h2>Cells</h2>",
        picture(cells, "How many cells have which quality, 1 that of a regular simplex."),
    ]
    path = out / PAGE
    replace_file(path, document(f"Mesh of {figures.name}", parts).encode())
    return [shown, cells, path]


def surface_row(figures: SurfaceFigures) -> tuple[object, ...]:
    """Cells of one surface, in the order of HEADER."""
    f = figures
    return (
        f.name, f.kind, f.facets,
        _kept_share(f.kept_facets, f.given_facets), _kept_share(f.kept_corners, f.given_corners),
        f"{f.vertices_off:.1e}", f"{f.middles_off:.1e}",
        f.area, _known(f.exact_area), _known(f.volume), _known(f.exact_volume),
    )  # fmt: skip


def _summary(figures: Figures) -> Iterator[tuple[str, object]]:
    yield "bodies come into the mesh by", figures.inserter
    yield "cells", figures.cells
    yield "vertices", figures.vertices
    yield "quality of the worst cell", figures.worst_quality
    yield "volume of the fluid, of its cells", figures.volume
    yield "volume of the fluid, exact", figures.exact_volume
    for phase, seconds in figures.seconds.items():
        yield f"{phase} [s]", seconds


def _kept_share(kept: int | None, given: int | None) -> str:
    return "" if given is None else f"{kept} of {given}"


def _known(value: float | None) -> object:
    return "" if value is None else value
