"""Channels between two circles: structured meshes with curved edges, and the flows known there in closed form."""

from __future__ import annotations

from typing import Any

import numpy as np

from rigidfluid.backends.scikit_fem import ScikitFem
from rigidfluid.core.fluid.conditions import BoundaryCondition, NoSlip, PrescribedPressure, PrescribedVelocity
from rigidfluid.core.fluid.fluid_problem import FluidProblem
from rigidfluid.core.fluid.material import Newtonian
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mesh.topology import boundary_facets, orient
from rigidfluid.core.model.types import CurvedEdges, Mesh, Pose
from rigidfluid.testing.fluid.boxes import nobody
from rigidfluid.testing.fluid.flow import Bodies, Flow

INNER, OUTER, VISCOSITY = 0.5, 1.0, 0.7
"""Radii of the circles about the origin [length], and viscosity."""

ANGLE, DROP = 2.0, 3.0
"""Of a bend [rad], and the pressure that is lost in it."""


def bend(layers: int, angle: float | None = ANGLE) -> Mesh:
    """The fluid between the circles, in ``layers`` from the inner (marker 0) to the outer one (1), from the x axis (2)
    through an ``angle`` (3), or all around without one."""
    around = round(layers * (angle or 2.0 * np.pi) * 0.75 / (OUTER - INNER))
    turns = np.linspace(0.0, angle or 2.0 * np.pi, around + 1)
    radii, turns = np.meshgrid(np.linspace(INNER, OUTER, layers + 1), turns if angle else turns[:-1], indexing="ij")
    number = np.arange(radii.size).reshape(radii.shape)
    ahead = number[:, 1:] if angle else np.roll(number, -1, axis=1)
    here = number[:, :-1] if angle else number
    a, b, c, d = (corner.ravel() for corner in (here[:-1], here[1:], ahead[1:], ahead[:-1]))
    cells = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    points = _at(radii.ravel(), turns.ravel())
    facets = boundary_facets(cells)
    where = [radii == INNER, radii == OUTER, (turns == 0.0) & bool(angle), (turns == angle) & bool(angle)]
    on = np.array([each.ravel()[facets].all(axis=1) for each in where])
    mesh = orient(Mesh(points, cells, facets, np.argmax(on, axis=0)))
    arcs = facets[mesh.markers < 2]
    chords = points[arcs].mean(axis=1)
    length = np.linalg.norm(chords, axis=1)
    surface = (length > 0.5 * (INNER + OUTER)).astype(np.int64)
    middles = chords * (np.array([INNER, OUTER])[surface] / length)[:, None]
    return Mesh(points, mesh.cells, facets, mesh.markers, curved=CurvedEdges(arcs, surface, middles))


def flow_in_bend(layers: int) -> Flow:
    """Steady Stokes flow by a pressure on the first of the bend's ends, none on the other."""
    return Flow.start(_backend(0, bend_faces(NoSlip)), bend(layers), nobody(2)).after(None)


def bend_faces(inner: type[Any]) -> tuple[BoundaryCondition, ...]:
    """Conditions on the bend, of the class ``inner`` on its inner wall."""
    ends = np.array([0.0, 1.0]), np.array([np.sin(ANGLE), -np.cos(ANGLE)])
    return (
        inner(0, "inner", None),
        NoSlip(1, "outer", None),
        PrescribedPressure(2, "start", ends[0], lambda _, at: np.full(len(at), DROP)),
        PrescribedPressure(3, "end", ends[1]),
    )


def speed_in_bend(radius: FloatArray) -> FloatArray:
    """u(r) = (G/2μ)(A r + B/r - r ln r) along the bend with the pressure G φ less than at its start, 0 on the walls."""
    a, b = np.linalg.solve([[INNER, 1.0 / INNER], [OUTER, 1.0 / OUTER]], [r * np.log(r) for r in (INNER, OUTER)])
    return np.asarray(DROP / ANGLE / (2.0 * VISCOSITY) * (a * radius + b / radius - radius * np.log(radius)))


