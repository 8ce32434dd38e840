"""Films of fluids whose viscosity varies: the resistance of the whole film, and what it takes of an impact."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad
from touching import contact, unstacked

from rigidfluid.core.contact.laws.stokes_number import stokes_number, stokes_number_taken
from rigidfluid.core.fluid.material import Material, Newtonian
from rigidfluid.core.mechanics.film_viscosity import film_viscosity
from rigidfluid.core.model.types import Film
from rigidfluid.materials.carreau import Carreau, CarreauOptions
from rigidfluid.materials.power_law import PowerLaw, PowerLawOptions

GAP, SPEED, RADIUS = 1e-4, 0.7, 2.0
LOADS = unstacked(np.ones(1), np.zeros(1), np.array([SPEED]), 0.1)


def carreau(dimension: int, exponent: float = 0.5) -> Carreau:
    options = CarreauOptions(viscosity=3.0, viscosity_infinite=0.03, relaxation_time=0.4, exponent=exponent)
    return Carreau(options, dimension)


def film(material: Material, gap: float, dimension: int, closing: float = SPEED, passing: float = 0.0) -> float:
    columns = (np.array([value]) for value in (gap, RADIUS, closing, passing))
    return float(film_viscosity(material, *columns, dimension)[0])


def power_law_force(exponent: float, consistency: float, dimension: int) -> float:
    """Force by the exact flow between two plates at each place of a squeezed film whose gap is a parabola, up to R."""

    def pressed(place: float) -> float:
        r = np.sqrt(2.0 * RADIUS * GAP) * np.exp(place)
        width = GAP + 0.5 * r**2 / RADIUS
        flux = SPEED * (0.5 * r if dimension == 3 else r)
        rate = (2.0 * exponent + 1.0) / exponent * 2.0 * flux / width**2
        gradient = 2.0 * consistency / width * rate**exponent
        return float((np.pi * r**2 if dimension == 3 else 2.0 * r) * gradient * r)

    return float(quad(pressed, -12.0, 0.5 * np.log(0.5 * RADIUS / GAP), limit=400)[0])


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize(("exponent", "within"), [(0.5, 0.09), (0.7, 0.03), (0.9, 0.005), (1.1, 0.005), (1.5, 0.02)])
def test_a_squeezed_film_of_a_power_law_resists_as_in_the_exact_solution(
    exponent: float, within: float, dimension: int
) -> None:
    options = PowerLawOptions(viscosity=0.3, shear_rate=1.0, exponent=exponent, least_shear_rate=1e-6)
    found = film(PowerLaw(options, dimension), GAP, dimension)
    newtonian = 6.0 * np.pi * RADIUS**2 / GAP if dimension == 3 else 3.0 * np.sqrt(2.0) * np.pi * (RADIUS / GAP) ** 1.5
    assert found * newtonian * SPEED == pytest.approx(power_law_force(exponent, 0.3, dimension), rel=within)


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_film_at_rest_has_the_viscosity_at_rest_and_a_fast_one_that_of_fast_shear(dimension: int) -> None:
    material = carreau(dimension)
    assert film(material, 0.1, dimension, closing=0.0) == pytest.approx(3.0)
    assert film(material, 0.1, dimension, closing=1e14) == pytest.approx(0.03, rel=0.01)
    slides = film(material, 0.1, dimension, closing=0.0, passing=0.5)
    assert film(material, 0.1, dimension, closing=0.5, passing=0.5) < slides < 3.0
    assert material.viscosity(np.array([5.0]))[0] < slides


def test_one_viscosity_is_that_of_any_film() -> None:
    assert film(Newtonian(0.7), 0.1, 3, closing=50.0) == 0.7


@pytest.mark.parametrize("dimension", [2, 3])
def test_an_impact_at_the_edge_has_the_stokes_number_of_the_local_viscosity(dimension: int) -> None:
    touching = contact(0.01, RADIUS, np.inf, dimension)
    held = Film(carreau(dimension), np.array([RADIUS]), 0.0, True)
    one = replace(held, material=Newtonian(film(held.material, RADIUS, dimension)))
    assert stokes_number(touching, held, LOADS) == pytest.approx(stokes_number(touching, one, LOADS))


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_film_that_thins_takes_what_its_resistance_at_each_gap_does(dimension: int) -> None:
    touching = contact(0.01, RADIUS, np.inf, dimension)
    held = Film(carreau(dimension), np.array([RADIUS]), 0.0, True)
    one = replace(held, material=Newtonian(1.0))
    edge, gaps = film(held.material, RADIUS, dimension), RADIUS * np.geomspace(1e-3, 1.0, 400)
    each = np.diff([-float(stokes_number_taken(touching, one, LOADS, gap)[0]) for gap in gaps])
    relative = np.array([film(held.material, gap, dimension) / edge for gap in np.sqrt(gaps[1:] * gaps[:-1])])
    found = float(stokes_number_taken(touching, held, LOADS, gaps[0])[0])
    assert found == pytest.approx(float(each @ relative), rel=1e-4)
    assert found < 0.8 * each.sum()
    same = replace(held, material=carreau(dimension, exponent=1.0))
    assert stokes_number_taken(touching, same, LOADS, gaps[0]) == pytest.approx(each.sum(), rel=1e-6)
