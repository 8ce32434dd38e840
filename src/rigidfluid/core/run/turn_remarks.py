"""Warns of bodies that turned so far in a step that the flow round them lost its energy."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.output.energy_account import NOTICEABLE, EnergyAccount
from rigidfluid.core.output.history import History
from rigidfluid.core.output.records import quantity_columns
from rigidfluid.core.run.remarks import Remark

FARTHEST_TURN = 0.5
"""Turn in a step up to which a flow that goes round with its body loses next to no energy [rad]."""

ADVISED_TOLERANCE = 0.003
"""A ``time.tolerance`` that makes steps short enough."""


def turn_remarks(history: History, account: EnergyAccount) -> list[Remark]:
    """Warn of the body that turned most in a step, if that was much and steps too long have lost energy.

    Flow that is the same all round a body keeps its energy however fast the body spins. Flow that is carried round with
    it is damped by steps of a radian and more, and by as much at half the step, so that halving the step shows nothing.
    """
    loss, lost_by_steps = account.loss, history.energy["residual_steps"]
    if account.share(min(loss.largest, lost_by_steps[loss.end] - lost_by_steps[loss.start])) < NOTICEABLE:
        return []
    components = quantity_columns(history.dimension)["angular_velocity"]
    bodies = history.table("bodies", ("time", "body", *components))
    order = np.argsort(bodies["body"], kind="stable")  # bodies may enter and leave
    name, time = bodies["body"][order], bodies["time"][order]
    angular_speed = np.sqrt(sum(np.square(bodies[component][order]) for component in components))
    turn = np.where(name[1:] == name[:-1], np.diff(time) * angular_speed[1:], 0.0)
    if turn.max(initial=0.0) <= FARTHEST_TURN:
        return []
    worst = int(np.argmax(turn))
    step = FARTHEST_TURN / float(angular_speed[name == name[worst]].max())
    text = (
        f"{str(name[worst])!r} turned by up to {turn[worst]:.2g} rad in a step: flow that is carried round with it "
        f"loses its energy, and above 1 rad halving time.step may not show it"
    )
    remedy = f"Set time.step to {step:.2g} or less, {FARTHEST_TURN:g} rad a step, "
    return [Remark("warning", text, remedy + f"or time.tolerance to {ADVISED_TOLERANCE:g}.")]
