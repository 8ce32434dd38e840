"""Bodies in curved and irregular domains by filling between facets, and by cutting along a level set."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from curved_gaps import CurvedGap, curved_gaps
from insertion_cases import CASES, outcome
from page_tools import Page, Work, table
from wall_drift import Drift, wall_drift

from rigidfluid.core.mesh.generation.inserter import Way
from rigidfluid.errors import MeshError
from rigidfluid.post.insertion import insert

WAYS: dict[Way, int] = {"fill": 20, "level_set": 5}
"""How many arrangements in the plane are tried in each way; in space it is one."""


def page(work: Work) -> Page:
    """How well bodies come into domains, what becomes of walls, and what gaps to them are."""
    head = ("case", "way", "failed", "cells", "quality", "vertices off", "middles", "walls kept", "walls' area", "s")
    text = ABOUT + table(head, [insertion_row(name, way) for name in CASES for way in WAYS]) + SHOWN
    head = ("scene", "way", "surface", "shape", "facets", "given vertices kept", "vertices off", "middles off")
    shown: list[tuple[str, Way]] = [("insertion_2d", "fill"), ("insertion_2d", "level_set"), ("insertion_3d", "fill")]
    text += table(head, (row for scene, way in shown for row in inserted_rows(work, scene, way)))
    text += "\n\n![Shapes in a vessel](insertion_2d.png)\n\n![Bodies in a bent tube](insertion_3d.png)\n"
    stops = list(wall_drift())
    head = ("new meshes", "area less the exact one", "vertices off", "quality", "facets")
    text += WALLS_THAT_STAY.format(stops=max(stop.remeshings for stop in stops)) + table(head, drift(stops))
    text += GAPS + table(("body", "at", "facets", "gap", "error", "bound"), map(gap_row, curved_gaps()))
    pictures = {f"_{dimension}": work.folder / f"insertion_{dimension}_fill" / "mesh.png" for dimension in ("2d", "3d")}
    return Page("Insertion of bodies", text, pictures)


def drift(found: list[Drift]) -> Iterable[tuple[str, ...]]:
    """Rows of what becomes of the stenosis' walls, after every tenth new mesh, and the worst of all."""
    for one in found[::10]:
        yield _drift_row(str(one.remeshings), one.area_error, one.off_wall, one.quality, one.curved_facets)
    worst = max(one.off_wall for one in found), min(one.quality for one in found)
    yield _drift_row("worst of all", max(one.area_error for one in found), *worst, found[-1].curved_facets)


def _drift_row(name: str, area: float, off: float, quality: float, facets: int) -> tuple[str, ...]:
    return name, f"{area:.4f}", f"{off:.0e}", f"{quality:.2f}", str(facets)


def gap_row(gap: CurvedGap) -> tuple[str, ...]:
    """One row of `insertion`'s last table."""
    place = f"({gap.place[0]:g}, {gap.place[1]:g})"
    return gap.shape, place, f"{gap.size:g}", f"{gap.exact:.4f}", f"{gap.error:.1e}", f"{gap.bound:.1e}"


def insertion_row(name: str, way: Way) -> tuple[str, ...]:
    """One row of `insertion`'s first table."""
    case, found, failed = CASES[name](), [], 0
    count = WAYS[way] if case.domain.dimension == 2 else 1
    for seed in range(count):
        try:
            found.append(outcome(case, seed, way))
        except MeshError as error:
            print(f"{name}, {way}, seed {seed}: {error}")
            failed += 1
    qualities = [one.quality for one in found]
    return (
        name,
        way,
        f"{failed} of {count}",
        f"{np.mean([one.cells for one in found]):.0f}",
        f"{min(qualities):.2f} / {np.median(qualities):.2f}",
        f"{max(one.vertices_off for one in found):.0e}",
        f"{max(one.middles_off for one in found):.2f}",
        f"{min(one.kept for one in found):.0%}",
        f"{max(one.area_change for one in found):.0e}",
        f"{np.mean([one.seconds for one in found]):.1f}",
    )


def inserted_rows(work: Work, scene: str, way: Way) -> Iterable[tuple[str, ...]]:
    """A row for each surface of a scene's mesh."""
    try:
        figures, _ = insert(work.scene(f"{scene}.toml", [f"mesh.inserter={way}"]), work.folder / f"{scene}_{way}")
    except MeshError as error:
        yield scene, way, f"fails at {error.subject}: {error.found}", "", "", "", "", ""
        return
    size = f"{figures.cells} cells, quality {figures.worst_quality:.2f}"
    yield scene, way, size, "", "", "", "", ""
    for surface in figures.surfaces:
        kept = "" if surface.given_corners is None else f"{surface.kept_corners} of {surface.given_corners}"
        off = f"{surface.vertices_off:.0e}", f"{surface.middles_off:.1e}"
        yield "", "", surface.name, surface.kind, str(surface.facets), kept, *off


ABOUT = """Balls and ellipsoids in turn, at random places and angles, none nearer than 0.12 to anything. The
stenosis is 32 by 8 with a throat of 1.75, its bodies have radii of .25 to .5, and facets are .1 on them and up to .5
on the walls; the tube has radius 1, its bodies .2 to .35, and facets are .08 and .4. `quality` is that of the worst
cell, the least of all arrangements and the median. `vertices off`: farthest vertex of a body from its shape.
`middles`: farthest middle of a facet, over what facets as long as the longest cut off the narrowest curvature, h²/8R
in the plane and h²/6R in space. `walls kept`: share of the vertices of curved walls that are in the mesh to the last
bit. Seconds are CPU seconds of one arrangement.

"""

SHOWN = """

## The scenes `insertion_2d.toml` and `insertion_3d.toml`

A collection of shapes in a vessel from a mesh file, and three balls in a row, an egg and bodies from STL files in a
bent tube from a STEP file, as in the appendix of arXiv:2402.19093. `given vertices kept`: corners of a shape made of
facets that are in the mesh to the last bit.
Colours show the pieces of the boundary, and in space the quality of cells in a slice.

"""

WALLS_THAT_STAY = """
## Walls that stay

A disk of diameter 1 goes through the throat of the stenosis, and the mesh is made anew at {stops} stops. Facets of the
bumps are kept or halved with the new vertex on the circle. `vertices off`: farthest vertex of a bump from its circle.

"""

GAPS = """

## Gaps to curved walls

Of a disk of radius .5 and an ellipse with semi-axes .6 and .3 beside and in the throat, by the detector on the mesh,
against the exact one. Bound: (h_w²/R + h_b²/r)/8 for the facets of wall and body that are nearest to each other.

"""
