"""A scalar that the fluid carries along, temperature or concentration, with all that it needs on surfaces."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from rigidfluid.core.fluid.conduction import Conduction
from rigidfluid.core.geometry.arrays import FloatArray

ScalarValue = Callable[[float, FloatArray], FloatArray]
"""Values (N,) at a time and points (N, d)."""


@dataclass(frozen=True)
class ScalarCondition:
    """Condition of the scalar on a surface, a body or a piece of the boundary: nothing goes through unless said.

    ``value(time, points)`` (N,): held there; on a face through which the fluid goes as it likes, that of what comes in.
    ``flux(time, points)`` (N,): given, into the fluid [scalar·length/time]. ``capacity``: of a body that has one value,
    its ``value`` at the start, which changes by the flux: its heat capacity over the fluid's per volume [length^d].
    ``conduction``: in a body inside which the scalar is solved for, from its ``value`` at the start on.
    """

    value: ScalarValue | None = None
    flux: ScalarValue | None = None
    capacity: float | None = None
    conduction: Conduction | None = None

    @property
    def is_lumped(self) -> bool:
        """Tell whether it is a body with one value that changes."""
        return self.capacity is not None

    @property
    def is_solved(self) -> bool:
        """Tell whether it is a body whose value, or values, are solved for; ``value`` is then that at the start."""
        return self.is_lumped or self.conduction is not None


NO_FLUX = ScalarCondition()
"""Condition where none is given: nothing goes through."""


@dataclass(frozen=True)
class Buoyancy:
    """Boussinesq's approximation: the fluid weighs -ρβ(T - T₀)g more where the scalar T differs from T₀.

    ``expansion`` β [1/scalar], ``reference`` T₀ [scalar], ``gravity`` g (d,) [length/time²].
    """

    expansion: float
    reference: float
    gravity: FloatArray

    def force(self, density: float, scalar: FloatArray) -> FloatArray:
        """Force on a fluid of this ``density`` where the ``scalar`` is (N,), (N, d) [force/volume]."""
        return np.asarray(-density * self.expansion * (scalar - self.reference)[:, None] * self.gravity)


@dataclass(frozen=True)
class ScalarProblem:
    """The equation of the scalar: ∂T/∂t + ∇·(u T) = ∇·(κ∇T) + s.

    ``diffusivity`` κ [length²/time]; ``initial(0, points)`` (N,) [scalar]; ``source(time, points)`` (N,)
    [scalar/time]; ``conditions``: one for each surface, bodies first; ``buoyancy`` None where the flow does not feel
    it.
    """

    diffusivity: float
    initial: ScalarValue
    conditions: tuple[ScalarCondition, ...]
    source: ScalarValue | None = None
    buoyancy: Buoyancy | None = None
