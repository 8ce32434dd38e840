"""The joints of a system as rows on the twists of its motions, and the poses at which they fit."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from copy import copy
from dataclasses import replace
from itertools import pairwise

import numpy as np
from scipy import sparse

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.joints.constraints import Constraint
from rigidfluid.core.joints.coordinates import units_by_name
from rigidfluid.core.joints.joint import PlacedJoint
from rigidfluid.core.joints.joint_forces import joint_forces
from rigidfluid.core.joints.joint_parts import ground_parts, joint_parts
from rigidfluid.core.joints.jointed_dynamics import JointedDynamics
from rigidfluid.core.joints.markers import Markers, PlacedPair
from rigidfluid.core.joints.pair_spring import PairSpring
from rigidfluid.core.joints.redundancy import motion_of, refuse_redundant, refuse_void
from rigidfluid.core.joints.springs import Spring
from rigidfluid.core.mechanics.rigid import inverse_lab_inertia, rotate
from rigidfluid.core.mechanics.wrenches import flat, nothing, wrench_sum
from rigidfluid.core.model.dynamics import ImpulsiveDynamics
from rigidfluid.core.model.joints import GroundLink, LinkReading
from rigidfluid.core.model.kinematics import Kinematics
from rigidfluid.core.model.motions import Motions
from rigidfluid.core.model.state import LinkLoad, unloaded
from rigidfluid.core.model.types import Links, Pose, Twist, Wrench
from rigidfluid.errors import StepRejected

ROUNDING = 1e-13
"""Relative tolerance of the constraint violation [1]."""

_MOST_ITERATIONS = 30


class JointLinkage:
    """Joints and ground links between n bodies, as `Joints` of the N motions that carry them.

    Its rows are, in this order, those of the joints as they are given, then those of the ground links. A joint has the
    rows of its kind's constraints. A ground link has rows for the forces and torques that hold the body, then those of
    its dampers.

    ``pose`` is that of the bodies at the start, on ``motions``; ``prescribed_twist`` gives the prescribed twists (N,
    d+k) at a time; ``resistance`` (n, d+k) is a lower bound of that of a fluid without inertia [force·time/length |
    force·length·time]; ``forces`` are long-range ones between two bodies. Raises SceneError if a joint holds nothing
    that moves freely, or what other joints hold already.

    ``clusters`` (N,) is equal for motions that joints link, directly or over others, and is a motion's own number where
    it is linked to nothing, or to the ground alone. ``frequency`` is that of the springs on the masses without joints,
    at the start: joints make motions heavier, so it bounds the frequencies with them in any pose. In a fluid without
    inertia it is the rate at which they relax against the ``resistance``, if less: a mass then follows without
    swinging.
    """

    def __init__(
        self,
        pose: Pose,
        joints: Sequence[PlacedJoint],
        ground: Sequence[GroundLink],
        motions: Motions,
        prescribed_twist: Callable[[float], FloatArray],
        resistance: FloatArray | None = None,
        forces: Sequence[PairSpring] = (),
    ) -> None:
        self._motions, self._prescribed_twist = motions, prescribed_twist
        self._prescribed, self._carrier = motions.prescribed, motions.carrier
        self._parts = [*(joint_parts(joint, pose) for joint in joints), *(ground_parts(link, pose) for link in ground)]
        self._constraints = [one for part in self._parts for one in part.constraints]
        self._rows_of_parts = _slices([part.rows for part in self._parts])
        self._rows_of_constraints = _slices([len(one.compliance) for one in self._constraints])
        self._springs: list[Spring] = [*(one for part in self._parts for one in part.springs), *forces]
        self._compliance = np.concatenate([np.zeros(0), *(one.compliance for one in self._constraints)])
        self._markers = Markers([one.markers for one in self._constraints], pose.position.shape[1])
        lengths = [one.directions(at)[0].any(axis=1) for one, at in self._placed(pose)]
        self._are_lengths = np.concatenate([np.zeros(0, dtype=bool), *lengths])[self._compliance == 0.0]
        self.coordinates: Mapping[str, str] = units_by_name(joint.kind.coordinate for joint in joints)
        drives = [joint.kind.drive for joint in joints if joint.kind.drive is not None]
        self._corners = [*(drive.next_corner for drive in drives), motions.next_corner]
        self.linked, self.clusters = self._link_clusters(
            [(one.first, one.second) for one in joints], [one.body for one in ground]
        )
        self.linked[[self._carrier[body] for force in forces for body in (force.first, force.second)]] = True
        self.driven = motions.driven or bool(self._prescribed.any()) or bool(drives)
        self.misfit(motions.pose, 0.0)  # so that a constraint that cannot answer is named before the first step
        refuse_void(self._constraints, self._carrier, self._prescribed)
        rigid = self._rigid(self.links(motions.pose, 0.0).rows)
        refuse_redundant(self._constraints, self._mass_weighted_rows(rigid, motions.pose))
        self.frequency = self._greatest_rate(motions.pose, resistance)

    def next_corner(self, time: float) -> float:
        """The first time after this at which rates of links jump; infinite if there is none [time]."""
        return min(corner(time) for corner in self._corners)

    def links(self, motions: Pose, time: float) -> Links:
        """C, rates and compliances, where the ``motions`` are there."""
        bodies, kinematics = self._bodies(motions, time)
        rows = np.zeros((len(self._compliance), *flat(nothing(bodies)).shape))
        rate = np.zeros(len(rows))
        for here, (one, at) in zip(self._rows_of_constraints, self._placed(bodies), strict=True):
            one.add_rows(at, rows[here])
            rate[here] = one.rate(time)
        if self.driven:
            rate -= np.einsum("cni,ni->c", rows, self._prescribed_part(bodies, kinematics, time))
        return Links(self._rows_on_motions(rows, kinematics), rate, self._compliance)

    def unloaded(self, motions: Pose) -> LinkLoad:
        """Zero loads, a force for each row."""
        return replace(unloaded(motions), force=np.zeros(len(self._compliance)))

    def misfit(self, motions: Pose, time: float) -> FloatArray:
        """Constraint violations of rigid links, one for each row [length | rad]."""
        bodies = self._bodies(motions, time)[0]
        return np.concatenate([np.zeros(0), *(one.misfit(at, time) for one, at in self._placed(bodies))])

    def tolerance(self, motions: Pose) -> FloatArray:
        """Misfits that are rounding there, a row for each [length | rad]."""
        length = np.abs(motions.position[self.linked]).max(initial=0.0) + self._markers.reach
        angle = 1.0 + np.abs(motions.orientation[self.linked]).max(initial=0.0)
        return np.asarray(ROUNDING * np.where(self._are_lengths, length, angle))

    def closed(self, motions: Pose, time: float) -> Pose:
        """Nearest poses at which the joints fit, in the metric of the masses, by Newton's method; raises StepRejected
        if there are none near."""
        moves, d = (self.linked & ~self._prescribed)[:, None], motions.position.shape[1]
        for _ in range(_MOST_ITERATIONS):
            misfit = self.misfit(motions, time)
            if np.all(np.abs(misfit) <= self.tolerance(motions)):
                return motions
            way = self._correction(motions, time, misfit)
            position = motions.position - way[:, :d]
            orientation = np.where(moves, rotate(motions.orientation, -way[:, d:]), motions.orientation)
            motions = Pose(position, orientation)
        raise StepRejected(
            "joints",
            f"a misfit of {np.abs(misfit).max():.3g} that cannot be closed",
            "poses at which they fit",
            "Shorten time.step.",
        )

    def fitting(self, motions: Pose, twist: Twist, time: float) -> Twist:
        """The ``twist`` (N rows) after the impulses of rigid joints that take out of it what they do not allow."""
        d, links = twist.velocity.shape[1], self.links(motions, time)
        missing = np.einsum("cni,ni->c", links.rows, flat(twist)) - links.rate
        change = self._correction(motions, time, missing[links.compliance == 0.0])
        return Twist(twist.velocity - change[:, :d], twist.angular_velocity - change[:, d:])

    def spring_wrench(self, motions: Pose, time: float) -> Wrench:
        """Wrenches of the springs on the N motions."""
        if not self._springs:
            return nothing(motions)
        bodies, kinematics = self._bodies(motions, time)
        return kinematics.motion_wrench(self._wrench_on_bodies(bodies))

    def with_springs(self, wrench: Wrench, motions: Pose, time: float) -> Wrench:
        """Sum of the ``wrench`` on the motions and that of the springs."""
        return wrench_sum(wrench, self.spring_wrench(motions, time))

    def load(self, links: Links, force: FloatArray, motions: Pose, time: float) -> LinkLoad:
        """Load of links with forces (c,), Cᵀ force on the motions, and of the springs there."""
        wrench = np.tensordot(force, links.rows, axes=1)
        return LinkLoad(force, wrench + flat(self.spring_wrench(motions, time)))

    def over(self, motions: ImpulsiveDynamics, start: float) -> JointedDynamics:
        """Dynamics of the motions with these joints from ``start`` on [time]."""
        return JointedDynamics(motions, self, start)

    def spring_energy(self, motions: Pose, time: float) -> float:
        """Energy stored in springs [energy]."""
        bodies = self._bodies(motions, time)[0]
        return sum(spring.energy(bodies) for spring in self._springs)

    def spring_power(self, motions: Pose, time: float) -> float:
        """Power that prescribed motions and strokes spend against springs [energy/time]."""
        if not self._springs or not self.driven:
            return 0.0
        bodies, kinematics = self._bodies(motions, time)
        return -float(np.sum(flat(self._wrench_on_bodies(bodies)) * self._prescribed_part(bodies, kinematics, time)))

    def _placed(self, bodies: Pose) -> Iterator[tuple[Constraint, PlacedPair]]:
        return zip(self._constraints, self._markers.placed(bodies), strict=True)

    def readings(self, bodies: Pose, twist: Twist, time: float, force: FloatArray) -> list[LinkReading]:
        """Readings of all joints and then all ground links; ``bodies`` and ``twist`` are those of the n bodies,
        ``force`` (c,) that of the rows."""
        placed, readings = iter(self._markers.placed(bodies)), []
        for part, rows in zip(self._parts, self._rows_of_parts, strict=True):
            own = [next(placed) for _ in part.constraints]
            readings.append(part.reading(own, bodies, twist, time, force[rows]))
        return readings

    def following(self, prescribed_twist: Callable[[float], FloatArray]) -> JointLinkage:
        """The same joints where given motions are other ones from now on, (N, d+k) at a time."""
        other = copy(self)
        other._prescribed_twist = prescribed_twist
        return other

    def _wrench_on_bodies(self, bodies: Pose) -> Wrench:
        wrench = nothing(bodies)
        for spring in self._springs:
            spring.add_wrench(bodies, wrench)
        return wrench

    def _bodies(self, motions: Pose, time: float) -> tuple[Pose, Kinematics]:
        return self._motions.poses(motions, time), self._motions.kinematics(motions, time)

    def _prescribed_part(self, bodies: Pose, kinematics: Kinematics, time: float) -> FloatArray:
        """Twists of the bodies (n, d+k) by prescribed motions and strokes alone, free motions at rest."""
        d = bodies.position.shape[1]
        motion = np.where(self._prescribed[:, None], self._prescribed_twist(time), 0.0)
        return flat(kinematics.component_twist(Twist(motion[:, :d], motion[:, d:])))

    def _rows_on_motions(self, rows: FloatArray, kinematics: Kinematics) -> FloatArray:
        """C G of rows (c, n, d+k) on the bodies, zero for given motions (c, N, d+k)."""
        return np.asarray(kinematics.motion_rows(rows) * ~self._prescribed[:, None])

    def _rigid(self, rows: FloatArray) -> FloatArray:
        return np.asarray(rows[self._compliance == 0.0])

    def _correction(self, motions: Pose, time: float, missing: FloatArray) -> FloatArray:
        """Product M⁻¹ Cᵀ (C M⁻¹ Cᵀ)⁻¹ · missing of the rigid rows, ``missing`` (r,), (N, d+k)."""
        rows = self._rigid(self.links(motions, time).rows)
        light = np.einsum("nij,cnj->cni", self._inverse_masses(motions, time), rows)
        force = joint_forces(np.einsum("cni,eni->ce", rows, light), missing)
        return np.asarray(np.einsum("c,cni->ni", force, light))

    def _inverse_masses(self, motions: Pose, time: float) -> FloatArray:
        """M⁻¹ of each motion (N, d+k, d+k)."""
        count, d = motions.position.shape
        inertia = self._motions.inertia(time)
        width = d + inertia.shape[1]
        blocks = np.zeros((count, width, width))
        blocks[:, :d, :d] = np.eye(d) / self._motions.mass[:, None, None]
        blocks[:, d:, d:] = inverse_lab_inertia(inertia, motions.orientation)
        return blocks

    def _mass_weighted_rows(self, rows: FloatArray, motions: Pose) -> FloatArray:
        """Rows (c, N, d+k) times the root of M⁻¹ at the start."""
        root = np.linalg.cholesky(self._inverse_masses(motions, 0.0))
        return np.asarray(np.einsum("cni,nij->cnj", rows, root))

    def _greatest_rate(self, motions: Pose, resistance: FloatArray | None) -> float:
        if not self._springs:
            return 0.0
        bodies, kinematics = self._bodies(motions, 0.0)
        stretch = self._rows_on_motions(
            np.concatenate([spring.stretch(bodies) for spring in self._springs]), kinematics
        )
        frequency = _norm(self._mass_weighted_rows(stretch, motions))
        if resistance is None:
            return frequency
        carried = np.zeros(stretch.shape[1:])
        np.add.at(carried, self._carrier, resistance)
        return min(frequency, _norm(stretch / np.sqrt(carried)) ** 2)

    def _link_clusters(
        self, joints: Sequence[tuple[int, int | None]], ground: Sequence[int]
    ) -> tuple[BoolArray, IntArray]:
        """Mask (N,) of the motions that have links, and the lowest number (N,) of those that each is linked with."""
        from scipy.sparse.csgraph import connected_components  # slow to load, and few scenes have joints

        count, linked = len(self._prescribed), np.zeros(len(self._prescribed), dtype=bool)
        linked[
            [self._carrier[body] for body in (*ground, *(one for pair in joints for one in pair if one is not None))]
        ] = True
        ends = [[motion_of(body, self._carrier, self._prescribed) for body in pair] for pair in joints]
        pairs = np.array([pair for pair in ends if None not in pair], dtype=np.int64).reshape(-1, 2)
        graph = sparse.coo_matrix((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
        parts = connected_components(graph, directed=False)[1]
        return linked, np.unique(parts, return_index=True)[1][parts]


def _norm(rows: FloatArray) -> float:
    """The spectral norm of rows (c, N, d+k)."""
    return float(np.linalg.norm(rows.reshape(len(rows), -1), ord=2))


def _slices(counts: Sequence[int]) -> tuple[slice, ...]:
    ends = np.cumsum([0, *counts]).tolist()
    return tuple(slice(start, end) for start, end in pairwise(ends))
