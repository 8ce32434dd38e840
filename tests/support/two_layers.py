"""A ball that conducts a scalar in the middle of a round wall, with what theory says of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache, partial
from typing import Any

import numpy as np
from scipy.optimize import brentq
from scipy.special import j0, j1, y0, y1

from rigidfluid.backends.scikit_fem import ScikitFem
from rigidfluid.bodies.sphere import Sphere
from rigidfluid.core.fluid.conditions import BoundaryCondition, PrescribedVelocity
from rigidfluid.core.fluid.conduction import Conduction, Inside
from rigidfluid.core.fluid.scalar import ScalarCondition, ScalarProblem
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.frames import to_world
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.generation.curved_edges import with_curved_edges
from rigidfluid.core.mesh.generation.inside import InsideOfBody, inside_mesh
from rigidfluid.core.mesh.generation.meshing import generate_mesh
from rigidfluid.core.mesh.size.size_field import Sizes
from rigidfluid.core.model.types import Mesh, Pose
from rigidfluid.core.setup.scalar import cells_inside
from rigidfluid.testing.fluid.exact import problem
from rigidfluid.testing.fluid.flow import Flow

DIFFUSIVITY, BALL, WALL = 0.3, 0.4, 1.0
"""Of the fluid, and the radii."""

TURNED = 0.3
"""Angle by which a body's mesh is turned from the fluid's, so that they do not match."""

Value = Callable[[float, FloatArray], FloatArray]


def ball(radius: float, dimension: int) -> Sphere:
    """A disk or a ball."""
    return Sphere(Sphere.Options(radius=radius), dimension)


@cache
def inside(radius: float, dimension: int, length: float, order: int = 2) -> Inside:
    """Cells inside a ball, with edges of this ``length``."""
    return cells_inside(inside_mesh(ball(radius, dimension), Sizes(length, length, 0.2, order=order), 60.0))


def conducting(
    conductivity: float,
    capacity: float = 1.0,
    radius: float = BALL,
    dimension: int = 2,
    length: float = 0.1,
    order: int = 2,
    value: Value | None = None,
) -> ScalarCondition:
    """A ball that conducts, its conductivity and capacity over the fluid's."""
    whole = capacity * ball(radius, dimension).volume
    cells = partial(inside, radius, dimension, length, order)
    return ScalarCondition(value=value, conduction=Conduction(conductivity, whole, cells))


@cache
def round_mesh(dimension: int, length: float, empty: bool = False) -> Mesh:
    """Fluid in a ball, around another one in its middle, or alone."""
    bodies = [] if empty else [ball(BALL, dimension)]
    turn = np.zeros((1, 1)) if dimension == 2 else np.array([[1.0, 0.0, 0.0, 0.0]])
    pose = Pose(np.zeros((len(bodies), dimension)), turn[: len(bodies)])
    around = FluidDomain(bodies, pose, InsideOfBody(ball(WALL, dimension), length), ())
    return with_curved_edges(generate_mesh(around, Sizes(length, length, 0.2)), around)


def started(
    mesh: Mesh, *conditions: ScalarCondition, initial: Value, velocity: Value | None = None, **given: Any
) -> Flow:
    """A flow in the round wall, which is the last of the ``conditions``, around the body of the first one, if any."""
    d, wall = mesh.points.shape[1], len(conditions) - 1
    posed = problem(d, bodies=wall)
    held: BoundaryCondition = replace(posed.conditions[0], name="wall", surface=wall)
    if velocity is not None:
        held = PrescribedVelocity(wall, "wall", None, value=velocity)
    scalar = ScalarProblem(DIFFUSIVITY, initial, conditions)
    posed = replace(posed, conditions=(held,), scalar=scalar, initial=velocity or "rest")
    turn = np.array([[TURNED] if d == 2 else [np.cos(TURNED), np.sin(TURNED), 0.0, 0.0]])
    pose = Pose(np.zeros((wall, d)), turn[:wall])
    return Flow.start(ScikitFem(ScikitFem.Options(), posed), mesh, pose, **given)


def held(value: Value) -> ScalarCondition:
    """A surface that holds this value."""
    return ScalarCondition(value=value)


def first(time: float, points: FloatArray) -> FloatArray:
    """x."""
    return points[:, 0]


def nothing(time: float, points: FloatArray) -> FloatArray:
    """0."""
    return np.zeros(len(points))


