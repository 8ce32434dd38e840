"""Bodies that no force can tell apart: one atom type of LAMMPS each."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigidfluid.api import FloatArray, IntArray, System
from rigidfluid_lammps.errors import CrosscheckError

MOST_KINDS = 12
"""A law needs a table for each pair of kinds."""


@dataclass(frozen=True)
class Kinds:
    """Kinds of balls: ``number`` (n,), the kind of each ball, from 1 on; ``first`` (K,), the first ball of a kind."""

    number: IntArray
    first: IntArray

    def __len__(self) -> int:
        return len(self.first)


def radii(system: System) -> FloatArray:
    """Radii of the balls (n,) [length]."""
    return np.array([body.bounding_radius for body in system.bodies])


def kinds(system: System) -> Kinds:
    """Sort the balls by radius, mass, weight and loads of the law; raises CrosscheckError above `MOST_KINDS` kinds."""
    features = [radii(system), system.mass, *system.weight.T]
    loads = None if system.law is None else system.law.loads
    if loads is not None:
        features += [loads.mass, loads.weight, loads.speed]
    _, first, number = np.unique(np.column_stack(features), axis=0, return_index=True, return_inverse=True)
    if len(first) > MOST_KINDS:
        raise CrosscheckError(
            "body",
            f"{len(first)} kinds of balls, by radius, density and load",
            f"at most {MOST_KINDS}, since a law needs a table for each pair of them",
            "Let more balls be alike.",
        )
    return Kinds(number.reshape(-1).astype(np.int64) + 1, first)
