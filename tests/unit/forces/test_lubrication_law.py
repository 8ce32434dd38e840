import numpy as np
import pytest
from touching import NORMAL, contact

from rigidfluid.core.model.types import Motion
from rigidfluid.errors import SceneError
from rigidfluid.forces.lubrication import LubricationLaw, LubricationOptions

VISCOSITY, RADIUS = 0.7, 2.0
# Brenner 1961: force on a sphere that moves onto a wall, over 6πμrV, by gap over radius.
BRENNER = {0.1: 11.45916, 0.05: 21.58582, 0.01: 101.896}


def law(range_: float, cutoff: float = 1e-9) -> LubricationLaw:
    return LubricationLaw(LubricationOptions(viscosity=VISCOSITY, cutoff=cutoff), range_)


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


@pytest.mark.parametrize("gap", [0.05, 0.01])
def test_sphere_at_wall_grows_as_in_the_exact_solution(gap: float) -> None:
    exact = 6 * np.pi * VISCOSITY * RADIUS * (BRENNER[gap] - BRENNER[0.1])
    found = resistance(law(0.1 * RADIUS), gap * RADIUS, RADIUS, np.inf, 3)
    assert found == pytest.approx(exact, rel=0.02)


@pytest.mark.parametrize("gap", [1e-2, 1e-4])
def test_cylinder_at_wall_grows_as_in_the_exact_solution(gap: float) -> None:
    exact = cylinder_at_wall(gap * RADIUS) - cylinder_at_wall(0.1 * RADIUS)
    assert resistance(law(0.1 * RADIUS), gap * RADIUS, RADIUS, np.inf, 2) == pytest.approx(exact, rel=2 * gap)


@pytest.mark.parametrize("dimension", [2, 3])
def test_two_balls_are_one_of_the_effective_radius_at_a_wall(dimension: int) -> None:
    pair = resistance(law(0.1), 0.02, 2.0, 0.5, dimension)
    assert pair == pytest.approx(resistance(law(0.1), 0.02, 0.4, np.inf, dimension))


@pytest.mark.parametrize("dimension", [2, 3])
def test_saturates_below_the_cutoff(dimension: int) -> None:
    found = [resistance(law(0.1, 0.01), gap, RADIUS, np.inf, dimension) for gap in (0.011, 0.01, 0.001, 0.0, -0.05)]
    assert found[0] < found[1]
    assert found[1:] == [found[1]] * 4


def test_sliding_is_free() -> None:
    motion = Motion(np.array([[-0.8, 0.6]]), np.ones(1))
    pushed = law(0.1).damping(contact(0.02, RADIUS, np.inf), motion)
    np.testing.assert_allclose(pushed, np.zeros_like(NORMAL), atol=1e-12)


def test_cutoff_beyond_range_is_refused() -> None:
    with pytest.raises(SceneError, match=r"contact.cutoff: found 0.1; .*below contact.range = 0.1"):
        law(0.1, cutoff=0.1)


def test_a_gap_of_unknown_curvature_is_refused() -> None:
    with pytest.raises(SceneError, match="surfaces 0 and 2, whose gap has no known curvature"):
        resistance(law(0.1), 0.02, np.nan, np.inf, 2)
