"""Judge the energy balance of a run: energy that came from nowhere or vanished, and why it did."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.output.energy_flows import (
    COLUMNS,
    PARTS,
    Flow,
    Table,
    creation_and_loss,
    energy_at_hand,
    lost_by_cause,
    lost_energy,
    round_off,
)
from rigidfluid.errors import OutputError

NOTICEABLE, SERIOUS = 0.01, 0.05
"""Shares of the energy at hand from which on energy created, lost or unaccounted for is worth a warning, and a serious
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


@dataclass(frozen=True, slots=True)
class EnergyAccount:
    """``at_hand``, ``put_in`` and ``round_off`` [energy], and what came from nowhere or vanished.

    ``at_hand``, ``creation`` and ``loss`` [energy]: as in `energy_at_hand` and `creation_and_loss`.

    Put in: what was stored at the start, the most that gravity had worked by any time, and the most that faces,
    prescribed bodies and the force on the fluid had. The error at a time is the residual and what re-meshing took.
    Shares of what was put in, zero where that is nothing: ``created``, the lowest that it was after the first step,
    less that step's own, its sign changed; ``lost``, the highest, without what friction between the fluid's solutions
    explains. Shares of what was put in, or at hand if that is more: ``unaccounted``, the residual at the end;
    ``path_friction``, that friction until the end; ``grad_div``, what stabilisation took until the end, no part of the
    others.
    """

    at_hand: float
    creation: Flow
    loss: Flow
    round_off: float
    put_in: float
    created: float
    lost: float
    unaccounted: float
    path_friction: float
    grad_div: float

    def share(self, amount: float) -> float:
        """An ``amount`` over what was at hand, zero where nothing was."""
        return _share(amount, self.at_hand)


@dataclass(frozen=True, slots=True)
class EnergyWarning:
    """Much energy was created or lost: how much and by what causes in ``text``, and in ``remedy`` what helps against
    the greatest."""

    serious: bool
    text: str
    remedy: str


def energy_account(energy: Table) -> EnergyAccount:
    """The account of a table of energies by column, (s,) each [energy], a row per state from the start on; raises
    OutputError where one is no number."""
    _refuse_gaps(energy)
    put_in, at_hand = _put_in(energy), energy_at_hand(energy)
    lost, friction = lost_energy(energy), energy["path_friction"]
    whole = max(put_in, at_hand)
    return EnergyAccount(
        at_hand,
        *creation_and_loss(energy, at_hand),
        round_off(energy),
        put_in,
        _share(float(_excess(-lost).max()), put_in),
        _share(float(_excess(lost - friction).max()), put_in),
        _share(float(energy["residual"][-1]), whole),
        _share(float(friction[-1]), whole),
        _share(float(energy["grad_div_loss"][-1]), whole),
    )


def energy_warnings(energy: Table, account: EnergyAccount) -> list[EnergyWarning]:
    """Warn of energy created, lost, or unaccounted for at the end and neither of these, and of energy that
    stabilisation took, if noticeable; ``energy``: the table by column, "time" (s,) [time] and others (s,) [energy], and
    its ``account``."""
    lost = lost_by_cause(energy)
    unexplained = lost | {"residual_contacts": lost["residual_contacts"] - energy["path_friction"]}
    created, vanished = account.share(account.creation.largest), account.share(account.loss.largest)
    warnings = []
    if created >= NOTICEABLE:
        came = {name: -values for name, values in lost.items()}
        warnings.append(_flow_warning(energy["time"], account, account.creation, came, "came from nowhere"))
    if vanished >= NOTICEABLE:
        warnings.append(_flow_warning(energy["time"], account, account.loss, unexplained, "vanished"))
    if abs(account.unaccounted) >= NOTICEABLE > (created if account.unaccounted < 0.0 else vanished):
        shares = {name: abs(account.unaccounted) * energy[name][-1] / energy["residual"][-1] for name in PARTS}
        said = "of the energy put in is unaccounted for at the end"
        warnings.append(_warning(account.unaccounted, said, shares))
    if account.grad_div >= STABILISED:
        taken = f"{per_cent(account.grad_div)} of the energy put in was taken by stabilisation"
        text = f"{taken}, in cells too coarse for the flow"
        warnings.append(EnergyWarning(False, text, "Make cells finer: mesh.size_body, or mesh.wake behind bodies."))
    return warnings


def per_cent(share: float) -> str:
    """Percentage to two digits; a share below a millionth is nothing."""
    value = 100.0 * share if abs(share) >= 1e-6 else 0.0
    return f"{value:.2g} %" if abs(value) < 100.0 else f"{value:.0f} %"


def _refuse_gaps(energy: Table) -> None:
    for name in (*COLUMNS, *PARTS):
        gaps = np.flatnonzero(~np.isfinite(energy[name]))
        if len(gaps):
            found = f"{energy[name][gaps[0]]} at the time {energy['time'][gaps[0]]:.6g}"
            raise OutputError(f"energy.csv, {name}", found, "finite energies", "Run the scene again.")


def _put_in(energy: Table) -> float:
    driven = energy["boundary"] + energy["control"] + energy["body_force"] + energy["exchange"]
    start = energy["kinetic"][0] + energy["contact"][0]
    return float(start + max(energy["gravity"].max(), 0.0) + max(driven.max(), 0.0))


def _excess(balance: FloatArray) -> FloatArray:
    """Growth of a sum (s,) since the first step; zero before that."""
    excess: FloatArray = balance - balance[:2][-1]
    excess[0] = 0.0
    return excess


def _share(amount: float, whole: float) -> float:
    return amount / whole if whole > 0.0 else 0.0


def _flow_warning(
    time: FloatArray, account: EnergyAccount, flow: Flow, sums: Mapping[str, FloatArray], what: str
) -> EnergyWarning:
    """Warn of the largest amount of a ``flow``, to which each of the ``sums`` (s,) has added what it grew by."""
    shares = {name: account.share(float(values[flow.end] - values[flow.start])) for name, values in sums.items()}
    between = f"between {time[flow.start]:.4g} and {time[flow.end]:.4g}"
    return _warning(account.share(flow.largest), f"of the energy at hand {what} {between}", shares)


def _warning(share: float, what: str, shares: Mapping[str, float]) -> EnergyWarning:
    serious = abs(share) >= SERIOUS
    causes = sorted(_CAUSES, key=lambda cause: -shares[cause.part])
    told = [cause for cause in causes if shares[cause.part] >= _TOLD * abs(share)]
    reasons = ", ".join(f"{per_cent(shares[cause.part])} {cause.text}" for cause in told)
    consequence = "; do not rely on this run" if serious else ""
    return EnergyWarning(serious, f"{per_cent(share)} {what}: {reasons}{consequence}", told[0].remedy)
