"""The distribution of the figure over random samples: quantiles and Sobol indices, with each numerical setting."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.post.studies.model import Study
from rigidfluid.post.studies.rows import cells
from rigidfluid.post.studies.sobol import SobolIndex, sobol_indices
from rigidfluid.post.studies.strict_table import Settings

QUANTILES = (0.05, 0.5, 0.95)

Grid = tuple[tuple[str, ...], list[list[object]]]
"""Header and rows of a table."""


@dataclass(frozen=True)
class Sampled:
    """Samples with one numerical setting, the ``variant``: their ``figures`` (n,), nan where a run failed, and the
    Sobol ``indices`` of the parameters, if they are asked for and there are any."""

    variant: Settings
    figures: FloatArray
    indices: dict[str, SobolIndex]

    @property
    def known(self) -> FloatArray:
        """Figures of the runs that did not fail."""
        return self.figures[np.isfinite(self.figures)]

    @property
    def quantiles(self) -> list[float]:
        """Figures below which 5, 50 and 95 % of all lie; nan where all runs failed."""
        found = self.known
        return [float(value) for value in np.quantile(found, QUANTILES)] if len(found) else [np.nan] * len(QUANTILES)


def sampled(study: Study, runs: Iterable[tuple[Settings, float]]) -> list[Sampled]:
    """Samples with each numerical setting; none in a study without random parameters. ``runs``: settings and figure of
    each that is planned, nan where it has none."""
    random = study.tables.random
    if random is None:
        return []
    figures = {_text(settings): figure for settings, figure in runs}
    found = []
    for variant in study.variants:
        values = np.array([figures[_text(group | variant)] for group in study.groups])
        indices = sobol_indices(values, len(study.parameters), random.seed) if random.indices else []
        found.append(Sampled(variant, values, dict(zip(study.parameters, indices, strict=False))))
    return found


def quantile_table(knobs: Sequence[str], samples: Sequence[Sampled]) -> Grid:
    """Quantiles of the figure, a row for each numerical setting, whose keys are ``knobs``."""
    rows = [[*cells(knobs, one.variant), len(one.known), len(one.figures), *one.quantiles] for one in samples]
    return (*knobs, "complete", "runs", *(f"quantile_{part:g}" for part in QUANTILES)), rows


def index_table(knobs: Sequence[str], samples: Sequence[Sampled]) -> Grid:
    """Sobol indices, a row for each numerical setting and parameter."""
    rows: list[list[object]] = [
        [*cells(knobs, one.variant), name, index.first, index.first_confidence, index.total, index.total_confidence]
        for one in samples
        for name, index in one.indices.items()
    ]
    return (*knobs, "parameter", "first", "first_confidence", "total", "total_confidence"), rows


def _text(settings: Settings) -> str:
    return json.dumps(settings, sort_keys=True, default=str)
