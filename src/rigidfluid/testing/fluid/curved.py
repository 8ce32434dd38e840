"""A ball in the unit box on cells that are curved along it: order, exact flows and balances there."""

from __future__ import annotations

from functools import cache
from itertools import combinations
from typing import ClassVar

import numpy as np
import pytest

from rigidfluid.core.fluid.conditions import Value
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.rigid import cross
from rigidfluid.core.mesh.topology import boundary_facets, orient
from rigidfluid.core.model.types import CurvedEdges, Mesh, Pose
from rigidfluid.testing.fluid.base import FluidContract
from rigidfluid.testing.fluid.boxes import box
from rigidfluid.testing.fluid.exact import VISCOSITY, enclosed
from rigidfluid.testing.fluid.flow import Bodies, Flow, components

RADIUS, CENTRE = 0.2, 0.5
"""Radius of the ball and each coordinate of its centre, in the middle of the box [length]."""


class CurvedContract(FluidContract):
    """Exact flows that cells with curved edges keep, and orders of convergence that they raise."""

    lowest_orders_at_a_ball: ClassVar[tuple[float, float]] = (2.8, 2.8)
    """Lowest observed orders allowed: velocity round a turning ball, and its torque. Straight facets give 2."""

    def test_orders_at_a_turning_ball(self, dimension: int) -> None:
        """u = ω × r (R/r)^d, Stokes flow without a pressure; the torque is -2 d Ω μ R^d ω, Ω = π in 2D, 4π/3 in 3D."""
        spin = np.array([[0.7]] if dimension == 2 else [[0.3, -0.5, 0.6]])
        points = _outside(dimension)

        def swirl(_time: float, at: FloatArray) -> FloatArray:
            arm = at - CENTRE
            near = np.linalg.norm(arm, axis=1, keepdims=True)
            return np.asarray(cross(np.tile(spin, (len(at), 1)), arm) * (RADIUS / near) ** dimension)

        solid_angle = np.pi if dimension == 2 else 4.0 * np.pi / 3.0
        exact = -2.0 * dimension * solid_angle * VISCOSITY * RADIUS**dimension * spin[0]
        errors = []
        for layers in (2, 4) if dimension == 3 else (2, 4, 8):
            flow = self._round_a_ball(ball_in_a_box(dimension, layers), swirl, inertia=False)
            flow = flow.after(None, twist=np.concatenate([np.zeros((1, dimension)), spin], axis=1))
            velocity, _ = flow.probe(points)
            wrong = np.linalg.norm(velocity - swirl(0.0, points), axis=1)
            torque = flow.advance.hydrodynamic_wrench.torque[0]
            errors.append([np.sqrt(np.mean(wrong**2)), np.linalg.norm(torque - exact)])
        orders = np.log2(np.divide(errors[-2], errors[-1]))
        assert np.all(orders > self.lowest_orders_at_a_ball), (orders, errors)

    def test_a_rigid_motion_of_all_is_exact_at_a_curved_body(self, dimension: int) -> None:
        """u = U + ω × r everywhere: rigid velocities are in the isoparametric space."""
        twist = np.array([[0.4, -0.3, 0.8]] if dimension == 2 else [[0.4, -0.3, 0.2, 0.8, -0.5, 0.3]])

        def rigid(_time: float, at: FloatArray) -> FloatArray:
            return np.asarray(twist[0, :dimension] + cross(np.tile(twist[:, dimension:], (len(at), 1)), at - CENTRE))

        flow = self._round_a_ball(ball_in_a_box(dimension, 2), rigid, inertia=False).after(None, twist=twist)
        points = _outside(dimension)
        self.assert_close(flow.probe(points)[0], rigid(0.0, points))
        self.assert_close(components(flow.advance.hydrodynamic_wrench), 0.0, scale=10.0)
        self.assert_close(flow.advance.dissipation, 0.0)

    def test_uniform_flow_stays_uniform_on_curved_cells_in_motion(self, dimension: int) -> None:
        """Geometric conservation, also where cells are curved."""
        twist = np.zeros((1, 3 if dimension == 2 else 6))
        twist[0, :dimension] = drift = np.array([1.0, -0.5, 0.3])[:dimension]
        mesh = ball_in_a_box(dimension, 2)
        flow = self._round_a_ball(mesh, lambda _, at: np.tile(drift, (len(at), 1))).after(None, twist=twist)
        for time, length in ((0.1, 0.1), (0.15, 0.05), (0.25, 0.1)):
            shift = 0.05 * np.sin(5.0 * time) * np.ones(dimension)
            pose = Pose(CENTRE + shift[None], flow.pose.orientation)
            flow = flow.after(length, points=_carried(flow.reference.geometry, shift), pose=pose, twist=twist)
            points = _outside(dimension)
            velocity, pressure = flow.probe(points)
            self.assert_close(velocity, np.broadcast_to(drift, velocity.shape))
            self.assert_close(pressure, 0.0, scale=10.0)

    def test_convection_makes_no_energy_on_curved_cells(self) -> None:
        """A lid drives the flow round a ball that is held: what the lid puts in is dissipated."""

        def lid(_time: float, at: FloatArray) -> FloatArray:
            top = at[:, 1] > 1.0 - 1e-9
            return np.column_stack([np.where(top, 16.0 * (at[:, 0] * (1.0 - at[:, 0])) ** 2, 0.0), np.zeros(len(at))])

        flow = self._round_a_ball(ball_in_a_box(2, 4), lid)
        for _ in range(3):
            flow = flow.after(None)
            self.assert_close(flow.advance.boundary_power, flow.advance.dissipation)

    def _round_a_ball(self, mesh: Mesh, velocity: Value, inertia: bool = True) -> Flow:
        """Fluid at rest round the ball, ``velocity`` prescribed on all faces of the box."""
        if not self.backend.curved_cells:
            pytest.skip(f"{self.backend.name} takes straight cells alone")
        dimension = mesh.points.shape[1]
        pose = Pose(np.full((1, dimension), CENTRE), np.eye(1, 1 if dimension == 2 else 4))
        posed = enclosed(dimension, velocity, bodies=1, inertia=inertia)
        return Flow.start(self.make_backend(posed), self.make_mesh(mesh), pose, Bodies.uniform(pose))


