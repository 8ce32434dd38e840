"""Impacts in a fluid: the law and the resolved film together leave what the formula asks for."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from touching import contact, unstacked

import rigidfluid
from rigidfluid.core.contact.laws.film_loss import FilmLoss
from rigidfluid.core.contact.laws.hunt_crossley import LEAST, hardening
from rigidfluid.core.contact.laws.loads import inverse_mass
from rigidfluid.core.contact.laws.restitution import Restitution
from rigidfluid.core.contact.laws.rough_film import RoughFilm
from rigidfluid.core.contact.laws.stokes_number import FILM_EDGE, stokes_number, stokes_number_taken
from rigidfluid.core.fluid.material import Newtonian
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.types import Film, Loads, Motion
from rigidfluid.forces.normal import NormalLaw

pytestmark = pytest.mark.long

DRY, DECAY, RADIUS, VISCOSITY = 0.97, 35.0, 0.1, 0.1
EDGE = FILM_EDGE * RADIUS
LOADS = unstacked(np.array([2.0]), np.zeros(1), np.zeros(1), 1e-3)
FILM = Film(Newtonian(VISCOSITY), np.array([RADIUS]), 0.0, True)


def cylinder_resistance(gap: float) -> float:
    """Exact in Stokes flow (Jeffrey and Onishi 1981)."""
    alpha = np.arccosh(1.0 + max(gap, 1e-6) / RADIUS)  # trial steps of the integrator may overlap
    return float(4.0 * np.pi * VISCOSITY / (alpha - np.tanh(alpha)))


def sphere_resistance(gap: float) -> float:
    return 6.0 * np.pi * VISCOSITY * RADIUS**2 / max(gap, 1e-6)


def work(excess: np.ndarray) -> np.ndarray:
    """y - ln(1 + y)."""
    return excess - np.log1p(excess)


class Impact(NamedTuple):
    """``whole``: the speed at the film's edge on the way out over that on the way in, zero where none comes back;
    ``fastest`` on the way out over the same; the smallest ``gap``."""

    whole: float
    fastest: float
    gap: float


def impact(law: ForceLaw, dimension: int, stokes: float) -> Impact:
    """Of a ball with a law and the exact film."""
    there = contact(EDGE, RADIUS, np.inf, dimension)
    mass, normal = 1.0 / float(inverse_mass(there, LOADS)[0]), there.normal
    speed = stokes / float(stokes_number(there, FILM, LOADS)[0])
    resistance = cylinder_resistance if dimension == 2 else sphere_resistance

    def rate(_: float, state: np.ndarray) -> list[float]:
        there, motion = contact(state[0], RADIUS, np.inf, dimension), Motion(state[1] * normal, np.array([mass]))
        force = float((law.force(there) + law.damping(there, motion))[0] @ normal[0])
        return [state[1], (force - resistance(state[0]) * state[1]) / mass]

    def out(_: float, state: np.ndarray) -> float:
        return float(state[0] - EDGE)

    out.terminal, out.direction = True, 1  # type: ignore[attr-defined]
    start, longest = [EDGE * (1.0 - 1e-9), -speed], EDGE / speed
    found = solve_ivp(rate, (0.0, 200.0 * longest), start, rtol=1e-5, atol=1e-9, events=out, max_step=longest)
    whole = float(found.y_events[0][0, 1]) / speed if len(found.y_events[0]) else 0.0
    return Impact(whole, float(found.y[1].max()) / speed, float(found.y[0].min()))


def loads(dimension: int, stokes: float) -> Loads:
    """Of a ball that arrives at the Stokes number."""
    there = contact(EDGE, RADIUS, np.inf, dimension)
    speed = np.array([stokes / float(stokes_number(there, FILM, LOADS)[0])])
    return replace(unstacked(LOADS.mass, np.zeros(1), speed, LOADS.smallest_gap), film=FILM)


def whole_rebound(dimension: int, law_range: float, stokes: float) -> float:
    held = replace(loads(dimension, stokes), smallest_gap=0.25 * law_range)
    law = NormalLaw(NormalLaw.Options(epsilon="auto"), law_range, held)
    return impact(Restitution(law, DRY, FilmLoss(DECAY, FILM, held)), dimension, stokes).whole


@pytest.mark.parametrize(("dimension", "law_range"), [(2, 0.03), (2, 0.01), (3, 0.03), (3, 0.002)])
@pytest.mark.parametrize("stokes", [30.0, 100.0, 1000.0])
def test_law_and_film_together_leave_the_formula(dimension: int, law_range: float, stokes: float) -> None:
    assert whole_rebound(dimension, law_range, stokes) == pytest.approx(DRY * np.exp(-DECAY / stokes), abs=0.05)


def rough_rebound(dimension: int, law_range: float, roughness: float, stokes: float) -> float:
    held = replace(loads(dimension, stokes), smallest_gap=0.25 * law_range)
    law = NormalLaw(NormalLaw.Options(epsilon="auto"), law_range, held)
    return impact(Restitution(law, DRY, RoughFilm(roughness, FILM, held)), dimension, stokes).whole


def film_share(dimension: int, roughness: float, stokes: float) -> float:
    """Share of the speed that the exact film takes on the way from its edge to the roughness."""
    if dimension == 3:
        return float(np.log(EDGE / roughness)) / stokes
    gaps, there = np.geomspace(roughness, EDGE, 4001), contact(EDGE, RADIUS, np.inf)
    lost = np.trapezoid([cylinder_resistance(gap) for gap in gaps], gaps) * float(inverse_mass(there, LOADS)[0])
    return float(lost * stokes_number(there, FILM, LOADS)[0]) / stokes


@pytest.mark.parametrize(("dimension", "stokes"), [(2, 200.0), (2, 1000.0), (3, 30.0), (3, 100.0), (3, 1000.0)])
@pytest.mark.parametrize("law_range", [0.02, 0.006])
@pytest.mark.parametrize("roughness", [1e-3, 1e-4])
def test_a_rough_ball_bounces_as_a_dry_one_behind_the_film_down_to_its_roughness(
    dimension: int, stokes: float, law_range: float, roughness: float
) -> None:
    """On both ways the exact film takes its share once, whatever the law's range."""
    share = film_share(dimension, roughness, stokes)
    expected = max(DRY * (1.0 - share) - share, 0.0)
    assert rough_rebound(dimension, law_range, roughness, stokes) == pytest.approx(expected, abs=0.03)


