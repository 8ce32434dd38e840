"""Work that stops an impact at the smallest gap wanted, less the share of the film."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigidfluid.core.contact.laws.loads import closing_speed, impact_energy, pair_energy, stacked_weight
from rigidfluid.core.contact.laws.stokes_number import stokes_number, stokes_number_taken
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.types import Contacts, Loads

SLOWEST = 0.25
"""Least part of the speed that the film is assumed to leave: impacts off the expected way meet less of it."""

WITHIN = 2.0 / 3.0
"""Film's share within range of the Stokes number of a body that the law stops at the smallest gap, over its share of a
fast one's."""


def work_to_stop(contacts: Contacts, loads: Loads, law_range: float) -> FloatArray:
    """Work of each contact in a head-on impact (m,): the energy that the film leaves + W (range - smallest_gap), W the
    weight of a stack, + the work of other laws that attract [energy]."""
    energy = impact_energy(contacts, loads) * share_left(contacts, loads, law_range, loads.smallest_gap)
    work = energy + stacked_weight(contacts, loads) * (law_range - loads.smallest_gap)
    if loads.attraction is None:
        return work
    there = replace(contacts, gap=np.full(len(contacts), loads.smallest_gap))
    return work + np.maximum(-loads.attraction.energy(there), 0.0)


def share_left(contacts: Contacts, loads: Loads, law_range: float, smallest_gap: float) -> FloatArray:
    """Part of the impact's energy that the resolved film leaves to the law, (m,) [1].

    The part is (1 - A/St)², A the film's share of the Stokes number on the way to range and WITHIN of its share from
    there to the smallest gap, but at least SLOWEST²; St of bodies that come down together is that of them all. The part
    is one where a body is no ball, whose film may be less, and without inertia of the fluid, where contacts bear the
    forces on the bodies and no impacts.
    """
    film, share = loads.film, np.ones(len(contacts))
    if film is None or not film.inertia:
        return share
    alone = pair_energy(contacts, loads)
    rows = (alone > 0.0) & ~np.isnan(contacts.radius_a) & ~np.isnan(contacts.radius_b)
    together = np.divide(impact_energy(contacts, loads), alone, out=np.ones(len(contacts)), where=rows)
    with np.errstate(invalid="ignore"):
        stokes = stokes_number(contacts, film, loads) * closing_speed(contacts, loads) * together
    outside = stokes_number_taken(contacts, film, loads, law_range)
    taken = outside + WITHIN * (stokes_number_taken(contacts, film, loads, smallest_gap) - outside)
    left = 1.0 - np.divide(taken, stokes, out=np.zeros(len(contacts)), where=rows)
    return np.maximum(left, SLOWEST) ** 2
