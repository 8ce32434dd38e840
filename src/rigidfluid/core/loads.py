"""What a contact must hold: the work that stops a body at the smallest gap wanted."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.types import Contacts, FloatArray, Loads
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


def work_to_stop(contacts: Contacts, loads: Loads, law_range: float) -> FloatArray:
    """½ m v² + W (range - smallest_gap), what a head-on impact puts into each contact.

    Parameters
    ----------
    contacts : Contacts
        The m contacts.
    loads : Loads
        Masses, weights, speeds and the smallest gap.
    law_range : float
        The gap where the law begins [length].

    Returns
    -------
    (m,) array
        Work [energy].
    """
    return impact_energy(contacts, loads) + held_weight(contacts, loads) * (law_range - loads.smallest_gap)


def impact_energy(contacts: Contacts, loads: Loads) -> FloatArray:
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
    return np.asarray(_both(loads.speed, contacts).sum(axis=0))


def held_weight(contacts: Contacts, loads: Loads) -> FloatArray:
    """W, the larger of the two weights, (m,) [force]."""
    return np.asarray(_both(loads.weight, contacts).max(axis=0))


def inverse_mass(contacts: Contacts, loads: Loads) -> FloatArray:
    """1/m_a + 1/m_b, (m,) [1/mass]."""
    return np.asarray(_both(1.0 / loads.mass, contacts).sum(axis=0))


def _both(column: FloatArray, contacts: Contacts) -> FloatArray:
    """What ``column`` (n,) says of a and of b, zero for walls, (2, m)."""
    extended = np.append(column, 0.0)
    return np.stack([extended[contacts.body_a], extended[np.minimum(contacts.body_b, len(column))]])
