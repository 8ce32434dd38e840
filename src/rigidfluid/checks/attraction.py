"""Do the laws of contact keep two bodies apart that a long-range force pulls together?"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from rigidfluid.checks.design_contacts import RepresentativeContacts
from rigidfluid.checks.finding import Finding, figure, round_down, round_up
from rigidfluid.checks.remedies import strength_remedy
from rigidfluid.checks.response import energy_along, force_along
from rigidfluid.core.contact.laws.loads import inverse_mass
from rigidfluid.core.contact.laws.repulsion import AUTO, Repulsion
from rigidfluid.core.contact.pairs.representative_contacts import pair_contacts
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.joints.pair_spring import PairSpring
from rigidfluid.core.mechanics.rigid import rotation_matrices
from rigidfluid.core.model.interactions import acting_together
from rigidfluid.core.model.pose_law import PairPoses, PoseLaw
from rigidfluid.core.model.system import System
from rigidfluid.core.model.wrapped_law import bare
from rigidfluid.core.setup.model import Model
from rigidfluid.core.setup.pair_forces import pair_springs

QUESTION = "attraction"

_STARTS = 12
"""Number of random rotations of both bodies from which the one of the least energy is looked for."""

_FRACTIONS = np.append(np.logspace(-9, -2, 36), np.linspace(0.02, 1.0, 99))
"""Gaps over the range of the laws of contact, from next to contact on [1]."""


def attraction_findings(model: Model, system: System) -> Iterator[Finding]:
    """Compare what the laws of contact give at most, without overlap, with the pull of each pair of bodies in the
    rotations that attract most, and with the work of that pull; a warning where it is less."""
    for spring in pair_springs(model):
        contacts = pair_contacts(system, (spring.first, spring.second))
        if len(contacts):
            acting = tuple(one for one in system.interactions if one.acts_in(contacts)[0])
            yield from _finding(system, spring, RepresentativeContacts(False, acting, contacts, np.ones(1)))


def _finding(system: System, spring: PairSpring, pair: RepresentativeContacts) -> Iterator[Finding]:
    names = system.surfaces[spring.first], system.surfaces[spring.second]
    law, towards = acting_together(pair.interactions), _attracting(spring.law, spring.closest, system.dimension)
    at_contact = _pull(spring.law, np.array([spring.closest]), towards)
    strength, whole = (float(one[0]) for one in at_contact)
    found = {"pull": strength, "work": whole}
    text = f"{names[0]} and {names[1]}: {bare(spring.law).name!r} pulls them together by up to {figure(strength)}"
    text += " at contact"
    if law is None or not law.keeps_apart:
        remedy = "Add an [[interaction]] that repels for them; ignore this if something else holds them."
        yield Finding("warning", QUESTION, names, f"{text}, and no law keeps them apart", remedy, found)
        return
    gaps = law.range * _FRACTIONS
    pull, work = _pull(spring.law, spring.closest + gaps, towards)
    push = force_along(law, pair.contacts, gaps[None])[0]
    stored = energy_along(law, pair.contacts, gaps[None])[0]
    held, stopped = float(np.max(push / pull)), float(np.max(stored / work))
    found |= {"force_over_pull": held, "energy_over_work": stopped}
    brakes = system.has_fluid or law.dissipative
    if held >= 1.0 and (stopped >= 1.0 or brakes):
        rests = float(gaps[np.flatnonzero(push >= pull)[-1]])
        text += f", and rest at a gap of {figure(rests)}"
        if stopped < 1.0:
            text += f"; the law stores at most {figure(stopped)} of its work, {figure(whole)}: "
            text += "the fluid or dampers must take the rest"
        yield Finding("note", QUESTION, names, text, found=found | {"rest_gap": rests})
        return
    if held < 1.0:
        text += f", of which the law gives at most {figure(held)}"
    else:
        text += f", and its work is {figure(whole)}, of which the law stores at most {figure(stopped)}"
    enough, remedy = _remedy(system, pair, whole, min(held, stopped))
    yield Finding("warning", QUESTION, names, f"{text}: they may be pulled through each other", remedy, found, enough)


def _remedy(system: System, pair: RepresentativeContacts, work: float, share: float) -> tuple[Mapping[str, float], str]:
    """Change of a parameter that is enough, by its name, and the remedy; `auto` can do with the ``work`` [energy]."""
    (first, *others) = [one for one in pair.interactions if one.law.keeps_apart]
    law = bare(first.law)
    if others or not isinstance(law, Repulsion):
        return strength_remedy(pair, share)
    if law.options.epsilon == AUTO:
        speed = float(np.sqrt(2.0 * work * inverse_mass(pair.contacts, system.loads)[0]))
        return {"impact_speed": speed}, f"Set contact.impact_speed to {round_up(speed)} or more, for `auto`."
    epsilon = float(law.options.epsilon) * share
    return {"epsilon": epsilon}, f"Set {first.field}.epsilon to {round_down(epsilon)} or less."


def _pull(law: PoseLaw, distances: FloatArray, towards: tuple[FloatArray, FloatArray]) -> tuple[FloatArray, FloatArray]:
    """Force (m,) that pulls bodies together at the ``distances`` (m,) of their centres [force], and its work from the
    range on (m,) [energy]; both at least a rounding above zero."""
    count, d = len(distances), towards[0].shape[-1]
    separation = distances[:, None] * np.eye(d)[0]
    pairs = PairPoses(separation, *(np.broadcast_to(one, (count, d, d)) for one in towards))
    least = np.finfo(float).tiny
    return np.maximum(-law.pair_force(pairs)[:, 0], least), np.maximum(-law.pair_energy(pairs), least)


def _attracting(law: PoseLaw, distance: float, dimension: int) -> tuple[FloatArray, FloatArray]:
    """Rotations (1, d, d) of both bodies, b from a along -x, that have the least energy at a ``distance``."""
    from scipy.optimize import minimize

    components = 1 if dimension == 2 else 4

    def rotations(unknowns: FloatArray) -> tuple[FloatArray, FloatArray]:
        turns = unknowns.reshape(2, components)
        turns = turns if dimension == 2 else turns / np.linalg.norm(turns, axis=1, keepdims=True)
        both = rotation_matrices(turns)
        return both[:1], both[1:]

    separation = distance * np.eye(dimension)[:1]

    def energy(unknowns: FloatArray) -> float:
        return float(law.pair_energy(PairPoses(separation, *rotations(unknowns)))[0])

    starts = np.random.default_rng(0).normal(size=(_STARTS, 2 * components)) * (np.pi if dimension == 2 else 1.0)
    scale = max(abs(energy(start)) for start in starts) or 1.0

    def scaled(unknowns: FloatArray) -> float:
        return energy(unknowns) / scale

    ends = [np.asarray(minimize(scaled, start).x) for start in starts]
    return rotations(min(ends, key=energy))
