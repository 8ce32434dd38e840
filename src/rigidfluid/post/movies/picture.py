"""One picture of a movie as an image: the fluid by colour, and bodies as the plane cuts them, with marks that turn."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.colors import to_rgb

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.model.types import Fields
from rigidfluid.post.reports.bodies import PlacedBody, seen_bodies
from rigidfluid.post.reports.insides import inside_section
from rigidfluid.post.reports.raster import Grid
from rigidfluid.post.reports.results import Results
from rigidfluid.post.reports.scale import Quantity, Scale
from rigidfluid.post.reports.section import Section
from rigidfluid.post.reports.style import BODY, HATCH, OUTSIDE

_NOTHING, _MARK, _EDGE = to_rgb("white"), to_rgb("black"), to_rgb("#404040")
_APART, _THICK = 8, 2
"""Points from line to line of the hatching, and across a line."""
_HAND = 0.12
"""Half the width of the mark over the body's bounding radius."""


def flow_image(fields: Fields, quantity: Quantity, grid: Grid) -> FloatArray:
    """A quantity of the fields at the points of a grid, (rows, columns), nan outside the fluid."""
    section = Section.cut(fields, grid.plane, grid.origin)
    return section.image(section.values(quantity), grid)


def inside_image(results: Results, path: Path, quantity: Quantity, grid: Grid) -> FloatArray:
    """A quantity inside bodies at the points of a grid, (rows, columns), by the ``path`` of the fluid's fields; nan
    where it is of the fluid alone, and outside bodies that conduct."""
    section = inside_section(results, path, grid.plane, grid.origin) if quantity == "scalar" else None
    if section is None:
        return np.full((grid.rows, grid.columns), np.nan)
    return section.image(section.values(quantity), grid)


def paint_flow(image: FloatArray, scale: Scale) -> FloatArray:
    """A picture (rows, columns, 3) of values (rows, columns), hatched where they are nan."""
    return np.where(np.isfinite(image)[..., None], scale.colours(np.nan_to_num(image)), hatching(*image.shape))


def hatching(rows: int, columns: int) -> FloatArray:
    """A picture (rows, columns, 3) of what is not in the domain: oblique lines."""
    line = (np.arange(columns) - np.arange(rows)[:, None]) % _APART < _THICK
    return np.where(line[..., None], to_rgb(HATCH), to_rgb(OUTSIDE))


def ground(results: Results, grid: Grid) -> FloatArray:
    """A picture without a fluid: the domain white, hatched around it, (rows, columns, 3)."""
    points = grid.points()
    inside = results.system.domain.contains(points.reshape(-1, points.shape[-1])).reshape(points.shape[:2])
    return np.where(inside[..., None], _NOTHING, hatching(grid.rows, grid.columns))


def draw_bodies(picture: FloatArray, grid: Grid, results: Results, state: int, known: BoolArray | None = None) -> None:
    """Paint the bodies, as the plane cuts them, into a picture (rows, columns, 3); only their outlines and marks at
    points whose colours are ``known`` (rows, columns)."""
    free = np.ones(picture.shape[:2], dtype=bool) if known is None else ~known
    for body in seen_bodies(results, state):
        _draw(picture, grid, body, free)


def _draw(picture: FloatArray, grid: Grid, placed: PlacedBody, free: BoolArray) -> None:
    """Paint one body, grey where points are ``free``; only points in the square about it are evaluated."""
    body = placed.shape
    part = grid.about(placed.centre, body.bounding_radius)
    if part is None:
        return
    columns, rows = part
    own = (grid.points(columns, rows) - placed.centre) @ placed.turn
    distance = body.signed_distance(own.reshape(-1, own.shape[-1])).reshape(own.shape[:2])
    inside = distance < 0.0
    off = np.linalg.norm(own[..., 1:], axis=-1)
    hand = inside & (own[..., 0] > 0.0) & (off < _HAND * body.bounding_radius)
    seen = picture[rows, columns]
    seen[inside & free[rows, columns]] = to_rgb(BODY)
    seen[hand] = _MARK
    seen[inside & (distance > -np.linalg.norm(grid.right))] = _EDGE
