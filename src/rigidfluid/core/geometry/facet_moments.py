"""Volume, centre of mass and second moments of the inside of a closed surface of facets, exact to rounding."""

from __future__ import annotations

from math import factorial
from typing import NamedTuple

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.facets import Facets


class FacetMoments(NamedTuple):
    """Moments of the inside: ``volume`` [length^d], negative if the normals point inwards, ``centre`` (d,) of mass
    [length], ``second`` (d, d) moments ∫ r rᵀ/volume about it [length²]."""

    volume: float
    centre: FloatArray
    second: FloatArray


def facet_moments(facets: Facets) -> FacetMoments:
    """Moments ∫ 1, ∫ x and ∫ x xᵀ of closed facets of nonzero volume: sums over the simplices (o, facet) of any point
    o, with their signs.

    A simplex of volume V with vertices x_i and one more at o = 0 has ∫ x = V s/(d + 1) and ∫ x xᵀ = V (s sᵀ + Σ x_i
    x_iᵀ)/((d + 1)(d + 2)), s = Σ x_i.
    """
    dimension = facets.points.shape[1]
    origin = facets.points[np.unique(facets.vertices)].mean(axis=0)
    corners = facets.points[facets.vertices] - origin
    volumes = np.linalg.det(corners) / factorial(dimension)
    volume, sums = float(volumes.sum()), corners.sum(axis=1)
    centre = volumes @ sums / ((dimension + 1) * volume)
    squares = np.einsum("f,fi,fj->ij", volumes, sums, sums) + np.einsum("f,fki,fkj->ij", volumes, corners, corners)
    second = squares / ((dimension + 1) * (dimension + 2) * volume) - np.outer(centre, centre)
    return FacetMoments(volume, origin + centre, second)


def unit_inertia(second: FloatArray) -> FloatArray:
    """Inertia over mass, tr(C) I - C (3, 3) of second moments C, their sum (1, 1) in 2D [length²]."""
    trace = np.trace(second)
    return np.full((1, 1), trace) if len(second) == 2 else np.asarray(trace * np.eye(3) - second)
