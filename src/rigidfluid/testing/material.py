"""Contract tests of a material."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
import pytest

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.generalised_newtonian import GeneralisedNewtonian


class MaterialContract:
    """Viscosities of one material over all shear rates, from a fluid at rest to 10¹² of its units.

    Override the fixture ``material``; parametrise it to hold several to the same standard.
    """

    stress_grows: ClassVar[bool] = True
    """Whether the stress grows with the shear rate, without which a step may have several solutions."""

    @pytest.fixture
    def material(self) -> GeneralisedNewtonian:
        """The material under test."""
        raise NotImplementedError("override the fixture `material`")

    @pytest.fixture
    def rates(self) -> FloatArray:
        """Shear rates, the first of them zero, (N,) [1/time]."""
        return np.concatenate([[0.0], np.logspace(-12.0, 12.0, 241)])

    def test_viscosities_are_positive_and_finite(self, material: GeneralisedNewtonian, rates: FloatArray) -> None:
        """One viscosity for each shear rate, also where there is none; else the interface raises."""
        material.viscosity(rates)
        material.viscosity(rates[:0])

    def test_the_viscosity_for_scales_is_one_of_them(self, material: GeneralisedNewtonian, rates: FloatArray) -> None:
        """`dynamic_viscosity` lies between the least and the greatest."""
        viscosity = material.viscosity(rates)
        assert viscosity.min() * (1.0 - 1e-6) <= material.dynamic_viscosity <= viscosity.max() * (1.0 + 1e-6)

    def test_the_stress_grows_with_the_shear_rate(self, material: GeneralisedNewtonian, rates: FloatArray) -> None:
        """μ γ̇ does, unless the class says otherwise by ``stress_grows``."""
        if not self.stress_grows:
            pytest.skip("its stress may fall")
        assert np.all(np.diff(material.viscosity(rates) * rates) > 0.0)

    def test_viscosities_are_smooth(self, material: GeneralisedNewtonian, rates: FloatArray) -> None:
        """Derivatives by log γ̇ over two small differences agree; Newton's iteration needs them."""
        near, far = (_slope(material, rates[1:], half) for half in (1e-5, 1e-3))
        np.testing.assert_allclose(near, far, atol=1e-4 * float(material.viscosity(rates).max()))

    def test_each_viscosity_is_of_its_shear_rate_alone(self, material: GeneralisedNewtonian, rates: FloatArray) -> None:
        """In another order, or without the others, shear rates have the same viscosities, but for rounding."""
        viscosity = np.array(material.viscosity(rates))
        order = np.random.default_rng(0).permutation(len(rates))
        np.testing.assert_allclose(material.viscosity(rates[order]), viscosity[order], rtol=1e-12)
        np.testing.assert_allclose(material.viscosity(rates[:3]), viscosity[:3], rtol=1e-12)

    def test_it_changes_and_remembers_nothing(self, material: GeneralisedNewtonian, rates: FloatArray) -> None:
        """Shear rates stay as they are; asked again after others, it answers the same to the last bit."""
        given = rates.copy()
        viscosity = np.array(material.viscosity(given))
        np.testing.assert_array_equal(given, rates)
        material.viscosity(2.0 * rates)
        np.testing.assert_array_equal(material.viscosity(rates), viscosity)


def _slope(material: GeneralisedNewtonian, rates: FloatArray, half: float) -> FloatArray:
    """Derivative of the viscosity by log γ̇, over twice the difference ``half``, (N,)."""
    upper, lower = (material.viscosity(rates * (1.0 + sign * half)) for sign in (1.0, -1.0))
    return np.asarray((upper - lower) / (2.0 * half))
