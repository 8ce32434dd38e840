"""One picture of a movie as an image: the fluid by colour, bodies over it, each with a mark that turns with it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import to_rgb

from rigidfluid.core.mechanics.rigid import rotation_matrices
from rigidfluid.core.model.interfaces import Body
from rigidfluid.core.model.types import Fields, FloatArray
from rigidfluid.core.output.vtu import read_vtu
from rigidfluid.reports.flow import vorticity
from rigidfluid.reports.raster import Grid, Sampling
from rigidfluid.reports.results import Results
from rigidfluid.reports.style import BODY, COLOURMAP, SIGNED_COLOURMAP

Quantity = Literal["speed", "vorticity", "pressure"]
SIGNED: tuple[Quantity, ...] = ("vorticity", "pressure")

_OUTSIDE, _NOTHING, _MARK = to_rgb("#d9d9d9"), to_rgb("white"), to_rgb("black")
_HAND = 0.12
"""Half the width of the mark over the body's radius."""


@dataclass(frozen=True)
class Scale:
    """Of a ``quantity`` between ``lowest`` and ``highest``."""

    quantity: Quantity
    lowest: float
    highest: float

    @classmethod
    def of(cls, quantity: Quantity, images: list[FloatArray]) -> Scale:
        """From what most points of some images have; about zero where the sign counts."""
        known = np.concatenate([image[np.isfinite(image)] for image in images] or [np.zeros(1)])
        highest = float(np.percentile(np.abs(known), 99.5)) if known.size else 0.0
        return cls(quantity, -highest if quantity in SIGNED else 0.0, highest or 1.0)

    @property
    def map(self) -> str:
        """Matplotlib's name of the colours."""
        return SIGNED_COLOURMAP if self.quantity in SIGNED else COLOURMAP

    def colours(self, image: FloatArray) -> FloatArray:
        """RGB (rows, columns, 3) of values; grey where there is no fluid."""
        share = (image - self.lowest) / (self.highest - self.lowest)
        found = colormaps[self.map](np.nan_to_num(share))[..., :3]
        return np.where(np.isfinite(image)[..., None], found, _OUTSIDE)


def flow_image(path: Path, quantity: Quantity, grid: Grid) -> FloatArray:
    """A quantity of the fields in a file at the points of a grid, (rows, columns), nan outside the fluid."""
    fields = read_vtu(path)
    return Sampling.of(fields, grid).image(_at_nodes(fields, quantity, grid))


def _at_nodes(fields: Fields, quantity: Quantity, grid: Grid) -> FloatArray:
    """At the nodes of each cell, (M, b)."""
    if quantity == "speed":
        return np.asarray(np.linalg.norm(fields.velocity, axis=1)[fields.cells])
    if quantity == "pressure":
        return np.asarray(fields.pressure[fields.cells])
    return vorticity(fields, grid.normal if fields.points.shape[1] == 3 else None)


def ground(results: Results, grid: Grid) -> FloatArray:
    """A picture without a fluid: the domain white, (rows, columns, 3)."""
    points = _points(grid)
    inside = results.system.domain.contains(points.reshape(-1, points.shape[-1])).reshape(points.shape[:2])
    return np.where(inside[..., None], _NOTHING, _OUTSIDE)


def draw_bodies(picture: FloatArray, grid: Grid, results: Results, state: int) -> None:
    """Paint the bodies, as the plane cuts them, into a picture (rows, columns, 3)."""
    position, turn = results.vectors("")[state], rotation_matrices(_orientation(results, state))
    for body, centre, matrix in zip(results.system.bodies, position, turn, strict=True):
        _draw(picture, grid, body, centre, matrix)


def _draw(picture: FloatArray, grid: Grid, body: Body, centre: FloatArray, turn: FloatArray) -> None:
    """Only the points in the square about it are asked for."""
    middle = grid.coordinates(centre)
    reach = body.bounding_radius / np.array([np.linalg.norm(grid.right), np.linalg.norm(grid.up)])
    first = np.maximum(np.floor(middle - reach).astype(int), 0)
    last = np.minimum(np.ceil(middle + reach).astype(int), (grid.columns - 1, grid.rows - 1)) + 1
    if np.any(last <= first):
        return
    columns, rows = slice(first[0], last[0]), slice(first[1], last[1])
    own = (_points(grid, columns, rows) - centre) @ turn
    flat = own.reshape(-1, own.shape[-1])
    inside = (body.signed_distance(flat) < 0.0).reshape(own.shape[:2])
    off = np.linalg.norm(own[..., 1:], axis=-1)
    hand = inside & (own[..., 0] > 0.0) & (off < _HAND * body.bounding_radius)
    picture[rows, columns][inside] = to_rgb(BODY)
    picture[rows, columns][hand] = _MARK


def _points(grid: Grid, columns: slice | None = None, rows: slice | None = None) -> FloatArray:
    """The points of a grid, or of a part of it, (rows, columns, d)."""
    i = np.arange(grid.columns)[columns or slice(None)]
    j = np.arange(grid.rows)[rows or slice(None)]
    return np.asarray(grid.origin + i[None, :, None] * grid.right + j[:, None, None] * grid.up)


def _orientation(results: Results, state: int) -> FloatArray:
    names = ("angle",) if results.system.dimension == 2 else ("qw", "qx", "qy", "qz")
    return np.stack([results.bodies[name][state] for name in names], axis=-1)
