"""The velocity without divergence that is nearest to another one, by a step's own solver, on any processes."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.taylor_hood.system.coupled import CoupledMatrix, CoupledSystem
from rigidfluid.taylor_hood.system.discretisation import Discretisation


class CoupledProjection:
    """A step of masses and divergence alone.

    Parameters
    ----------
    target : Discretisation
        All its bodies are prescribed.
    points : (vertices + K, d) array
        The geometry.
    position : (N, d) array
        Centres of the motions [length].
    """

    def __init__(self, target: Discretisation, points: FloatArray, position: FloatArray) -> None:
        self._target = target
        numbering, motions = target.numbering, len(position)
        width = 3 if numbering.dimension == 2 else 6
        node_points = numbering.node_points(points)
        still = np.zeros_like(node_points)
        self._matrix = CoupledMatrix(
            points=points,
            node_points=node_points,
            inertia=1.0,
            viscosity=0.0,
            advection=still,
            flow=still,
            position=position,
            mass_matrix=np.zeros((motions, width, width)),
            prescribed=np.ones(motions, dtype=bool),
            frame=np.zeros(numbering.dimension),
        )

    def nearest(
        self, velocity: FloatArray, tolerance: float, guess: FloatArray, prescribed: FloatArray | None = None
    ) -> FloatArray:
        target, matrix = self._target, self._matrix
        none, still = np.zeros(matrix.mass_matrix.shape[:2]), np.zeros(target.numbering.vertices)
        of_guess = target.mass_times(matrix.points, guess)
        system = CoupledSystem(
            matrix,
            load=target.mass_times(matrix.points, velocity),
            body_load=none,
            prescribed=target.surfaces.prescribed_part(velocity if prescribed is None else prescribed),
            velocity=guess,
            pressure=still,
            twist=none,
            pressure_jump=still,
            scale=float(np.sqrt(target.surfaces.ranks.sum(np.sum(of_guess**2)))),
        )
        return target.solve(system, tolerance).velocity

    def product(self, first: FloatArray, second: FloatArray) -> float:
        local = np.sum(first * self._target.mass_times(self._matrix.points, second))
        return float(self._target.surfaces.ranks.sum(local))