def test_a_rough_ball_that_the_film_stops_does_not_come_back() -> None:
    assert film_share(3, 1e-4, 7.0) == pytest.approx(1.0, abs=0.02)
    assert rough_rebound(3, 0.02, 1e-4, 7.0) == 0.0


@pytest.mark.parametrize(("dimension", "law_range"), [(2, 0.03), (2, 0.01), (3, 0.03), (3, 0.002)])
def test_slow_impacts_in_a_resolved_film_do_not_come_back(dimension: int, law_range: float) -> None:
    assert whole_rebound(dimension, law_range, 7.0) == 0.0


@pytest.mark.parametrize("stokes", [35.0, 44.0, 60.0])
def test_a_film_that_takes_more_than_the_formula_is_all_that_takes(stokes: float) -> None:
    """In 2D and within a twentieth of the radius: nothing more than a law without losses could come back."""
    law_range, held = 0.05 * RADIUS, replace(loads(2, stokes), smallest_gap=0.0125 * RADIUS)
    lossless = impact(NormalLaw(NormalLaw.Options(epsilon="auto"), law_range, held), 2, stokes).whole
    asked = min(DRY * float(np.exp(-DECAY / stokes)), lossless)
    assert whole_rebound(2, law_range, stokes) == pytest.approx(asked, abs=0.01)


