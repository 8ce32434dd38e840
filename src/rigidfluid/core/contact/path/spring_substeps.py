"""Substeps of free balls between flat walls, with springs along their surfaces, by a compiled loop."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from rigidfluid.core.contact.laws.ball_law import BallLaw, ball_law
from rigidfluid.core.contact.pairs.carried_springs import springs_at
from rigidfluid.core.contact.pairs.proximity import refuse_overlap
from rigidfluid.core.contact.path.ball_substeps import near_free_balls
from rigidfluid.core.contact.path.contact_load import ContactLoad
from rigidfluid.core.contact.path.substeps import Span, SubstepResult
from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.mechanics.dynamics import DryDynamics
from rigidfluid.core.model.detection import Sight
from rigidfluid.core.model.dynamics import BodyDynamics
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.pair_formula import compiled
from rigidfluid.core.model.part_results import refuse_no_number
from rigidfluid.core.model.system import System
from rigidfluid.core.model.tangential_springs import TangentialSprings
from rigidfluid.core.model.types import Contacts, Pose, Wrench

if TYPE_CHECKING:
    from rigidfluid.core.contact.pairs.near_pairs import NearPairs, PairList


class Rows(NamedTuple):
    """Springs as the loop has them: each ``pair`` (s, 2) of balls and walls, these numbered after the balls, in order;
    ``normal`` and ``displacement`` (s, d), ``turning`` (s, k), ``stiffness`` (s,) and ``gap`` (s,)."""

    pair: IntArray
    normal: FloatArray
    displacement: FloatArray
    turning: FloatArray
    stiffness: FloatArray
    gap: FloatArray

    def with_room(self, most: int) -> tuple[tuple[Any, ...], tuple[Any, ...], int]:
        """The same in arrays with room for ``most`` and for themselves, other arrays as large, and their number."""
        count = len(self.pair)
        room = tuple(np.resize(column, (max(most, count), *column.shape[1:])) for column in self)
        return room, tuple(np.empty_like(column) for column in room), count


class SpringSubsteps:
    """`Substeps` of balls that move freely under this ``law``, of which ``near`` are listed."""

    def __init__(self, system: System, law: BallLaw, near: NearPairs, dynamics: DryDynamics) -> None:
        self._system, self._law, self._near, self._dynamics = system, law, near, dynamics
        walls = [wall.surface for wall in system.walls]
        self._surfaces = np.array([*range(len(system.bodies)), *walls], dtype=np.int64)

    def advance(self, span: Span, sight: Sight, load: ContactLoad, impulse: Wrench) -> SubstepResult:
        from rigidfluid.core.contact.path.spring_kernel import advance_sticking_balls

        balls, near, law, law_range = self._dynamics.free_balls(), self._near, self._law, self._system.law_range
        wrench, pushed = Wrench(load.wrench.force.copy(), load.wrench.torque.copy()), (impulse.force, impulse.torque)
        formula, rest, loss, dissipated = compiled(law.formula.function), span, load.loss, 0.0
        springs, since, elapsed, outdated = self._rows(load.springs), np.zeros(len(balls.mass)), 0.0, True
        while outdated:
            listed = near.within(balls.position, law_range)
            around = listed.start, listed.second, listed.position, listed.spare(law_range) ** 2, near.planes
            given, now = (self._parameters(listed), law_range, *law[1:]), (wrench.force, wrench.torque, loss)
            fixed = tuple(balls), near.radii, around, now, pushed, springs.with_room(len(listed.second)), tuple(rest)
            count, left, planned, lost, loss, least, (rows, kept), elapsed, outdated = advance_sticking_balls(
                formula, given, *fixed, (since, elapsed), elapsed > 0.0
            )
            springs = Rows(*(column[:kept] for column in rows))
            rest, dissipated = rest._replace(left=left, planned=planned, most=rest.most - count), dissipated + lost
        refuse_overlap(self._system, *least)
        refuse_no_number("contacts", "velocity after forces by a law's formula", balls.velocity, "contact.law")
        self._dynamics.place(balls, span.left - left)
        pose = self._dynamics.pose
        after, contacts = ContactLoad(wrench, None, loss, 0.0, self._springs(springs, pose)), sight.contacts_at(pose)
        return SubstepResult(span.most - rest.most, left, planned, contacts, after, dissipated, 0.0)

    def _parameters(self, listed: PairList) -> FloatArray:
        """Parameters of the law in each listed pair (m, p), or in all (1, p)."""
        first = np.repeat(np.arange(len(listed.start) - 1), np.diff(listed.start))
        none = np.zeros((len(first), self._near.planes.shape[2]))
        return self._law.parameters(self._contacts(np.column_stack([first, listed.second]), none, none, none[:, 0]))

    def _contacts(self, pair: IntArray, normal: FloatArray, position: FloatArray, gap: FloatArray) -> Contacts:
        """Contacts of pairs (m, 2) of balls and walls with these normals (m, d) and gaps (m,), a's centres at
        ``position`` (m, d)."""
        (a, b), radii = pair.T, self._near.radii
        point = position - radii[a, None] * normal
        radius_b = np.append(radii, np.inf)[np.minimum(b, len(radii))]
        columns = a, self._surfaces[b], point, point - gap[:, None] * normal, normal, gap, radii[a], radius_b
        return Contacts(*columns, b >= len(radii))

    def _rows(self, springs: TangentialSprings | None) -> Rows:
        """Springs in the order of their pairs."""
        if springs is None:
            none = np.zeros((0, self._near.planes.shape[2]))
            turning, pair = np.zeros((0, 1 if none.shape[1] == 2 else 3)), np.zeros((0, 2), dtype=np.int64)
            return Rows(pair, none, none, turning, np.zeros(0), np.zeros(0))
        ordered = springs.select(np.lexsort((springs.body_b, springs.body_a)))
        pair = np.column_stack([ordered.body_a, np.searchsorted(self._surfaces, ordered.body_b)])
        columns = ordered.normal, ordered.displacement, ordered.turning, ordered.stiffness
        return Rows(pair, *columns, np.zeros(len(ordered)))

    def _springs(self, rows: Rows, pose: Pose) -> TangentialSprings | None:
        """Springs that are stretched, of those that the loop leaves."""
        contacts = self._contacts(rows.pair, rows.normal, pose.position[rows.pair[:, 0]], rows.gap)
        springs = springs_at(contacts, rows.displacement, rows.stiffness, pose, rows.turning)
        return springs if len(springs) else None


def spring_substeps(system: System, law: ForceLaw, dynamics: BodyDynamics) -> SpringSubsteps | None:
    """Compiled substeps of bodies with these ``dynamics``, None unless they are balls that move freely between flat
    walls at rest, and the ``law`` has springs along their surfaces and a formula."""
    known = ball_law(law)
    near = None if known is None else near_free_balls(system, dynamics)
    if known is None or near is None or not isinstance(dynamics, DryDynamics):
        return None
    return SpringSubsteps(system, known, near, dynamics)
