from dataclasses import replace

import bispherical
import numpy as np
import pytest
from approach import approach
from published import brenner, drag_of_approach
from touching import NORMAL, contact, unstacked

from rigidfluid.core.fluid.material import Material, Newtonian
from rigidfluid.core.model.types import Film, Motion
from rigidfluid.errors import SceneError
from rigidfluid.forces.film_resistance import film_resistance
from rigidfluid.forces.lubrication import LubricationLaw, LubricationOptions
from rigidfluid.materials.carreau import Carreau, CarreauOptions

VISCOSITY, RADIUS = 0.7, 2.0
CENTRES = {"wall": np.inf, "equal": 1.0, "smaller": 0.5, "far smaller": 0.1, "larger": 3.0}
"""Radius of b by that of a."""


def law(range_: float, cutoff: float = 1e-9, sliding: bool = True) -> LubricationLaw:
    return LubricationLaw(LubricationOptions(viscosity=VISCOSITY, cutoff=cutoff, sliding=sliding), range_)


def resistance(law: LubricationLaw, gap: float, radius_a: float, radius_b: float, dimension: int) -> float:
    """Force on a over the speed towards b, against the motion."""
    touching = contact(gap, radius_a, radius_b, dimension)
    pushed = law.damping(touching, Motion(-3.0 * touching.normal, np.ones(1)))
    np.testing.assert_allclose(pushed, np.linalg.norm(pushed) * touching.normal)
    return float(np.linalg.norm(pushed)) / 3.0


def cylinder_at_wall(gap: float) -> float:
    """Jeffrey and Onishi 1981: force on a cylinder per length and speed onto a wall."""
    alpha = np.arccosh(1 + gap / RADIUS)
    return float(4 * np.pi * VISCOSITY / (alpha - np.tanh(alpha)))


@pytest.mark.parametrize(("sliding", "within"), [(True, 1e-3), (False, 0.02)])
@pytest.mark.parametrize("gap", [0.05, 0.01, 1e-3])
def test_sphere_at_wall_grows_as_in_the_exact_solution(gap: float, sliding: bool, within: float) -> None:
    exact = 6 * np.pi * VISCOSITY * RADIUS * (brenner(gap) - brenner(0.1))
    found = resistance(law(0.1 * RADIUS, sliding=sliding), gap * RADIUS, RADIUS, np.inf, 3)
    assert found == pytest.approx(exact, rel=within)


@pytest.mark.parametrize("gap", [0.05, 0.01, 1e-3])
def test_equal_spheres_grow_as_in_the_exact_solution(gap: float) -> None:
    exact = 3 * np.pi * VISCOSITY * RADIUS * (drag_of_approach(gap) - drag_of_approach(0.1))
    assert resistance(law(0.1 * RADIUS), gap * RADIUS, RADIUS, RADIUS, 3) == pytest.approx(exact, rel=4e-3)


@pytest.mark.parametrize("gap", [0.05, 0.01, 1e-3, 1e-4])
@pytest.mark.parametrize("radius_b", [1.0, 0.5, 0.1, 3.0])
def test_unequal_spheres_that_nothing_else_holds_grow_as_in_the_exact_solution(gap: float, radius_b: float) -> None:
    size = 1.0 / (1.0 + 1.0 / radius_b)
    thin, thick = (
        1.0 / (np.array([1.0, -1.0]) @ np.linalg.solve(approach(part * size, radius_b), [1.0, -1.0]))
        for part in (gap, 0.1)
    )
    found = resistance(law(0.1 * size * RADIUS), gap * size * RADIUS, RADIUS, radius_b * RADIUS, 3)
    assert found == pytest.approx(VISCOSITY * RADIUS * (thin - thick), rel=1e-2)


def test_spheres_on_a_line_have_the_exact_forces() -> None:
    """Two equal ones of Brenner's series, and two far apart of Stokes' law and Oseen's tensor."""
    assert approach(0.1, 1.0) @ [1.0, -1.0] == pytest.approx(6 * np.pi * drag_of_approach(0.1) * np.array([1, -1]))
    far = 6 * np.pi * np.array([[1.0, -6e-4], [-6e-4, 4.0]])
    np.testing.assert_allclose(approach(1e4, 4.0), far, rtol=1e-3)


def along_and_turning(law: LubricationLaw, gap: float, radius_b: float) -> np.ndarray:
    """Resistances (2, 2) to sliding across the plane of the normal, and to rolling n × w there."""
    touching, across = contact(gap, RADIUS, radius_b, 3), np.array([[0.0, 0.0, 1.0]])
    about = np.cross(across, touching.normal)
    np.testing.assert_allclose(np.cross(touching.normal, about), across)
    columns = []
    for motion in (Motion(across, np.ones(1)), Motion(np.zeros((1, 3)), np.ones(1), about)):
        force, couple = law.damping(touching, motion), law.couple(touching, motion)
        np.testing.assert_allclose(force, np.sum(force * across) * across, atol=1e-12)
        np.testing.assert_allclose(couple, np.sum(couple * about) * about, atol=1e-12)
        columns.append([-np.sum(force * across), -np.sum(couple * about)])
    return np.transpose(columns)


