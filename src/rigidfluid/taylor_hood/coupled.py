"""The linear system of one step, fluid and bodies together, and its solution."""

from __future__ import annotations

from dataclasses import dataclass

from rigidfluid.core.types import BoolArray, FloatArray


@dataclass(frozen=True)
class CoupledSystem:
    """Find u and p on the nodes and vertices of one process' part, and the twists of the bodies that are free, with

    inertia (u, v) + (a·∇u, v) + viscosity (∇u + ∇uᵀ, ∇v) - (p, ∇·v) - (∇·u, q) = load(v)

    for velocities that move rigidly with each body, plus ``mass_matrix`` · twist = ``body_load`` + the fluid's wrench.

    ``points`` (vertices, d), ``node_points`` (nodes, d); ``advection`` a (nodes, d) already holds the density.
    ``load`` (nodes, d): with several processes a node's load is the sum of what they have there. ``given`` (nodes, d):
    velocities where they are prescribed, zero elsewhere. ``position``, ``mass_matrix``, ``body_load``, ``controlled``
    are of all bodies, as in `Step`. ``velocity``, ``pressure``, ``twist`` are a first guess.
    """

    points: FloatArray
    node_points: FloatArray
    inertia: float
    viscosity: float
    advection: FloatArray
    load: FloatArray
    given: FloatArray
    position: FloatArray
    mass_matrix: FloatArray
    body_load: FloatArray
    controlled: BoolArray
    velocity: FloatArray
    pressure: FloatArray
    twist: FloatArray


@dataclass(frozen=True)
class Solution:
    """What solves it: ``velocity`` (nodes, d), ``pressure`` (vertices,), ``twist`` (n, d+k), the guess where it is
    given.

    ``reaction`` (nodes, d), by which the fluid's own equations are not met: the force on the fluid where its velocity
    is not free; with several processes a node's is the sum of what they have there.
    """

    velocity: FloatArray
    pressure: FloatArray
    twist: FloatArray
    reaction: FloatArray
