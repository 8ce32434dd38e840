"""Hunt and Crossley's damper in an impact, whatever the law that it belongs to."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.piecewise_cubic import PiecewiseCubic

LEAST = 0.05
"""Least restitution: at range the force is then 21 times the law's own, and that grows as 1/e."""

_NODES = 400
"""Number of nodes on either side of rest; forces are then right to 1e-6 with LEAST, and to 1e-9 from a restitution of a
half on."""

_SLIGHTEST = 1e-6
"""Least logarithm L, at a restitution of 1 - 3e-7: below it differences are lost in rounding."""

_HALVINGS = 30


class Hardening(NamedTuple):
    """Factor 1 + y on a law's force, from y = ``most`` x where range is reached to y = -``least``, e x, where it is
    left with the restitution e; ``room`` 1 - e x; (m,) [1]."""

    most: FloatArray
    least: FloatArray
    room: FloatArray


def hardening(restitution: FloatArray) -> Hardening:
    """Solution x of x (1 + e) = ln[(1 + x)/(1 - e x)] for each ``restitution`` e (m,) from LEAST to 1 [1].

    The logarithm is L = x + e x, so that e x = 1 - L/(exp L - 1); e is thus known over L.
    """
    return _hardening_by_logarithm(np.maximum(_logarithm()(restitution), _SLIGHTEST))


def excess(restitution: float, share: FloatArray) -> FloatArray:
    """Excess y = x ẇ/v (m,) of the force over the law's, with (v/x)² [G(x) - G(y)] = U/m and G(y) = y - ln(1 + y) [1].

    ``restitution`` e is from LEAST to 1 [1]; ``share`` (m,) is ẇ/√(ẇ² + 2U/m), from -1 to 1, with the closing speed ẇ,
    the energy U of the law and the effective mass m [1].
    """
    return np.asarray(share * excess_per_share(restitution)(share))


def excess_by_speed(
    closing: FloatArray, stored: FloatArray, hardening_at: Callable[[FloatArray], Hardening]
) -> FloatArray:
    """Excess y (m,) [1] where x depends on the speed v at which range was reached, which is found by halving.

    The speed v is unique, as (v/x)² [G(x) - G(x ẇ/v)] = ∫ u du/(1 + u x/v) from ẇ to v grows with v where x/v falls
    with it: so it is if the restitution never falls with the speed. The root lies between √(ẇ² + 2U/m) and 1/e times
    that. ``closing`` is ẇ (m,) [length/time], ``stored`` 2U/m (m,) [length²/time²], ``hardening_at`` the `Hardening` of
    impacts at speeds v (m,).
    """
    slowest = np.sqrt(np.maximum(closing**2 + stored, np.finfo(float).tiny))
    low, high = np.zeros_like(slowest), np.full_like(slowest, -np.log(LEAST))
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        speed = slowest * np.exp(middle)
        harder = hardening_at(speed)
        now = np.maximum(harder.most * closing / speed, -harder.least)
        enough = 2.0 * (speed / harder.most) ** 2 * (_work(harder.most) - _work(now)) >= stored
        low, high = np.where(enough, low, middle), np.where(enough, middle, high)
    return np.asarray(now)


def _work(excess: FloatArray) -> FloatArray:
    """Work G(y) = y - ln(1 + y) = ∫ y dy/(1 + y) of the law in units of m (v/x)²."""
    return np.asarray(excess - np.log1p(excess))


def _hardening_by_logarithm(logarithm: FloatArray) -> Hardening:
    """Hardening (m,) of impacts with the logarithm L (m,)."""
    room = np.asarray(logarithm / np.expm1(logarithm))
    return Hardening(logarithm - 1.0 + room, 1.0 - room, room)


@lru_cache(maxsize=1)
def _logarithm() -> PiecewiseCubic:
    """L over the restitution; near 1 it is 3 (1 - e)."""
    logarithm = np.linspace(1e-3, 1.0 + 1.1 / LEAST, 10 * _NODES)
    most, least, room = _hardening_by_logarithm(logarithm)
    fall = room / logarithm - room**2 / logarithm - room
    slope = -(most**2) / (fall * most + least * (1.0 + fall))
    ends = (np.append(one[::-1], end) for one, end in ((least / most, 1.0), (logarithm, 0.0), (slope, -3.0)))
    return PiecewiseCubic(*ends)


@lru_cache
def excess_per_share(restitution: float) -> PiecewiseCubic:
    """Excess y/share over the share, √(2 G(x)) at rest; nodes are even in ln(1 + y)."""
    most, _, room = (float(one) for one in hardening(np.array(restitution)))
    ends = np.log(room), 0.0, np.log1p(most)
    nodes = np.concatenate([np.linspace(*ends[:2], _NODES), np.linspace(*ends[1:], _NODES)[1:]])
    y = np.expm1(nodes)
    left = np.maximum(most - ends[2] - (y - nodes), 0.0)
    ratio = np.sqrt(y**2 + 2.0 * left)
    share = y / ratio
    share[[0, -1]] = -1.0, 1.0
    return PiecewiseCubic(share, ratio, y**2 / (1.0 + y - share**2 * y))
