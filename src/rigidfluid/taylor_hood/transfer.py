"""States whose velocity comes from elsewhere, from another mesh or an impact; it is projected to zero divergence."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from rigidfluid.core.model.types import FloatArray, FluidState, Mesh, Pose, Twist
from rigidfluid.taylor_hood.coupled import CoupledMatrix, CoupledSystem
from rigidfluid.taylor_hood.discretisation import Discretisation, kinetic_energy
from rigidfluid.taylor_hood.numbering import Numbering
from rigidfluid.taylor_hood.sampling import Samples
from rigidfluid.taylor_hood.state import at_rest

_TIGHTER, _TIGHTEST = 1e-3, 1e-11
"""Of steps' tolerance, and at least: the residual of the projection that a run starts from."""

_POTENTIAL = 10.0
"""Times steps' tolerance: the residual of the potential flow in a transfer, as only a part of it, by which the energy's
scale differs from 1, gets into the state. What divergence is left shows, over the next step, as a burst of pressure."""

_MOST_SCALED = 1.25
"""Flow beside potential flow is scaled by at most this, or its inverse, to keep its kinetic energy."""


def transfer(
    source: Numbering,
    target: Discretisation,
    tolerance: float,
    forget: Callable[[], None],
    fluid: FluidState,
    old: Mesh,
    new: Mesh,
    energies: tuple[float, float],
) -> FluidState:
    """The state on ``new``.

    Both time levels are carried as functions on the present mesh; the mesh's own displacement over the last step is
    one more such function, so that the mesh velocity of the next step stays second order. Interpolated velocities
    are not divergence-free on the new mesh, which would show as a burst of pressure at the next step: each level is
    projected, on the mesh where it belongs, and given the kinetic energy that it had, of ``energies`` (now, one step
    before). ``forget`` drops what solutions before have left.
    """
    forget()
    numbering = target.numbering
    on_nodes = Samples(old, source, numbering.node_points(new.geometry))
    displacement = on_nodes.quadratic(source.node_points(old.geometry - fluid["points_previous"]))
    moved = dict(fluid)
    moved["points_previous"] = new.geometry - numbering.geometry_of(displacement)
    levels = ("", new.geometry, energies[0]), ("_previous", moved["points_previous"], energies[1])
    for suffix, points, energy in levels:
        moved["pressure" + suffix] = on_nodes.linear(fluid["pressure" + suffix])[: numbering.vertices]
        velocity = on_nodes.quadratic(fluid["velocity" + suffix])
        position, twist = fluid["position" + suffix], fluid["twist" + suffix]
        every = np.ones(len(twist), dtype=bool)
        target.surfaces.move_with_bodies(velocity, numbering.node_points(points), position, twist, every)
        matrix = _masses(target, points, position)
        projected = _projected(target, matrix, velocity, tolerance)
        at_boundary = target.surfaces.held_part(projected)
        potential = _projected(target, matrix, at_boundary, _POTENTIAL * tolerance)
        moved["velocity" + suffix] = _with_energy(target, points, projected, potential, energy)
    forget()
    return moved


def initial(target: Discretisation, tolerance: float, mesh: Mesh, pose: Pose, twist: Twist) -> tuple[FluidState, float]:
    """Fluid that was at rest when its bodies were set in motion, and its kinetic energy.

    An impact on the bodies sends a wave of pressure through the fluid, which is projection: the flow is potential.
    """
    state = dict(at_rest(target.surfaces, mesh, pose, twist))
    if target.surfaces.ranks.greatest(bool(state["velocity"].any())):
        projected = project(target, tolerance, state["velocity"], mesh.geometry, pose.position)
        state["velocity"] = state["velocity_previous"] = projected
    return state, kinetic_energy(target, mesh.geometry, state["velocity"])


def project(
    target: Discretisation, tolerance: float, velocity: FloatArray, points: FloatArray, position: FloatArray
) -> FloatArray:
    """The divergence-free velocity nearest to ``velocity`` in L², unchanged on bodies and prescribed faces, solved
    better than steps of this ``tolerance``.

    ``target`` takes all bodies as controlled.
    """
    return _projected(target, _masses(target, points, position), velocity, max(_TIGHTER * tolerance, _TIGHTEST))


def _masses(target: Discretisation, points: FloatArray, position: FloatArray) -> CoupledMatrix:
    """The matrix of projections, the mass of velocities with their divergence, for bodies that are all controlled."""
    numbering, bodies = target.numbering, len(target.surfaces.body_nodes)
    width, node_points = _width(target), numbering.node_points(points)
    still = np.zeros_like(node_points)
    return CoupledMatrix(
        points=points,
        node_points=node_points,
        inertia=1.0,
        viscosity=0.0,
        advection=still,
        flow=still,
        position=position,
        mass_matrix=np.zeros((bodies, width, width)),
        controlled=np.ones(bodies, dtype=bool),
    )


def _projected(target: Discretisation, matrix: CoupledMatrix, velocity: FloatArray, tolerance: float) -> FloatArray:
    numbering, none = target.numbering, np.zeros((len(matrix.controlled), _width(target)))
    system = CoupledSystem(
        matrix,
        load=target.mass_times(matrix.points, velocity),
        body_load=none,
        given=target.surfaces.held_part(velocity),
        velocity=velocity,
        pressure=np.zeros(numbering.vertices),
        twist=none,
        pressure_jump=np.zeros(numbering.vertices),
    )
    return target.solve(system, tolerance).velocity


def _width(target: Discretisation) -> int:
    """Components of a twist."""
    return 3 if target.numbering.dimension == 2 else 6


def _with_energy(
    target: Discretisation, points: FloatArray, velocity: FloatArray, potential: FloatArray, energy: float
) -> FloatArray:
    """``potential`` + s · (``velocity`` - ``potential``) with s such that its kinetic energy is ``energy``.

    Both velocities are free of divergence and equal on the boundary, so that all combinations are too. Near a gap the
    new mesh knows another added mass than the squeezed one before, and the projection changes the kinetic energy.
    """
    beside = velocity - potential
    square, rest = kinetic_energy(target, points, beside), kinetic_energy(target, points, potential)
    if square == 0.0:
        return velocity
    product = kinetic_energy(target, points, velocity) - square - rest
    root = np.sqrt(max(product**2 - 4.0 * square * (rest - energy), 0.0))
    scale = np.clip((root - product) / (2.0 * square), 1.0 / _MOST_SCALED, _MOST_SCALED)
    return np.asarray(potential + scale * beside)
