"""Stress that bodies add to that of the fluid, and the viscosity of a suspension in shear."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.shear import Shear
from rigidfluid.core.mechanics.suspension import symmetric
from rigidfluid.post.statistics.blocks import Mean, mean
from rigidfluid.post.statistics.samples import Samples


class StressFigures(NamedTuple):
    """Figures of one cause of stress: ``stress`` Σ (d, d) and ``pressure`` -tr Σ/d [force/length^(d-1)]; between walls
    that shear ``differences`` (d - 1,), N₁ and in 3D N₂ [force/length^(d-1)], and in a Newtonian fluid ``viscosity``,
    its part of that of the suspension over the fluid's [1]."""

    stress: Mean
    pressure: Mean
    differences: Mean | None
    viscosity: Mean | None

    def to_dict(self) -> dict[str, Any]:
        """Names and lists."""
        found = zip(self._fields, self, strict=True)
        return {name: None if value is None else value.to_list() for name, value in found}


class SuspensionStress(NamedTuple):
    """Stress of the bodies ``by_cause``, ``fluid``, ``contacts``, ``lubrication`` where a law gives it, and ``total``;
    and between walls that shear, the ``shear_rate`` [1/time] and in a Newtonian fluid the ``relative_viscosity`` [1],
    None without these."""

    by_cause: Mapping[str, StressFigures]
    shear_rate: float | None
    relative_viscosity: Mean | None

    def to_dict(self) -> dict[str, Any]:
        """Names, numbers and lists."""
        viscosity = self.relative_viscosity
        return {
            **{cause: figures.to_dict() for cause, figures in self.by_cause.items()},
            "shear_rate": self.shear_rate,
            "relative_viscosity": None if viscosity is None else viscosity.to_list(),
        }


def suspension_stress(
    samples: Samples, table: Mapping[str, NDArray[Any]], by_contacts: Mapping[str, FloatArray]
) -> SuspensionStress | None:
    """Mean stress of the bodies that move; None where the ``table`` of stresslets has none in these states.

    Σ = ΣS/V + Σᶜ with the stresslets S of the bodies and the symmetric parts of the stresses Σᶜ ``by_contacts`` (s, d,
    d); between walls that slide past each other at a rate γ the viscosity is 1 + t·Σ·n/(μγ) times the fluid's. It is
    that of bodies on which no other forces act, in a fluid without inertia. Stresses are positive in tension, N₁ =
    t·Σ·t - n·Σ·n and N₂ = n·Σ·n - w·Σ·w, with t along the flow, n across and w along the vorticity.

    Notes
    -----
    Batchelor, J. Fluid Mech. 41 (1970) 545, doi:10.1017/S0022112070000745; signs as Seto and Giusteri, J. Fluid Mech.
    857 (2018) 200, arXiv:1806.09423.
    """
    by_fluid = _sums(samples, table) / samples.volume
    known = np.isfinite(by_fluid).all(axis=(1, 2))
    if not known.any():
        return None
    causes = {"fluid": by_fluid} | {cause: symmetric(stress) for cause, stress in by_contacts.items()}
    causes["total"] = np.sum(list(causes.values()), axis=0)
    shear = samples.shear
    figures = {cause: _figures(stress[known], shear) for cause, stress in causes.items()}
    added = figures["total"].viscosity
    relative = None if added is None else added._replace(value=1.0 + added.value)
    return SuspensionStress(figures, None if shear is None else shear.rate, relative)


def _figures(stress: FloatArray, shear: Shear | None) -> StressFigures:
    """Figures of one cause by its ``stress`` (s, d, d)."""
    pressure = mean(-np.trace(stress, axis1=1, axis2=2) / stress.shape[1])
    if shear is None:
        return StressFigures(mean(stress), pressure, None, None)
    differences, viscosity = mean(shear.normal_differences(stress)), shear.added_viscosity(stress)
    return StressFigures(mean(stress), pressure, differences, None if viscosity is None else mean(viscosity))


def _sums(samples: Samples, table: Mapping[str, NDArray[Any]]) -> FloatArray:
    """Sum of the stresslets of the bodies that move in each state (s, d, d) [force·length]; not a number where they are
    not known."""
    d = samples.dimension
    rows, columns = np.triu_indices(d)
    states = np.searchsorted(samples.step, table["step"])
    known = (states < len(samples.step)) & np.isin(table["body"], samples.name)
    known[known] = samples.step[states[known]] == table["step"][known]
    sums, count = np.zeros((len(samples.step), d, d)), np.bincount(states[known], minlength=len(samples.step))
    for row, column in zip(rows, columns, strict=True):
        np.add.at(sums[:, row, column], states[known], table[f"s{'xyz'[row]}{'xyz'[column]}"][known])
    sums[:, columns, rows] = sums[:, rows, columns]
    sums[count != samples.count] = np.nan
    return sums
