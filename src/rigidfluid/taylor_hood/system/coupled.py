"""The linear system of one step, fluid and bodies together, and its solution."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.taylor_hood.system.local_viscosity import UNIFORM, LocalViscosity


@dataclass(frozen=True, eq=False)
class CoupledMatrix:
    """Matrix of u and p on the nodes and vertices of one process' part, and of the twists of the bodies that are free:

    inertia (u, v) + (a·∇u, v) + ½ ((∇·c) u, v) + viscosity (∇u + ∇uᵀ, ∇v) + (γ ∇·u, ∇·v) - (p, ∇·v) - (∇·u, q)

    for velocities that move rigidly with each body, plus ``mass_matrix`` · twist on the bodies; γ follows from c, see
    `grad_div`. All this is of u - ``frame`` (d,), the container's velocity; its inertia is in the load.

    ``points`` (vertices + K, d): the mesh's geometry; ``node_points`` (nodes, d). ``advection`` a and ``flow`` c,
    (nodes, d), already hold the density: c is what flows past the container, a what flows past the mesh; the term of
    ∇·c keeps convection from making energy.
    ``local``: what varies of the viscosity, over ``viscosity``, and how it changes with u.
    ``mass_matrix``, ``prescribed`` are of all motions that carry the bodies, as in `Step`; ``position`` (n, d): the
    centres of these motions in the images of the bodies that are on the mesh. ``masses``: 𝓜, the masses alone of a
    step's matrix, by which bodies and fluid respond to impulses at once; None where not wanted.
    """

    points: FloatArray
    node_points: FloatArray
    inertia: float
    viscosity: float
    advection: FloatArray
    flow: FloatArray
    position: FloatArray
    mass_matrix: FloatArray
    prescribed: BoolArray
    frame: FloatArray
    masses: CoupledMatrix | None = None
    local: LocalViscosity = UNIFORM


def masses_alone(matrix: CoupledMatrix, d0: float) -> CoupledMatrix:
    """Masses of a step's ``matrix``, without its BDF weight ``d0`` [1/time]."""
    still = np.zeros_like(matrix.advection)
    return replace(
        matrix,
        frame=np.zeros_like(matrix.frame),
        inertia=matrix.inertia / d0,
        viscosity=0.0,
        local=UNIFORM,
        advection=still,
        flow=still,
        mass_matrix=matrix.mass_matrix / d0,
    )


@dataclass(frozen=True)
class CoupledSystem:
    """A `CoupledMatrix` with its right side and a first guess.

    ``load`` (nodes, d): with several processes a node's load is the sum of what they have there. ``body_load`` is of
    all bodies. ``prescribed`` (nodes, d): prescribed velocities, zero elsewhere. ``velocity``, ``pressure``,
    ``twist`` are the guess. ``pressure_jump`` (vertices,): the excess of the pressure there over that at images on
    periodic faces. ``scale``: the size of the largest parts that the right side is a sum of; where they
    cancel, the residual is held against it. ``again``: the guess is a solution of nearly the same system.
    """

    matrix: CoupledMatrix
    load: FloatArray
    body_load: FloatArray
    prescribed: FloatArray
    velocity: FloatArray
    pressure: FloatArray
    twist: FloatArray
    pressure_jump: FloatArray
    scale: float = 0.0
    again: bool = False


@dataclass(frozen=True)
class Solution:
    """Solution of a `CoupledSystem`: ``velocity`` (nodes, d), ``pressure`` (vertices,), ``twist`` (n, d+k), the guess
    where it is prescribed.

    ``reaction`` (nodes, d), the residual of the fluid's own equations: the force on the fluid where its velocity
    is not free; with several processes a node's is the sum of what they have there. ``jump_load`` (nodes, d): (Δp, ∇·v)
    of the pressure's jumps at periodic faces, whose power is not zero, since ∇·u = 0 is meant for pressures without
    jumps; None without any.
    """

    velocity: FloatArray
    pressure: FloatArray
    twist: FloatArray
    reaction: FloatArray
    jump_load: FloatArray | None = None
