"""Measures of any shape: inscribed radius, half thickness, equal-volume radius, and a key of equal shapes."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.model.body import Body

_SAMPLES = {2: 400, 3: 1600}
"""Number of surface points, by dimension, at which inscribed balls touch."""

_BISECTIONS = 50
"""Bisections of a ball's radius: to rounding of the shape's size."""

_SLACK = 1e-6
"""Relative tolerance of a ball's radius against the depth of its centre."""


def shape_key(body: Body) -> tuple[str, str]:
    """Key that is equal for bodies of the same shape: the type's name and its options as text."""
    return body.name, body.options.model_dump_json()


def inscribed_radius(body: Body) -> float:
    """Radius of the largest ball about the centre of mass inside the shape, 0 where the centre is outside [length]."""
    if body.radius is not None:
        return body.radius
    return max(-float(body.signed_distance(np.zeros((1, body.dimension)))[0]), 0.0)


def half_thickness(body: Body) -> float:
    """Radius of the largest ball that fits into the shape, to a few per cent unless it is an ellipsoid [length].

    The balls touch the surface at samples of it, each found by bisection, so that no shape is too thin.
    """
    if body.semi_axes is not None:
        return float(body.semi_axes.min())
    touched = body.sample_surface(_SAMPLES[body.dimension])
    normal = body.normal(touched)
    fits, least_too_large = np.zeros(len(touched)), np.full(len(touched), body.bounding_radius)
    for _ in range(_BISECTIONS):
        radius = 0.5 * (fits + least_too_large)
        inside = -body.signed_distance(touched - radius[:, None] * normal) >= (1.0 - _SLACK) * radius
        fits, least_too_large = np.where(inside, radius, fits), np.where(inside, least_too_large, radius)
    return float(fits.max())


def equal_volume_radius(body: Body) -> float:
    """Radius of the ball that has the body's volume, √(V/π) in 2D, ∛(3V/4π) in 3D [length]."""
    if body.dimension == 2:
        return float(np.sqrt(body.volume / np.pi))
    return float(np.cbrt(0.75 * body.volume / np.pi))
