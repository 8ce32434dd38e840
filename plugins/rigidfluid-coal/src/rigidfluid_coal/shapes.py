"""The semi-axes of the bodies that coal knows as ellipsoids."""

from __future__ import annotations

import numpy as np

from rigidfluid.api import Body, FloatArray, SceneError


def semi_axes(index: int, body: Body) -> FloatArray:
    """Semi-axes of a ball or an ellipsoid in its own frame.

    Parameters
    ----------
    index : int
        Number of the body, for the message.
    body : Body
        A shape.

    Returns
    -------
    (d,) array
        The semi-axes [length].

    Raises
    ------
    SceneError
        If the body is neither.
    """
    if body.radius is not None:
        return np.full(body.dimension, body.radius)
    if body.name == "ellipsoid":
        return np.array(body.options.model_dump()["semi_axes"], dtype=float)
    raise SceneError(
        "contact.detector",
        f'"coal" with body.{index} of type "{body.name}"',
        "balls and ellipsoids",
        'Use detector = "brute_force" for this shape.',
    )


def in_space(axes: FloatArray) -> FloatArray:
    """The semi-axes (3,) of an ellipsoid that stands for an ellipse ``axes`` (2,) in the plane z = 0 [length].

    Whatever the third axis, the nearest points of two such ellipsoids lie in the plane. The shortest way out of an
    overlap does as well if the third axis is no shorter than the others.
    """
    return axes if len(axes) == 3 else np.append(axes, axes.max())
