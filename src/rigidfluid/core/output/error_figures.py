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


def error_figures(table: Estimates, dimension: int) -> dict[str, dict[str, dict[str, float | None]]]:
    """Errors by ``mesh`` and by ``steps`` in the last row, and the greatest in any, by body and quantity; None where
    nothing is known."""
    found: dict[str, dict[str, dict[str, float | None]]] = {}
    for body in dict.fromkeys(table["body"].tolist()):
        found[body] = {}
        for quantity in ESTIMATED:
            sizes = {cause: error_sizes(table, body, quantity, cause, dimension) for cause in CAUSES}
            latest = {cause: _known(each[-1:]) for cause, each in sizes.items()}
            greatest = {f"greatest_{cause}": _known(each) for cause, each in sizes.items()}
            found[body][quantity] = latest | greatest
    return found


def error_sizes(table: Estimates, body: str, quantity: str, cause: str, dimension: int) -> FloatArray:
    """Magnitude of the estimated error of a body's ``quantity`` by one ``cause``, a value for each output."""
    names = quantity_columns(dimension)[quantity]
    chosen = table["body"] == body
    return np.asarray(np.linalg.norm([table[f"{name}_{cause}"][chosen] for name in names], axis=0))


def _known(sizes: FloatArray) -> float | None:
    known = sizes[np.isfinite(sizes)]
    return float(known.max()) if len(known) else None
