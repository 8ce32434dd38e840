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
    sizes = {
        quantity: {cause: _error_sizes(table, quantity, cause, dimension) for cause in CAUSES} for quantity in ESTIMATED
    }
    rows: dict[str, list[int]] = {}
    for row, body in enumerate(table["body"].tolist()):
        rows.setdefault(body, []).append(row)
    return {
        body: {
            quantity: _figures({cause: each[chosen] for cause, each in causes.items()})
            for quantity, causes in sizes.items()
        }
        for body, chosen in rows.items()
    }


def _figures(sizes: Mapping[str, FloatArray]) -> dict[str, float | None]:
    """Figures of the ``sizes`` (o,) of the errors of one quantity of one body by cause, over the outputs."""
    latest = {cause: _known(each[-1:]) for cause, each in sizes.items()}
    greatest = {f"greatest_{cause}": _known(each) for cause, each in sizes.items()}
    bar = _known(error_bars(*(sizes[cause][-1:] for cause in CAUSES)))
    return {"bar": bar} | latest | greatest


def _error_sizes(table: Estimates, quantity: str, cause: str, dimension: int) -> FloatArray:
    """Magnitude (rows,) of the estimated error of a ``quantity`` by one ``cause``."""
    names = quantity_columns(dimension)[quantity]
    return np.asarray(np.linalg.norm([table[f"{name}_{cause}"] for name in names], axis=0))


def _known(sizes: FloatArray) -> float | None:
    known = sizes[np.isfinite(sizes)]
    return float(known.max()) if len(known) else None
