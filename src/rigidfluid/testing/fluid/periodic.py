"""Periodic faces: outflow through one is inflow through the other, and a pressure may drop between them,
or a flux be held."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from rigidfluid.core.fluid.conditions import Periodic, Slip, TimeValue, Value, no_pressure
from rigidfluid.core.fluid.fluid_problem import FluidProblem
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mesh.adaptation.recut import neighbours, recut
from rigidfluid.core.mesh.adaptation.smooth_cut import smooth_cut
from rigidfluid.core.mesh.generation.periodic import Seams
from rigidfluid.core.mesh.topology import boundary_facets
from rigidfluid.core.model.types import Mesh, Pose
from rigidfluid.testing.fluid.base import FluidContract
from rigidfluid.testing.fluid.boxes import box, quadrature, samples, swayed
from rigidfluid.testing.fluid.curved import CENTRE, ball_in_a_box
from rigidfluid.testing.fluid.exact import DENSITY, VISCOSITY, problem
from rigidfluid.testing.fluid.flow import Bodies, Flow, figures

DROP = 2.0
"""Pressure drop from x0 to x1."""

FLUX = 0.7
"""Flux from x0 to x1."""


class PeriodicContract(FluidContract):
    """Exact flows and balances between periodic faces; for backends that take ``periodic_faces``."""

    def test_the_flow_that_a_pressure_drop_drives_is_exact(self, dimension: int) -> None:
        """u = G y(1 - y)/2μ and a linear pressure of zero mean, periodic also across z in 3D."""
        posed = self._periodic(problem(dimension, inertia=False), (0, 2) if dimension == 3 else (0,))
        flow = self.empty(posed, box(dimension, 3)).after(None)
        velocity, pressure = flow.probe(samples(dimension))
        height = samples(dimension)[:, 1]
        along = DROP * height * (1.0 - height) / (2.0 * VISCOSITY)
        self.assert_close(velocity, np.outer(along, np.eye(dimension)[0]))
        self.assert_close(pressure, DROP * (0.5 - samples(dimension)[:, 0]), scale=10.0)
        self.assert_close(flow.advance.boundary_power, flow.advance.dissipation)

    def test_the_seam_of_a_periodic_mesh_may_be_anywhere(self, dimension: int) -> None:
        """The same exact flow where the periodic facets are bent, and the pressure goes on past the box."""
        posed = self._periodic(problem(dimension, inertia=False), (0, 2) if dimension == 3 else (0,))
        flow = self.empty(posed, _bent_seam(dimension)).after(None)
        fields = flow.backend.fields(flow.fluid, flow.mesh)
        assert fields.points[:, 0].max() > 1.2
        along = DROP * fields.points[:, 1] * (1.0 - fields.points[:, 1]) / (2.0 * VISCOSITY)
        self.assert_close(fields.velocity, np.outer(along, np.eye(dimension)[0]))
        pressure = fields.pressure + DROP * fields.points[:, 0]
        self.assert_close(pressure, pressure[0], scale=10.0)
        self.assert_close(flow.advance.boundary_power, flow.advance.dissipation)

    def test_two_periods_are_twice_one_period(self, dimension: int) -> None:
        """A pressure drop and forces that are the same in each period, from rest and with convection."""

        def stirring(_time: float, at: FloatArray) -> FloatArray:
            force = np.zeros_like(at)
            force[:, 1] = 8.0 * np.sin(2.0 * np.pi * at[:, 0])
            return force

        forced = problem(dimension, source=stirring)
        posed, twice = (self._periodic(forced, (0,), drop) for drop in (DROP, 2.0 * DROP))
        one, two = self.empty(posed, box(dimension, 3)), self.empty(twice, _twice(dimension))
        shift = np.eye(dimension)[0]
        for _ in range(3):
            one, two = one.after(0.1), two.after(0.1)
            velocity, _ = one.probe(samples(dimension))
            for period in range(2):
                self.assert_close(two.probe(samples(dimension) + period * shift)[0], velocity)
            self.assert_close(figures(two.advance)["energies"], 2.0 * figures(one.advance)["energies"])
        assert np.abs(velocity[:, 1]).max() > 0.01

    def test_fluid_that_nothing_holds_falls_freely(self, dimension: int) -> None:
        """Periodic in all directions: u = g t by a force ρ g, and no pressure."""
        gravity = np.array([0.3, -1.0, 0.5])[:dimension]
        falling: Value = lambda _, at: np.tile(DENSITY * gravity, (len(at), 1))  # noqa: E731
        posed = self._periodic(problem(dimension, source=falling), tuple(range(dimension)), drop=0.0)
        flow = self.empty(posed, box(dimension, 3))
        for _ in range(3):
            flow = flow.after(0.1)
            velocity, pressure = flow.probe(samples(dimension))
            self.assert_close(velocity, np.broadcast_to(flow.time * gravity, velocity.shape))
            self.assert_close(pressure, 0.0, scale=10.0)

    def test_momentum_is_kept_between_seams_alone(self, dimension: int) -> None:
        """Periodic in all directions: vortices on a mesh that moves keep ∫ ρ u to rounding, whatever the solver
        leaves."""
        if not self.backend.initial_flows:
            pytest.skip(f"{self.backend.name} starts from rest alone")
        posed = replace(self._periodic(problem(dimension), tuple(range(dimension)), drop=0.0), initial=_vortices)
        flow = self.empty(posed, box(dimension, 3))
        start = _momentum(flow)
        for _ in range(3):
            swaying = 0.1 * np.sin(5.0 * (flow.time + 0.1)) * np.ones(dimension)
            flow = flow.after(0.1, points=swayed(flow.reference.points, swaying))
            np.testing.assert_allclose(_momentum(flow), start, rtol=0, atol=1e-13)
        assert np.abs(flow.probe(samples(dimension))[0]).max() > 0.1

    def test_a_ball_takes_all_of_the_pressure_drop_where_walls_take_none(self, dimension: int) -> None:
        """The momentum of a steady flow: drag = drop · area, with slip on the sides."""
        if not self.backend.curved_cells:
            pytest.skip(f"{self.backend.name} takes straight cells alone")
        sides = dict.fromkeys(("y0", "y1", "z0", "z1")[: 2 * dimension - 2], Slip)
        posed = self._periodic(problem(dimension, sides, bodies=1, inertia=False), (0,))
        pose = Pose(np.full((1, dimension), CENTRE), np.eye(1, 1 if dimension == 2 else 4))
        mesh = self.make_mesh(ball_in_a_box(dimension, 2))
        flow = Flow.start(self.make_backend(posed), mesh, pose, Bodies.uniform(pose)).after(None)
        self.assert_close(flow.advance.hydrodynamic_wrench.force[0, 0], DROP, scale=10.0)
        if dimension == 2:  # in 3D dissipation on curved cells depends on the rule of its integral
            self.assert_close(flow.advance.boundary_power, flow.advance.dissipation)

    def test_a_flux_that_is_held_is_driven_by_the_drop_of_poiseuille_flow(self, dimension: int) -> None:
        """12 μ Q/h³ over a length 1 and a height h = 1, with the flux Q per width; steady, without inertia."""
        posed = self._holding(problem(dimension, inertia=False), (0, 2) if dimension == 3 else (0,), lambda _: FLUX)
        flow = self.empty(posed, box(dimension, 3)).after(None)
        flux, drop = flow.backend.driving(flow.fluid, flow.mesh)[0]
        height = samples(dimension)[:, 1]
        along = 6.0 * FLUX * height * (1.0 - height)
        self.assert_close([flux, drop], [FLUX, 12.0 * VISCOSITY * FLUX], scale=10.0)
        self.assert_close(flow.probe(samples(dimension))[0], np.outer(along, np.eye(dimension)[0]), scale=10.0)
        self.assert_close(flow.advance.boundary_power, flow.advance.dissipation, scale=10.0)

    def test_a_flux_that_changes_is_met_in_every_step(self, dimension: int) -> None:
        """With inertia and convection, from rest, to rounding whatever the residual of the solver."""
        posed = self._holding(problem(dimension), (0,), lambda time: np.sin(5.0 * time))
        flow = self.empty(posed, box(dimension, 3))
        for _ in range(4):
            flow = flow.after(0.1)
            flux, drop = flow.backend.driving(flow.fluid, flow.mesh)[0]
            assert abs(flux - np.sin(5.0 * flow.time)) < 1e-12
        assert drop > 0.0

    def test_the_drop_that_is_found_drives_the_flow_that_was_held(self, dimension: int) -> None:
        """A free body in the flow of a flux, and of the drop that was found for it."""
        held = self._holding(problem(dimension, bodies=1), (0,), lambda _: FLUX)
        flow = self._round_a_body(held, dimension).after(0.1)
        (_, drop), *_ = flow.backend.driving(flow.fluid, flow.mesh)
        driven = self._round_a_body(self._periodic(problem(dimension, bodies=1), (0,), drop), dimension).after(0.1)
        for name, value in figures(flow.advance).items():
            self.assert_close(value, figures(driven.advance)[name], scale=100.0 + 10.0 * abs(drop))

    def _round_a_body(self, posed: FluidProblem, dimension: int) -> Flow:
        """A free ball in the middle of the box."""
        if not self.backend.curved_cells:
            pytest.skip(f"{self.backend.name} takes straight cells alone")
        pose = Pose(np.full((1, dimension), CENTRE), np.eye(1, 1 if dimension == 2 else 4))
        mesh = self.make_mesh(ball_in_a_box(dimension, 2))
        return Flow.start(self.make_backend(posed), mesh, pose, Bodies.uniform(pose, prescribed=False))

    def _holding(self, posed: FluidProblem, axes: tuple[int, ...], flux: TimeValue) -> FluidProblem:
        """The box with the faces across some axes periodic, and a ``flux`` held through the first of them."""
        if not self.backend.held_fluxes:
            pytest.skip(f"{self.backend.name} holds no flux")
        periodic = self._periodic(posed, axes, 0.0)
        first = periodic.conditions[0]
        assert isinstance(first, Periodic)
        return replace(
            periodic, conditions=(replace(first, drop=no_pressure, held_flux=flux), *periodic.conditions[1:])
        )

    def _periodic(self, posed: FluidProblem, axes: tuple[int, ...], drop: float = DROP) -> FluidProblem:
        """The box with the faces across some axes periodic, a pressure drop from the first of them."""
        if not self.backend.periodic_faces:
            pytest.skip(f"{self.backend.name} takes no periodic faces")
        conditions = list(posed.conditions)
        for axis in axes:
            first, second = conditions[2 * axis], conditions[2 * axis + 1]
            jump: Value = (lambda _, at: np.full(len(at), drop)) if axis == 0 else no_pressure
            conditions[2 * axis] = Periodic(first.surface, first.name, first.normal, second.surface, jump)
            conditions[2 * axis + 1] = Periodic(second.surface, second.name, second.normal)
        return replace(posed, conditions=tuple(conditions))


def _vortices(_time: float, at: FloatArray) -> FloatArray:
    """A flow (N, d) that is periodic and has no symmetry, near one without divergence."""
    along, across = 2.0 * np.pi * at[:, 0], 2.0 * np.pi * at[:, 1]
    velocity = np.zeros_like(at)
    velocity[:, 0] = 0.3 + np.cos(along) * np.sin(across) + 0.5 * np.sin(2.0 * across + along)
    velocity[:, 1] = 0.2 * np.sin(along) - np.sin(along) * np.cos(across)
    return velocity


def _momentum(flow: Flow) -> FloatArray:
    """Momentum (d,) of the fluid in an empty box [mass·length/time]."""
    points, weights = quadrature(flow.mesh)
    return np.asarray(DENSITY * weights @ flow.probe(points)[0])


def _bent_seam(dimension: int) -> Mesh:
    """The box, periodic across x and in 3D z, cut open along a curve instead of along x = 0."""
    mesh, axes = box(dimension, 6 if dimension == 2 else 4), np.array((0, 2) if dimension == 3 else (0,))
    seams = Seams(2 * axes, 2 * axes + 1, np.eye(dimension)[axes])
    centres = mesh.points[mesh.cells].mean(axis=1)
    shift = np.zeros((len(mesh.cells), len(axes)), dtype=np.int64)
    shift[:, 0] = centres[:, 0] < 0.3 + 0.3 * np.sin(2.0 * np.pi * centres[:, 1])
    none = np.zeros(len(mesh.cells), dtype=bool)
    return recut(mesh, seams, smooth_cut(shift, neighbours(mesh, seams), none, none))


def _twice(dimension: int) -> Mesh:
    """Two boxes side by side."""
    one = box(dimension, 3)
    ahead = one.points + np.eye(dimension)[0]
    points, number = np.unique(np.round(np.concatenate([one.points, ahead]), 12), axis=0, return_inverse=True)
    cells = number.ravel()[np.concatenate([one.cells, one.cells + len(one.points)])]
    facets = boundary_facets(cells)
    middle = points[facets].mean(axis=1) / np.array([2.0, 1.0, 1.0])[:dimension]
    distance = np.stack([middle, 1.0 - middle], axis=2).reshape(len(facets), 2 * dimension)
    return Mesh(points, cells, facets, np.argmin(distance, axis=1))
