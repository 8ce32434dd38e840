"""Integrals of the fluid's velocity over layers across an axis, at the output times of a run."""

from __future__ import annotations

from dataclasses import replace
from math import factorial
from typing import NamedTuple

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.quadratic_cells import node_stretches, quadratic_basis
from rigidfluid.core.model.types import Fields
from rigidfluid.core.output.vtu import read_vtu
from rigidfluid.post.reports.results import Results
from rigidfluid.post.statistics.cell_pieces import cut_by_layers, simplex_rule
from rigidfluid.post.statistics.samples import Samples, samples_at

OUTPUTS = 50
"""Most output times whose fields are read."""
_AT_ONCE = 2000
"""Cells that are cut at a time: in 3D 100 MB."""


class FluidLayers(NamedTuple):
    """Fluid in l layers across an axis at o output times: its ``volume`` (o, l) [length^d], and the integral of its
    velocity over that, ``moved`` (o, l, d) [length^(d+1)/time]; ``samples`` of all bodies at these times."""

    samples: Samples
    volume: FloatArray
    moved: FloatArray


def fluid_layers(results: Results, samples: Samples, axis: int, layers: int, most: int) -> FluidLayers | None:
    """Fluid in so many ``layers`` at the output times within those of the ``samples``, at ``most`` so many even ones;
    None without fields."""
    first, last = samples.time[0], samples.time[-1]
    series = [(time, path) for time, path in results.series if first <= time <= last]
    if not series:
        return None
    chosen = np.unique(np.linspace(0, len(series) - 1, min(len(series), most)).round().astype(int))
    rows = np.array([results.state_at(series[number][0]) for number in chosen])
    bodies = np.flatnonzero(results.present[rows].any(axis=0))
    lower, thickness = samples.lower[axis], (samples.upper[axis] - samples.lower[axis]) / layers
    found = [layer_integrals(read_vtu(series[number][1]), axis, lower, thickness, layers) for number in chosen]
    volume, moved = (np.array(values) for values in zip(*found, strict=True))
    return FluidLayers(samples_at(results, rows, bodies), volume, moved)


def layer_integrals(
    fields: Fields, axis: int, lower: float, thickness: float, layers: int
) -> tuple[FloatArray, FloatArray]:
    """Volume (l,) [length^d] of so many ``layers`` of one ``thickness``, from ``lower`` on along an ``axis``, and the
    integral of the velocity over each (l, d) [length^(d+1)/time].

    Cells outside of the layers are in their images, as of a periodic mesh that is cut elsewhere. They are cut as if
    they were straight, and integrated as they are.
    """
    volume, moved = np.zeros(layers), np.zeros((layers, fields.points.shape[1]))
    height = (fields.points[:, axis] - lower) / thickness
    for start in range(0, len(fields.cells), _AT_ONCE):
        some = replace(fields, cells=fields.cells[start : start + _AT_ONCE])
        _add_cells(some, height, volume, moved)
    return volume, moved


def _add_cells(fields: Fields, height: FloatArray, volume: FloatArray, moved: FloatArray) -> None:
    """Add volumes and integrals over the cells, whose nodes have a ``height`` (N,) in layers."""
    layers, d = moved.shape
    pieces = cut_by_layers(height[fields.cells[:, : d + 1]])
    points, weights = simplex_rule(d + 1)
    basis = quadratic_basis(points @ pieces.corners)
    stretch = np.einsum("pqb,pb->pq", basis, node_stretches(fields.points[fields.cells])[pieces.cell])
    portion = stretch * weights * pieces.share[:, None] / factorial(d)
    flow = np.einsum("pq,pqb,pbd->pd", portion, basis, fields.velocity[fields.cells[pieces.cell]], optimize=True)
    layer = np.floor(pieces.height.mean(axis=1)).astype(int) % layers
    np.add.at(volume, layer, portion.sum(axis=1))
    np.add.at(moved, layer, flow)