def flux_through_bend() -> float:
    """∫ u dr of `speed_in_bend`, by Gauss' rule."""
    root, weight = np.polynomial.legendre.leggauss(20)
    radius = INNER + (OUTER - INNER) * 0.5 * (1.0 + root)
    return float(0.5 * (OUTER - INNER) * weight @ speed_in_bend(radius))


def flux_of(flow: Flow, panels: int = 400) -> float:
    """The same of a computed ``flow``, half-way through the bend."""
    root, weight = np.polynomial.legendre.leggauss(3)
    share = ((np.arange(panels)[:, None] + 0.5 * (1.0 + root)) / panels).ravel()
    velocity, _ = flow.probe(_at(INNER + (OUTER - INNER) * share, np.full(len(share), 0.5 * ANGLE)))
    along = _at(np.array([1.0]), np.array([0.5 * ANGLE + 0.5 * np.pi]))[0]
    return float((OUTER - INNER) * np.tile(0.5 * weight / panels, panels) @ (velocity @ along))


def error_in_bend(flow: Flow) -> float:
    """Root mean square of the velocity's error at random points of the bend, over that of the velocity."""
    share = np.random.default_rng(0).uniform(size=(200, 2))
    radius, turn = INNER + (OUTER - INNER) * share[:, 0], ANGLE * share[:, 1]
    velocity, _ = flow.probe(_at(radius, turn))
    exact = speed_in_bend(radius)[:, None] * _at(np.ones(len(turn)), turn + 0.5 * np.pi)
    return float(np.linalg.norm(velocity - exact) / np.linalg.norm(exact))


def flow_from_within(layers: int, outside: str) -> Flow:
    """Steady Stokes flow out of the inner circle, u = x/|x|²; ``outside`` no "pressure", or the "velocity"."""
    within = PrescribedVelocity(0, "inner", None, from_within)
    given, free = PrescribedVelocity(1, "outer", None, from_within), PrescribedPressure(1, "outer", None)
    faces = within, given if outside == "velocity" else free
    return Flow.start(_backend(0, faces), bend(layers, None), nobody(2)).after(None)


def from_within(_time: float, at: FloatArray) -> FloatArray:
    """x/|x|²; its stress across circles is -2μ/|x|² besides the pressure."""
    return at / np.sum(at**2, axis=1, keepdims=True)


def flow_between_cylinders(layers: int, inner: float, outer: float, *, wall: bool = True) -> Flow:
    """Steady Stokes flow round a disk that turns with the angular velocity ``inner`` in a round wall that turns with
    ``outer``, or a surface with that velocity that is no ``wall``."""

    def turning(at: FloatArray) -> FloatArray:
        return outer * np.column_stack([-at[:, 1], at[:, 0]])

    around = PrescribedVelocity(1, "outer", None, lambda _, at: turning(at))
    condition = NoSlip(1, "outer", None, turning) if wall else around
    pose = Pose(np.zeros((1, 2)), np.zeros((1, 1)))
    start = Flow.start(_backend(1, (condition,)), bend(layers, None), pose, Bodies.uniform(pose))
    return start.after(None, twist=np.array([[0.0, 0.0, inner]]))


def torque_between_cylinders(inner: float, outer: float) -> float:
    """On the inner one, 4πμ(Ω₂ - Ω₁) R₁²R₂²/(R₂² - R₁²), for each unit of length (Taylor 1923)."""
    square = (INNER * OUTER) ** 2 / (OUTER**2 - INNER**2)
    return float(4.0 * np.pi * VISCOSITY * (outer - inner) * square)


def _backend(bodies: int, faces: tuple[BoundaryCondition, ...]) -> Any:
    posed = FluidProblem(2, bodies, 1.0, Newtonian(VISCOSITY), False, faces)
    return ScikitFem(ScikitFem.Options(tolerance=1e-12), posed)


def _at(radius: FloatArray, turn: FloatArray) -> FloatArray:
    return np.column_stack([radius * np.cos(turn), radius * np.sin(turn)])
