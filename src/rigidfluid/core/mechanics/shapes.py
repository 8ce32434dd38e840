"""What any shape says of itself beyond its interface: how round it is, and whether two are the same."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.model.interfaces import Body

_LATTICE = {2: 80, 3: 32}
"""Dimension → points along each side of the box around a shape."""


def shape_key(body: Body) -> tuple[str, str]:
    """Equal for bodies of the same shape: the type's name and its options as text."""
    return body.name, body.options.model_dump_json()


def inscribed_radius(body: Body) -> float:
    """Radius of the largest ball about the centre of mass inside the shape, 0 where the centre is outside [length]."""
    if body.radius is not None:
        return body.radius
    return max(-float(body.signed_distance(np.zeros((1, body.dimension)))[0]), 0.0)


def half_thickness(body: Body) -> float:
    """Radius of the largest ball that fits into the shape, to a few per cent where it is no ellipsoid [length]."""
    if body.semi_axes is not None:
        return float(body.semi_axes.min())
    lower, upper = body.bounds
    places = (np.arange(_LATTICE[body.dimension]) + 0.5) / _LATTICE[body.dimension]
    lattice = np.stack(np.meshgrid(*[places] * body.dimension, indexing="ij"), axis=-1).reshape(-1, body.dimension)
    return -float(body.signed_distance(lower + lattice * (upper - lower)).min())


def equal_volume_radius(body: Body) -> float:
    """Radius of the ball that has the body's volume, √(V/π) in 2D, ∛(3V/4π) in 3D [length]."""
    if body.dimension == 2:
        return float(np.sqrt(body.volume / np.pi))
    return float(np.cbrt(0.75 * body.volume / np.pi))
