"""Drag and lift coefficients and Strouhal numbers of a run: the fluid's force over that of a reference speed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.shapes import equal_volume_radius
from rigidfluid.post.reports.periods import frequency, late, late_periods
from rigidfluid.post.reports.results import Results
from rigidfluid.post.reports.stream import prescribed_stream
from rigidfluid.post.reports.view_plane import plane_of_motion

_LEAST_LIFT = 1e-3
"""Least amplitude of the lift over the mean drag: smaller swings are rounding, or asymmetry of the mesh."""
_LEAST_WAY = 1e-2
"""Least amplitude of a path over the diameter: smaller swings count as none."""
_LEAST_LEFT = 0.1
"""The sine of the angle between the flow and the normal of the plane of motion below which lift is along its ``up``."""


@dataclass(frozen=True)
class Reference:
    """The ``speed`` U [length/time], the directions (d, d) in rows, along the flow past the bodies and across it, and
    ``words`` on where U is from."""

    speed: float
    axes: FloatArray
    words: str


@dataclass(frozen=True)
class Figures:
    """Coefficients of a body in the second half of its time, over whole periods if there are any.

    Mean ``drag``, mean ``lift``, half of the lift's range (``swing``), and the ``strouhal`` number f D/U, None where
    there is no period; ``by`` what it is measured, lift or path.
    """

    drag: float
    lift: float
    swing: float
    strouhal: float | None
    by: str


def reference(results: Results) -> Reference | None:
    """The stream that the scene prescribes, else the fastest motion that it prescribes to a body; None without both, as
    for bodies that fall, whose speed is a result, without a fluid, and in one without inertia."""
    problem = results.system.fluid
    if problem is None or not problem.inertia:
        return None
    stream = prescribed_stream(results)
    if stream is not None:
        words = "the greatest mean velocity of an inlet"
        return Reference(float(np.linalg.norm(stream)), _axes(results, stream), words)
    towed = results.quantity("velocity")[results.present & results.system.prescribed]
    speed = np.linalg.norm(towed, axis=1)
    if not speed.any():
        return None
    fastest = towed[speed.argmax()]
    return Reference(float(speed.max()), _axes(results, -fastest), "the greatest prescribed speed of a body")


def diameters(results: Results) -> FloatArray:
    """Diameters of the balls of equal volume (n,) [length]."""
    return np.array([2.0 * equal_volume_radius(body) for body in results.system.bodies])


def coefficients(results: Results, by: Reference) -> FloatArray:
    """F/(½ρU²D), in 3D F/(½ρU²πD²/4), along each axis of the reference (s, n, d); not known in the first state."""
    assert results.system.fluid is not None
    density = results.system.fluid.density
    width = diameters(results)
    area = width if results.system.dimension == 2 else 0.25 * np.pi * width**2
    found: FloatArray = results.quantity("force") @ by.axes.T / (0.5 * density * by.speed**2 * area[:, None])
    found[0] = np.nan
    return found


def figures(results: Results, by: Reference) -> Iterator[Figures]:
    """Coefficients of each body."""
    found, time = coefficients(results, by)[1:], results.time[1:]
    across = results.quantity("position")[1:] @ by.axes[1]
    for i, (width, there) in enumerate(zip(diameters(results), results.present[1:].T, strict=True)):
        yield _figures(time[there], found[there, i], across[there, i], width, by)


def _figures(time: FloatArray, found: FloatArray, across: FloatArray, width: float, by: Reference) -> Figures:
    """Coefficients from those ``found`` (s, d) for a body of this diameter, and its way ``across`` (s,) the flow."""
    if not len(time):
        return Figures(np.nan, np.nan, np.nan, None, "path")
    scale = np.abs(found[late(time), 0]).mean()
    by_lift = frequency(time, found[:, 1], _LEAST_LIFT * scale)
    rate = by_lift or frequency(time, across, _LEAST_WAY * width)
    chosen = late(time) if rate is None else late_periods(time, rate)
    drag, lift = (_mean(time[chosen], found[chosen, k]) for k in (0, 1))
    strouhal = None if rate is None else rate * width / by.speed
    swing = 0.5 * float(np.ptp(found[chosen, 1]))
    return Figures(drag, lift, swing, strouhal, "path" if by_lift is None else "lift")


def _mean(time: FloatArray, values: FloatArray) -> float:
    return float(np.trapezoid(values, time) / np.ptp(time)) if len(time) > 1 else float(values[-1])


def _axes(results: Results, along: FloatArray) -> FloatArray:
    """Rows: along; across it to its left, in 3D in the plane of motion; and in 3D across that plane."""
    first = along / np.linalg.norm(along)
    if len(first) == 2:
        return np.array([first, [-first[1], first[0]]])
    plane = plane_of_motion(results)
    left = np.cross(plane.normal, first)
    if np.linalg.norm(left) < _LEAST_LEFT:
        left = plane.up
    second = left - (left @ first) * first
    second = second / np.linalg.norm(second)
    return np.array([first, second, np.cross(first, second)])
