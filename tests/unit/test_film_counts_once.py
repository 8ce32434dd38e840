"""Impacts in a fluid: the law and the resolved film together leave what the formula asks for."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from touching import contact, unstacked

import rigidfluid
from rigidfluid.core.contact.film_loss import FilmLoss
from rigidfluid.core.contact.restitution import Restitution
from rigidfluid.core.contact.stokes_number import FILM_EDGE, Film
from rigidfluid.core.model.types import Motion
from rigidfluid.forces.normal import NormalLaw

DRY, DECAY, RADIUS, VISCOSITY = 0.97, 35.0, 0.1, 0.1
EDGE = FILM_EDGE * RADIUS


def cylinder_resistance(gap: float) -> float:
    """Exact in Stokes flow (Jeffrey and Onishi 1981)."""
    alpha = np.arccosh(1.0 + max(gap, 1e-6) / RADIUS)  # trial steps of the integrator may overlap
    return float(4.0 * np.pi * VISCOSITY / (alpha - np.tanh(alpha)))


def sphere_resistance(gap: float) -> float:
    return 6.0 * np.pi * VISCOSITY * RADIUS**2 / max(gap, 1e-6)


def whole_rebound(dimension: int, law_range: float, stokes: float, finest: float = 0.0) -> float:
    """Speed over speed at the film's edge, on the way out and in: a ball, its law and its film; zero if none comes."""
    mass = 2.0
    film = Film(VISCOSITY, np.array([RADIUS]), unstacked(np.array([mass]), np.zeros(1), np.zeros(1), 1e-3), finest)
    normal = contact(EDGE, RADIUS, np.inf, dimension).normal
    speed = stokes / float(film.stokes_number(contact(EDGE, RADIUS, np.inf, dimension))[0])
    bare = NormalLaw(NormalLaw.Options(epsilon=(0.75 * law_range) ** 3 / 3.0 / (0.5 * mass * speed**2)), law_range)
    law = Restitution(bare, DRY, FilmLoss(DECAY, film))
    resistance = cylinder_resistance if dimension == 2 else sphere_resistance

    def rate(_: float, state: np.ndarray) -> list[float]:
        there, motion = contact(state[0], RADIUS, np.inf, dimension), Motion(state[1] * normal, np.array([mass]))
        force = float((law.force(there) + law.damping(there, motion))[0] @ normal[0])
        return [state[1], (force - resistance(state[0]) * state[1]) / mass]

    def out(_: float, state: np.ndarray) -> float:
        return float(state[0] - EDGE)

    out.terminal, out.direction = True, 1  # type: ignore[attr-defined]
    span = (0.0, 200.0 * EDGE / speed)
    found = solve_ivp(rate, span, [EDGE * (1.0 - 1e-9), -speed], rtol=1e-5, atol=1e-9, events=out, max_step=EDGE / speed)
    return float(found.y_events[0][0, 1]) / speed if len(found.y_events[0]) else 0.0


@pytest.mark.parametrize(("dimension", "law_range"), [(2, 0.03), (2, 0.01), (3, 0.03), (3, 0.002)])
@pytest.mark.parametrize("stokes", [30.0, 100.0, 1000.0])
def test_law_and_film_together_leave_the_formula(dimension: int, law_range: float, stokes: float) -> None:
    assert whole_rebound(dimension, law_range, stokes) == pytest.approx(DRY * np.exp(-DECAY / stokes), abs=0.03)


@pytest.mark.parametrize(("dimension", "law_range"), [(2, 0.03), (2, 0.01), (3, 0.03), (3, 0.002)])
def test_slow_impacts_in_a_resolved_film_do_not_come_back(dimension: int, law_range: float) -> None:
    assert whole_rebound(dimension, law_range, 7.0) == 0.0


def test_the_cylinders_film_takes_what_its_exact_resistance_does() -> None:
    film = Film(VISCOSITY, np.array([RADIUS]), unstacked(np.ones(1), np.zeros(1), np.zeros(1), 1e-3), 0.0)
    gaps = np.geomspace(0.02 * RADIUS, EDGE, 2001)
    lost = np.trapezoid([cylinder_resistance(gap) for gap in gaps], gaps)
    there = contact(gaps[0], RADIUS)
    exact = lost * float(film.stokes_number(there)[0])
    assert film.taken(there, gaps[:1])[0] == pytest.approx(exact, rel=0.02)
    assert film.taken(there, np.array([2.0 * EDGE]))[0] == 0.0


def test_a_film_that_cells_do_not_resolve_takes_nothing() -> None:
    there, loads = contact(0.001, RADIUS), unstacked(np.ones(1), np.zeros(1), np.zeros(1), 1e-3)
    taken = [float(Film(0.1, np.array([RADIUS]), loads, cell).taken(there, there.gap)[0]) for cell in (0.0, 0.02, 0.1)]
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
