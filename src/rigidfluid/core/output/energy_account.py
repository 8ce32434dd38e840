"""What the energy balance of a run says of it: energy that came from nowhere or vanished, and why it may have."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rigidfluid.core.model.types import BoolArray, FloatArray

Table = Mapping[str, NDArray[Any]]

NOTICEABLE, SERIOUS = 0.01, 0.05
"""From these shares on, energy created or lost is worth a warning and a serious one."""

_HALF = 0.5
"""A cause that may explain so much of what was created or lost is named."""
_IMPACTS = ("at impacts, for which time.step is too long", "Shorten time.step: halve it and compare.")
_TRANSFERS = (
    "in re-meshing, which changed much energy by itself",
    "Shorten time.step: halve it and compare; then mesh.size and mesh.size_body.",
)
_STEPS = (
    "because time.step is too long or the mesh too coarse for the motion",
    "Shorten time.step: halve it and compare; then mesh.size and mesh.size_body.",
)


@dataclass(frozen=True, slots=True)
class EnergyAccount:
    """``put_in`` [energy], and shares of it, zero where nothing was put in.

    Put in: what was stored at the start, the most that gravity had worked by any time, and the most that faces and
    driven bodies had. ``created``: the lowest residual after the first step, less that step's own, its sign changed.
    ``lost``: the highest, without what friction between the fluid's solutions explains. ``unaccounted``: the residual
    at the end. ``path_friction``: that friction, until the end.
    """

    put_in: float
    created: float
    lost: float
    unaccounted: float
    path_friction: float


@dataclass(frozen=True, slots=True)
class EnergyWarning:
    """Much energy was created or lost: how much and the likely cause in ``text``, and what helps in ``remedy``."""

    serious: bool
    text: str
    remedy: str


def energy_account(energy: Table) -> EnergyAccount:
    """The account of a table of energies by column, (s,) each [energy], a row per state from the start on."""
    put_in = _put_in(energy)
    friction = energy["path_friction"]

    def share(value: float) -> float:
        return value / put_in if put_in > 0.0 else 0.0

    return EnergyAccount(
        put_in,
        share(float(_excess(-energy["residual"]).max())),
        share(float(_excess(energy["residual"] - friction).max())),
        share(float(energy["residual"][-1])),
        share(float(friction[-1])),
    )


def energy_warnings(energy: Table, pushed: BoolArray) -> list[EnergyWarning]:
    """Of energy created, then of energy lost, where they are noticeable.

    Parameters
    ----------
    energy : mapping of str to (s,) array
        The table of energies by column [energy].
    pushed : (s,) bool array
        Whether contacts pushed any body in the step that led to each state.
    """
    account = energy_account(energy)
    found = (
        (account.created, -energy["residual"], "came from nowhere"),
        (account.lost, energy["residual"] - energy["path_friction"], "vanished"),
    )
    return [
        _warning(share, what, *_cause(energy, _excess(excess), pushed))
        for share, excess, what in found
        if share >= NOTICEABLE
    ]


def contacts_pushed(bodies: Table, states: int) -> BoolArray:
    """Whether contacts pushed any body in the step to each state (s,), from the table of bodies, n rows a state."""
    forces = np.stack([bodies[name] for name in ("cfx", "cfy", "cfz") if name in bodies])
    return np.asarray(forces.any(axis=0).reshape(states, -1).any(axis=1))


def per_cent(share: float) -> str:
    """To two digits; what is below a millionth is nothing."""
    value = 100.0 * share
    return f"{value:.0f} %" if abs(value) >= 100.0 or abs(share) < 1e-6 else f"{value:.2g} %"


def _put_in(energy: Table) -> float:
    driven = energy["boundary"] + energy["control"]
    start = energy["kinetic"][0] + energy["contact"][0]
    return float(start + max(energy["gravity"].max(), 0.0) + max(driven.max(), 0.0))


def _excess(balance: FloatArray) -> FloatArray:
    """What a sum (s,) has grown by since the first step; zero before that."""
    excess: FloatArray = balance - balance[:2][-1]
    excess[0] = 0.0
    return excess


def _cause(energy: Table, excess: FloatArray, pushed: BoolArray) -> tuple[str, str]:
    """The likely cause of the largest excess (s,), and what helps.

    An impact acts in its step and, by BDF2, in the next: both are steps with contacts.
    """
    worst = int(excess.argmax())
    near = pushed | np.concatenate([[False], pushed[:-1]])
    growth = np.maximum(np.diff(excess[: worst + 1]), 0.0)
    if growth[near[1 : worst + 1]].sum() >= _HALF * growth.sum():
        return _IMPACTS
    if np.abs(np.diff(energy["transfer_loss"])).sum() >= _HALF * excess[worst]:
        return _TRANSFERS
    if energy["path_friction"][-1] >= _HALF * excess[worst]:
        return _IMPACTS
    return _STEPS


def _warning(share: float, what: str, cause: str, remedy: str) -> EnergyWarning:
    serious = share >= SERIOUS
    consequence = "; do not rely on this run" if serious else ""
    text = f"{per_cent(share)} of the energy put in {what}, probably {cause}{consequence}"
    return EnergyWarning(serious, text, remedy)