@cache
def ball_in_a_box(dimension: int, layers: int) -> Mesh:
    """The unit box around a ball, in so many ``layers`` from the one to the other, curved edges on the ball."""
    outer = box(dimension, 2 * layers if dimension == 2 else layers)
    facets = boundary_facets(outer.cells)
    used, facets = np.unique(facets, return_inverse=True)
    facets, at_box = np.sort(facets.reshape(-1, dimension), axis=1), outer.points[used] - CENTRE
    at_ball = RADIUS * at_box / np.linalg.norm(at_box, axis=1, keepdims=True)
    levels = np.linspace(0.0, 1.0, layers + 1)[:, None, None]
    points = CENTRE + ((1.0 - levels) * at_ball + levels * at_box).reshape(-1, dimension)
    # Prisms over the facets in simplices: up the layer from one vertex after the other, in the order of numbers.
    low, high = facets, facets + len(used)
    layer = np.concatenate([np.hstack([low[:, : k + 1], high[:, k:]]) for k in range(dimension)])
    cells = np.concatenate([layer + len(used) * number for number in range(layers)])
    outside = boundary_facets(cells)
    on_ball = outside.max(axis=1) < len(used)
    middle = points[outside].mean(axis=1)
    distance = np.stack([middle, 1.0 - middle], axis=2).reshape(len(outside), 2 * dimension)
    edges = np.unique(
        np.concatenate([facets[:, pair] for pair in map(list, combinations(range(dimension), 2))]), axis=0
    )
    chord = points[edges].mean(axis=1) - CENTRE
    arc = CENTRE + RADIUS * chord / np.linalg.norm(chord, axis=1, keepdims=True)
    markers = np.where(on_ball, 0, 1 + np.argmin(distance, axis=1))
    mesh = orient(Mesh(points, cells, outside, markers))
    return Mesh(
        mesh.points, mesh.cells, outside, markers, curved=CurvedEdges(edges, np.zeros(len(edges), dtype=np.int64), arc)
    )


def _outside(dimension: int) -> FloatArray:
    """Points (N, d) at random in the box, not in the ball and not on it."""
    points = np.random.default_rng(1).uniform(0.02, 0.98, (400, dimension))
    return np.asarray(points[np.linalg.norm(points - CENTRE, axis=1) > 1.3 * RADIUS])


def _carried(geometry: FloatArray, shift: FloatArray) -> FloatArray:
    """The box with its ball displaced by ``shift`` (d,); the faces stay."""
    apart = np.linalg.norm(geometry - CENTRE, axis=1) - RADIUS
    share = np.cos(0.5 * np.pi * np.clip((apart - 1e-6) / (CENTRE - RADIUS - 1e-6), 0.0, 1.0)) ** 2
    return np.asarray(geometry + share[:, None] * shift)
