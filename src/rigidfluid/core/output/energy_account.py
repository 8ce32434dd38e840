"""Judge the energy balance of a run: energy that came from nowhere or vanished, and why it did."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rigidfluid.core.geometry.arrays import FloatArray

Table = Mapping[str, NDArray[Any]]

NOTICEABLE, SERIOUS = 0.01, 0.05
"""Shares of the energy put in from which on energy created, lost or unaccounted for is worth a warning, and a serious
one."""

STABILISED = 0.05
"""Share of the energy put in from which on the loss by grad-div stabilisation is worth a warning."""

_TOLD = 0.1
"""A cause of less than this part of what was created or lost is not told."""


class _Cause(NamedTuple):
    """A part of the residual: where its energy went, in words, and what helps."""

    part: str
    text: str
    remedy: str


_CAUSES = (
    _Cause("residual_steps", "by a time.step too long for the motion", "Shorten time.step: halve it and compare."),
    _Cause(
        "residual_contacts", "at impacts, for which time.step is too long", "Shorten time.step: halve it and compare."
    ),
    _Cause(
        "residual_remeshing",
        "by re-meshing",
        "Make cells finer by mesh.size_body and mesh.cells_per_gap, or new meshes rarer by mesh.remesh_every.",
    ),
    _Cause(
        "residual_mesh",
        "through curved slip faces, for which the mesh is too coarse",
        "Make cells there finer: mesh.size, or a [[mesh.refine]] at those faces.",
    ),
    _Cause(
        "residual_start",
        "in first steps, of the run or after a jump of a stroke",
        "Shorten time.step, or let what is prescribed begin slowly, by a ramp.",
    ),
)
PARTS = tuple(cause.part for cause in _CAUSES)
"""Columns whose sum is the residual."""


@dataclass(frozen=True, slots=True)
class EnergyAccount:
    """``put_in`` [energy], and shares of it, zero where nothing was put in.

    Put in: what was stored at the start, the most that gravity had worked by any time, and the most that faces,
    prescribed bodies and the force on the fluid had. The error at a time is the residual and what re-meshing took.
    ``created``: the lowest that it was after the first step, less that step's own, its sign changed. ``lost``: the
    highest, without what friction between the fluid's solutions explains. ``unaccounted``: the residual at the end.
    ``path_friction``: that friction, until the end. ``grad_div``: what stabilisation took until the end, no part of
    the others.
    """

    put_in: float
    created: float
    lost: float
    unaccounted: float
    path_friction: float
    grad_div: float


@dataclass(frozen=True, slots=True)
class EnergyWarning:
    """Much energy was created or lost: how much and by what causes in ``text``, and in ``remedy`` what helps against
    the greatest."""

    serious: bool
    text: str
    remedy: str


def energy_account(energy: Table) -> EnergyAccount:
    """The account of a table of energies by column, (s,) each [energy], a row per state from the start on."""
    put_in = _put_in(energy)
    lost, friction = energy["residual"] + energy["transfer_loss"], energy["path_friction"]

    def share(value: float) -> float:
        return value / put_in if put_in > 0.0 else 0.0

    return EnergyAccount(
        put_in,
        share(float(_excess(-lost).max())),
        share(float(_excess(lost - friction).max())),
        share(float(energy["residual"][-1])),
        share(float(friction[-1])),
        share(float(energy["grad_div_loss"][-1])),
    )


def energy_warnings(energy: Table) -> list[EnergyWarning]:
    """Warn of energy created, lost, or unaccounted for at the end and neither of these, and of energy that
    stabilisation took, if noticeable; ``energy``: the table by column (s,) [energy]."""
    account, sums = energy_account(energy), _lost_by_cause(energy)
    lost = energy["residual"] + energy["transfer_loss"]
    friction = energy["path_friction"]
    warnings = []
    if account.created >= NOTICEABLE:
        shares = _shares(sums, -1.0, int(_excess(-lost).argmax()), account.put_in)
        warnings.append(_warning(account.created, "came from nowhere", shares))
    if account.lost >= NOTICEABLE:
        beyond = sums | {"residual_contacts": sums["residual_contacts"] - friction}
        shares = _shares(beyond, 1.0, int(_excess(lost - friction).argmax()), account.put_in)
        warnings.append(_warning(account.lost, "vanished", shares))
    told = account.created if account.unaccounted < 0.0 else account.lost
    if abs(account.unaccounted) >= NOTICEABLE > told:
        at_end = {name: float(np.sign(account.unaccounted) * energy[name][-1]) / account.put_in for name in PARTS}
        warnings.append(_warning(account.unaccounted, "is unaccounted for at the end", at_end))
    if account.grad_div >= STABILISED:
        taken = f"{per_cent(account.grad_div)} of the energy put in was taken by stabilisation"
        text = f"{taken}, in cells too coarse for the flow"
        warnings.append(EnergyWarning(False, text, "Make cells finer: mesh.size_body, or mesh.wake behind bodies."))
    return warnings


def per_cent(share: float) -> str:
    """Percentage to two digits; a share below a millionth is nothing."""
    value = 100.0 * share if abs(share) >= 1e-6 else 0.0
    return f"{value:.2g} %" if abs(value) < 100.0 else f"{value:.0f} %"


def _put_in(energy: Table) -> float:
    driven = energy["boundary"] + energy["control"] + energy["body_force"]
    start = energy["kinetic"][0] + energy["contact"][0]
    return float(start + max(energy["gravity"].max(), 0.0) + max(driven.max(), 0.0))


def _excess(balance: FloatArray) -> FloatArray:
    """Growth of a sum (s,) since the first step; zero before that."""
    excess: FloatArray = balance - balance[:2][-1]
    excess[0] = 0.0
    return excess


def _lost_by_cause(energy: Table) -> dict[str, FloatArray]:
    """The parts of the residual (s,); what a transfer took is re-meshing's."""
    residual = {name: energy[name] for name in PARTS}
    return residual | {"residual_remeshing": residual["residual_remeshing"] + energy["transfer_loss"]}


def _shares(sums: Mapping[str, FloatArray], sign: float, worst: int, put_in: float) -> dict[str, float]:
    """``sign`` times what each sum (s,) has grown by from the first step to the ``worst`` state, over ``put_in``."""
    return {name: sign * float(_excess(values)[worst]) / put_in for name, values in sums.items()}


def _warning(share: float, what: str, shares: Mapping[str, float]) -> EnergyWarning:
    serious = abs(share) >= SERIOUS
    causes = sorted(_CAUSES, key=lambda cause: -shares[cause.part])
    told = [cause for cause in causes if shares[cause.part] >= _TOLD * abs(share)]
    reasons = ", ".join(f"{per_cent(shares[cause.part])} {cause.text}" for cause in told)
    consequence = "; do not rely on this run" if serious else ""
    text = f"{per_cent(share)} of the energy put in {what}: {reasons}{consequence}"
    return EnergyWarning(serious, text, told[0].remedy)
