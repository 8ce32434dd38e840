"""Jumps of the fluid's forces on bodies where a new mesh is made."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.output.history import History
from rigidfluid.core.output.records import quantity_columns
from rigidfluid.core.run.remarks import Remark

_AFTER = 3
"""Steps on a new mesh in which a jump is looked for."""

_START = 5
"""First steps of a run, whose forces are those of the start."""

NOTED = 0.1
"""A jump of more than this share of the range is noted at the end of a run."""

_NOISE = 1e-3
"""Least range of a torque, over that of the force times the body's radius [1]."""


def remesh_jumps(history: History, radii: Mapping[str, float]) -> dict[str, dict[str, float]]:
    """Largest jump of force and torque of each body at new meshes, over the range of each in the run [1].

    A jump is the distance of one of the first steps on a new mesh from the line through the two steps before it. The
    range is the largest less the smallest of a component after the first steps; of a vector the largest one counts. The
    range of a torque is at least a thousandth of the force's times the bounding radius of ``radii``, by name [length]:
    what is less is noise. Empty without new meshes.
    """
    steps = history.table("steps", ("time", "remeshes"))
    first = np.flatnonzero(np.diff(steps["remeshes"]) > 0) + 1
    first = first[first >= _START + 2]
    if not len(first):
        return {}
    names = quantity_columns(history.dimension)
    loads = {load: names[load] for load in ("force", "torque")}
    bodies = history.table("bodies", ("time", "body", *loads["force"], *loads["torque"]))
    found = {}
    for name, radius in radii.items():
        mine = bodies["body"] == name
        time = bodies["time"][mine]
        rows = np.searchsorted(time, steps["time"][first] - 1e-9 * time[-1])
        rows = rows[(rows >= _START + 2) & (rows < len(time))]  # bodies may enter and leave
        if not len(rows):
            continue
        values = {load: np.column_stack([bodies[axis][mine] for axis in axes]) for load, axes in loads.items()}
        extent = {load: float(np.ptp(each[_START:], axis=0).max()) for load, each in values.items()}
        extent["torque"] = max(extent["torque"], _NOISE * radius * extent["force"])
        found[name] = {
            load: _largest_jump(time, each, rows) / extent[load] if extent[load] > 0.0 else 0.0
            for load, each in values.items()
        }
    return found


def jump_remarks(jumps: Mapping[str, Mapping[str, float]]) -> list[Remark]:
    """Note the body whose force, and that whose torque, jumped most by `remesh_jumps`, where that is much."""
    remarks = []
    for load in ("force", "torque"):
        jump, name = max(((each[load], name) for name, each in jumps.items()), default=(0.0, ""))
        if jump > NOTED:
            text = f"the {load} on {name!r} jumped by up to {jump:.0%} of its range in the first steps on a new mesh"
            remedy = "Where no contact did that, set a smaller mesh.size_body."
            remarks.append(Remark("note", text, remedy))
    return remarks


def _largest_jump(time: FloatArray, values: FloatArray, first: IntArray) -> float:
    """Largest jump of ``values`` (s, c) at the rows ``first``."""
    jump = 0.0
    for row in first:
        slope = (values[row - 1] - values[row - 2]) / (time[row - 1] - time[row - 2])
        after = slice(row, row + _AFTER)
        expected = values[row - 1] + np.multiply.outer(time[after] - time[row - 1], slope)
        jump = max(jump, float(np.abs(values[after] - expected).max()))
    return jump
