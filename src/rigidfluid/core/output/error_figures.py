"""Error bars of a run in figures: the latest and the greatest of each body and quantity."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.output.records import CAUSES, ESTIMATED, quantity_columns

Estimates = Mapping[str, NDArray[Any]]
"""The table of error_estimates.csv by column."""

SAFETY = 1.25
"""Error bar over the estimated error, by Roache's grid convergence index (1994, doi:10.1115/1.2910291) [1]."""


def error_bars(by_mesh: FloatArray, by_steps: FloatArray) -> FloatArray:
    """Error bars of sizes of errors by the mesh and by the steps, or by the mesh alone where the others are unknown."""
    return SAFETY * (by_mesh + np.nan_to_num(by_steps))


def error_figures(table: Estimates, dimension: int) -> dict[str, dict[str, dict[str, float | None]]]:
    """Errors by ``mesh`` and by ``steps`` in the last row with their ``bar``, and the greatest in any, by body and
    quantity; None where nothing is known."""
    found: dict[str, dict[str, dict[str, float | None]]] = {}
    for body in dict.fromkeys(table["body"].tolist()):
        found[body] = {}
        for quantity in ESTIMATED:
            sizes = {cause: error_sizes(table, body, quantity, cause, dimension) for cause in CAUSES}
            latest = {cause: _known(each[-1:]) for cause, each in sizes.items()}
            greatest = {f"greatest_{cause}": _known(each) for cause, each in sizes.items()}
            bar = _known(error_bars(*(sizes[cause][-1:] for cause in CAUSES)))
            found[body][quantity] = {"bar": bar} | latest | greatest
    return found


def error_sizes(table: Estimates, body: str, quantity: str, cause: str, dimension: int) -> FloatArray:
    """Magnitude of the estimated error of a body's ``quantity`` by one ``cause``, a value for each output."""
    names = quantity_columns(dimension)[quantity]
    chosen = table["body"] == body
    return np.asarray(np.linalg.norm([table[f"{name}_{cause}"][chosen] for name in names], axis=0))


def _known(sizes: FloatArray) -> float | None:
    known = sizes[np.isfinite(sizes)]
    return float(known.max()) if len(known) else None
