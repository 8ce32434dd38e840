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
        raise SceneError(_FIELD, found, allowed, "Say how fast it may hit, or give `epsilon` as a number.")
    return loads


def work_to_stop(contacts: Contacts, loads: Loads, law_range: float) -> FloatArray:
    """½ m v² + W (range - smallest_gap), what a head-on impact puts into each contact.

    m is the effective mass, v = v_a + v_b and W the larger of the two weights; a wall has neither weight nor speed.
    Between two bodies of given twist it is zero, since nothing is to be stopped.

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
    a, b = contacts.body_a, np.minimum(contacts.body_b, len(loads.mass))
    weight, speed = (np.append(column, 0.0) for column in (loads.weight, loads.speed))
    inverse_mass = np.append(1.0 / loads.mass, 0.0)
    twice_kinetic = np.zeros(len(contacts))
    inverse = inverse_mass[a] + inverse_mass[b]
    np.divide((speed[a] + speed[b]) ** 2, inverse, out=twice_kinetic, where=inverse > 0.0)
    falling = np.maximum(weight[a], weight[b]) * (law_range - loads.smallest_gap)
    return np.asarray(0.5 * twice_kinetic + falling)
