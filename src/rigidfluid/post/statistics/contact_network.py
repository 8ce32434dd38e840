"""Contacts of bodies: how many each has, how large the groups are, and the stress that contacts carry."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.post.statistics.blocks import Mean, mean
from rigidfluid.post.statistics.samples import Samples


class ContactNetwork(NamedTuple):
    """Means over the states: ``coordination``, contacts of a body with others [1]; ``touching``, share of bodies that
    have a contact, with walls too [1]; ``largest``, bodies in the largest group over all [1]; ``stress`` (d, d) of
    contacts between bodies, and (s, d, d) ``stress_by_state`` [force/length^(d-1)]; ``on_walls``, forces on what does
    not move by name (d,) [force]."""

    coordination: Mean
    touching: Mean
    largest: Mean
    stress: Mean
    stress_by_state: FloatArray
    on_walls: dict[str, Mean]


def contact_network(samples: Samples, table: Mapping[str, NDArray[Any]]) -> ContactNetwork:
    """Contacts within the range of the laws, by the ``table`` of contacts.

    The stress is σ = -Σ F (x_a - x_b)ᵀ/V, with the force F on a and the centres x, of b that of the image at the
    contact: negative under pressure.
    """
    places = {name: place for place, name in enumerate(samples.name)}
    states = np.searchsorted(samples.step, table["step"])
    known = states < len(samples.step)
    known[known] = samples.step[states[known]] == table["step"][known]
    axes = "xyz"[: samples.dimension]
    force, point_b = (
        np.stack([table[f"{kind}{axis}"][known] for axis in axes], axis=1).reshape(-1, samples.dimension)
        for kind in "fb"
    )
    state = states[known]
    a, b = (np.array([places.get(name, -1) for name in table[side][known]], dtype=int) for side in "ab")
    by_state = [(a[state == one], b[state == one]) for one in range(len(samples.step))]

    def over_states(figure: Callable[[int, IntArray, IntArray], float]) -> Mean:
        return mean(np.array([figure(samples.count, *one) for one in by_state]))

    stress = _stress(samples, state, (a, b), point_b, force)
    return ContactNetwork(
        coordination=over_states(_coordination),
        touching=over_states(_touching),
        largest=over_states(_largest),
        stress=mean(stress),
        stress_by_state=stress,
        on_walls=_on_walls(samples, state, (table["a"][known], table["b"][known]), (a, b), force),
    )


def _coordination(count: int, a: IntArray, b: IntArray) -> float:
    return 2.0 * len(_pairs(a, b)) / count


def _touching(count: int, a: IntArray, b: IntArray) -> float:
    return len(np.setdiff1d(np.concatenate([a, b]), [-1])) / count


def _largest(count: int, a: IntArray, b: IntArray) -> float:
    pairs = _pairs(a, b)
    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
    _, group = connected_components(graph, directed=False)
    return float(np.bincount(group).max()) / count


def _pairs(a: IntArray, b: IntArray) -> IntArray:
    """Pairs of bodies that touch, (p, 2), each once however many contacts it has."""
    both = (a >= 0) & (b >= 0)
    return np.unique(np.sort(np.stack([a[both], b[both]], axis=1), axis=1), axis=0)


def _stress(
    samples: Samples, state: IntArray, pair: tuple[IntArray, IntArray], point_b: FloatArray, force: FloatArray
) -> FloatArray:
    """Stress of contacts between bodies in each state (s, d, d), by their points on b [force/length^(d-1)]."""
    a, b = pair
    both = (a >= 0) & (b >= 0)
    state, force = state[both], force[both]
    centre_b = samples.position[state, b[both]]
    centre_b = centre_b + samples.periods(point_b[both] - centre_b)
    arm = samples.position[state, a[both]] - centre_b
    stress = np.zeros((len(samples.step), samples.dimension, samples.dimension))
    np.add.at(stress, state, -force[:, :, None] * arm[:, None, :] / samples.volume)
    return stress


def _on_walls(
    samples: Samples,
    state: IntArray,
    names: tuple[NDArray[Any], NDArray[Any]],
    numbers: tuple[IntArray, IntArray],
    force: FloatArray,
) -> dict[str, Mean]:
    """Forces of the bodies on each surface that does not move."""
    found: dict[str, FloatArray] = {}
    for name, number, sign in zip(names, numbers, (1.0, -1.0), strict=True):
        for surface in np.unique(name[number < 0]):
            here = (name == surface) & (number < 0)
            total = found.setdefault(str(surface), np.zeros((len(samples.step), samples.dimension)))
            np.add.at(total, state[here], sign * force[here])
    return {name: mean(total) for name, total in sorted(found.items())}
