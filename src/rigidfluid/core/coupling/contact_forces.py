"""Forces of the contacts of a state, for its tables."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.contact.pairs.gap_curvature import with_gap_curvatures
from rigidfluid.core.contact.path.stretched import stretched
from rigidfluid.core.contact.path.substep import relative_angular_velocity, relative_motion, relative_velocity
from rigidfluid.core.coupling.scheme import Scheme
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.interactions import acting_together
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Contacts, Motion, Pose, Twist


def contact_forces(system: System, scheme: Scheme, state: State, time: float) -> FloatArray:
    """Force of each contact of a state on its first body, by all laws, their dampers and springs along surfaces (m, d),
    zero at the start [force]."""
    contacts, law = state.contacts, system.law
    if law is None or len(system.acting(contacts)) == 0 or state.count == 0:
        return np.zeros((len(contacts), system.dimension))
    if not law.dissipative:
        return law.force(contacts)
    motion = relative_motion(contacts, scheme.bodies_now(state, time), system.wall_velocity, law.couples)
    force = np.asarray(law.force(contacts) + law.damping(contacts, motion))
    if law.sticking:
        force += stretched(law, contacts, motion, state.pose, state.springs, 0.0).force
    return force


def film_forces(system: System, contacts: Contacts, pose: Pose, twist: Twist) -> FloatArray:
    """Force of the films that laws resist by, in ``contacts`` between bodies, on their first ones (m, d) [force]."""
    films = acting_together([interaction for interaction in system.interactions if interaction.law.film])
    if films is None:
        return np.zeros((len(contacts), system.dimension))
    curved = with_gap_curvatures(contacts, system, pose)
    spin = relative_angular_velocity(contacts, twist, None)
    return films.damping(curved, Motion(relative_velocity(contacts, pose, twist), np.zeros(len(contacts)), spin))
