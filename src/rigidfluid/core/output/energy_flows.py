"""Energy that came from nowhere or vanished: the most of it in any stretch of a run, and all of it, by cause."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rigidfluid.core.geometry.arrays import FloatArray

Table = Mapping[str, NDArray[Any]]

PARTS = ("residual_steps", "residual_contacts", "residual_remeshing", "residual_mesh", "residual_start")
"""Columns whose sum is the residual."""

_SHORTEST = 10.0
"""Least length of a stretch, in longest steps, where most is dissipated. A creeping flow would be judged by less than a
step: it dissipates at once what is there, and remembers no error."""

_DISSIPATED = ("dissipation", "grad_div_loss", "contact_loss")
_WORKS = ("gravity", "boundary", "control", "body_force", "exchange")
_BALANCE = ("kinetic", "contact", *_WORKS, *_DISSIPATED, "transfer_loss")
COLUMNS = (*_BALANCE, "path_friction", "residual")
"""All other columns."""

_ROUND_OFF = 8.0 * float(np.finfo(float).eps)
"""Relative error of a sum of the columns of the balance, and of the clock of stretches."""


@dataclass(frozen=True, slots=True)
class Flow:
    """Energy that came from nowhere, or that vanished: the ``largest`` net amount between two states in one stretch,
    from the state ``start`` to ``end``; ``summed``, the most in one stretch if nothing of it is set off against what
    went the other way; and ``by_cause`` the sum of the whole run, by part of the residual [energy].

    A change in a step by less than round-off is none.
    """

    largest: float
    start: int
    end: int
    summed: float
    by_cause: dict[str, float]


def creation_and_loss(energy: Table, at_hand: float) -> tuple[Flow, Flow]:
    """Energy that came from nowhere and energy that vanished, by stretches in which no more is dissipated than was
    ``at_hand``; of what vanished without what friction of impacts explains."""
    lost, dissipated = lost_energy(energy), _dissipated(energy)
    floor, sums = round_off(energy), lost_by_cause(energy)
    changes = {name: _changes(values, floor) for name, values in sums.items()}

    def flow(sign: float, balance: FloatArray, excused: FloatArray | float) -> Flow:
        amount, start, end = largest_growth(balance, dissipated, at_hand)
        rises = {name: np.cumsum(np.maximum(sign * change, 0.0)) for name, change in changes.items()}
        summed, _, _ = largest_growth(np.asarray(sum(rises.values()) - excused), dissipated, at_hand)
        largest = amount if amount > floor else 0.0
        return Flow(largest, start, end, summed, {name: float(values[-1]) for name, values in rises.items()})

    friction = energy["path_friction"]
    return flow(-1.0, -lost, 0.0), flow(1.0, lost - friction, friction)


def energy_at_hand(energy: Table) -> float:
    """The most energy that was there at once [energy]: kinetic, and in contacts and springs, attraction counted from
    its lowest; as far as the balance accounts for it.

    It is no less than the most that is dissipated in ten times the longest step. The work that gravity can still do is
    not there: in a viscous fluid it flows through, the more the longer the fall.
    """
    stored = energy["kinetic"] + energy["contact"] - min(energy["contact"].min(), 0.0)
    accounted = stored + lost_energy(energy)
    found = max(float(np.minimum(stored, accounted).max()), _most_dissipated(energy))
    return found if found > round_off(energy) else float(np.maximum(stored, accounted).max())


def lost_energy(energy: Table) -> FloatArray:
    """Energy that has vanished until each state (s,), what re-meshing took included; below zero of what came from
    nowhere."""
    return np.asarray(energy["residual"] + energy["transfer_loss"])


def lost_by_cause(energy: Table) -> dict[str, FloatArray]:
    """The parts of the residual (s,); what a transfer took is re-meshing's."""
    residual = {name: energy[name] for name in PARTS}
    return residual | {"residual_remeshing": residual["residual_remeshing"] + energy["transfer_loss"]}


def largest_growth(balance: FloatArray, clock: FloatArray, stretch: float) -> tuple[float, int, int]:
    """Largest growth of a ``balance`` (s,) between two states no more than a ``stretch`` of the ``clock`` (s,) apart,
    and these two; the clock never goes back."""
    first = np.searchsorted(clock, clock - stretch * (1.0 + _ROUND_OFF) - _ROUND_OFF * clock[-1]).tolist()
    values = balance.tolist()
    lowest: deque[int] = deque()  # of the states in reach, those below all after them
    largest = 0.0, 0, 0
    for state, value in enumerate(values):
        while lowest and values[lowest[-1]] >= value:
            lowest.pop()
        lowest.append(state)
        while lowest[0] < first[state]:
            lowest.popleft()
        largest = max(largest, (value - values[lowest[0]], lowest[0], state), key=lambda found: found[0])
    return largest


def _changes(values: FloatArray, floor: float) -> FloatArray:
    """Changes of a sum (s,) in the step to each state, zero where they are no more than the ``floor``."""
    change = np.diff(values, prepend=values[:1])
    return np.where(np.abs(change) > floor, change, 0.0)


def _most_dissipated(energy: Table) -> float:
    """The most that is dissipated in ten times the longest step [energy]."""
    time, dissipated = energy["time"], _dissipated(energy)
    span = _SHORTEST * float(np.diff(time).max(initial=0.0)) + _ROUND_OFF * abs(float(time[-1]))
    return float((dissipated - dissipated[np.searchsorted(time, time - span)]).max())


def _dissipated(energy: Table) -> FloatArray:
    """Energy taken by viscosity, stabilisation and dampers until each state (s,)."""
    return np.maximum.accumulate(np.sum([energy[name] for name in _DISSIPATED], axis=0))


def round_off(energy: Table) -> float:
    """Round-off of the residual [energy]: changes in a step by no more are left out of sums."""
    return _ROUND_OFF * float(np.sum(np.abs([energy[name] for name in _BALANCE]), axis=0).max())
