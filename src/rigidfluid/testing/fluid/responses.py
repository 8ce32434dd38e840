"""Impulse responses of bodies: at once, with added mass alone; within a step, with viscosity as well."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import ClassVar

import numpy as np
from scipy.linalg import block_diag

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.rigid import rotation_matrices
from rigidfluid.core.model.types import Mesh, Pose
from rigidfluid.testing.arrangement import in_a_box
from rigidfluid.testing.fluid.base import FluidContract
from rigidfluid.testing.fluid.boxes import balls_pose
from rigidfluid.testing.fluid.exact import DENSITY, problem
from rigidfluid.testing.fluid.flow import Bodies, Flow, components, size

STEP = 0.01
"""Length of the step in most tests; inviscid responses do not depend on it [time]."""

IMPACT = 1e-3
"""A step so short that viscosity does little in it [time]."""

SHORT = 10.0 ** -np.arange(2.0, 6.0)
"""Steps in which viscosity does less and less [time]."""

RADII, GAP = np.array([1.0, 0.6]), 0.2
"""Radii (2,) of two disks, and the gap between them [length]."""


class ResponsesContract(FluidContract):
    """Added masses that are known, and what the same backend's steps do."""

    response_tolerance: ClassVar[float] = 1e-4
    """Accuracy of impulse responses, relative to the largest entry."""

    def test_a_disk_takes_its_own_volume_of_fluid_along(self) -> None:
        """Mass m + ρπr² along, and none of the fluid's as it turns (Lamb 1932, §68)."""
        flow = self._in_a_wide_box(np.ones((1, 2)), np.zeros((1, 2)), mass=DENSITY * np.pi)
        expected = DENSITY * np.pi * np.array([2.0, 2.0, 1.0])
        _assert_near(_mass(flow), np.diag(expected), 0.02)

    def test_an_ellipse_takes_more_along_across_than_along(self) -> None:
        """ρπb² and ρπa² along its axes a and b, ρπ(a² - b²)²/8 as it turns (Lamb 1932, §71); its axes are tilted."""
        a, b, mass, tilt = 1.0, 0.5, 0.1, np.array([[0.5]])
        flow = self._in_a_wide_box(np.array([[a, b]]), np.zeros((1, 2)), mass, tilt)
        turn = rotation_matrices(tilt)[0]
        added = DENSITY * np.pi * np.array([b**2, a**2, (a**2 - b**2) ** 2 / 8])
        along = turn @ np.diag(mass + added[:2]) @ turn.T
        found = _mass(flow)
        _assert_near(found[:2, :2], along, 0.02)
        _assert_near(found[2:, 2:], mass + added[2:, None], 0.03)
        assert np.abs(found[:2, 2:]).max() < 0.01 * along.max()

    def test_two_disks_near_each_other(self) -> None:
        """Along the line of centres and across, one of them moving or both: as by images of doublets."""
        centres, mass = np.array([[0.0, 0.0], [RADII.sum() + GAP, 0.0]]), 0.1
        found = _mass(self._in_a_wide_box(np.tile(RADII[:, None], 2), centres, mass))
        for axis in range(2):
            expected = mass * np.eye(2) + DENSITY * _added_to_two_disks(across=axis == 1)
            _assert_near(found[axis::3, axis::3], expected, 0.015)

    def test_a_ball_takes_half_its_volume_of_fluid_along(self) -> None:
        """Mass m + ρV/2 (Lamb 1932, §92), on a coarse mesh, in which more than the ball moves along."""
        volume = 4.0 / 3.0 * np.pi
        flow = self._in_a_wide_box(np.ones((1, 3)), np.zeros((1, 3)), 3.0 * DENSITY * volume)
        _assert_near(_mass(flow)[:3, :3], 3.5 * DENSITY * volume * np.eye(3), 0.05)

    def test_responses_are_reciprocal(self, dimension: int) -> None:
        """Impulse responses are symmetric and positive definite: inviscid ones and, without convection, viscous
        ones."""
        inviscid, _ = _responses(self._stirred_free(dimension), STEP)
        for found in (inviscid, *_responses(self._free_balls(dimension), STEP)):
            self._assert_responses(found, found.T)
            assert np.linalg.eigvalsh(0.5 * (found + found.T)).min() > 0.0

    def test_responses_add_up(self, dimension: int) -> None:
        """In a stirred flow impulse responses are linear in the impulse."""
        flow = self._stirred_free(dimension)
        step = flow.step_after(STEP)
        impulses = np.random.default_rng(4).normal(size=(2, *step.load.shape))
        applied = np.concatenate([impulses, 2.0 * impulses[:1] - impulses[1:]])
        response = flow.backend.response(flow.fluid, flow.mesh, step, applied)
        for found in (response.inviscid, response.viscous):
            assert found.shape == applied.shape
            self._assert_responses(found[2], 2.0 * found[0] - found[1])

    def test_in_a_short_step_masses_alone_count(self) -> None:
        """Viscosity makes responses smaller, by less and less as the step gets shorter."""
        flow, apart = self._free_balls(2), []
        for length in SHORT:
            inviscid, viscous = _responses(flow, length)
            drag = np.linalg.inv(viscous) - np.linalg.inv(inviscid)
            least = -self.response_tolerance * np.linalg.norm(np.linalg.inv(inviscid))
            assert np.linalg.eigvalsh(0.5 * (drag + drag.T)).min() > least
            apart.append(np.linalg.norm(inviscid - viscous) / np.linalg.norm(inviscid))
        assert np.all(np.diff(apart) < 0.0), apart
        assert apart[-1] < 0.02 < 0.05 < apart[0], apart

    def test_a_step_responds_as_was_told(self, dimension: int) -> None:
        """Two steps of a stirred flow, one with an impulse in its load, differ by the response to it."""
        flow = self.stirred(dimension, steps=2)
        step = self.stirring(flow)
        impulse = 0.01 * np.random.default_rng(5).normal(size=step.load.shape)
        pushed = replace(step, load=step.load + step.derivative[0] * impulse, impulse=impulse)
        told = flow.backend.response(flow.fluid, flow.mesh, step, impulse[None]).viscous[0]
        twists = [components(flow.taken(taken, None).twist) for taken in (step, pushed)]
        self._assert_responses(told, twists[1] - twists[0])
        assert np.abs(told).max() > 1e-3

    def test_what_turns_convects_as_the_flow_of_an_impact(self, dimension: int) -> None:
        """In fluid at rest a step with impulses that turn responds much as one in the flow that these have just
        made."""
        flow, units = self._free_balls(dimension), _units(self._free_balls(dimension))
        twist = 5.0 * np.random.default_rng(6).normal(size=len(units))
        turning = (_mass(flow) @ twist).reshape(units[0].shape)
        blown = replace(flow.after(IMPACT, impulse=turning), past=None)
        still, turned, expected = (
            at.backend.response(at.fluid, at.mesh, replace(at.step_after(STEP), turning=given), units).viscous
            for at, given in ((flow, np.zeros_like(turning)), (flow, turning), (blown, np.zeros_like(turning)))
        )
        assert np.abs(turned - still).max() > 10.0 * self.response_tolerance * np.abs(still).max()
        assert np.linalg.norm(turned - expected) < 0.5 * np.linalg.norm(still - expected)

    def test_without_new_points_the_present_mesh_responds(self, dimension: int) -> None:
        """The same where it is at rest, in fluid that is not."""
        flow = self._stirred_free(dimension).after(STEP).after(STEP)
        step, units = flow.step_after(STEP), _units(flow)
        there, here = (
            flow.backend.response(flow.fluid, flow.mesh, each, units) for each in (step, replace(step, points=None))
        )
        self._assert_responses(here.inviscid, there.inviscid)
        self._assert_responses(here.viscous, there.viscous)

    def test_without_inertia_of_the_fluid_it_only_drags(self, dimension: int) -> None:
        """Stokes flow: inviscid M⁻¹ and viscous d₀ (d₀M + R)⁻¹, R from steady flows past bodies of prescribed twist."""
        flow = self._free_balls(dimension, inertia=False)
        moved = self.with_balls(problem(dimension, bodies=2, inertia=False))
        drag = [-components(moved.after(None, twist=unit).advance.hydrodynamic_wrench) for unit in _units(flow)]
        step = flow.step_after(STEP)
        inviscid, viscous = _responses(flow, STEP)
        resisted = block_diag(*step.mass_matrix) + np.array(drag).reshape(inviscid.shape).T
        d0 = step.derivative[0]
        self._assert_responses(inviscid, d0 * np.linalg.inv(block_diag(*step.mass_matrix)))
        self._assert_responses(viscous, d0 * np.linalg.inv(resisted))
        assert np.linalg.norm(inviscid - viscous) > 0.1 * np.linalg.norm(inviscid)

    def test_prescribed_bodies_do_not_respond(self, dimension: int) -> None:
        """Neither they to an impulse nor a free body to one on them, which it feels as a wall."""
        flow = self._free_balls(dimension)
        fixed = replace(flow, bodies=replace(flow.bodies, prescribed=np.array([True, False])))
        width = size(flow.pose)
        for found, free in zip(_responses(fixed, STEP), _responses(flow, STEP), strict=True):
            assert not found[:width].any()
            assert not found[:, :width].any()
            mass = np.linalg.inv(free)  # of both: next to a prescribed body the other one's own part of it counts
            self._assert_responses(found[width:, width:], np.linalg.inv(mass[width:, width:]))

    def _assert_responses(self, found: FloatArray, expected: FloatArray) -> None:
        np.testing.assert_allclose(found, expected, rtol=0, atol=self.response_tolerance * np.abs(expected).max())

    def _free_balls(self, dimension: int, inertia: bool = True) -> Flow:
        """Two light balls in fluid at rest."""
        bodies = Bodies.uniform(balls_pose(dimension), mass=0.05, prescribed=False)
        return self.with_balls(problem(dimension, bodies=2, inertia=inertia), bodies)

    def _stirred_free(self, dimension: int) -> Flow:
        flow = self.stirred(dimension, steps=2)
        return replace(flow, bodies=replace(flow.bodies, prescribed=np.zeros(2, dtype=bool)))

    def _in_a_wide_box(
        self, semi_axes: FloatArray, centres: FloatArray, mass: float, turned: FloatArray | None = None
    ) -> Flow:
        """Free bodies of one mass and moment of inertia in fluid at rest, the walls far away."""
        count, dimension = centres.shape
        upright = np.tile(np.eye(1, 1 if dimension == 2 else 4) * (dimension == 3), (count, 1))
        pose = Pose(centres, upright if turned is None else turned)
        mesh = _wide_box(_rows(semi_axes), _rows(centres), _rows(pose.orientation))
        inertia = np.tile(mass * np.eye(1 if dimension == 2 else 3), (count, 1, 1))
        bodies = Bodies(np.full(count, mass), inertia, np.zeros(count, dtype=bool))
        return Flow.start(self.make_backend(problem(dimension, bodies=count)), self.make_mesh(mesh), pose, bodies)


