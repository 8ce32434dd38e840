"""How Hunt and Crossley's damper acts in an impact, whatever the law that it belongs to."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rigidfluid.core.model.types import FloatArray

if TYPE_CHECKING:
    from scipy.interpolate import CubicSpline

LEAST = 0.05
"""The least restitution: at range the force is then 21 times the law's own, and that grows as 1/e."""

_NODES = 400
"""On either side of rest; forces are then right to 1e-6 with LEAST, and to 1e-9 from a restitution of a half on."""

_SLIGHTEST = 1e-6
"""The least logarithm L, at a restitution of 1 - 3e-7: below it differences are lost in rounding."""

_HALVINGS = 30


class Hardening(NamedTuple):
    """The factor on a law's force is 1 + y, from y = ``most`` x where range is reached to y = -``least``, e x, where it
    is left with the restitution e; ``room`` 1 - e x; (m,) [1]."""

    most: FloatArray
    least: FloatArray
    room: FloatArray


def hardening(restitution: FloatArray) -> Hardening:
    """x (1 + e) = ln[(1 + x)/(1 - e x)], solved for x.

    With L = x + e x, which the logarithm is, e x = 1 - L/(exp L - 1); so e is known over L.

    Parameters
    ----------
    restitution : (m,) array
        e, from LEAST to 1 [1].

    Returns
    -------
    Hardening
        Of each.
    """
    return _of_logarithm(np.maximum(_logarithm()(restitution), _SLIGHTEST))


def excess(restitution: float, share: FloatArray) -> FloatArray:
    """y = x ẇ/v with (v/x)² [G(x) - G(y)] = U/m and G(y) = y - ln(1 + y).

    Parameters
    ----------
    restitution : float
        e, from LEAST to 1 [1].
    share : (m,) array
        ẇ/√(ẇ² + 2U/m), from -1 to 1, with the closing speed ẇ, the energy U of the law and the effective mass m [1].

    Returns
    -------
    (m,) array
        By which the force exceeds the law's [1].
    """
    return np.asarray(share * _excess_per_share(restitution)(share))


def excess_by_speed(
    closing: FloatArray, stored: FloatArray, hardening_at: Callable[[FloatArray], Hardening]
) -> FloatArray:
    """The same where x depends on the speed v at which range was reached, which is found by halving.

    There is one v, as (v/x)² [G(x) - G(x ẇ/v)] = ∫ u du/(1 + u x/v) from ẇ to v grows with v where x/v falls with it:
    so it is if the restitution never falls with the speed. It lies between √(ẇ² + 2U/m) and 1/e times that.

    Parameters
    ----------
    closing, stored : (m,) array
        ẇ [length/time] and 2U/m [length²/time²].
    hardening_at : callable
        What the impact is at speeds v (m,).

    Returns
    -------
    (m,) array
        y [1].
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
    """G(y) = y - ln(1 + y) = ∫ y dy/(1 + y), the work of the law in units of m (v/x)²."""
    return np.asarray(excess - np.log1p(excess))


def _of_logarithm(logarithm: FloatArray) -> Hardening:
    room = np.asarray(logarithm / np.expm1(logarithm))
    return Hardening(logarithm - 1.0 + room, 1.0 - room, room)


@lru_cache(maxsize=1)
def _logarithm() -> CubicSpline:
    """L over the restitution; near 1 it is 3 (1 - e)."""
    from scipy.interpolate import CubicSpline

    logarithm = np.linspace(1e-3, 1.0 + 1.1 / LEAST, 10 * _NODES)
    harder = _of_logarithm(logarithm)
    restitution = harder.least / harder.most
    return CubicSpline(np.append(restitution[::-1], 1.0), np.append(logarithm[::-1], 0.0))


@lru_cache
def _excess_per_share(restitution: float) -> CubicSpline:
    """y over the share, which at rest is √(2 G(x)), over the share; nodes are even in ln(1 + y)."""
    from scipy.interpolate import CubicSpline

    most, _, room = (float(one) for one in hardening(np.array(restitution)))
    ends = np.log(room), 0.0, np.log1p(most)
    nodes = np.concatenate([np.linspace(*ends[:2], _NODES), np.linspace(*ends[1:], _NODES)[1:]])
    y = np.expm1(nodes)
    left = np.maximum(most - ends[2] - (y - nodes), 0.0)
    ratio = np.sqrt(y**2 + 2.0 * left)
    share = y / ratio
    share[[0, -1]] = -1.0, 1.0
    return CubicSpline(share, ratio)
