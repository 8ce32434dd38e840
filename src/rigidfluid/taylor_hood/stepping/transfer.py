"""States whose velocity comes from elsewhere, from another mesh or an impact; it is projected to zero divergence."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from rigidfluid.core.fluid.fluid_problem import FluidProblem
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.fluid_backend import Filling
from rigidfluid.core.model.types import FluidState, Mesh, Pose, Twist
from rigidfluid.taylor_hood.elements.numbering import Numbering
from rigidfluid.taylor_hood.elements.sampling import Samples
from rigidfluid.taylor_hood.elements.state import resting_state
from rigidfluid.taylor_hood.elements.surfaces import Surfaces
from rigidfluid.taylor_hood.system.discretisation import Discretisation, Projection, kinetic_energy
from rigidfluid.taylor_hood.system.driving import fluxes

_TIGHTER, _TIGHTEST = 1e-3, 1e-11
"""Residual of the projection that a run starts from, over the steps' tolerance, and its least value."""

_LOOSE, _OF_STATE = 1e-3, 2.0
"""The residual of the potential flow from which the energy's scale is known, and, times steps' tolerance, what it may
leave in the state, into which as much of it gets as the scale differs from 1."""

_MOST_SCALED = 1.25
"""Rotational flow is scaled by at most this, or its inverse, to keep its kinetic energy."""


@dataclass(frozen=True, eq=False)
class Flow:
    """State of a ``fluid`` on a ``mesh`` with this ``numbering``, its kinetic ``energies``, now and one step before
    [energy], and the ``drops`` (k,) of its pressure across the periods."""

    fluid: FluidState
    mesh: Mesh
    numbering: Numbering
    energies: tuple[float, float]
    drops: Callable[[FloatArray], FloatArray]


def transfer(flow: Flow, target: Discretisation, tolerance: float, new: Mesh) -> FluidState:
    """Carry a flow over to the mesh ``new``.

    Both time levels are carried as functions on the present mesh; the mesh's own displacement over the last step is
    one more such function, so that the mesh velocity of the next step stays second order. Interpolated velocities
    are not divergence-free on the new mesh, which would show as a burst of pressure at the next step: each level is
    projected, on the mesh where it belongs, and given the kinetic energy that it had. The solution of one level is the
    guess for the other.
    """
    source, fluid, old = flow.numbering, flow.fluid, flow.mesh
    numbering, inertia = target.numbering, target.problem.inert_density
    on_nodes = Samples(old, source, numbering.node_points(new.geometry))
    displacement = on_nodes.quadratic(source.node_points(old.geometry - fluid["points_previous"]))
    moved = dict(fluid)
    moved["points_previous"] = new.geometry - numbering.geometry_of(displacement)
    for suffix in ("", "_previous"):
        moved["position" + suffix] = fluid["position" + suffix] + _bodies_displaced(old, new)
    levels = ("", new.geometry, flow.energies[0]), ("_previous", moved["points_previous"], flow.energies[1])
    correction = rotational = np.zeros((numbering.nodes, numbering.dimension))
    for suffix, points, energy in levels:
        pressure = fluid["pressure" + suffix]
        carried = on_nodes.linear(pressure)
        if old.periods is not None:
            carried += on_nodes.periods @ flow.drops(pressure)
        moved["pressure" + suffix] = carried[: numbering.vertices]
        if "scalar" in fluid:
            moved["scalar" + suffix] = on_nodes.quadratic(fluid["scalar" + suffix])
        velocity = on_nodes.quadratic(fluid["velocity" + suffix])
        position, twist = moved["position" + suffix], fluid["twist" + suffix]
        every = np.ones(len(twist), dtype=bool)
        target.surfaces.move_with_bodies(velocity, numbering.node_points(points), position, twist, every)
        projection = target.projection(points, position)
        projected = projection.nearest(velocity, tolerance, velocity + correction)
        correction = projected - velocity
        scale = 1.0
        if inertia > 0.0:
            prescribed = target.surfaces.prescribed_part(projected)
            wanted = 2.0 * energy / inertia
            scale, rotational = _rotational_part(projection, projected, prescribed, wanted, tolerance, rotational)
        moved["velocity" + suffix] = projected + (scale - 1.0) * rotational
    return moved


def among_other_bodies(
    fluid: FluidState, old: Mesh, filling: Filling, target: Discretisation, tolerance: float, rest: FluidState
) -> FluidState:
    """Flow of a ``fluid`` on the mesh ``old`` that goes on among other bodies, which move as in the state of ``rest``
    on the target's mesh; see `FluidBackend.with_bodies`."""
    numbering, geometry, position = target.numbering, rest["points_previous"], rest["position"]
    node_points, every = numbering.node_points(geometry), np.ones(len(position), dtype=bool)
    before = Numbering.from_mesh(old)
    samples = Samples(old, before, node_points)
    velocity, carried = samples.quadratic(fluid["velocity"]), samples.linear(fluid["pressure"])
    if old.periods is not None:
        surfaces = _surfaces_among(len(old.periods.winding), target.problem, before, old)
        carried += samples.periods @ surfaces.pressure_drops(fluid["pressure"])
    pressure = carried[: numbering.vertices]
    left, filled = filling(node_points)
    velocity[left] = filled[left]
    target.surfaces.move_with_bodies(velocity, node_points, position, rest["twist"], every)
    velocity = project(target, tolerance, velocity, geometry, position)
    flow = {"velocity": velocity, "velocity_previous": velocity, "pressure": pressure, "pressure_previous": pressure}
    return {**rest, **flow}


