"""Forces along the surfaces in an implicit step, of springs that friction holds: solved together with the gaps."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from scipy import sparse

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.model.contacts import normal_part, tangential_part, turning_radius
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.types import Contacts, Motion

_HALVINGS = 50
_ROUNDING = 1e-14


class Rubbing(NamedTuple):
    """Mean ``force`` q of springs and dampers on ``body_a`` (m, c) [force] and its slopes: ``stiffness`` -dq/dw
    (m, c, c) by the way w of the surfaces past each other [force/length], ``rise`` dq/df (m, c) by the normal force
    [1]; ``displacement`` of the springs at the end (m, c) [length]. ``expected``: the force that the slopes begin from,
    that of surfaces that stick where slip has turned round.

    The c components are the d along the axes, and the k of turning where the law has springs that resist it: their way
    is the relative angle times the effective radius R, their force the couple over R.
    """

    force: FloatArray
    expected: FloatArray
    stiffness: FloatArray
    rise: FloatArray
    displacement: FloatArray


class Condensed(NamedTuple):
    """Forces along the surfaces as linear functions of the normal ones f: ``compliance`` of the gaps (m, m)
    [length/force] and ``free`` (m,), the gaps without f [length]; the force ``fixed`` (m, c), to which ``rise`` times f
    is added, (c·m, m), None for nothing."""

    compliance: Any
    free: FloatArray
    fixed: FloatArray
    rise: Any = None

    def along(self, force: FloatArray) -> FloatArray:
        """Forces along the surfaces (m, c), for the normal ``force`` (m,) [force]."""
        return self.fixed if self.rise is None else self.fixed + _rows(self.rise @ force, len(force))


def no_rubbing(force: FloatArray) -> Rubbing:
    """A ``force`` (m, c) that does not depend on how the surfaces move."""
    none, c = np.zeros_like(force), force.shape[1]
    return Rubbing(force, force, np.zeros((len(force), c, c)), none, none)


class Slip(NamedTuple):
    """Attempt at the forces along the surfaces: the ``motion`` in the step of this ``size`` [time] that the forces
    ``used`` (m, c) have led to [force]; ``secant``: whether slopes are to be those of secants, for which attempts
    converge slowly but surely."""

    motion: Motion
    size: float
    used: FloatArray
    secant: bool


class _Slider(NamedTuple):
    """Springs and dashpots that friction holds in some directions: the ``tangents`` (m, c, c) project on these; ``way``
    of the surfaces there [length], the force ``damped`` of dampers, the force ``used``, and the displacement ``held``
    at the start (m, c). ``hold`` gives the displacement that friction holds of another one, at rest."""

    tangents: FloatArray
    way: FloatArray
    damped: FloatArray
    used: FloatArray
    held: FloatArray
    hold: Callable[[Contacts, Motion, FloatArray], FloatArray]


def rubbing(law: ForceLaw, middle: Contacts, end: Contacts, held: FloatArray, slip: Slip) -> Rubbing:
    """Mean force along the surfaces in a step, where springs have the displacement ``held`` ξ₀ (m, c) at its start, and
    ``middle`` has the gaps at which the law gives the mean normal forces; that of dampers where there is no spring.

    Spring and dashpot, side by side, are in a row with the slip s: for the way w = Δξ + s

        q = -[k (ξ₀ + ξ₁)/2 + c Δξ/Δt],   |q| ≤ μ F_n,   s = -λ q with λ ≥ 0 only where |q| = μ F_n.

    The loss q·w less the change of k ξ²/2 is then c Δξ²/Δt + |q| |s| ≥ 0. So are those of ξ₀ and ξ₁, each shortened to
    what friction can hold, ξ₁ at the ``end``. The slopes are those of surfaces that stick if the force is opposite to
    the one used: the slip went too far. Sliding, rolling and twisting are three such rows, each with its own bound.
    """
    sliding = _mapped(law, middle, end, _sliding(law, middle, held, slip), slip)
    if not law.rolling:
        return sliding
    turning = [_mapped(law, middle, end, slider, slip) for slider in _turning(law, middle, held, slip)]
    return _beside(sliding, turning)


def _sliding(law: ForceLaw, middle: Contacts, held: FloatArray, slip: Slip) -> _Slider:
    """Springs along the surfaces."""
    normal, d = middle.normal, middle.normal.shape[1]
    return _Slider(
        np.eye(d) - normal[:, :, None] * normal[:, None, :],
        slip.size * tangential_part(slip.motion.velocity, middle),
        tangential_part(law.damping(middle, slip.motion), middle),
        slip.used[:, :d],
        held[:, :d],
        law.held_displacement,
    )


def _turning(law: ForceLaw, middle: Contacts, held: FloatArray, slip: Slip) -> list[_Slider]:
    """Springs that resist rolling, and in 3D those that resist twisting."""
    d, radius = middle.normal.shape[1], turning_radius(middle)
    way = slip.size * radius * slip.motion.angular_velocity
    damped = _over(law.couple(middle, slip.motion), radius)

    def slider(tangents: FloatArray) -> _Slider:
        def projected(vectors: FloatArray) -> FloatArray:
            return np.asarray(np.einsum("mij,mj->mi", tangents, vectors))

        def hold(contacts: Contacts, motion: Motion, turning: FloatArray) -> FloatArray:
            return projected(law.held_turning(contacts, motion, turning))

        used, before = projected(slip.used[:, d:]), projected(held[:, d:])
        return _Slider(tangents, projected(way), projected(damped), used, before, hold)

    if d == 2:
        return [slider(np.ones((len(middle), 1, 1)))]
    along = middle.normal[:, :, None] * middle.normal[:, None, :]
    return [slider(np.eye(d) - along), slider(along)]


def _mapped(law: ForceLaw, middle: Contacts, end: Contacts, slider: _Slider, slip: Slip) -> Rubbing:
    """Force of springs and dashpots in a row with a slider, by return mapping."""
    motion, stiffness = slip.motion, law.tangential_stiffness(middle)[:, None]
    straight = Motion(motion.velocity - tangential_part(motion.velocity, middle), motion.mass)
    tangents, way, damped, used, held, hold = slider
    before = hold(middle, straight, held)
    resistance = 0.5 * stiffness + middle.sign[:, None] * _over(_length(damped), _length(way))
    tried = stiffness * before + resistance * way
    pulled = stiffness * hold(middle, straight, _over(tried, stiffness))
    after = before + _over(pulled - stiffness * before, resistance)
    sticks = _length(pulled) >= (1.0 - _ROUNDING) * _length(tried)
    turned = ~sticks & (np.sum(pulled * used, axis=1, keepdims=True) > 0.0) & (not slip.secant)
    expected, sticks = np.where(turned, tried, pulled), sticks | turned
    bounded = np.where(sticks, np.where(_length(before) < _length(held), stiffness * before, 0.0), pulled)
    sprung = stiffness != 0.0
    slopes = resistance[:, :, None] * _directions(tangents, expected, tried, sticks | slip.secant)
    return Rubbing(
        np.where(sprung, -pulled, damped),
        np.where(sprung, -expected, damped),
        np.where(sprung[:, :, None], slopes, 0.0),
        -_over(bounded, _normal_force(law, middle, straight)),
        hold(end, Motion(np.zeros_like(motion.velocity), motion.mass), after),
    )


def _beside(sliding: Rubbing, turning: Sequence[Rubbing]) -> Rubbing:
    """Forces of ``sliding``, and beside them the sum of those of ``turning``."""
    force, expected, stiffness, rise, displacement = (sum(each) for each in zip(*turning, strict=True))
    m, d, k = *sliding.force.shape, force.shape[1]
    slopes = np.zeros((m, d + k, d + k))
    slopes[:, :d, :d], slopes[:, d:, d:] = sliding.stiffness, stiffness
    return Rubbing(
        np.hstack([sliding.force, force]),
        np.hstack([sliding.expected, expected]),
        slopes,
        np.hstack([sliding.rise, rise]),
        np.hstack([sliding.displacement, displacement]),
    )


def contacts_of_mean_force(
    law: ForceLaw, start: Contacts, middle: Contacts, gap: FloatArray, force: FloatArray
) -> Contacts:
    """The contacts ``middle`` with gaps between those at the ``start`` and ``gap`` (m,) at which the law has this
    ``force`` (m,), its mean on the way."""
    near, far = np.minimum(start.gap, gap), np.maximum(start.gap, gap)
    for _ in range(_HALVINGS):
        between = replace(middle, gap=0.5 * (near + far))
        weaker = middle.sign * (normal_part(law.force(between), between) - force) < 0.0
        before = near, far
        near, far = np.where(weaker, near, between.gap), np.where(weaker, between.gap, far)
        if np.array_equal((near, far), before):
            break
    return replace(middle, gap=0.5 * (near + far))


def condensed(
    response: Any, contacts: Contacts, rub: Rubbing, gap: FloatArray, normal: FloatArray, along: FloatArray
) -> Condensed:
    """Forces along the surfaces by their slopes at the ``gap`` (m,) [length] that the forces ``normal`` (m,) and
    ``along`` (m, c) [force] have led to, where ``response`` (c·m, c·m) is that of all ways to all forces
    [length/force]."""
    dense, straight = isinstance(response, np.ndarray), np.zeros_like(along)
    straight[:, : contacts.normal.shape[1]] = contacts.normal
    columns = straight[:, :, None], rub.rise[:, :, None], rub.stiffness
    ahead, lift, slope = (_blocks(entries, dense) for entries in columns)
    identity = np.eye(len(response)) if dense else sparse.eye(response.shape[0])
    lag = (rub.expected - along).T.ravel()
    rise, missing = _solved(identity + slope @ response, lift - slope @ (response @ ahead), lag)
    opening = ahead.T @ response
    compliance = opening @ ahead + opening @ rise
    fixed = along + _rows(missing - rise @ normal, len(normal))
    return Condensed(compliance, gap + opening @ missing - compliance @ normal, fixed, rise)


def _rows(column: FloatArray, count: int) -> FloatArray:
    """Vectors (m, c) of a ``column`` (c·m,) of all first components, all second ones, …"""
    return np.asarray(column.reshape(-1, count).T)


def _solved(matrix: Any, right: Any, lag: FloatArray) -> tuple[Any, FloatArray]:
    """Solutions of ``matrix`` x = ``right`` (c·m, m) and = ``lag`` (c·m,)."""
    if isinstance(matrix, np.ndarray):
        both = np.linalg.solve(matrix, np.column_stack([right, lag]))
        return both[:, :-1], both[:, -1]
    from scipy.sparse.linalg import splu

    factors = splu(sparse.csc_matrix(matrix))
    return sparse.csr_matrix(factors.solve(right.toarray())), factors.solve(lag)


def _blocks(entries: FloatArray, dense: bool) -> Any:
    """Matrix (a·m, b·m) of a·b diagonal blocks, from the ``entries`` (m, a, b) on their diagonals."""
    count, rows, columns = entries.shape
    if dense:
        matrix, here = np.zeros((rows, count, columns, count)), np.arange(count)
        matrix[:, here, :, here] = entries
        return matrix.reshape(rows * count, columns * count)
    contact, row, column = np.indices(entries.shape)
    places = (row * count + contact).ravel(), (column * count + contact).ravel()
    return sparse.csr_matrix((entries.ravel(), places), (rows * count, columns * count))


def _directions(tangents: FloatArray, pulled: FloatArray, tried: FloatArray, also_ahead: BoolArray) -> FloatArray:
    """Derivative (m, c, c) along the ``tangents`` (m, c, c) of forces ``pulled`` by those ``tried``, which were
    shortened to them; those ``also_ahead`` (m, 1) are shortened by the same factor."""
    length = _length(tried)
    ahead = _over(tried, length)
    sideways = tangents - np.where(also_ahead, 0.0, 1.0)[:, :, None] * ahead[:, :, None] * ahead[:, None, :]
    part = np.where(length > 0.0, _over(_length(pulled), length), 1.0)
    return np.asarray(part[:, :, None] * sideways)


def _normal_force(law: ForceLaw, contacts: Contacts, motion: Motion) -> FloatArray:
    return normal_part(law.force(contacts) + law.damping(contacts, motion), contacts)[:, None]


def _length(vectors: FloatArray) -> FloatArray:
    return np.asarray(np.linalg.norm(vectors, axis=1, keepdims=True))


def _over(numerator: FloatArray, denominator: FloatArray) -> FloatArray:
    """Quotient (m, c) by a column or by components, zero where the denominator is."""
    return np.divide(numerator, denominator, out=np.zeros_like(numerator), where=denominator != 0.0)
