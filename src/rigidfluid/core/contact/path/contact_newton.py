"""Contact forces of one implicit step by Newton's method, where gaps depend on them linearly."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy import sparse

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.types import Contacts
from rigidfluid.errors import StepRejected

MOST_ITERATIONS = 100
"""Largest number of Newton iterations; more reject the step."""

MOST_DENSE = 200
"""Largest number of contacts with a full matrix; a sparse one is faster for more."""

_ROUNDING = 1e-13
_NARROW = 2e-5
_SHRINK = 0.1
_FLATTER = 0.5
_HALVINGS = 30


@dataclass(frozen=True, slots=True)
class Problem:
    """Problem f = s φ(g) - c (g + o) for f, where the gaps at the end of the step are g = ``free`` + ``compliance`` f.

    φ is the discrete gradient -[U(g) - U(g₀)]/(g - g₀) of the law's energy, with g₀ the gaps of the contacts at
    ``start`` of the step. ``free`` (m,) [length], ``compliance`` (m, m), dense or sparse [length/force], ``scale`` s
    (m,) [1], ``drag`` c (m,) [force/length], ``offset`` o (m,): g + o is the way along the normal in the step [length].
    """

    law: ForceLaw
    start: Contacts
    free: FloatArray
    compliance: Any
    scale: FloatArray
    drag: FloatArray
    offset: FloatArray

    def law_force(self, gap: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Force f of the law and the drag at this gap (m,) [force], and -df/dg (m,) [force/length]."""
        force, slope = discrete_gradient(self.law, self.start, gap)
        return self.scale * force - self.drag * (gap + self.offset), self.scale * slope + self.drag


def discrete_gradient(law: ForceLaw, start: Contacts, gap: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Discrete gradient φ = -[U(g) - U(g₀)]/(g - g₀) (m,), the force whose work from g₀ to g is -ΔU, F if g ≈ g₀
    [force], and -dφ/dg (m,), not below zero [force/length].

    ``start`` are the m contacts at g₀, ``gap`` is g (m,), positive [length]. Gonzalez, J. Nonlinear Sci. 6 (1996) 449,
    doi:10.1007/BF02440162.
    """
    end, middle = replace(start, gap=gap), replace(start, gap=0.5 * (gap + start.gap))
    change = gap - start.gap
    narrow = np.abs(change) <= _NARROW * np.minimum(gap, start.gap)
    width = np.where(narrow, 1.0, change)
    mean = np.where(narrow, _along(law, middle), (law.energy(start) - law.energy(end)) / width)
    slope = np.where(narrow, 0.5 * law.stiffness(middle), (mean - _along(law, end)) / width)
    return mean, np.maximum(slope, 0.0)


def contact_forces(problem: Problem, force: FloatArray, gap: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Forces f (m,) [force] and positive gaps g (m,) [length] of a ``problem``, by Newton's method with a line search
    that keeps all gaps open; raises StepRejected if it does not converge.

    The solution for a law that grows steadily is the minimum of a convex function of the bodies' ways: so there is one
    only, and the search follows that function's slope. The start may be any ``force`` with any open ``gap``: their
    mismatch is reduced with each part of a step.
    """
    lacking = gap - (problem.free + problem.compliance @ force)
    lacking = np.where(np.abs(lacking) <= _tolerance(problem), 0.0, lacking)
    for _ in range(MOST_ITERATIONS):
        law_force, slope = problem.law_force(gap)
        rest = force - law_force
        step = _solved(problem.compliance, slope, slope * lacking - rest)
        moved = problem.compliance @ step - lacking
        if np.all(np.abs(moved) <= _tolerance(problem)) and np.all(gap + moved > 0.0):
            return force + step, gap + moved
        part = _open_part(gap, moved) if lacking.any() else _searched(problem, force, gap, step, moved)
        lacking = (1.0 - part) * lacking
        force = force + part * step
        gap = gap + part * moved
    raise StepRejected(
        "the implicit contact step",
        f"no forces after {MOST_ITERATIONS} iterations",
        "forces that keep all gaps open",
        "Strengthen the contact force, widen its range or shorten the step.",
    )


def _tolerance(problem: Problem) -> FloatArray:
    return _ROUNDING * (problem.law.range + np.abs(problem.free) + problem.start.gap)


def _along(law: ForceLaw, contacts: Contacts) -> FloatArray:
    return np.asarray(np.sum(law.force(contacts) * contacts.normal, axis=1))


def _solved(compliance: Any, slope: FloatArray, right: FloatArray) -> FloatArray:
    """Solution of (1 + slope · compliance) x = right, (m,)."""
    if isinstance(compliance, np.ndarray):
        try:
            return np.asarray(np.linalg.solve(np.eye(len(slope)) + slope[:, None] * compliance, right))
        except np.linalg.LinAlgError:
            found, allowed = "forces whose change with the gap outweighs all else by rounding", "softer ones"
            raise StepRejected("the implicit contact step", found, allowed, "Raise the law's epsilon.") from None
    from scipy.sparse.linalg import spsolve

    matrix = sparse.eye(len(slope)) + sparse.diags(slope) @ compliance
    return np.asarray(spsolve(matrix.tocsc(), right))


def _open_part(gap: FloatArray, moved: FloatArray) -> float:
    """Largest part of a move, at most 1, that leaves a tenth of each gap."""
    closing = moved < 0.0
    return float(np.min((1.0 - _SHRINK) * gap[closing] / -moved[closing], initial=1.0))


def _searched(problem: Problem, force: FloatArray, gap: FloatArray, step: FloatArray, moved: FloatArray) -> float:
    """Part of a step at which the convex function no longer rises half as steeply as it falls at the start."""

    def slope(part: float) -> float:
        return float(moved @ (force + part * step - problem.law_force(gap + part * moved)[0]))

    part, steepest = _open_part(gap, moved), -slope(0.0)
    for _ in range(_HALVINGS):
        if slope(part) <= _FLATTER * steepest:
            break
        part *= 0.5
    return part