def _surfaces_among(bodies: int, problem: FluidProblem, numbering: Numbering, mesh: Mesh) -> Surfaces:
    """Surfaces of a ``mesh`` with another number of ``bodies`` than the ``problem``, under its conditions."""
    more = bodies - problem.bodies
    numbered = [replace(condition, surface=condition.surface + more) for condition in problem.conditions]
    conditions = [each if each.image is None else each.with_image(each.image + more) for each in numbered]
    return Surfaces(numbering, mesh, conditions, range(bodies))


def _bodies_displaced(old: Mesh, new: Mesh) -> FloatArray:
    """Displacement of the bodies' images from the ``old`` mesh to those on the ``new`` one, (n, d) or () [length]."""
    if old.periods is None or new.periods is None:
        return np.zeros(())
    return (old.periods.winding - new.periods.winding) @ old.periods.ways


def initial(target: Discretisation, tolerance: float, mesh: Mesh, pose: Pose, twist: Twist) -> tuple[FluidState, float]:
    """Fluid that was at rest when its bodies were set in motion, and its kinetic energy.

    An impact on the bodies sends a wave of pressure through the fluid, which is projection: the flow is potential.
    """
    state = dict(resting_state(target.surfaces, mesh, pose, twist))
    if target.surfaces.ranks.greatest(bool(state["velocity"].any())):
        projected = project(target, tolerance, state["velocity"], mesh.geometry, pose.position)
        state["velocity"] = state["velocity_previous"] = projected
    return state, kinetic_energy(target, mesh.geometry, state["velocity"])


def struck(target: Discretisation, tolerance: float, mesh: Mesh, pose: Pose, twist: Twist) -> tuple[FluidState, float]:
    """The same where faces were set in motion as well: of all flows with their values that of least kinetic energy
    (Kelvin)."""
    state, surfaces = dict(resting_state(target.surfaces, mesh, pose, twist)), target.surfaces
    node_points, every = target.numbering.node_points(mesh.geometry), np.ones(len(state["twist"]), dtype=bool)
    prescribed = surfaces.prescribed_velocity(0.0, node_points, pose.position, state["twist"], every)
    projection = target.projection(mesh.geometry, pose.position)
    least = projection.nearest(np.zeros_like(prescribed), _start_tolerance(tolerance), prescribed, prescribed)
    least = _with_held_fluxes(least, target, projection, node_points, tolerance)
    state["velocity"] = state["velocity_previous"] = least
    return state, kinetic_energy(target, mesh.geometry, least)


def _with_held_fluxes(
    velocity: FloatArray, target: Discretisation, projection: Projection, node_points: FloatArray, tolerance: float
) -> FloatArray:
    """A potential flow (nodes, d) with the fluxes held at time 0: an impulse of the drop of pressure from a face on
    gives the fluid that rests on all surfaces what a uniform one along the face's normal does."""
    surfaces, still = target.surfaces, np.zeros_like(velocity)
    held = [(face, face.condition.held_flux) for face in surfaces.faces if face.condition.held_flux is not None]
    if not held:
        return velocity
    faces, start = [face for face, _ in held], _start_tolerance(tolerance)
    impulses = [np.broadcast_to(np.asarray(face.condition.normal), velocity.shape).copy() for face in faces]
    responses = [projection.nearest(impulse, start, impulse, still) for impulse in impulses]
    by_impulse = np.array([fluxes(surfaces, faces, node_points, each) for each in responses]).T
    wanted = np.array([flux(0.0) for _, flux in held])
    missing = np.linalg.solve(by_impulse, wanted - fluxes(surfaces, faces, node_points, velocity))
    return np.asarray(velocity + np.tensordot(missing, np.array(responses), axes=1))


def project(
    target: Discretisation, tolerance: float, velocity: FloatArray, points: FloatArray, position: FloatArray
) -> FloatArray:
    """The divergence-free velocity nearest to ``velocity`` in L², unchanged on bodies and prescribed faces, solved
    better than steps of this ``tolerance``.

    ``target`` takes all bodies as prescribed.
    """
    return target.projection(points, position).nearest(velocity, _start_tolerance(tolerance), velocity)


def _start_tolerance(tolerance: float) -> float:
    return max(_TIGHTER * tolerance, _TIGHTEST)


def _rotational_part(
    projection: Projection,
    velocity: FloatArray,
    prescribed: FloatArray,
    square: float,
    tolerance: float,
    guess: FloatArray,
) -> tuple[float, FloatArray]:
    """Scale of `_scale`, and the difference (nodes, d) of a ``velocity`` from the potential flow with the same
    ``prescribed`` values, from a ``guess`` onwards; the potential flow has the residual that ``tolerance`` asks for."""
    potential = projection.nearest(prescribed, _LOOSE, velocity - guess)
    scale = _scale(projection, velocity, velocity - potential, square)
    if _LOOSE * abs(scale - 1.0) > _OF_STATE * tolerance:
        potential = projection.nearest(prescribed, _OF_STATE * tolerance / abs(scale - 1.0), potential)
        scale = _scale(projection, velocity, velocity - potential, square)
    return scale, velocity - potential


def _scale(projection: Projection, velocity: FloatArray, rotational: FloatArray, square: float) -> float:
    """s such that ∫ |v + (s - 1) b|² = ``square``, of a ``velocity`` v and its ``rotational`` part b.

    Both are free of divergence and b is zero on the boundary, so that all combinations are right there. Near a gap the
    new mesh knows another added mass than the squeezed one before, and the projection changes the kinetic energy.
    """
    a, b = projection.product(rotational, rotational), projection.product(velocity, rotational)
    if a == 0.0:
        return 1.0
    rest = projection.product(velocity, velocity) - 2.0 * b + a
    root = np.sqrt(max((b - a) ** 2 - a * (rest - square), 0.0))
    return float(np.clip((root - (b - a)) / a, 1.0 / _MOST_SCALED, _MOST_SCALED))
