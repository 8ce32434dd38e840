"""Slip and pressure on faces that lie across no axis: a channel that is turned is the same channel."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from rigidfluid.core.fluid.conditions import NoSlip, PrescribedPressure, PrescribedVelocity, Slip
from rigidfluid.core.fluid.fluid_problem import FluidProblem
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.rigid import rotation_matrices
from rigidfluid.core.model.types import Mesh
from rigidfluid.testing.fluid.base import FluidContract
from rigidfluid.testing.fluid.boxes import box, samples, swayed_across
from rigidfluid.testing.fluid.curved import CENTRE, RADIUS, ball_in_a_box
from rigidfluid.testing.fluid.exact import FACES, VISCOSITY, Kind, problem
from rigidfluid.testing.fluid.flow import Flow, figures

DRIFT = 0.7
"""Speed of a uniform flow [length/time]."""


class ObliqueContract(FluidContract):
    """Slip and pressure on faces in any direction; for backends that take ``oblique_faces``."""

    @pytest.mark.parametrize("side", [NoSlip, Slip])
    def test_a_channel_that_is_turned_is_the_same_channel(self, dimension: int, side: Kind) -> None:
        """A pressure drives fluid from rest, while the mesh moves; walls or slip above and below, slip on the sides."""
        kinds = {"x1": PrescribedPressure, "y0": side, "z0": Slip, "z1": Slip}
        kinds["x0"] = partial(PrescribedPressure, value=lambda time, at: np.full(len(at), 1.0 + time))
        posed, mesh, turn = problem(dimension, kinds), box(dimension, 3), _turn(dimension)
        straight, oblique = self.empty(posed, mesh), self._turned(posed, mesh)
        points = samples(dimension)
        for _ in range(3):
            moved = swayed_across(mesh.points, 0.05 * np.sin(10.0 * (straight.time + 0.1)) * np.ones(dimension))
            straight, oblique = straight.after(0.1, points=moved), oblique.after(0.1, points=moved @ turn.T)
            velocity, pressure = straight.probe(points)
            turned_velocity, turned_pressure = oblique.probe(points @ turn.T)
            self.assert_close(turned_velocity @ turn, velocity)
            self.assert_close(turned_pressure, pressure, scale=10.0)
            self.assert_close(figures(oblique.advance)["energies"], figures(straight.advance)["energies"])
        assert np.linalg.norm(velocity, axis=1).max() > 0.01

    def test_the_flow_between_oblique_walls_is_exact(self, dimension: int) -> None:
        """u = G y(1 - y)/2μ along the channel and p linear, by pressures on its oblique ends."""
        kinds: dict[str, Kind] = {"x1": PrescribedPressure, "z0": Slip, "z1": Slip}
        kinds["x0"] = partial(PrescribedPressure, value=lambda _, at: np.full(len(at), 2.0))
        posed = problem(dimension, kinds, inertia=False)
        flow, turn = self._turned(posed, box(dimension, 3)).after(None), _turn(dimension)
        points = samples(dimension)
        velocity, pressure = flow.probe(points @ turn.T)
        along = points[:, 1] * (1.0 - points[:, 1]) / VISCOSITY
        self.assert_close(velocity, np.outer(along, turn[:, 0]))
        self.assert_close(pressure, 2.0 * (1.0 - points[:, 0]), scale=10.0)
        self.assert_close(flow.advance.boundary_power, flow.advance.dissipation)

    def test_uniform_flow_slips_along_oblique_faces(self, dimension: int) -> None:
        """Nothing holds it, and it stays as it is."""
        drift = DRIFT * _turn(dimension)[:, 0]
        kinds: dict[str, Kind] = dict.fromkeys(FACES[2 : 2 * dimension], Slip)
        kinds["x0"] = partial(PrescribedVelocity, value=lambda _, at: np.tile(drift, (len(at), 1)))
        posed = problem(dimension, kinds | {"x1": PrescribedPressure})
        flow = self._turned(posed, box(dimension, 3)).after(None)
        for length in (0.1, 0.1):
            flow = flow.after(length)
            velocity, pressure = flow.probe(samples(dimension) @ _turn(dimension).T)
            self.assert_close(velocity, np.broadcast_to(drift, velocity.shape))
            self.assert_close(pressure, 0.0, scale=10.0)

    def test_fluid_under_even_pressure_rests_along_a_curved_face(self, dimension: int) -> None:
        """The same pressure on all of the box pushes nothing past a ball with slip."""
        even = partial(PrescribedPressure, value=lambda _, at: np.full(len(at), 3.0))
        every = problem(dimension, dict.fromkeys(FACES[: 2 * dimension], even))
        flow = self._past_a_ball(every, layers=2).after(None).after(0.1)
        velocity, pressure = flow.probe(_outside(dimension))
        self.assert_close(velocity, 0.0)
        self.assert_close(pressure, 3.0, scale=10.0)

    @pytest.mark.parametrize(("inertia", "allowed"), [(False, 0.0), (True, 2e-5)], ids=["Stokes", "with inertia"])
    def test_what_flows_past_a_curved_face_is_dissipated(self, inertia: bool, allowed: float) -> None:
        """In 2D as much flows out as in, and power in is dissipation; but for what convection carries across a curved
        face between its nodes, of order 4."""
        kinds: dict[str, Kind] = {"x1": PrescribedPressure, "y0": Slip, "y1": Slip}
        kinds["x0"] = partial(PrescribedVelocity, value=lambda _, at: np.tile([DRIFT, 0.0], (len(at), 1)))
        flow = self._past_a_ball(problem(2, kinds, inertia=inertia), layers=4)
        for _ in range(12 if inertia else 1):
            flow = flow.after(None)
        root, weight = np.polynomial.legendre.leggauss(3)
        height = ((np.arange(8)[:, None] + 0.5 * (1.0 + root)) / 8.0).ravel()
        velocity, _ = flow.probe(np.column_stack([np.ones(len(height)), height]))
        self.assert_close(np.tile(weight / 16.0, 8) @ velocity[:, 0], DRIFT)
        dissipation = flow.advance.dissipation
        self.assert_close(
            flow.advance.boundary_power, dissipation, scale=10.0 + dissipation * allowed / self.solver_tolerance
        )
        assert dissipation > 1.0

    def _turned(self, posed: FluidProblem, mesh: Mesh) -> Flow:
        """Fluid at rest in the box and the ``mesh``, all turned."""
        self._skip_without_oblique_faces()
        turn = _turn(posed.dimension)
        faces = tuple(replace(c, normal=None if c.normal is None else turn @ c.normal) for c in posed.conditions)
        return self.empty(replace(posed, conditions=faces), replace(mesh, points=mesh.points @ turn.T))

    def _past_a_ball(self, posed: FluidProblem, layers: int) -> Flow:
        """Fluid at rest in the box round a ball that is part of the domain's boundary, with slip."""
        self._skip_without_oblique_faces()
        if not self.backend.curved_cells:
            pytest.skip(f"{self.backend.name} takes straight cells alone")
        ball = Slip(0, "ball", None)
        box_faces = tuple(replace(c, surface=c.surface + 1) for c in posed.conditions)
        mesh = ball_in_a_box(posed.dimension, layers)
        return self.empty(replace(posed, conditions=(ball, *box_faces)), mesh)

    def _skip_without_oblique_faces(self) -> None:
        if not self.backend.oblique_faces:
            pytest.skip(f"{self.backend.name} takes slip and pressure on faces across an axis alone")


def _turn(dimension: int) -> FloatArray:
    """Rotation by 30° in 2D, and by 40° about a slanted axis in 3D."""
    if dimension == 2:
        return np.asarray(rotation_matrices(np.array([[np.pi / 6.0]]))[0])
    axis = np.array([2.0, -1.0, 3.0]) / np.sqrt(14.0)
    return np.asarray(rotation_matrices(np.array([[np.cos(np.pi / 9.0), *(np.sin(np.pi / 9.0) * axis)]]))[0])


def _outside(dimension: int) -> FloatArray:
    """Points (N, d) at random in the box and outside the ball."""
    points = samples(dimension, 200)
    return np.asarray(points[np.linalg.norm(points - CENTRE, axis=1) > 1.3 * RADIUS])
