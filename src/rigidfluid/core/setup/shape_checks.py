"""Spot checks of shapes that others have made: volume, inertia, distances and nearest points must fit each other."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import pi

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.guarded import is_foreign, part_error
from rigidfluid.core.geometry.wrong import Wrong
from rigidfluid.core.model.body import Body

_POINTS = 32
"""Points of the surface that are looked at, about."""

_TOLERANCE = 1e-6
"""Greatest error of what must fit, relative; the contract tests allow 1e-10."""


def check_shapes(shapes: Sequence[Body]) -> None:
    """Raise PluginError for a shape that contradicts itself; those of rigidfluid are known not to."""
    for shape in {id(shape): shape for shape in shapes}.values():
        if is_foreign(type(shape)):
            for key, found, allowed in _contradictions(shape):
                raise part_error(shape, key, Wrong(found, allowed))


def _contradictions(shape: Body) -> Iterator[tuple[str, str, str]]:
    """Method or attribute of a shape that contradicts others, what it gives, and what these allow."""
    reach, d = shape.bounding_radius, shape.dimension
    surface = shape.sample_surface(_POINTS)[:_POINTS]
    farthest = float(np.linalg.norm(surface, axis=1).max())
    ball, longest = (pi if d == 2 else 4.0 / 3.0 * pi) * reach**d, float(shape.unit_inertia.max())
    if farthest > (1.0 + _TOLERANCE) * reach:
        yield "bounding_radius", f"{reach:.6g}", f"at least {farthest:.6g}, as far as points of its surface"
    if shape.radius is not None and abs(shape.radius - reach) > _TOLERANCE * reach:
        yield "radius", f"{shape.radius:.6g}", f"{reach:.6g}, the bounding radius"
    if shape.volume > (1.0 + _TOLERANCE) * ball or (shape.radius and shape.volume < (1.0 - _TOLERANCE) * ball):
        bound = "at most" if shape.radius is None else "the"
        yield "volume", f"{shape.volume:.6g}", f"{bound} {ball:.6g} of the ball of the bounding radius"
    if longest > (1.0 + _TOLERANCE) * reach**2:
        yield "unit_inertia", f"{longest:.6g}", f"moments of at most {reach**2:.6g}, the bounding radius squared"
    yield from _odd_distances(shape, surface, reach)


def _odd_distances(shape: Body, surface: FloatArray, reach: float) -> Iterator[tuple[str, str, str]]:
    """The same of distances and nearest points: far away, beside points of the ``surface``, and on it."""
    far = 2.0 * reach * np.concatenate([np.eye(shape.dimension), -np.eye(shape.dimension)])
    points, slack = np.concatenate([far, 1.5 * surface]), _TOLERANCE * reach
    distance, foot = shape.signed_distance(points.copy()), shape.closest_point(points.copy())
    least, apart = float(distance[: len(far)].min()), np.linalg.norm(points - foot, axis=1)
    off = float(np.abs(shape.signed_distance(surface.copy())).max())
    if least < reach - slack:
        yield "signed_distance", f"{least:.6g} at two bounding radii", f"at least {reach:.6g}"
    if off > slack:
        yield "signed_distance", f"{off:.6g} at a point of its surface", "zero"
    if np.any(wrong := np.abs(apart - np.abs(distance)) > slack):
        allowed = f"one at the distance of {np.abs(distance[wrong][0]):.6g} from there"
        yield "closest_point", f"a point {apart[wrong][0]:.6g} from {points[wrong][0].tolist()}", allowed
