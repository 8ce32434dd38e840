"""A surface of CAD faces: fine facets say which face is near, and its closed form where exactly."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from rigidfluid.core.model.facet_surface import FacetSurface
from rigidfluid.core.model.facets import Facets, area_vectors
from rigidfluid.core.model.surface import Surface
from rigidfluid.core.model.types import BoolArray, FloatArray, IntArray
from rigidfluid.domains.closed_form import Form, Offset

_SLACK = 2.0
"""A point of a form is on its face if it is no farther from the facets than this many times what they cut off."""


@dataclass(frozen=True)
class _Face:
    """``sense``: 1 where the fluid is on the side that the form calls outward, else -1; ``slack`` [length]."""

    form: Form
    sense: float
    slack: float


class _Measured(NamedTuple):
    foot: FloatArray
    distance: FloatArray
    normal: FloatArray


class FormedSurface(Surface):
    """Faces with known forms, each bounded by its facets; a face without is what its facets are.

    Beside an edge of a face, where the nearest point of its form is beyond it, the nearest point is that of the facets,
    put onto the form: it is off by what the facets cut off.

    Parameters
    ----------
    facets : Facets
        Fine ones, vertices on the faces, marked by the number of their face.
    forms : sequence of Form or None
        Of all faces.
    whole : FacetSurface, optional
        The closed surface that they are a part of.
    """

    def __init__(self, facets: Facets, forms: Sequence[Form | None], whole: FacetSurface | None = None) -> None:
        self._coarse = FacetSurface(facets, whole)
        self._faces: dict[int, _Face] = {}
        for number in np.unique(facets.markers).tolist():
            if (form := forms[number]) is not None:
                self._faces[number] = _face(facets, facets.markers == number, form)
        self._complete = len(self._faces) == len(np.unique(facets.markers))

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Corners of the box around the facets and what they cut off, (d,) each [length]."""
        lower, upper = self._coarse.bounds
        return lower - self.slack, upper + self.slack

    @property
    def slack(self) -> float:
        """How far at most the faces may be beyond the facets [length]."""
        return max((face.slack for face in self._faces.values()), default=0.0)

    @property
    def radius(self) -> float | None:
        """Of a part of one ball, negative where the fluid is inside; else None [length]."""
        only = next(iter(self._faces.values())) if self._complete and len(self._faces) == 1 else None
        if only is None or not isinstance(only.form, Offset) or not only.form.round:
            return None
        return only.sense * only.form.radius

    @property
    def least_radius(self) -> float | None:
        """Of all faces; None where one has no known form [length]."""
        return min(face.form.least_radius for face in self._faces.values()) if self._complete else None

    def closest_point(self, points: FloatArray) -> FloatArray:
        """Nearest points, (N, d), for ``points`` (N, d) [length]."""
        return self._measured(points).foot

    def signed_distance(self, points: FloatArray) -> FloatArray:
        """Distance to them, (N,), > 0 in the fluid, for ``points`` (N, d) [length]."""
        return self._measured(points).distance

    def normal(self, points: FloatArray) -> FloatArray:
        """Unit normals into the fluid, (N, d), at the nearest points of ``points`` (N, d)."""
        return self._measured(points).normal

    def _measured(self, points: FloatArray) -> _Measured:
        """Where faces pass into one another, the form of the face that is near the point may end before the foot."""
        near = self._on_forms(points, self._face_of(points))
        return self._on_forms(points, self._face_of(near.foot))

    def _face_of(self, points: FloatArray) -> IntArray:
        return self._coarse.facets.markers[self._coarse.nearest_facets(points)]

    def _on_forms(self, points: FloatArray, face_of: IntArray) -> _Measured:
        foot, normal = self._coarse.closest_point(points), self._coarse.normal(points)
        inside = self._coarse.signed_distance(points) > 0.0
        for number, face in self._faces.items():
            rows = np.flatnonzero(face_of == number)
            exact = face.form.closest_point(points[rows])
            bounded = self._on_facets(exact, face)
            exact[~bounded] = face.form.closest_point(foot[rows[~bounded]])
            foot[rows], normal[rows] = exact, face.sense * face.form.outward(exact)
            above = np.sum((points[rows] - exact) * normal[rows], axis=1) > 0.0
            inside[rows[bounded]] = above[bounded]
        away = np.linalg.norm(points - foot, axis=1)
        return _Measured(foot, np.where(inside, away, -away), normal)

    def _on_facets(self, points: FloatArray, face: _Face) -> BoolArray:
        return np.asarray(np.abs(self._coarse.signed_distance(points)) <= face.slack)


def _face(facets: Facets, chosen: BoolArray, form: Form) -> _Face:
    vertices = facets.vertices[chosen]
    middles, normals = facets.points[vertices].mean(axis=1), area_vectors(facets.points, vertices)
    cut_off = float(np.linalg.norm(form.closest_point(middles) - middles, axis=1).max())
    sense = float(np.sign(np.sum(normals * form.outward(middles))))
    rounding = 1e-12 * float(np.ptp(facets.points, axis=0).max())
    return _Face(form, sense, max(_SLACK * cut_off, rounding))
