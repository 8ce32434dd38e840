"""Materials that no flow could be solved with, and what the contract says of them."""

import numpy as np
import pytest

from rigidfluid.api import GeneralisedNewtonian, PartOptions
from rigidfluid.errors import PluginError, StepRejected
from rigidfluid.testing import MaterialContract


class Thinning(GeneralisedNewtonian):
    """μ = 1/(1 + γ̇) + .1."""

    name = "thinning"
    dynamic_viscosity = 1.0

    def viscosity(self, shear_rate):
        return 1.0 / (1.0 + shear_rate) + 0.1


class Scaled(Thinning):
    dynamic_viscosity = 50.0


class Falling(Thinning):
    """Its stress has a greatest value."""

    def viscosity(self, shear_rate):
        return 1.0 / (1.0 + shear_rate**2) + 1e-13


class Jumping(Thinning):
    def viscosity(self, shear_rate):
        return np.where(shear_rate < 1.0, 1.0, 0.7) * super().viscosity(shear_rate)


class Ranked(Thinning):
    """Relative to the greatest shear rate asked for."""

    def viscosity(self, shear_rate):
        return 0.1 + 1.0 / (1.0 + shear_rate / (1.0 + np.max(shear_rate, initial=0.0)))


class Mover(Thinning):
    def viscosity(self, shear_rate):
        shear_rate += 1e-3
        return super().viscosity(shear_rate)


class Remembering(Thinning):
    asked = 0

    def viscosity(self, shear_rate):
        self.asked += 1
        return (1.0 + self.asked) * super().viscosity(shear_rate)


class Ideal(Thinning):
    """Infinite at rest."""

    def viscosity(self, shear_rate):
        with np.errstate(divide="ignore"):
            return 1.0 + 1.0 / shear_rate


class Negative(Thinning):
    def viscosity(self, shear_rate):
        return 1.0 - shear_rate


class Column(Thinning):
    def viscosity(self, shear_rate):
        return super().viscosity(shear_rate)[:, None]


def made(kind):
    return kind(PartOptions(), 2)


def rates():
    return MaterialContract.rates.__wrapped__(MaterialContract())


@pytest.mark.parametrize(
    ("kind", "found"),
    [
        (Scaled, "test_the_viscosity_for_scales_is_one_of_them"),
        (Falling, "test_the_stress_grows_with_the_shear_rate"),
        (Jumping, "test_viscosities_are_smooth"),
        (Ranked, "test_each_viscosity_is_of_its_shear_rate_alone"),
        (Mover, "test_it_changes_and_remembers_nothing"),
        (Remembering, "test_it_changes_and_remembers_nothing"),
    ],
)
def test_each_flaw_is_found(kind, found):
    contract = MaterialContract()
    with pytest.raises(AssertionError):
        getattr(contract, found)(made(kind), rates())
    getattr(contract, found)(made(Thinning), rates())


@pytest.mark.parametrize(
    ("kind", "error", "found"),
    [
        (Ideal, StepRejected, "viscosity: found .*inf"),
        (Negative, PluginError, "viscosity: found .*; allowed is numbers above 0"),
        (Column, PluginError, r"viscosity: found .* of shape \(242,\)"),
    ],
)
def test_viscosities_that_are_none_are_refused_by_name(kind, error, found):
    with pytest.raises(error, match=f"material 'thinning', {found}"):
        made(kind).viscosity(rates())