@pytest.mark.parametrize("gap", [0.05, 0.01, 1e-3, 1e-4])
@pytest.mark.parametrize("radius_b", CENTRES.values(), ids=CENTRES)
def test_spheres_that_slide_and_roll_are_resisted_as_in_the_exact_solution(gap: float, radius_b: float) -> None:
    """From a tenth of the effective radius on; the coupling is compared with the geometric mean of both others."""
    size = 1.0 / (1.0 + 1.0 / radius_b)
    found = along_and_turning(law(0.1 * size * RADIUS), gap * size * RADIUS, radius_b * RADIUS)
    thin, thick = (bispherical.film_resistance(part * size, radius_b) for part in (gap, 0.1))
    exact = VISCOSITY * (thin - thick) * RADIUS ** np.array([[1, 2], [2, 3]])
    scale = np.sqrt(np.outer(exact.diagonal(), exact.diagonal()))
    np.testing.assert_allclose(found / scale, exact / scale, rtol=0, atol=0.01)


def test_disks_that_slide_and_roll_are_resisted_as_in_the_exact_solution() -> None:
    """Jeffrey & Onishi 1981: a cylinder at a wall has the resistances 4πμ/α to motion and 4πμ r² coth α to turning,
    cosh α = 1 + h/r, and no force by turning."""

    def exact(gap: float) -> np.ndarray:
        alpha, arm = np.arccosh(1.0 + gap), RADIUS * (1.0 + 0.5 * gap)
        own = 4.0 * np.pi * VISCOSITY * np.diag([1.0 / alpha, RADIUS**2 / np.tanh(alpha)])
        to_own = np.array([[1.0, -arm], [0.0, -1.0]])  # of U and ω from v and n × w
        return np.asarray(to_own.T @ own @ to_own)

    touching, expected = contact(1e-4 * RADIUS, RADIUS, np.inf), exact(1e-4) - exact(0.01)
    along = np.array([[-0.8, 0.6]])
    for column, motion in enumerate(
        (Motion(along, np.ones(1)), Motion(np.zeros((1, 2)), np.ones(1), np.array([[-1.0]])))
    ):
        law_ = law(0.01 * RADIUS)
        force, couple = law_.damping(touching, motion), law_.couple(touching, motion)
        assert -np.sum(force * along) == pytest.approx(expected[0, column], rel=2e-3)
        assert couple[0, 0] == pytest.approx(expected[1, column], rel=2e-3)


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("unlike", [0.0, -0.5, -1.0, -1.8, -3.0, -10.0, -100.0])
def test_no_motion_gains_energy_not_even_in_a_hollow(unlike: float, dimension: int) -> None:
    """δ is below -1 there, which no term but the leading ones is for; at -1.8 they would give energy."""
    radius = 0.5 * (1.0 - unlike)
    inverse_b = 1.0 / radius - 1.0
    radius_b = 1.0 / inverse_b if inverse_b else np.inf
    for thin, thick in ((1e-3, 0.1), (0.15, 0.19), (0.1, 3.0)):
        gaps = np.array([thin, thick]) * radius
        film, end = (film_resistance(np.array([gap]), np.ones(1), np.array([radius_b]), dimension) for gap in gaps)
        beyond = film.beyond(end)
        assert min(beyond.squeezing[0], beyond.sliding[0], beyond.rolling[0]) > 0.0
        assert beyond.coupling[0] ** 2 <= (1.0 + 1e-12) * beyond.sliding[0] * beyond.rolling[0]


@pytest.mark.parametrize("radius_b", CENTRES.values(), ids=CENTRES.keys())
@pytest.mark.parametrize("gap", [0.05, 0.01, 1e-3, 1e-4])
def test_spheres_that_twist_are_resisted_as_in_the_exact_solution(gap: float, radius_b: float) -> None:
    """To .3 % of the whole resistance, of which most is that at range."""
    touching = contact(gap * RADIUS * _part(radius_b), RADIUS, radius_b * RADIUS, 3)
    motion = Motion(np.zeros((1, 3)), np.ones(1), -1.5 * touching.normal)
    law_ = law(0.1 * RADIUS * _part(radius_b))
    thin, thick = (bispherical.twisting_resistance(one * _part(radius_b), radius_b) for one in (gap, 0.1))
    np.testing.assert_allclose(law_.damping(touching, motion), 0.0, atol=1e-12)
    added = np.sum(law_.couple(touching, motion) * touching.normal) / (1.5 * VISCOSITY * RADIUS**3)
    assert added == pytest.approx(thin - thick, rel=0.0, abs=3e-3 * thin)
    assert added > 0.0


def _part(radius_b: float) -> float:
    """Effective radius over that of a."""
    return 1.0 / (1.0 + 1.0 / radius_b)