def in_linear_field(conductivity: float, length: float, dimension: int = 2) -> Flow:
    """The steady state where the wall holds x."""
    condition = conducting(conductivity, dimension=dimension, length=length)
    return started(round_mesh(dimension, length), condition, held(first), initial=nothing).after(None)


def gradient_inside(conductivity: float, dimension: int) -> float:
    """A in T = A x inside, where the wall holds x; T = (B + C/rᵈ) x outside."""
    d, ratio = dimension, (BALL / WALL) ** dimension
    return d / (d - 1.0 + conductivity + (1.0 - conductivity) * ratio)


def exact_outside(conductivity: float, points: FloatArray) -> FloatArray:
    """(B + C/rᵈ) x at ``points`` (N, d)."""
    d = points.shape[1]
    inner = gradient_inside(conductivity, d)
    part = inner * (1.0 - conductivity) / d
    return (inner - part + part * BALL**d / np.linalg.norm(points, axis=1) ** d) * points[:, 0]


def gradient_found(flow: Flow) -> float:
    """Mean gradient along x of the values inside."""
    insides = flow.backend._insides
    along = to_world(flow.pose, 0, insides.spaces[0].node_points)[:, 0]
    weighted = insides.capacity @ along
    return float(weighted @ flow.fluid["scalar_inside"] / (weighted @ along))


def node_points(flow: Flow) -> FloatArray:
    """Nodes of the fluid (nodes, d)."""
    return flow.backend.numbering_of(flow.mesh).node_points(flow.mesh.geometry)


def error_outside(flow: Flow, exact: FloatArray) -> float:
    """Root of the mean square of the difference from ``exact`` values (nodes,)."""
    equations = flow.backend._scalar_equations(flow.mesh)
    return float(np.sqrt(equations.mean(flow.mesh.geometry, (flow.fluid["scalar"] - exact) ** 2)))


def values_at(flow: Flow, points: FloatArray) -> FloatArray:
    """Values (N,) at ``points`` (N, d) of fluid and body."""
    return flow.backend.probe_scalar(flow.fluid, flow.mesh, flow.pose, points)


def slowest_mode(conductivity: float, capacity: float) -> tuple[float, Value]:
    """Rate λ of the slowest mode round the axis in 2D, c∂T/∂t = kκ∇²T inside and ∂T/∂t = κ∇²T outside, and the mode.

    The wall is held at 0. Inside it is J₀(αr), outside a J₀(βr) + b Y₀(βr), with α² = λc/(kκ) and β² = λ/κ.
    """

    def parts(rate: float) -> tuple[float, float, FloatArray]:
        inner, outer = np.sqrt(rate * capacity / (conductivity * DIFFUSIVITY)), np.sqrt(rate / DIFFUSIVITY)
        value = [j0(outer * BALL), y0(outer * BALL)]
        flux = [outer * j1(outer * BALL), outer * y1(outer * BALL)]
        at_body = np.array([j0(inner * BALL), conductivity * inner * j1(inner * BALL)])
        return inner, outer, np.linalg.solve(np.array([value, flux]), at_body)

    def at_wall(rate: float) -> float:
        _, outer, weights = parts(rate)
        return float(weights @ [j0(outer * WALL), y0(outer * WALL)])

    rates = np.linspace(0.01, 4.0, 400)
    values = np.array([at_wall(rate) for rate in rates])
    bracket = np.flatnonzero(values[:-1] * values[1:] < 0.0)[0]
    rate = float(brentq(at_wall, rates[bracket], rates[bracket + 1], xtol=1e-14))
    inner, outer, weights = parts(rate)

    def mode(time: float, points: FloatArray) -> FloatArray:
        r = np.linalg.norm(points, axis=1)
        outside = weights[0] * j0(outer * r) + weights[1] * y0(np.maximum(outer * r, 1e-3))
        return np.where(r < BALL, j0(inner * r), outside)

    return rate, mode


def left_of_mode(conductivity: float, capacity: float, decay: float, steps: int, length: float) -> float:
    """Part of the slowest mode's mean inside that is left after ``decay``/λ in so many steps; exact is e^-decay."""
    rate, mode = slowest_mode(conductivity, capacity)
    condition = conducting(conductivity, capacity, length=length, value=mode)
    flow = started(round_mesh(2, length), condition, held(nothing), initial=mode)
    start = flow.backend._insides.means(np.zeros(2), flow.fluid["scalar_inside"])[0]
    for _ in range(steps):
        flow = flow.after(decay / rate / steps)
    return float(flow.advance.scalar.inside[0] / start)
