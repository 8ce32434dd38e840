"""A transported scalar on a new mesh: what interpolation loses or makes is put back."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.types import FluidState, Mesh
from rigidfluid.taylor_hood.stepping.scalar_step import NAMES, REMESHING, ScalarEquations


def conserve(
    before: ScalarEquations, fluid: FluidState, old: Mesh, after: ScalarEquations, moved: FluidState, new: Mesh
) -> FluidState:
    """The scalar of an interpolated state ``moved`` with the content that it had in ``fluid``, at both times.

    Values go no further than the extremes before, and those on surfaces that hold them stay. The content is that of
    T - c with the mean c: so it does not depend on the zero of the scale where the polygons of bodies differ.
    """
    found, restored = {}, 0.0
    geometries = (old.geometry, new.geometry), (fluid["points_previous"], moved["points_previous"])
    for name, (there, here) in zip(NAMES, geometries, strict=True):
        values, constant = fluid[name], before.mean(there, fluid[name])
        content = before.content_by_node(there, values - constant).sum()
        bounds = float(values.min()), float(values.max())
        interpolated = np.clip(moved[name], *bounds)
        _keep_uniform(before, values, after, interpolated)
        found[name], missing = _with_content(after, here, interpolated, content, constant, bounds)
        restored += abs(missing) if name == NAMES[0] else 0.0
    return {**found, REMESHING: np.asarray(fluid[REMESHING] + restored)}


def _keep_uniform(before: ScalarEquations, values: FloatArray, after: ScalarEquations, moved: FloatArray) -> None:
    """Write on each surface that fixes one and the same value the one that it had: new nodes on it may be outside the
    old cells."""
    for surface in np.unique(after.surfaces.owner[after.surfaces.owner >= 0]):
        held = values[before.surfaces.owner == surface]
        if len(held) and held.min() == held.max():
            moved[after.surfaces.owner == surface] = held[0]


def _with_content(
    equations: ScalarEquations,
    points: FloatArray,
    values: FloatArray,
    content: float,
    constant: float,
    bounds: tuple[float, float],
) -> tuple[FloatArray, float]:
    """``values`` (nodes,) drawn towards one of their ``bounds`` until T - ``constant`` has this ``content``, and how
    much of it was missing."""
    missing = float(content - equations.content_by_node(points, values - constant).sum())
    bound = bounds[1] if missing > 0.0 else bounds[0]
    room = np.where(equations.surfaces.owner < 0, bound - values, 0.0)
    whole = float(equations.content_by_node(points, room).sum())
    if missing == 0.0 or whole * missing <= 0.0:
        return values, missing
    return values + (missing / whole) * room, missing