def test_twisting_beside_a_wall_is_that_of_the_zeta_function_in_contact() -> None:
    assert bispherical.twisting_resistance(1e-7, np.inf) == pytest.approx(8.0 * np.pi * 1.2020569, rel=1e-5)
    halves = [bispherical.twisting_resistance(gap, 1.0) for gap in (0.2, 40.0)]
    assert halves[0] == pytest.approx(0.5 * bispherical.twisting_resistance(0.1, np.inf), rel=1e-9)  # plane half-way
    assert halves[1] == pytest.approx(4.0 * np.pi, rel=1e-4)


@pytest.mark.parametrize("gap", [1e-2, 1e-4])
def test_cylinder_at_wall_grows_as_in_the_exact_solution(gap: float) -> None:
    exact = cylinder_at_wall(gap * RADIUS) - cylinder_at_wall(0.1 * RADIUS)
    assert resistance(law(0.1 * RADIUS), gap * RADIUS, RADIUS, np.inf, 2) == pytest.approx(exact, rel=2 * gap)


@pytest.mark.parametrize("dimension", [2, 3])
def test_two_balls_are_one_of_the_effective_radius_at_a_wall(dimension: int) -> None:
    """Of the leading term, which is all in 2D."""
    film = law(0.1, sliding=dimension == 2)
    pair = resistance(film, 0.02, 2.0, 0.5, dimension)
    assert pair == pytest.approx(resistance(film, 0.02, 0.4, np.inf, dimension))


@pytest.mark.parametrize("dimension", [2, 3])
def test_saturates_below_the_cutoff(dimension: int) -> None:
    found = [resistance(law(0.1, 0.01), gap, RADIUS, np.inf, dimension) for gap in (0.011, 0.01, 0.001, 0.0, -0.05)]
    assert found[0] < found[1]
    assert found[1:] == [found[1]] * 4


def test_sliding_is_free_where_the_table_says_so() -> None:
    motion = Motion(np.array([[-0.8, 0.6]]), np.ones(1), np.ones((1, 1)))
    film = law(0.1, sliding=False)
    assert not film.couples
    np.testing.assert_allclose(film.damping(contact(0.02, RADIUS, np.inf), motion), np.zeros_like(NORMAL), atol=1e-12)
    assert not film.couple(contact(0.02, RADIUS, np.inf), motion).any()


def test_cutoff_beyond_range_is_refused() -> None:
    with pytest.raises(SceneError, match=r"contact.cutoff: found 0.1; .*below contact.range = 0.1"):
        law(0.1, cutoff=0.1)


def test_a_gap_of_unknown_curvature_is_refused() -> None:
    for sliding in (True, False):
        with pytest.raises(SceneError, match="surfaces 0 and 2, whose gap has no known curvature"):
            resistance(law(0.1, sliding=sliding), 0.02, np.nan, np.inf, 2)


def fluid_law(material: Material, cutoff: float = 1e-9) -> LubricationLaw:
    loads = replace(unstacked(np.ones(1), np.zeros(1), np.ones(1), 0.1), film=Film(material, np.ones(1), np.inf, True))
    return LubricationLaw(LubricationOptions(cutoff=cutoff, sliding=True), 0.2, loads)


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_film_of_the_fluid_has_its_viscosity(dimension: int) -> None:
    given = resistance(law(0.2), 0.01, RADIUS, np.inf, dimension)
    assert resistance(fluid_law(Newtonian(VISCOSITY)), 0.01, RADIUS, np.inf, dimension) == pytest.approx(given)


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_film_of_a_fluid_that_thins_resists_the_less_the_faster_it_moves(dimension: int) -> None:
    options = CarreauOptions(viscosity=VISCOSITY, relaxation_time=1.0, exponent=0.5)
    thinning, touching = fluid_law(Carreau(options, dimension)), contact(0.01, RADIUS, np.inf, dimension)
    tangent = np.roll(touching.normal, 1, axis=1)
    turns = np.zeros((1, 1 if dimension == 2 else 3))
    turns[0, 0] = 1.0
    for velocity, turning in ((touching.normal, 0.0 * turns), (tangent, 0.0 * turns), (0.0 * tangent, turns)):
        shares = []
        for speed in (1e-6, 1.0, 100.0):
            motion = Motion(speed * velocity, np.ones(1), speed * turning)
            pairs = [(one.damping(touching, motion), one.couple(touching, motion)) for one in (thinning, law(0.2))]
            mine, given = (np.sum(f * motion.velocity) + np.sum(c * motion.angular_velocity) for f, c in pairs)
            shares.append(mine / given)
        assert shares[0] == pytest.approx(1.0, rel=1e-3)
        assert shares[0] > 1.2 * shares[1] > 1.2 * shares[2] > 0.0


def test_a_film_without_a_fluid_needs_a_viscosity() -> None:
    with pytest.raises(SceneError, match=r"contact\.viscosity: found none; allowed is a viscosity of the film"):
        LubricationLaw(LubricationOptions(cutoff=0.01), 0.2)
