"""Loads that a contact must hold: weight, and the energy of an impact."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.types import Contacts, Loads
from rigidfluid.errors import SceneError

_FIELD = "contact.epsilon"


def require_loads(loads: Loads | None, law_range: float) -> Loads:
    """Loads, if a strength can be computed from them; raises SceneError without loads, with a smallest gap outside the
    range, or where a free body has neither weight nor speed."""
    if loads is None:
        raise SceneError(_FIELD, '"auto" without known loads', "a number", "Give `epsilon` as a number.")
    if not 0.0 < loads.smallest_gap < law_range:
        allowed = f"a length above 0 and below contact.range = {law_range}"
        raise SceneError("contact.smallest_gap", loads.smallest_gap, allowed, "Shorten it, or widen the range.")
    idle = np.isfinite(loads.mass) & (loads.weight == 0.0) & (loads.speed == 0.0)
    if idle.any():
        number = int(np.argmax(idle))
        body = repr(loads.names[number]) if loads.names else number
        found = f'"auto" with body {body} that has neither weight nor speed'
        allowed = "a load that the contacts must hold"
        remedy = "Say how fast it may hit: `contact.impact_speed`, or give `epsilon` as a number."
        raise SceneError(_FIELD, found, allowed, remedy)
    return loads


def impact_energy(contacts: Contacts, loads: Loads) -> FloatArray:
    """Energy of an approach (m,): that of the two bodies alone, or if it is more, of the bodies that come down together
    [energy].

    Bodies that come down on a wall or on one of prescribed twist bring ``stacked_energy`` of the lowest. The upper one
    of two bodies hits the lower, and brings its own: it is the one with less.
    """
    return _stack_load(loads.stacked_energy, pair_energy(contacts, loads), contacts, loads)


def pair_energy(contacts: Contacts, loads: Loads) -> FloatArray:
    """Kinetic energy of the approach ½ m v² (m,) with the effective mass m and v = v_a + v_b; a wall is heavy and rests
    [energy].

    The energy is zero between two bodies of prescribed twist, since nothing is to be stopped.
    """
    inverse = inverse_mass(contacts, loads)
    twice = np.zeros(len(contacts))
    np.divide(closing_speed(contacts, loads) ** 2, inverse, out=twice, where=inverse > 0.0)
    return 0.5 * twice


def closing_speed(contacts: Contacts, loads: Loads) -> FloatArray:
    """Closing speed v_a + v_b, (m,) [length/time]."""
    return np.asarray(pair_values(loads.speed, contacts).sum(axis=0))


def held_weight(contacts: Contacts, loads: Loads) -> FloatArray:
    """Larger of the two bodies' own weights, (m,) [force]."""
    return np.asarray(pair_values(loads.weight, contacts).max(axis=0))


def stacked_weight(contacts: Contacts, loads: Loads) -> FloatArray:
    """Larger of the two bodies' own weights, or if it is more, the weight of the stack on top of the contact, (m,);
    zero between two bodies of prescribed twist [force]."""
    return _stack_load(loads.stacked_weight, held_weight(contacts, loads), contacts, loads)


def inverse_mass(contacts: Contacts, loads: Loads) -> FloatArray:
    """Inverse effective mass 1/m_a + 1/m_b, (m,) [1/mass]."""
    return np.asarray(pair_values(1.0 / loads.mass, contacts).sum(axis=0))


def pair_values(column: FloatArray, contacts: Contacts, at_wall: float = 0.0) -> FloatArray:
    """Values of ``column`` (n,) for a and for b, ``at_wall`` for walls, (2, m)."""
    extended = np.append(column, at_wall)
    return np.stack([extended[contacts.body_a], extended[np.minimum(contacts.body_b, len(column))]])


def _stack_load(column: FloatArray, single: FloatArray, contacts: Contacts, loads: Loads) -> FloatArray:
    """Load ``single`` (m,) of two bodies, or that of the stack behind both, by ``column`` (n,), if more, (m,)."""
    behind = pair_values(column, contacts, at_wall=np.inf).min(axis=0)
    return np.where(inverse_mass(contacts, loads) > 0.0, np.maximum(single, behind), 0.0)
