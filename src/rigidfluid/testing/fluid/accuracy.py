"""Flows that the discrete equations have exactly, and orders of convergence to those that they have not."""

from __future__ import annotations

from functools import partial
from typing import ClassVar

import numpy as np
import pytest

from rigidfluid.core.fluid.conditions import PrescribedVelocity
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.testing.fluid.base import FluidContract
from rigidfluid.testing.fluid.boxes import box, quadrature, renumbered, samples, swayed, swayed_across
from rigidfluid.testing.fluid.exact import DENSITY, VISCOSITY, LinearFlow, Waves, enclosed, problem
from rigidfluid.testing.fluid.flow import Flow

UNEVEN = np.array([1.0, 0.5, 0.5, 1.0, 1.0])
"""Steps that halve and double, in units of the longest."""

END = 0.5
"""Time at which the test of the order in time compares [time]."""


class AccuracyContract(FluidContract):
    """Patch tests, on meshes at rest and in motion, and orders in space and time."""

    lowest_orders: ClassVar[tuple[float, float, float]] = (2.9, 1.9, 1.9)
    """Lowest observed orders allowed: velocity in space, pressure in space, both in time."""

    def test_a_linear_flow_is_exact(self, dimension: int) -> None:
        """u = A x + b and p = c·x: a Stokes step from rest, and the Navier–Stokes step after it."""
        exact = LinearFlow.steady(dimension)
        flow = self.empty(enclosed(dimension, exact.velocity, exact.source), box(dimension, 3))
        for length in (None, 0.1):
            flow = flow.after(length)
            self._check(flow, exact)

    def test_a_shear_flow_is_exact_on_a_mesh_in_motion(self, dimension: int) -> None:
        """u = A x + b: its difference in time along the vertices' paths is what the mesh velocity carries."""
        exact = LinearFlow.shear(dimension)
        flow = self.empty(enclosed(dimension, exact.velocity, exact.source), box(dimension, 3)).after(None)
        points, weights = quadrature(box(dimension, 1))
        kinetic = 0.5 * DENSITY * float(weights @ np.sum(exact.velocity(0.0, points) ** 2, axis=1))
        strain = exact.gradient + exact.gradient.T
        for length in 0.1 * UNEVEN:
            sway = _sway(flow.time + length, dimension)
            flow = flow.after(length, points=swayed_across(flow.reference.points, sway))
            self._check(flow, exact)
            self.assert_close(flow.advance.kinetic_energy, kinetic, scale=10.0)
            dissipated = [flow.advance.dissipation, flow.advance.dissipation_midway]
            self.assert_close(dissipated, 0.5 * VISCOSITY * np.sum(strain**2), scale=10.0)

    def test_uniform_flow_stays_uniform_on_a_mesh_in_motion(self, dimension: int) -> None:
        """Geometric conservation: however the mesh moves, and however unequal the steps."""
        drift = np.array([1.0, -0.5, 0.3])[:dimension]
        flow = self.empty(enclosed(dimension, lambda _, x: np.tile(drift, (len(x), 1))), box(dimension, 3)).after(None)
        points = samples(dimension)
        for length in 0.1 * UNEVEN:
            flow = flow.after(length, points=swayed(flow.reference.points, _sway(flow.time + length, dimension)))
            velocity, pressure = flow.probe(points)
            self.assert_close(velocity, np.broadcast_to(drift, velocity.shape))
            self.assert_close(pressure, 0.0, scale=10.0)

    def test_an_enclosed_flow_does_not_depend_on_the_numbering(self, dimension: int) -> None:
        """Inflow equals outflow, but not as interpolated on the faces: no single vertex may take the difference."""

        def through(_time: float, points: FloatArray) -> FloatArray:
            velocity, across = np.zeros_like(points), points[:, 1:]
            parabola, sine = 6.0 * across * (1.0 - across), 0.5 * np.pi * np.sin(np.pi * across)
            velocity[:, 0] = np.prod(np.where(points[:, :1] < 0.5, parabola, sine), axis=1)
            return velocity

        given = partial(PrescribedVelocity, value=through)
        posed, mesh = problem(dimension, {"x0": given, "x1": given}), box(dimension, 3)
        flow, other = (self.empty(posed, whole).after(None) for whole in (mesh, renumbered(mesh)))
        points = samples(dimension)
        (velocity, pressure), (velocity_there, pressure_there) = flow.probe(points), other.probe(points)
        self.assert_close(velocity_there, velocity)
        self.assert_close(pressure_there, pressure, scale=10.0 * float(np.abs(pressure).max()))

    def test_orders_in_space(self, dimension: int) -> None:
        """Steady Navier–Stokes flow: velocity of order 3 and pressure of order 2 in L²."""
        divisions = (4, 8, 16) if dimension == 2 else (3, 6)
        errors = np.array([self._errors(dimension, count) for count in divisions])
        orders = np.log2(errors[:-1] / errors[1:])[-1]
        assert np.all(orders > self.lowest_orders[:2]), (orders, errors)

    @pytest.mark.parametrize("even", [True, False], ids=["even", "uneven"])
    def test_order_in_time(self, even: bool) -> None:
        """On a swaying mesh, with a flow that is linear in space: only time errs, velocity and pressure by order 2."""
        pattern = np.ones(5) if even else UNEVEN
        errors = np.array([self._error_in_time(np.tile(pattern, count)) for count in (4, 8, 16)])
        orders = np.log2(errors[:-1] / errors[1:])[-1]
        assert np.all(orders > self.lowest_orders[2]), (orders, errors)

    def _check(self, flow: Flow, exact: LinearFlow) -> None:
        points = samples(len(exact.drift))
        velocity, pressure = flow.probe(points)
        self.assert_close(velocity, exact.velocity(flow.time, points))
        self.assert_close(pressure, exact.pressure(flow.time, points), scale=10.0)

    def _errors(self, dimension: int, divisions: int) -> FloatArray:
        """L² errors (2,) of velocity and pressure; the advecting velocity is a Stokes solution, itself of order 3."""
        exact, mesh = Waves(dimension), box(dimension, divisions)
        flow = self.empty(enclosed(dimension, exact.velocity, exact.source), mesh).after(None)
        flow = flow.after(1e9)
        points, weights = quadrature(mesh)
        velocity, pressure = flow.probe(points)
        wrong = np.sum((velocity - exact.velocity(1.0, points)) ** 2, axis=1)
        return np.sqrt([weights @ wrong, weights @ (pressure - exact.pressure(1.0, points)) ** 2])

    def _error_in_time(self, pattern: FloatArray) -> FloatArray:
        """Largest errors of velocity and pressure at `END`."""
        steady, points = LinearFlow.steady(2), samples(2)
        exact = LinearFlow(
            steady.gradient,
            steady.drift,
            steady.slope,
            lambda time: float(np.cos(3 * time)),
            lambda time: float(-3 * np.sin(3 * time)),
            lambda time: float(1 + np.sin(2 * time)),
        )
        flow = self.empty(enclosed(2, exact.velocity, exact.source), box(2, 4)).after(None)
        for length in pattern * (END / pattern.sum()):
            flow = flow.after(length, points=swayed(flow.reference.points, _sway(flow.time + length, 2)))
        velocity, pressure = flow.probe(points)
        return np.array(
            [
                np.abs(velocity - exact.velocity(flow.time, points)).max(),
                np.abs(pressure - exact.pressure(flow.time, points)).max(),
            ]
        )


def _sway(time: float, dimension: int) -> FloatArray:
    """How far a mesh is displaced, zero at time 0 [length]."""
    return np.array([0.06 * np.sin(6 * time), 0.06 * (np.cos(5 * time) - 1.0), 0.05 * np.sin(4 * time)])[:dimension]
