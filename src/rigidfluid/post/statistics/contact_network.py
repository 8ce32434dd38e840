"""Contacts of bodies: how many each has, how large the groups are, and the stress that contacts carry."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.mechanics.suspension import coordination, touching_pairs
from rigidfluid.post.statistics.blocks import Mean, mean
from rigidfluid.post.statistics.contact_rows import ContactRows


class ContactNetwork(NamedTuple):
    """Means over the states, the first three over those with bodies: ``coordination``, contacts of a body with others
    [1]; ``touching``, share of bodies that have a contact, with walls too [1]; ``largest``, bodies in the largest group
    over all [1]; ``stress`` (d, d) of contacts between bodies [force/length^(d-1)]; ``on_walls``, forces on what does
    not move by name (d,) [force]."""

    coordination: Mean
    touching: Mean
    largest: Mean
    stress: Mean
    on_walls: dict[str, Mean]


def contact_network(rows: ContactRows) -> ContactNetwork:
    """Contacts within the range of the laws, by the ``rows`` of their table.

    The stress is σ = -Σ F (x_a - x_b)ᵀ/V, with the force F on a and the centres x, of b that of the image at the
    contact: negative under pressure.
    """
    samples, force, pairs = rows.samples, rows.vectors("f"), rows.paired
    occupied = np.flatnonzero(samples.count)
    sides = [_numbers(rows, int(state)) for state in occupied]

    def over_states(figure: Callable[[int, IntArray, IntArray], float]) -> Mean:
        counts = samples.count[occupied].tolist()
        return mean(np.array([figure(count, a, b) for count, (a, b) in zip(counts, sides, strict=True)]))

    return ContactNetwork(
        coordination=over_states(coordination),
        touching=over_states(_touching),
        largest=over_states(_largest),
        stress=mean(rows.selected(pairs).stress(force[pairs])),
        on_walls=_on_walls(rows, force),
    )


def _numbers(rows: ContactRows, state: int) -> tuple[IntArray, IntArray]:
    """Numbers (c,) of both sides of the contacts in a state, among the bodies that are there; -1 of others."""
    number = np.cumsum(rows.samples.present[state]) - 1
    here = rows.state == state
    a, b = (np.where(side[here] >= 0, number[side[here]], -1) for side in (rows.a, rows.b))
    return a, b


def _touching(count: int, a: IntArray, b: IntArray) -> float:
    return len(np.setdiff1d(np.concatenate([a, b]), [-1])) / count


def _largest(count: int, a: IntArray, b: IntArray) -> float:
    pairs = touching_pairs(a, b)
    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
    _, group = connected_components(graph, directed=False)
    return float(np.bincount(group).max()) / count


def _on_walls(rows: ContactRows, force: FloatArray) -> dict[str, Mean]:
    """Forces of the bodies on each surface that does not move."""
    found: dict[str, FloatArray] = {}
    for name, number, sign in zip(rows.names, (rows.a, rows.b), (1.0, -1.0), strict=True):
        for surface in np.unique(name[number < 0]):
            here = (name == surface) & (number < 0)
            total = found.setdefault(str(surface), np.zeros((len(rows.samples.step), force.shape[1])))
            np.add.at(total, rows.state[here], sign * force[here])
    return {name: mean(total) for name, total in sorted(found.items())}
