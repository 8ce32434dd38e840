"""What a contact must hold: the work that stops a body at the smallest gap wanted."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.model.types import Contacts, FloatArray, Loads
from rigidfluid.errors import SceneError

_FIELD = "contact.epsilon"


def require_loads(loads: Loads | None, law_range: float) -> Loads:
    """The loads, if a strength can be computed from them.

    Parameters
    ----------
    loads : Loads or None
        What the contacts must hold.
    law_range : float
        The range of the law [length].

    Returns
    -------
    Loads
        The same.

    Raises
    ------
    SceneError
        Without loads, with a smallest gap outside the range, or where a free body has neither weight nor speed.
    """
    if loads is None:
        raise SceneError(_FIELD, '"auto" without known loads', "a number", "Give `epsilon` as a number.")
    if not 0.0 < loads.smallest_gap < law_range:
        allowed = f"a length above 0 and below contact.range = {law_range}"
        raise SceneError("contact.smallest_gap", loads.smallest_gap, allowed, "Shorten it, or widen the range.")
    idle = np.isfinite(loads.mass) & (loads.weight == 0.0) & (loads.speed == 0.0)
    if idle.any():
        found = f'"auto" with body.{int(np.argmax(idle))} that has neither weight nor speed'
        allowed = "a load that the contacts must hold"
        remedy = "Say how fast it may hit: `contact.impact_speed`, or give `epsilon` as a number."
        raise SceneError(_FIELD, found, allowed, remedy)
    return loads


def impact_energy(contacts: Contacts, loads: Loads) -> FloatArray:
    """The energy of an approach: of the two bodies alone, or if it is more, of the bodies that come down together.

    Those that come down on a wall or on a body of given twist bring ``stacked_energy`` of the lowest. Of two bodies
    the upper one hits the lower, and brings its own: it is the one with less.

    Parameters
    ----------
    contacts : Contacts
        The m contacts.
    loads : Loads
        Masses, speeds and stacked energies.

    Returns
    -------
    (m,) array
        Kinetic energy [energy].
    """
    return _of_stack(loads.stacked_energy, pair_energy(contacts, loads), contacts, loads)


def pair_energy(contacts: Contacts, loads: Loads) -> FloatArray:
    """½ m v² with the effective mass m and v = v_a + v_b; a wall is heavy and rests.

    Between two bodies of given twist it is zero, since nothing is to be stopped.

    Parameters
    ----------
    contacts : Contacts
        The m contacts.
    loads : Loads
        Masses and speeds.

    Returns
    -------
    (m,) array
        Kinetic energy of the approach [energy].
    """
    inverse = inverse_mass(contacts, loads)
    twice = np.zeros(len(contacts))
    np.divide(closing_speed(contacts, loads) ** 2, inverse, out=twice, where=inverse > 0.0)
    return 0.5 * twice


def closing_speed(contacts: Contacts, loads: Loads) -> FloatArray:
    """v_a + v_b, (m,) [length/time]."""
    return np.asarray(of_both(loads.speed, contacts).sum(axis=0))


def held_weight(contacts: Contacts, loads: Loads) -> FloatArray:
    """The larger of the two bodies' own weights, (m,) [force]."""
    return np.asarray(of_both(loads.weight, contacts).max(axis=0))


def stacked_weight(contacts: Contacts, loads: Loads) -> FloatArray:
    """The larger of the two bodies' own weights, or if it is more, that of the stack on top of the contact.

    Parameters
    ----------
    contacts : Contacts
        The m contacts.
    loads : Loads
        Weights, of bodies and of stacks.

    Returns
    -------
    (m,) array
        Weight [force]; zero between two bodies of given twist.
    """
    return _of_stack(loads.stacked_weight, held_weight(contacts, loads), contacts, loads)


def inverse_mass(contacts: Contacts, loads: Loads) -> FloatArray:
    """1/m_a + 1/m_b, (m,) [1/mass]."""
    return np.asarray(of_both(1.0 / loads.mass, contacts).sum(axis=0))


def of_both(column: FloatArray, contacts: Contacts, at_wall: float = 0.0) -> FloatArray:
    """What ``column`` (n,) says of a and of b, ``at_wall`` for walls, (2, m)."""
    extended = np.append(column, at_wall)
    return np.stack([extended[contacts.body_a], extended[np.minimum(contacts.body_b, len(column))]])


def _of_stack(column: FloatArray, single: FloatArray, contacts: Contacts, loads: Loads) -> FloatArray:
    """The load ``single`` (m,) of two bodies, or what stands behind both of them, by ``column`` (n,), if more, (m,)."""
    behind = of_both(column, contacts, at_wall=np.inf).min(axis=0)
    return np.where(inverse_mass(contacts, loads) > 0.0, np.maximum(single, behind), 0.0)
