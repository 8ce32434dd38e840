"""Output times that a report shows, and the plane section at each."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.post.reports.bodies import cuts
from rigidfluid.post.reports.insides import inside_section
from rigidfluid.post.reports.results import Results
from rigidfluid.post.reports.section import Section
from rigidfluid.post.reports.view_plane import ViewPlane

MOMENTS = 4
"""How many output times a row of pictures shows."""


@dataclass(frozen=True)
class Moment:
    """The fields' ``section`` at one output time; the ``centre`` (2,) of the body looked at, to the right and up, the
    ``width`` of the ball around it and its ``gap`` [length]; and ``outlines`` of bodies in the plane, (K, 2) each.
    ``has_body``: whether that body is there. ``extent``: corners (2,) of what is in the domain. ``insides``: section
    of the scalar inside bodies, if some conduct."""

    time: float
    section: Section
    centre: FloatArray
    width: float = 0.0
    gap: float = np.inf
    outlines: tuple[FloatArray, ...] = ()
    has_body: bool = False
    extent: tuple[FloatArray | float, FloatArray | float] = (-np.inf, np.inf)
    insides: Section | None = None


@dataclass(frozen=True)
class View:
    """The part of the plane that a panel shows, between the corners ``lower`` and ``upper`` (2,)."""

    lower: FloatArray
    upper: FloatArray

    @classmethod
    def about(cls, centre: FloatArray, half: float) -> View:
        """A square about a point."""
        return cls(centre - half, centre + half)

    @classmethod
    def whole(cls, moment: Moment) -> View:
        """All that is meshed in the domain."""
        points = np.clip(moment.section.flat_points, *moment.extent)
        return cls(points.min(axis=0), points.max(axis=0))

    def holds(self, points: FloatArray) -> BoolArray:
        """Which points (N, 2) lie in the view, (N,)."""
        return np.asarray(np.all((points >= self.lower) & (points <= self.upper), axis=1))


def shown_outputs(results: Results) -> list[int]:
    """Numbers of some output times spread over the run, the last among them."""
    count = len(results.outputs)
    chosen = np.unique(np.linspace(0, count - 1, min(MOMENTS + 1, count)).round().astype(int))
    return [int(i) for i in (chosen[1:] if count > 1 else chosen)]


def moment(results: Results, output: int, plane: ViewPlane, body: int) -> Moment:
    """Section, gap and outlines at an output time in the plane, in 3D through the centre of a body; both by number."""
    time, path = results.series[output]
    state = results.state_at(time)
    centre = results.path(body)[state]
    whole = Moment(
        time=time,
        section=Section.cut(results.fields(path), plane, centre),
        centre=plane.flat(centre),
        extent=plane.extent(*results.system.domain.extent),
        insides=inside_section(results, path, plane, centre),
    )
    if not results.names:
        return whole
    return replace(
        whole,
        width=2.0 * results.system.bodies[body].bounding_radius,
        gap=float(results.bodies["gap"][state, body]),
        outlines=tuple(cuts(results, state, plane, centre)),
        has_body=bool(results.present[state, body]),
    )


def nearest_body(results: Results) -> int:
    """Number of the body that came nearest to anything, 0 without bodies."""
    return int(np.argmin(results.bodies["gap"].min(axis=0))) if results.names else 0


def narrowest(results: Results, body: int | None) -> tuple[int, int]:
    """Numbers of the output time at which a gap was smallest, of one body if it is given, and of that body."""
    gaps = np.array([results.bodies["gap"][results.state_at(time)] for time, _ in results.series])
    if body is not None:
        return int(np.argmin(gaps[:, body])), body
    output, nearest = np.unravel_index(int(np.argmin(gaps)), gaps.shape)
    return int(output), int(nearest)
