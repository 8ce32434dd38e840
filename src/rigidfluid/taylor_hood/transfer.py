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
"""What divergence is left shows, over the step, as a burst of pressure: projections are solved so much better."""


def transfer(
    source: Numbering,
    target: Discretisation,
    tolerance: float,
    forget: Callable[[], None],
    fluid: FluidState,
    old: Mesh,
    new: Mesh,
) -> FluidState:
    """The state on ``new``.

    Both time levels are carried as functions on the present mesh; the mesh's own displacement over the last step is
    one more such function, so that the mesh velocity of the next step stays second order. Interpolated velocities
    are not divergence-free on the new mesh, which would show as a burst of pressure at the next step: each level is
    projected, on the mesh where it belongs; one preconditioner serves both, as the meshes differ by a step. ``forget``
    drops what the solution before has left.
    """
    numbering = target.numbering
    on_nodes = Samples(old, source, numbering.node_points(new.geometry))
    displacement = on_nodes.quadratic(source.node_points(old.geometry - fluid["points_previous"]))
    moved = dict(fluid)
    moved["points_previous"] = new.geometry - numbering.geometry_of(displacement)
    forget()
    for suffix, points in (("", new.geometry), ("_previous", moved["points_previous"])):
        moved["pressure" + suffix] = on_nodes.linear(fluid["pressure" + suffix])[: numbering.vertices]
        velocity = on_nodes.quadratic(fluid["velocity" + suffix])
        position, twist = fluid["position" + suffix], fluid["twist" + suffix]
        every = np.ones(len(twist), dtype=bool)
        target.surfaces.move_with_bodies(velocity, numbering.node_points(points), position, twist, every)
        moved["velocity" + suffix] = project(target, tolerance, velocity, points, position)
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
    """The divergence-free velocity nearest to ``velocity`` in L², unchanged on bodies and prescribed faces.

    ``target`` takes all bodies as controlled.
    """
    numbering, bodies = target.numbering, len(target.surfaces.body_nodes)
    width, still = numbering.dimension + (1 if numbering.dimension == 2 else 3), np.zeros_like(velocity)
    matrix = CoupledMatrix(
        points=points,
        node_points=numbering.node_points(points),
        inertia=1.0,
        viscosity=0.0,
        advection=still,
        flow=still,
        position=position,
        mass_matrix=np.zeros((bodies, width, width)),
        controlled=np.ones(bodies, dtype=bool),
    )
    system = CoupledSystem(
        matrix,
        load=target.mass_times(points, velocity),
        body_load=np.zeros((bodies, width)),
        given=np.where(target.surfaces.velocity_free, 0.0, velocity),
        velocity=velocity,
        pressure=np.zeros(numbering.vertices),
        twist=np.zeros((bodies, width)),
    )
    return target.solve(system, max(_TIGHTER * tolerance, _TIGHTEST)).velocity
