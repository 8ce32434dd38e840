"""Fluid whose viscosity is a formula in the shear rate."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from pydantic import Field

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.generalised_newtonian import GeneralisedNewtonian
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.nested.expressions import formula
from rigidfluid.errors import SceneError, StepRejected


class ExpressionOptions(PartOptions):
    """Keys of a ``[fluid.material]`` table with type ``expression``."""

    viscosity: str = Field(
        description="Expression of `shear_rate` and `pi`, positive and finite also at rest [mass·length^(2-d)/time]"
    )


class ExpressionMaterial(GeneralisedNewtonian):
    """μ as an expression gives it, by the same operators and functions as boundary data."""

    name: ClassVar[str] = "expression"
    Options: ClassVar[type[PartOptions]] = ExpressionOptions
    options: ExpressionOptions

    def __init__(self, options: ExpressionOptions, dimension: int) -> None:
        super().__init__(options, dimension)
        self._formula = formula(options.viscosity, "viscosity", "shear_rate")
        self.dynamic_viscosity = float(self._formula(np.zeros(1))[0])
        if not 0.0 < self.dynamic_viscosity < np.inf:
            found = f"{self.dynamic_viscosity} at rest from {options.viscosity!r}"
            remedy = "Bound it there, as with max(shear_rate, 0.01)."
            raise SceneError("viscosity", found, "a finite number above 0", remedy)

    def viscosity(self, shear_rate: FloatArray) -> FloatArray:
        """μ, (N,) [mass·length^(2-d)/time]."""
        found = self._formula(shear_rate)
        wrong = np.flatnonzero(~((found > 0.0) & (found < np.inf)))
        if len(wrong):
            value, rate = found[wrong[0]], shear_rate[wrong[0]]
            told = f"{value:.3g} at a shear rate of {rate:.3g} from {self.options.viscosity!r}"
            remedy = "Bound it there, as with max(…), or shorten time.step if the step is too long for such rates."
            raise StepRejected("fluid.material.viscosity", told, "a finite number above 0", remedy)
        return found
