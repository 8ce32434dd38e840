"""Displacement and rotation of mechanisms in each cycle of their strokes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.rigid import rotation_between
from rigidfluid.core.output.energy_account import per_cent
from rigidfluid.core.output.history import History
from rigidfluid.core.output.records import quantity_columns
from rigidfluid.core.run.remarks import Remark

_ROUNDING = 1e-9
_ROUNDING_OF_WAYS = 1e-6
_SAME = 0.02
"""Part of a cycle's displacement or rotation by which the first two may differ without a remark."""


def cycles(history: History, periods: Mapping[str, float]) -> dict[str, dict[str, Any]]:
    """Displacement and rotation of each whole cycle of the mechanisms with these ``periods`` [time], by name.

    Each has its ``period`` [time]; for each whole cycle the ``displacement`` of the centre of mass, a vector [length],
    and the ``rotation``, in 2D an angle, in 3D a rotation vector [rad]. Values are linear between two steps if none
    ends with a cycle.
    """
    names = quantity_columns(history.dimension)
    table = history.table("bodies", ("time", "body", *names["position"], *names["orientation"]))
    return {name: _mechanism_cycles(table, name, period, history.dimension) for name, period in periods.items()}


def start_remarks(found: Mapping[str, Mapping[str, Any]], inertia: bool, length: float) -> list[Remark]:
    """Remark that first cycles of `cycles` differ from second ones, or that nobody can tell, as a fluid with
    ``inertia`` has no second one.

    Displacements below a millionth of the bodies' ``length`` are rounding [length].
    """
    remedy = "Take later cycles: lengthen time.end, and leave the first one out."
    remarks = []
    for name, mine in found.items():
        begins = f"the first cycle of {name!r} contains the start"
        if len(mine["displacement"]) == 1 and inertia:
            remarks.append(Remark("note", f"{begins}, and there is no second one to compare", remedy))
        for figure, least in (("displacement", _ROUNDING_OF_WAYS * length), ("rotation", _ROUNDING_OF_WAYS)):
            sizes = [float(np.linalg.norm(one)) for one in mine[figure][:2]]
            if len(sizes) < 2 or max(sizes) <= least:
                continue
            off = float(np.linalg.norm(np.subtract(*mine[figure][:2])))
            if off > _SAME * sizes[1] and off > least:
                text = f"{begins}: its {figure} is {sizes[0]:.3g}, that of the second {sizes[1]:.3g}"
                text += f", {per_cent(off / sizes[1])} off" if sizes[1] > least else ""
                remarks.append(Remark("note", text, remedy))
    return remarks


def _mechanism_cycles(table: Mapping[str, FloatArray], name: str, period: float, dimension: int) -> dict[str, Any]:
    mine = table["body"] == name
    time, names = table["time"][mine], quantity_columns(dimension)
    whole = int(np.floor(time[-1] / period + _ROUNDING)) if len(time) else 0
    ends = period * np.arange(whole + 1)

    def interpolate(quantity: str) -> FloatArray:
        return np.column_stack([np.interp(ends, time, table[column][mine]) for column in names[quantity]])

    places, turns = interpolate("position"), interpolate("orientation")
    if dimension == 3:
        turns /= np.linalg.norm(turns, axis=1, keepdims=True)
    rotation = rotation_between(turns[:-1], turns[1:])
    return {
        "period": period,
        "displacement": np.diff(places, axis=0).tolist(),
        "rotation": (rotation[:, 0] if dimension == 2 else rotation).tolist(),
    }