@pytest.mark.parametrize("dry", [0.97, 0.8, 0.5, 0.3, 0.1])
@pytest.mark.parametrize(("dimension", "law_range"), [(2, 0.02), (2, 0.005), (2, 0.002), (3, 0.02), (3, 0.002)])
def test_each_state_has_one_speed_at_range(dimension: int, law_range: float, dry: float) -> None:
    """Its energy grows with that speed at any closing speed, though the restitution may fall with it."""
    held = replace(loads(dimension, 20.0), smallest_gap=0.25 * law_range)
    law, there = (
        NormalLaw(NormalLaw.Options(epsilon="auto"), law_range, held),
        contact(law_range, RADIUS, np.inf, dimension),
    )
    per_speed = float(stokes_number(there, FILM, LOADS)[0])
    found = FilmLoss(DECAY, FILM, held).restitution(dry, law, there, 1.0 / inverse_mass(there, LOADS))
    speed = np.geomspace(1.0, 2000.0, 600) / per_speed
    restitution = np.maximum([float(found(one)[0]) for one in speed[:, None]], LEAST)
    harder = hardening(restitution)
    for closing in np.concatenate([-np.geomspace(1.0, 500.0, 12), [0.0, 5.0, 50.0]]) / per_speed:
        met = (np.abs(closing) <= speed) & (closing >= -restitution * speed)
        now = np.maximum(harder.most * closing / speed, -harder.least)
        stored = 2.0 * (speed / harder.most) ** 2 * (work(harder.most) - work(now))
        both = met[1:] & met[:-1]
        assert np.all(np.diff(stored)[both] > -1e-9 * stored.max())


@pytest.mark.parametrize(("dimension", "stokes"), [(2, 8.0), (3, 4.0), (3, 6.0)])
def test_auto_lets_the_film_stop_what_it_can(dimension: int, stokes: float) -> None:
    """It counts on the speed that the film leaves, so that the ball comes near and next to nothing comes back."""
    law_range, held = 0.1 * RADIUS, loads(dimension, stokes)
    held = replace(held, smallest_gap=0.25 * law_range)
    found, dry = (
        impact(NormalLaw(NormalLaw.Options(epsilon="auto"), law_range, one), dimension, stokes)
        for one in (held, replace(held, film=None))
    )
    assert found.whole == 0.0
    assert held.smallest_gap < found.gap < 0.85 * dry.gap
    assert found.fastest < 0.75 * dry.fastest


def test_the_cylinders_film_takes_what_its_exact_resistance_does() -> None:
    gaps = np.geomspace(0.02 * RADIUS, EDGE, 2001)
    lost = np.trapezoid([cylinder_resistance(gap) for gap in gaps], gaps)
    there = contact(EDGE, RADIUS, np.inf)
    exact = lost * float(inverse_mass(there, LOADS)[0] * stokes_number(there, FILM, LOADS)[0])
    assert stokes_number_taken(there, FILM, LOADS, gaps[0])[0] == pytest.approx(exact, rel=0.02)
    assert stokes_number_taken(there, FILM, LOADS, 2.0 * EDGE)[0] == 0.0


def test_a_film_that_cells_do_not_resolve_takes_nothing() -> None:
    films = [Film(Newtonian(VISCOSITY), np.array([RADIUS]), cell, True) for cell in (0.0, 0.02, 0.1)]
    taken = [float(stokes_number_taken(contact(0.001, RADIUS, np.inf), film, LOADS, 0.001)[0]) for film in films]
    assert taken[0] > taken[1] > taken[2] == 0.0


def test_a_disk_in_a_fluid_comes_back_as_the_formula_says() -> None:
    """Speeds at a gap of half a radius, at St = 44."""
    overrides = ["fluid.viscosity=0.035", "contact.restitution=0.97", "contact.restitution_stokes=35"]
    overrides += ["mesh.size_body=0.04", "body.0.position=[0.3, 0.4]", "time.step=0.001", "time.end=0.05"]
    bodies = rigidfluid.run(rigidfluid.load_scene("scenes/rebound.toml", overrides)).bodies
    gap, speed = bodies["gap"], bodies["vx"]
    turn = int(np.argmin(gap))
    came = -float(np.interp(0.05, gap[: turn + 1][::-1], speed[: turn + 1][::-1]))
    gone = float(np.interp(0.05, gap[turn:], speed[turn:]))
    stokes = 9.0 * 0.2 * came / (9.0 * 0.035)
    assert gone / came == pytest.approx(0.97 * np.exp(-35.0 / stokes), abs=0.04)
