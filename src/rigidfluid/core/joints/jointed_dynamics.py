"""Motion of bodies linked by joints, held directions, springs and dampers."""

from __future__ import annotations

from copy import copy
from dataclasses import replace
from math import prod
from typing import Any, NamedTuple, Protocol, Self

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.joints.damping import damper_impulse
from rigidfluid.core.joints.joint_forces import joint_forces
from rigidfluid.core.mechanics.matrices import sparse_as
from rigidfluid.core.mechanics.own_motions import OwnMotions
from rigidfluid.core.mechanics.wrenches import flat, nothing, wrench_sum
from rigidfluid.core.model.dynamics import ImpulsiveDynamics, LinkWork
from rigidfluid.core.model.joints import Joints
from rigidfluid.core.model.kinematics import Kinematics
from rigidfluid.core.model.types import Links, Pose, Twist, Wrench
from rigidfluid.errors import StepRejected

_MOST_ITERATIONS = 50

_AHEAD = 1e-3
"""Time after a corner at which rates are read, over that of the first kick [1]."""

_PARTS = 4
"""Number of parts of a time in which accelerations are sampled."""


class PlacedLinks(Joints, Protocol):
    """Joints that close by impulses, with springs."""

    def misfit(self, motions: Pose, time: float) -> FloatArray:
        """Constraint violation of rigid links, a row for each [length | rad]."""

    def tolerance(self, motions: Pose) -> FloatArray:
        """Constraint violations that are rounding there, a row for each [length | rad]."""

    def spring_wrench(self, motions: Pose, time: float) -> Wrench:
        """Wrench of springs on the motions, N rows."""


