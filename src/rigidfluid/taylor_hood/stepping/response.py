"""Impulse response of bodies in the fluid: by mass and incompressibility alone, and by a step's own matrix."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.types import Response, Step
from rigidfluid.taylor_hood.system.coupled import CoupledMatrix
from rigidfluid.taylor_hood.system.discretisation import Discretisation

_TOLERANCE = 1e-4
"""Relative residual of the response by a step's matrix [1]: the relative error of the response, and so of a contact's
energy, is up to thirty times that."""

_INVISCID_TOLERANCE = 1e-5
"""Relative residual of the inviscid response [1]: for a disk dropped in the plane the error was up to nine times that.
With 1e-3 it was .6 %, and impacts lost half as much energy again."""

_SHARED_TOLERANCE = 2e-3
"""Relative residual of both where bodies far apart share right sides [1]: what each of them does to the other's
neighbours, some hundredths, is left out then."""


def response(discretisation: Discretisation, matrix: CoupledMatrix, step: Step, impulses: FloatArray) -> Response:
    """Twists of the bodies by ``impulses`` (c, n, d+k): W_i = Eᵀ 𝓜⁻¹ E and W_s = d₀ Eᵀ 𝓚⁻¹ E times these.

    E puts wrenches on the bodies, 𝓚 is the step's ``matrix`` and 𝓜 its masses alone, for velocities that are rigid on
    bodies and without divergence: so W_i⁻¹ is the bodies' mass with the added mass among the present walls and
    neighbours. Without inertia of the fluid it is the bodies' own.
    """
    d0, loads = step.derivative[0], np.moveaxis(impulses, 0, -1)
    tolerance, inviscid_tolerance = (_SHARED_TOLERANCE,) * 2 if step.shared else (_TOLERANCE, _INVISCID_TOLERANCE)
    viscous = d0 * discretisation.twist_response(matrix, loads, tolerance)
    if matrix.masses is None:
        inviscid = _body_response(matrix, d0 * loads)
    else:
        inviscid = discretisation.twist_response(matrix.masses, loads, inviscid_tolerance)
    return Response(np.moveaxis(inviscid, -1, 0), np.moveaxis(viscous, -1, 0))


def _body_response(matrix: CoupledMatrix, loads: FloatArray) -> FloatArray:
    """Twists that the bodies' own ``mass_matrix`` gives, zero where they are prescribed."""
    free, twists = ~matrix.prescribed, np.zeros_like(loads)
    twists[free] = np.linalg.solve(matrix.mass_matrix[free], loads[free])
    return twists
