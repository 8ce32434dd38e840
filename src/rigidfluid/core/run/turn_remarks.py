"""Whether bodies that spin turned so far in a step that the flow round them lost its energy."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.output.energy_account import NOTICEABLE, energy_account
from rigidfluid.core.output.history import History
from rigidfluid.core.output.records import columns
from rigidfluid.core.run.remarks import Remark

FARTHEST_TURN = 0.5
"""A step of so many radians loses next to nothing of a flow that goes round with its body [rad]."""


def turn_remarks(history: History) -> list[Remark]:
    """Warn of the body that turned most in a step, where that was much and steps too long have lost energy.

    Flow that is the same all round a body keeps its energy however fast the body spins. Other flow goes round with the
    body and is damped by steps of a radian and more, by as much at half the step.
    """
    energy = history.energy
    account = energy_account(energy)
    if account.lost < NOTICEABLE or energy["residual_steps"][-1] < NOTICEABLE * account.put_in:
        return []
    spins = tuple(name for name in columns(history.dimension)["bodies"] if name in ("w", "wx", "wy", "wz"))
    bodies = history.table("bodies", ("time", "body", *spins))
    count = len(np.unique(bodies["body"]))
    time = bodies["time"].reshape(-1, count)
    spin = np.sqrt(sum(np.square(bodies[name].reshape(-1, count)) for name in spins))
    turn = np.max(np.diff(time, axis=0) * spin[1:], axis=0)
    worst = int(np.argmax(turn))
    if turn[worst] <= FARTHEST_TURN:
        return []
    name, enough = str(bodies["body"][worst]), FARTHEST_TURN / float(spin[:, worst].max())
    text = (
        f"{name!r} turned by up to {turn[worst]:.2g} rad in a step: flow that is carried round with it loses its "
        f"energy, and above 1 rad halving time.step may not show it"
    )
    remedy = f"Set time.step to {enough:.2g} or less, {FARTHEST_TURN:g} rad a step."
    return [Remark("warning", text, remedy)]
