"""Stress on the surfaces of the domain, by the fluid and by contacts."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.post.statistics.blocks import Mean, mean
from rigidfluid.post.statistics.samples import Samples


class WallStresses(NamedTuple):
    """Mean traction τ (d,) on each surface, ``by_surface`` [force/length^(d-1)], and the ``relative_viscosity`` that
    walls feel which slide past each other [1], None without such walls or with a viscosity that varies."""

    by_surface: Mapping[str, Mean]
    relative_viscosity: Mean | None

    def to_dict(self) -> dict[str, Any]:
        """Names and lists."""
        viscosity = self.relative_viscosity
        return {
            "traction": {name: traction.to_list() for name, traction in self.by_surface.items()},
            "relative_viscosity": None if viscosity is None else viscosity.to_list(),
        }


def wall_stresses(samples: Samples, table: Mapping[str, NDArray[Any]]) -> WallStresses | None:
    """Forces in the ``table`` of walls over their areas; None where it has none in these states."""
    known = np.isin(table["step"], samples.step)
    names = sorted(set(table["wall"][known].tolist()))
    tractions = {name: _traction(table, known & (table["wall"] == name), samples.dimension) for name in names}
    if not tractions:
        return None
    slides = None if samples.shear is None else tractions.get(samples.shear.wall)
    viscosity = None if samples.shear is None or slides is None else samples.shear.viscosity_at_wall(slides)
    by_surface = {name: mean(traction) for name, traction in tractions.items()}
    return WallStresses(by_surface, None if viscosity is None else mean(viscosity))


def _traction(table: Mapping[str, NDArray[Any]], rows: NDArray[np.bool_], dimension: int) -> FloatArray:
    """Force of fluid and contacts on one surface over its area, (s, d)."""
    axes = "xyz"[:dimension]
    force = np.stack([table[f"f{axis}"][rows] + table[f"contact_f{axis}"][rows] for axis in axes], axis=1)
    return np.asarray(force / table["area"][rows, None])
