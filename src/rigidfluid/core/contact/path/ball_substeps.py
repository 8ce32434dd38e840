"""Substeps of free balls between flat walls, by a compiled loop, where the law has a formula for it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rigidfluid.core.contact.pairs.proximity import refuse_overlap
from rigidfluid.core.contact.path.contact_load import ContactLoad
from rigidfluid.core.contact.path.detection import PoseDetection
from rigidfluid.core.contact.path.substeps import Span, SubstepResult
from rigidfluid.core.mechanics.dynamics import DryDynamics
from rigidfluid.core.model.detection import Sight
from rigidfluid.core.model.dynamics import BodyDynamics
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.pair_formula import PairFormula, common_formula, compiled
from rigidfluid.core.model.part_results import refuse_no_number
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Wrench

if TYPE_CHECKING:
    from rigidfluid.core.contact.pairs.near_pairs import NearPairs


class BallSubsteps:
    """`Substeps` of balls that move freely under a law of this ``formula``, of which ``near`` are listed."""

    def __init__(self, system: System, formula: PairFormula, near: NearPairs, dynamics: DryDynamics) -> None:
        self._formula = compiled(formula.function)
        self._law = formula.parameters, system.law_range
        self._system, self._near, self._dynamics = system, near, dynamics

    def advance(self, span: Span, sight: Sight, load: ContactLoad, impulse: Wrench) -> SubstepResult:
        from rigidfluid.core.contact.pairs.near_pairs import PairList
        from rigidfluid.core.contact.path.ball_kernel import advance_balls

        near, balls, law_range = self._near, self._dynamics.free_balls(), self._law[1]
        listed = near.within(balls.position, law_range)
        around = listed.start, listed.second, listed.position.copy(), listed.reach, near.wider(law_range), near.planes
        wrench, pushed = Wrench(load.wrench.force.copy(), load.wrench.torque.copy()), (impulse.force, impulse.torque)
        now = wrench.force, wrench.torque, load.loss
        count, left, planned, dissipated, loss, gap, nearest, anew, made = advance_balls(
            self._formula, self._law, tuple(balls), near.radii, around, now, pushed, tuple(span)
        )
        refuse_overlap(self._system, nearest, gap)
        refuse_no_number("contacts", "velocity after forces by a law's formula", balls.velocity, "contact.law")
        if anew:
            near.keep(PairList(*made))
        self._dynamics.place(balls, span.left - left)
        contacts = sight.contacts_at(self._dynamics.pose)
        return SubstepResult(count, left, planned, contacts, ContactLoad(wrench, None, loss, 0.0), dissipated, 0.0)


def ball_substeps(system: System, law: ForceLaw, dynamics: BodyDynamics) -> BallSubsteps | None:
    """Compiled substeps of bodies with these ``dynamics``, None unless they are balls that move freely between flat
    walls at rest, and the ``law`` has a formula that acts alike in all contacts, and no springs along surfaces."""
    formula = common_formula(law)
    near = None if formula is None or law.sticking else near_free_balls(system, dynamics)
    if formula is None or near is None or not isinstance(dynamics, DryDynamics):
        return None
    return BallSubsteps(system, formula, near, dynamics)


def near_free_balls(system: System, dynamics: BodyDynamics) -> NearPairs | None:
    """Neighbour list of the bodies with these ``dynamics``, None unless they are balls that move freely between flat
    walls at rest."""
    detection = system.detection
    if not isinstance(detection, PoseDetection) or not isinstance(dynamics, DryDynamics):
        return None
    if system.wall_velocity is not None or not dynamics.is_of_free_balls:
        return None
    return detection.near_balls