def _responses(flow: Flow, length: float) -> tuple[FloatArray, FloatArray]:
    """Inviscid and viscous impulse response matrices, (n·(d+k), n·(d+k)) each, from impulses to twists."""
    units = _units(flow)
    response = flow.backend.response(flow.fluid, flow.mesh, flow.step_after(length), units)
    return response.inviscid.reshape(len(units), -1).T, response.viscous.reshape(len(units), -1).T


def _mass(flow: Flow) -> FloatArray:
    """Mass matrix of bodies and fluid, (n·(d+k), n·(d+k)): the inverse of the inviscid response."""
    return np.asarray(np.linalg.inv(_responses(flow, STEP)[0]))


def _units(flow: Flow) -> FloatArray:
    """Unit impulses, one for each component, (n·(d+k), n, d+k)."""
    count, width = len(flow.pose.position), size(flow.pose)
    return np.eye(count * width).reshape(-1, count, width)


def _assert_near(found: FloatArray, expected: FloatArray, part: float) -> None:
    """Equal but for this ``part`` of the largest entry expected."""
    np.testing.assert_allclose(found, expected, rtol=0, atol=part * np.abs(expected).max())


def _added_to_two_disks(across: bool) -> FloatArray:
    """Added mass over density, of motions along or ``across`` the line of centres, (2, 2) [length²].

    A disk of radius a that moves with speed 1 is a doublet of strength a²; its image in a circle of radius b, at a
    distance f from there, is one of ∓(b/f)² times the strength at b²/f (Milne-Thomson 1968, Theoretical Hydrodynamics,
    §6.21, the circle theorem), which has an image in the first one. The impulse of the fluid about a disk is 2π times
    all doublets in it less the area times its velocity.
    """
    added = -np.diag(np.pi * RADII**2)
    for moving in range(2):
        body, strength, inside = moving, RADII[moving] ** 2, 0.0
        for _ in range(100):
            added[body, moving] += 2.0 * np.pi * strength
            body, away = 1 - body, RADII.sum() + GAP - inside
            strength *= (1.0 if across else -1.0) * (RADII[body] / away) ** 2
            inside = RADII[body] ** 2 / away
    return added


Rows = tuple[tuple[float, ...], ...]


def _rows(array: FloatArray) -> Rows:
    return tuple(map(tuple, array.tolist()))


@cache
def _wide_box(semi_axes: Rows, centres: Rows, orientation: Rows) -> Mesh:
    """Bodies of size 1 about the origin of a box, fine on them: elements on them move along, a layer of added mass."""
    dimension = len(centres[0])
    half, sizes = (20.0, (5.0, 0.02)) if dimension == 2 else (3.0, (3.0, 0.35))
    corners = np.full(dimension, -half), np.full(dimension, half)
    pose = Pose(np.array(centres), np.array(orientation))
    return in_a_box(np.array(semi_axes), pose, corners, range(2 * dimension), sizes).mesh
