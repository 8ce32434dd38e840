"""Substeps of balls in a fluid that a reduced model moves, between flat walls, by a compiled loop."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, Protocol, runtime_checkable

from rigidfluid.core.contact.pairs.proximity import refuse_overlap
from rigidfluid.core.contact.path.contact_load import ContactLoad
from rigidfluid.core.contact.path.detection import PoseDetection
from rigidfluid.core.contact.path.substeps import Span, SubstepResult
from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.model.detection import Sight
from rigidfluid.core.model.dynamics import BodyDynamics
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.pair_formula import PairFormula, common_formula, compiled
from rigidfluid.core.model.part_results import refuse_no_number
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Pose, Wrench

if TYPE_CHECKING:
    from rigidfluid.core.contact.pairs.near_pairs import NearPairs


class ModalBalls(NamedTuple):
    """Balls in a fluid: position (n, d), orientation (n, q), velocity (n, d) and spin (n, k), which change in place;
    acceleration without contacts (n, d) and (n, k), and inverse mass (n, d, d), not read for velocities of the
    model."""

    position: FloatArray
    orientation: FloatArray
    velocity: FloatArray
    spin: FloatArray
    rate: FloatArray
    turning: FloatArray
    inverse_mass: FloatArray


class Modes(NamedTuple):
    """Modes of the model, and factors of kicks of one length: ``body`` and ``axis`` (c,) of its velocities, ``shape``
    (c, c) of modes, velocities at the ``start`` (c,); ``modal`` velocities (c,), which change in place; their ``load``
    and its ``growth`` (c,); the ``share`` of them that a kick leaves, and what they have ``gained`` in it by a
    constant and a ``growing`` load (c,); the times kicked and drifted (2,), and ``integrals`` (3, c) of the modal
    velocities, of these times the time and of their squares, which change in place."""

    body: IntArray
    axis: IntArray
    shape: FloatArray
    start: FloatArray
    modal: FloatArray
    load: FloatArray
    growth: FloatArray
    share: FloatArray
    gained: FloatArray
    growing: FloatArray
    times: FloatArray
    integrals: FloatArray


@runtime_checkable
class ModalDynamics(Protocol):
    """Dynamics of bodies of which a reduced model moves some."""

    @property
    def pose(self) -> Pose:
        """Present pose."""

    def modal_balls(self, kick: float) -> tuple[ModalBalls, Modes]:
        """The present state as balls, and the modes in kicks as long as ``kick`` [time]."""

    def place_balls(self, balls: ModalBalls, modes: Modes) -> None:
        """Take over ``balls`` and ``modes`` that have moved."""

    @property
    def turns(self) -> bool:
        """Tell whether the model has angular velocities."""


class ModalSubsteps:
    """`Substeps` of balls with these ``dynamics`` under a law of this ``formula``, of which ``near`` are listed."""

    def __init__(self, system: System, formula: PairFormula, near: NearPairs, dynamics: ModalDynamics) -> None:
        self._formula = compiled(formula.function)
        self._law = formula.parameters, system.law_range
        self._system, self._near, self._dynamics = system, near, dynamics

    def advance(self, span: Span, sight: Sight, load: ContactLoad, impulse: Wrench) -> SubstepResult:
        from rigidfluid.core.contact.pairs.near_pairs import PairList
        from rigidfluid.core.contact.path.modal_kernel import advance_modal_balls

        (balls, modes), near, law_range = self._dynamics.modal_balls(0.5 * span.substep), self._near, self._law[1]
        listed = near.within(balls.position, law_range)
        around = listed.start, listed.second, listed.position.copy(), listed.reach, near.wider(law_range), near.planes
        force, fixed = load.wrench.force.copy(), (tuple(balls), tuple(modes), near.radii)
        count, left, planned, gap, nearest, anew, made = advance_modal_balls(
            self._formula, self._law, *fixed, around, force, impulse.force, tuple(span)
        )
        refuse_overlap(self._system, nearest, gap)
        refuse_no_number("contacts", "velocity after forces by a law's formula", balls.velocity, "contact.law")
        if anew:
            near.keep(PairList(*made))
        self._dynamics.place_balls(balls, modes)
        contacts = sight.contacts_at(self._dynamics.pose)
        still = ContactLoad(Wrench(force, load.wrench.torque), None, 0.0, 0.0)
        return SubstepResult(count, left, planned, contacts, still, 0.0, 0.0)


def modal_substeps(system: System, law: ForceLaw, dynamics: BodyDynamics) -> ModalSubsteps | None:
    """Compiled substeps of bodies with these ``dynamics``, None unless they are free balls between flat walls at rest,
    of which a reduced model moves some without turning them, and the ``law`` has a formula and no dampers."""
    detection, formula = system.detection, common_formula(law)
    if formula is None or law.dissipative or not isinstance(detection, PoseDetection):
        return None
    if not isinstance(dynamics, ModalDynamics) or dynamics.turns or system.prescribed.any():
        return None
    if system.wall_velocity is not None:
        return None
    near = detection.near_balls
    return None if near is None else ModalSubsteps(system, formula, near, dynamics)
