"""Impulse response of bodies in the fluid: by mass and incompressibility alone, and by a step's own matrix."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.types import Response, Step
from rigidfluid.taylor_hood.coupled import CoupledMatrix
from rigidfluid.taylor_hood.discretisation import Discretisation

_TOLERANCE = 1e-4
"""Relative residual of the response by a step's matrix [1]: the response is up to thirty times as wrong, and a
contact's energy is as wrong as that."""

_INVISCID_TOLERANCE = 1e-5
"""Relative residual of the inviscid response [1], which was up to nine times as wrong for a disk dropped in the plane.
With 1e-3 it was off by .6 %, and impacts lost half as much energy again."""


def response(discretisation: Discretisation, matrix: CoupledMatrix, step: Step, impulses: FloatArray) -> Response:
    """W_s = d₀ Eᵀ S⁻¹ E of the step's ``matrix`` S, and W_i = Eᵀ 𝓜⁻¹ E of its masses 𝓜, times ``impulses`` (c, n, d+k).

    E puts wrenches on the bodies. 𝓜 holds fluid and bodies on velocities that are rigid on bodies and without
    divergence: so W_i⁻¹ is the bodies' mass with the added mass in the present geometry, walls, films and neighbours in
    it. Without inertia of the fluid it is the bodies' own.
    """
    d0, loads = step.derivative[0], np.moveaxis(impulses, 0, -1)
    viscous = d0 * discretisation.twist_response(matrix, loads, _TOLERANCE)
    if matrix.at_once is None:
        inviscid = _body_response(matrix, d0 * loads)
    else:
        inviscid = discretisation.twist_response(matrix.at_once, loads, _INVISCID_TOLERANCE)
    return Response(np.moveaxis(inviscid, -1, 0), np.moveaxis(viscous, -1, 0))


def _body_response(matrix: CoupledMatrix, loads: FloatArray) -> FloatArray:
    free, twists = ~matrix.prescribed, np.zeros_like(loads)
    twists[free] = np.linalg.solve(matrix.mass_matrix[free], loads[free])
    return twists
