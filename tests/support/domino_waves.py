"""Speed of the front of a row of falling dominoes, by the theory of van Leeuwen.

Notes
-----
J. M. J. van Leeuwen, The domino effect, Am. J. Phys. 78 (2010) 721, doi:10.1119/1.3406154. Dominoes turn about their
lower edges and do not slide there, impacts are inelastic, and each domino leans with its upper edge on the next one,
with friction. So the angle of the foremost gives those of all behind it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp

from rigidfluid.core.geometry.arrays import FloatArray

TIPPED = 0.05
"""Angle from which on a domino counts as falling [rad]."""


def measured_speeds(time: FloatArray, lean: FloatArray, pitch: float, gravity: float) -> FloatArray:
    """Distance of dominoes of height 1 over the time from one's fall to the next one's, (n - 2,) [√(g h)], from the
    second one on; ``lean`` (steps, n) are their angles at each ``time`` (steps,)."""
    falls = []
    for angle in lean.T[1:]:
        after = int(np.argmax(angle > TIPPED))
        falls.append(np.interp(TIPPED, angle[after - 1 : after + 1], time[after - 1 : after + 1]))
    return np.asarray(pitch / np.diff(falls) / np.sqrt(gravity))


class Lean(NamedTuple):
    """Dominoes behind the foremost one, and that one first: their angles θ [rad], dθ/dθ₀ and d²θ/dθ₀², and what a
    torque on each adds to that on the foremost, (n,) each [1]."""

    angle: FloatArray
    rate: FloatArray
    bend: FloatArray
    lever: FloatArray


def front_speeds(thickness: float, gap: float, friction: float, count: int, start: float = 1.0) -> FloatArray:
    """Distance of dominoes over the time from impact to impact, (count,) [√(g h)], of dominoes of height 1.

    ``thickness`` and ``gap`` are over the height, ``start`` is the first angular velocity [√(g/h)].
    """
    inertia, hit = (1.0 + thickness**2) / 3.0, np.arcsin(gap)
    times, velocity = np.empty(count), start

    def reached(_: float, place: FloatArray) -> float:
        return float(place[0] - hit)

    reached.terminal = True  # type: ignore[attr-defined]
    for moving in range(1, count + 1):

        def accelerated(_: float, place: FloatArray, moving: int = moving) -> list[float]:
            lean = lean_of(float(place[0]), moving, thickness, gap, friction)
            weight = 0.5 * (np.sin(lean.angle) - thickness * np.cos(lean.angle)) / inertia
            return [place[1], lean.lever @ (weight - lean.bend * place[1] ** 2) / (lean.lever @ lean.rate)]

        fall = solve_ivp(accelerated, (0.0, 50.0), [0.0, velocity], events=reached, rtol=1e-8, atol=1e-10)
        times[moving - 1] = fall.t[-1]
        before = lean_of(float(hit), moving, thickness, gap, friction)
        after = lean_of(0.0, moving + 1, thickness, gap, friction)
        velocity = fall.y[1, -1] * (after.lever[1:] @ before.rate) / (after.lever @ after.rate)
    return (gap + thickness) / times


def lean_of(foremost: float, count: int, thickness: float, gap: float, friction: float) -> Lean:
    """Angles of ``count`` dominoes, the foremost one at its angle [rad]."""
    pitch, rows = gap + thickness, [(foremost, 1.0, 0.0, 1.0)]
    for _ in range(count - 1):
        angle, rate, bend, lever = rows[-1]
        apart = np.arcsin(pitch * np.cos(angle) - thickness)
        opening = -pitch * np.sin(angle) / np.cos(apart)
        slope = np.cos(angle) * np.cos(apart) + np.sin(angle) * np.sin(apart) * opening
        height = np.cos(apart) - pitch * np.sin(angle)
        passed_on = (height - friction * thickness) / (np.cos(apart) + friction * np.sin(apart))
        rows.append(
            (
                angle + apart,
                rate * (1.0 + opening),
                bend * (1.0 + opening) - rate**2 * pitch * slope / np.cos(apart) ** 2,
                lever * passed_on,
            )
        )
    return Lean(*(np.array(column) for column in zip(*rows, strict=True)))