class JointedDynamics(OwnMotions):
    """RATTLE: kicks by impulses Cᵀ J after which twists are those that joints allow, drifts after impulses Cᵀ J at
    their start with which rigid joints fit at their end.

    It is of second order, reversible, and without a fluid symplectic; dampers act during a kick, exactly. ``inner`` are
    the N motions without joints, at the start, and is replaced by copies; ``time`` is that of the start [time].

    Andersen, J. Comput. Phys. 52 (1983) 24, doi:10.1016/0021-9991(83)90014-1; Leimkuhler and Skeel, J. Comput. Phys.
    112 (1994) 117, doi:10.1006/jcph.1994.1085.
    """

    def __init__(self, inner: ImpulsiveDynamics, linkage: PlacedLinks, time: float) -> None:
        self._inner, self._linkage, self._time = inner, linkage, time
        self._here = self._rows_here()
        self._rigid: BoolArray = self._here.links.compliance == 0.0
        nothing_yet = np.zeros_like(self._here.links.rate), np.zeros_like(flat(self.twist))
        self._work = LinkWork(*nothing_yet, 0.0, 0.0)
        self._begun = not linkage.driven

    @property
    def pose(self) -> Pose:
        """Poses of the N motions."""
        return self._inner.pose

    @property
    def twist(self) -> Twist:
        return self._inner.twist

    @property
    def link_work(self) -> LinkWork:
        return self._work

    @property
    def friction_loss(self) -> float:
        return self._inner.friction_loss

    @property
    def drag_left_out(self) -> float:
        return self._inner.drag_left_out

    @property
    def resisted(self) -> bool:
        return self._inner.resisted

    @property
    def inverse_mass(self) -> FloatArray:
        """Inverse masses of the motions without joints [1/mass]: joints only make motions heavier, so that plans with
        these err to the safe side."""
        return self._inner.inverse_mass

    @property
    def inverse_inertia(self) -> FloatArray:
        """Inverse inertia without joints; see `inverse_mass`."""
        return self._inner.inverse_inertia

    def inverse_mass_along(self, body: IntArray, direction: FloatArray) -> FloatArray:
        """Inverse mass along a direction without joints; see `inverse_mass`."""
        return self._inner.inverse_mass_along(body, direction)

    def inverse_masses(self, time: float) -> Any:
        """W - W Cᵀ (C W Cᵀ)⁻¹ C W, C of rigid joints, W without them."""
        alone, rows = self._inner.inverse_masses(time), self._here.rows[self._rigid]
        responses = alone @ rows.T
        held = joint_forces(rows @ responses, responses.T)
        return alone - sparse_as(alone, responses) @ sparse_as(alone, held)

    def copied(self) -> Self:
        other = copy(self)
        other._inner = self._inner.copied()
        return other

    def max_acceleration(self, time: float) -> FloatArray:
        """Largest acceleration of each motion without contacts (N,) [length/time²], sampled a few times within ``time``
        from now."""
        d = self.pose.position.shape[1]
        return np.asarray(np.linalg.norm(self._accelerations(time)[:, :, :d], axis=2).max(axis=0))

    def max_angular_acceleration(self, time: float) -> FloatArray:
        """Largest angular acceleration of each motion (N,) [rad/time²]; see `max_acceleration`."""
        d = self.pose.position.shape[1]
        return np.asarray(np.linalg.norm(self._accelerations(time)[:, :, d:], axis=2).max(axis=0))

    def kick(self, wrench: Wrench, time: float, at: Kinematics | None = None) -> None:
        """Change the twists by ``wrench`` and springs, while dampers act, and then by rigid joints."""
        if not self._begun:
            self._begin(time)
        springs = self._linkage.spring_wrench(self.pose, self._time)
        before = None if self._rigid.all() else self._missing_rate()
        drive_work = time * self._linkage.spring_power(self.pose, self._time)
        self._inner.kick(wrench_sum(wrench, springs), time, at)
        impulse, damped = self._rigid_impulse(), 0.0
        if before is not None:
            undamped = self._missing_rate() - self._here.delassus @ impulse
            by_dampers, damped = self._damper_impulse(before, undamped, time)
            impulse += by_dampers
        self._push(impulse, drive_work, damped, time * flat(springs))

    def drift(self, time: float) -> None:
        """Move the poses so that rigid joints fit at the end, where they then take out of the twist what they do not
        allow."""
        impulse = self._close(time)
        if impulse.any():
            self._add_work(impulse, self._motion_impulse(impulse))
        self._time += time
        self._here = self._rows_here()
        self._push(self._rigid_impulse())

    def _begin(self, time: float) -> None:
        """Change from the rates before a corner of a drive or stroke to those after it, where the first drift, twice as
        long as its first kick of so much ``time``, begins at the corner or just before."""
        self._begun, before = True, self._here.links
        corner = self._linkage.next_corner(self._time - time)
        if corner >= self._time + 2.0 * time:
            return
        ahead = max(corner - self._time, 0.0) + _AHEAD * time
        after = replace(before, rate=self._linkage.links(self.pose, self._time + ahead).rate)
        self._here = self._here._replace(links=after)
        self._inner.begin(ahead)
        impulse = self._rigid_impulse()
        self._push(impulse, 0.5 * float(impulse @ (before.rate - after.rate)))

    def _close(self, time: float) -> FloatArray:
        """Drift after the impulses (c,) that make rigid joints fit at the end, by Newton's method."""
        impulse, rigid, end = np.zeros(len(self._rigid)), self._rigid, self._time + time
        for _ in range(_MOST_ITERATIONS):
            trial = self._inner.copied()
            if impulse.any():
                trial.apply_impulse(self._motion_impulse(impulse))
            trial.drift(time)
            misfit = self._linkage.misfit(trial.pose, end)
            if np.all(np.abs(misfit) <= self._linkage.tolerance(trial.pose)):
                self._inner = trial
                return impulse
            there = self._linkage.links(trial.pose, end).rows[rigid]
            slope = time * there.reshape(len(there), flat(trial.twist).size) @ self._here.responses[:, rigid]
            impulse[rigid] -= joint_forces(slope, misfit)
        found = f"a misfit of {np.abs(misfit).max():.3g} that no force closes"
        raise StepRejected("joints", found, "forces with which they fit", "Shorten time.step.")

    def _rigid_impulse(self) -> FloatArray:
        """Impulses (c,) of rigid joints that make the twist what they allow."""
        impulse, rigid = np.zeros(len(self._rigid)), self._rigid
        impulse[rigid] = joint_forces(self._here.among_rigid, self._missing_rate()[rigid])
        return impulse

    def _damper_impulse(self, before: FloatArray, undamped: FloatArray, time: float) -> tuple[FloatArray, float]:
        """Impulses (c,) of dampers, whose rates lack ``before`` and without them ``undamped`` (c,), and of rigid joints
        that resist them; and the energy that they take."""
        rigid, damped, delassus = self._rigid, ~self._rigid, self._here.delassus
        across, impulse = delassus[rigid][:, damped], np.zeros(len(rigid))
        resisting = -joint_forces(self._here.among_rigid, across)
        alone = delassus[damped][:, damped] + across.T @ resisting
        start, end = -before[damped], -undamped[damped]
        impulse[damped] = damper_impulse(alone, self._here.links.compliance[damped], start, end, time)
        impulse[rigid] = resisting @ impulse[damped]
        return impulse, -0.5 * float(impulse[damped] @ (start + end + alone @ impulse[damped]))

    def _missing_rate(self) -> FloatArray:
        """Rates that the twist lacks, rate - C u (c,)."""
        return np.asarray(self._here.links.rate - self._here.rows @ flat(self.twist).ravel())

    def _push(
        self, impulse: FloatArray, drive_work: float = 0.0, damped: float = 0.0, springs: FloatArray | float = 0.0
    ) -> None:
        """Change the twist by impulses (c,) of links, and add to the work of joints also that of the ``springs``."""
        pushed = self._motion_impulse(impulse)
        self._inner.apply_impulse(pushed)
        self._add_work(impulse, pushed + springs, drive_work, damped)

    def _add_work(self, impulse: FloatArray, pushed: FloatArray, drive_work: float = 0.0, damped: float = 0.0) -> None:
        """Add to the work of joints: impulses (c,) here, at the rates here, that of all on the motions (N, d+k), and
        works of drives and dampers."""
        so_far = self._work
        drive_work += float(impulse @ self._here.links.rate)
        self._work = LinkWork(
            so_far.impulse + impulse, so_far.pushed + pushed, so_far.drive_work + drive_work, so_far.damped + damped
        )

    def _motion_impulse(self, impulse: FloatArray) -> FloatArray:
        """Impulses on the motions Cᵀ J (N, d+k)."""
        return np.asarray(np.einsum("c,cni->ni", impulse, self._here.links.rows))

    def _rows_here(self) -> _Rows:
        links = self._linkage.links(self.pose, self._time)
        rows, rigid = links.rows.reshape(len(links.rate), prod(links.rows.shape[1:])), links.compliance == 0.0
        responses = self._inner.inverse_masses(0.0) @ rows.T
        delassus = rows @ responses
        return _Rows(links, rows, responses, delassus, delassus[rigid][:, rigid])

    def _accelerations(self, time: float) -> FloatArray:
        """Mean accelerations in parts of a time (parts, N, d+k)."""
        trial, none, part = self.copied(), nothing(self.pose), time / _PARTS
        twists = [flat(self.twist)]
        for _ in range(_PARTS):
            trial.kick(none, part)
            trial.drift(part)
            twists.append(flat(trial.twist))
        return np.asarray(np.diff(twists, axis=0) / part)


class _Rows(NamedTuple):
    """Linearised links in one pose: ``rows`` C (c, N·(d+k)), ``responses`` W Cᵀ to impulses, ``delassus`` C W Cᵀ, and
    that ``among_rigid`` rows."""

    links: Links
    rows: FloatArray
    responses: FloatArray
    delassus: FloatArray
    among_rigid: FloatArray
