"""A surface of CAD faces: fine facets say which face is near, and its closed form where exactly."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.geometry.facet_surface import FacetSurface
from rigidfluid.core.geometry.facets import Facets, area_vectors
from rigidfluid.core.geometry.surface import Surface
from rigidfluid.domains.closed_form import Flat, Form, Offset

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


class _Feet(NamedTuple):
    """``foot`` (N, d), ``normal`` (N, d) there, the ``face`` that is nearest to it (N,), and whether it is the form's
    own (N,)."""

    foot: FloatArray
    normal: FloatArray
    face: IntArray
    bounded: BoolArray


class FormedSurface(Surface):
    """Faces with known forms, each bounded by its facets; a face without is what its facets are.

    Near an edge of a face, where the nearest point of its form is beyond it, the nearest point is that of the facets,
    put onto the form: it is off by what the facets cut off.

    ``facets`` are fine ones with vertices on the faces, marked by the number of their face in ``forms``, None where a
    form is not known; ``whole`` is the closed surface that they are a part of.
    """

    def __init__(self, facets: Facets, forms: Sequence[Form | None], whole: FacetSurface | None = None) -> None:
        self._coarse, self._whole = FacetSurface(facets), whole
        self._faces: dict[int, _Face] = {}
        for number in np.unique(facets.markers).tolist():
            if (form := forms[number]) is not None:
                self._faces[number] = _face(facets, facets.markers == number, form)
        self._complete = len(self._faces) == len(np.unique(facets.markers))

    @cached_property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Corners of the box around the facets and what they cut off, (d,) each [length]."""
        points, vertices, marked = self._coarse.facets.points, self._coarse.facets.vertices, self._coarse.facets.markers
        corners = [(number, points[vertices[marked == number].ravel()]) for number in np.unique(marked).tolist()]
        slack = {number: face.slack for number, face in self._faces.items()}
        lower = np.min([mine.min(axis=0) - slack.get(number, 0.0) for number, mine in corners], axis=0)
        upper = np.max([mine.max(axis=0) + slack.get(number, 0.0) for number, mine in corners], axis=0)
        return lower, upper

    @property
    def slack(self) -> float:
        """Greatest distance of the faces beyond the facets [length]."""
        return max((face.slack for face in self._faces.values()), default=0.0)

    @property
    def radius(self) -> float | None:
        """Radius of the ball that the surface is a part of, negative if the fluid is inside; else None [length]."""
        only = next(iter(self._faces.values())) if self._complete and len(self._faces) == 1 else None
        if only is None or not isinstance(only.form, Offset) or not only.form.round:
            return None
        return only.sense * only.form.radius

    @property
    def least_radius(self) -> float | None:
        """Least radius of curvature of all faces; None where one has no known form [length]."""
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
        facet, coarse_foot, coarse_distance, coarse_normal = self._coarse.nearest(points)
        face = self._coarse.facets.markers[facet]
        found = self._feet_on_forms(points, _Feet(coarse_foot, coarse_normal, face, np.zeros(len(points), dtype=bool)))
        self._continue_feet(points, found, np.flatnonzero(found.face != face))
        away = np.linalg.norm(points - found.foot, axis=1)
        formed = np.isin(face, list(self._faces))
        above = np.sum((points - found.foot) * found.normal, axis=1)
        inside = np.where(formed, above, coarse_distance) > 0.0
        if self._whole is not None:
            behind = np.flatnonzero(~inside & (away > self.slack))
            inside[behind] = self._whole.signed_distance(points[behind]) > 0.0
        return _Measured(found.foot, np.where(inside, away, -away), found.normal)

    def _continue_feet(self, points: FloatArray, found: _Feet, rows: IntArray) -> None:
        """Replace feet at ``rows`` that lie on the next face, as faces pass into one another, by those of its form."""
        there = _Feet(found.foot[rows], found.normal[rows], found.face[rows], found.bounded[rows])
        following = self._feet_on_forms(points[rows], there)
        taken = following.bounded
        found.foot[rows[taken]], found.normal[rows[taken]] = following.foot[taken], following.normal[taken]

    def _feet_on_forms(self, points: FloatArray, near: _Feet) -> _Feet:
        """The nearest points of the forms of the faces that points are ``near`` to; those there, put onto the form,
        where the form's are not on the face."""
        foot, normal, slack = near.foot.copy(), near.normal.copy(), np.full(len(points), np.inf)
        rows_of = {number: np.flatnonzero(near.face == number) for number in self._faces}
        for number, rows in rows_of.items():
            foot[rows] = self._faces[number].form.closest_point(points[rows])
            slack[rows] = self._faces[number].slack
        facet, _, distance, _ = self._coarse.nearest(foot)
        bounded = np.abs(distance) <= slack
        for number, rows in rows_of.items():
            form, off = self._faces[number].form, rows[~bounded[rows]]
            foot[off] = form.closest_point(near.foot[off])
            normal[rows] = self._faces[number].sense * form.outward(foot[rows])
        return _Feet(foot, normal, self._coarse.facets.markers[facet], bounded)


def _face(facets: Facets, chosen: BoolArray, form: Form) -> _Face:
    vertices = facets.vertices[chosen]
    middles, normals = facets.points[vertices].mean(axis=1), area_vectors(facets.points, vertices)
    cut_off = float(np.linalg.norm(form.closest_point(middles) - middles, axis=1).max())
    sense = float(np.sign(np.sum(normals * form.outward(middles))))
    rounding = 1e-12 * float(np.ptp(facets.points, axis=0).max())
    return _Face(form, sense, rounding if isinstance(form, Flat) else max(_SLACK * cut_off, rounding))
