"""Sobol indices by SALib: the points that they need, and what they are."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.errors import SceneError

CONSTANT = 1e-12
"""Spread of figures, over their size, below which they are alike but for round-off."""

RESAMPLES = 1000
"""Resamples from which the half-width of a 95 % confidence interval is estimated."""


@dataclass(frozen=True)
class SobolIndex:
    """Part of the figure's variance that a parameter brings: alone (``first``), and with all that it acts together with
    (``total``); each with the half-width of its 95 % confidence interval."""

    first: float
    first_confidence: float
    total: float
    total_confidence: float


def block_length(parameters: int) -> int:
    """Runs for each sample: two independent ones, and one for each parameter in which it is exchanged."""
    return parameters + 2


def require_salib() -> None:
    """Raise SceneError where SALib is missing."""
    try:
        import SALib  # noqa: F401
    except ImportError:
        remedy = "Install it: pip install 'rigidfluid[sweeps]'; or set indices = false."
        raise SceneError("random.indices", "true without SALib", "true where SALib is installed", remedy) from None


def sobol_points(number: int, parameters: int, seed: int) -> FloatArray:
    """Points (number · block, parameters) in the unit cube: Saltelli's blocks of a scrambled Sobol sequence."""
    from SALib.sample import sobol

    return np.asarray(sobol.sample(_problem(parameters), number, calc_second_order=False, seed=seed))


def sobol_indices(figures: FloatArray, parameters: int, seed: int) -> list[SobolIndex]:
    """Indices of each parameter from the ``figures`` (number · block,) at those points, nan where a run failed; blocks
    with one are left out. None where two blocks do not remain, or where all figures are alike."""
    from SALib.analyze import sobol

    blocks = figures.reshape(-1, block_length(parameters))
    blocks = blocks[np.isfinite(blocks).all(axis=1)]
    if len(blocks) < 2 or np.ptp(blocks[:, [0, -1]]) <= CONSTANT * np.abs(blocks).max():
        return []
    found = sobol.analyze(
        _problem(parameters),
        blocks.ravel(),
        calc_second_order=False,
        num_resamples=RESAMPLES,
        seed=seed + 1,  # SALib takes 0 for none
    )
    columns = (found[name].tolist() for name in ("S1", "S1_conf", "ST", "ST_conf"))
    return [SobolIndex(*values) for values in zip(*columns, strict=True)]


def _problem(parameters: int) -> dict[str, Any]:
    names = [f"x{number}" for number in range(parameters)]
    return {"num_vars": parameters, "names": names, "bounds": [[0.0, 1.0]] * parameters}
