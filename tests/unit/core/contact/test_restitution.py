"""Impacts that lose energy: a restitution for every law."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from dry_scenes import ball, dry_scene
from scipy.integrate import solve_ivp
from touching import NORMAL, contact, unstacked

from rigidfluid.api import Simulation
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.case.system import build_system
from rigidfluid.core.contact.laws.film_loss import FilmLoss
from rigidfluid.core.contact.laws.hunt_crossley import LEAST
from rigidfluid.core.contact.laws.restitution import Restitution
from rigidfluid.core.contact.laws.rough_film import RoughFilm
from rigidfluid.core.contact.laws.stokes_number import stokes_number
from rigidfluid.core.contact.path.substep import _greatest
from rigidfluid.core.fluid.material import Newtonian
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.state import State
from rigidfluid.core.model.types import Film, Motion
from rigidfluid.errors import SceneError
from rigidfluid.forces.lubrication import LubricationLaw
from rigidfluid.forces.normal import NormalLaw
from rigidfluid.forces.spring_dashpot import SpringDashpotLaw

RANGE = 0.02
EPSILON = {"normal": 1e-6, "centre": 1e-6, "contact": 1e-8, "barrier": 1e-4}
FILM = Film(Newtonian(0.1), np.array([0.1, 0.1]), np.inf, True)
LOADS = unstacked(np.array([2.0, 2.0]), np.zeros(2), np.zeros(2), 0.25 * RANGE)


def law_table(law: str, restitution: float, **keys: Any) -> dict[str, Any]:
    own = {"stiffness": 1e4} if law == "spring-dashpot" else {"epsilon": EPSILON[law]}
    return {"law": law, "range": RANGE, "restitution": restitution} | own | keys


def gone(*scene: Any, **keys: Any) -> State:
    simulation = Simulation(dry_scene(*scene, **keys))
    simulation.go()
    return simulation.state


def thrown_at_a_wall(table: dict[str, Any], speed: float = 1.0, density: float = 1.0) -> State:
    """A disk whose gap is a quarter beyond range; it is back there at the end."""
    disk = ball([0.1 + 1.25 * RANGE, 0.5], [-speed, 0.0], density=density)
    return gone(table, disk, end=0.2 / speed, step=0.002 / speed)


def rebound(state: State) -> float:
    return float(state.twist.velocity[0, 0])


@pytest.mark.parametrize("law", EPSILON)
@pytest.mark.parametrize("restitution", [0.2, 0.5, 0.9])
@pytest.mark.parametrize(("speed", "density"), [(1.0, 1.0), (0.1, 30.0)])
def test_an_impact_ends_with_the_restitution_whatever_law_speed_and_mass(
    law: str, restitution: float, speed: float, density: float
) -> None:
    state = thrown_at_a_wall(law_table(law, restitution), speed, density)
    assert rebound(state) == pytest.approx(restitution * speed, abs=1e-3 * speed)
    kinetic = 0.5 * density * np.pi * 0.01 * speed**2
    assert state.ledger.contact_loss == pytest.approx((1.0 - restitution**2) * kinetic, rel=2e-3)
    assert abs(state.ledger.residual) < 1e-3 * kinetic


@pytest.mark.parametrize("dimension", [2, 3])
def test_two_balls_part_with_the_restitution(dimension: int) -> None:
    across = [0.5] * (dimension - 1)
    left = ball([0.38, *across], [1.0] + [0.0] * (dimension - 1))
    right = ball([0.61, *across], [-0.5] + [0.0] * (dimension - 1), density=3.0)
    velocity = gone(law_table("normal", 0.6), left, right, end=0.08, step=0.001).twist.velocity
    assert velocity[1, 0] - velocity[0, 0] == pytest.approx(0.6 * 1.5, abs=1.5e-3)
    assert velocity[0, 0] + 3.0 * velocity[1, 0] == pytest.approx(1.0 - 1.5, abs=1e-9)


def test_the_error_falls_with_the_substeps() -> None:
    coarse, fine = (abs(rebound(thrown_at_a_wall(law_table("normal", 0.2, substeps=count))) - 0.2) for count in (4, 32))
    assert fine < 0.2 * coarse


@pytest.mark.parametrize("shape", ["ellipsoid", pytest.param("polygon", marks=pytest.mark.validation)])
def test_an_impact_off_the_centre_creates_no_energy(shape: str) -> None:
    keys = {"semi_axes": [0.15, 0.06]}
    if shape == "polygon":
        keys = {"points": [[-0.15, -0.05], [0.15, -0.05], [0.15, 0.05], [-0.15, 0.05]]}
    body = {"type": shape, "density": 1.0, "position": [0.25, 0.5], "angle": 0.5, "velocity": [-1.0, 0.0]} | keys
    simulation = Simulation(dry_scene(law_table("normal", 0.5), body, end=0.3, step=0.002))
    energies = [simulation.state.ledger.kinetic]
    while not simulation.ended:
        simulation.step()
        energies.append(simulation.state.ledger.kinetic + simulation.state.ledger.contact)
    assert simulation.state.twist.velocity[0, 0] > -0.5
    assert np.all(np.diff(energies) < 1e-3 * energies[0])
    assert 0.25 * energies[0] < energies[-1] < 0.8 * energies[0]
    assert abs(simulation.state.ledger.residual) < 2e-3 * energies[0]


@pytest.mark.parametrize(
    ("count", "stepping"),
    [
        (1, "substeps"),
        (3, "implicit"),
        pytest.param(3, "substeps", marks=pytest.mark.validation),
    ],
)
def test_dropped_balls_come_to_rest(stepping: str, count: int) -> None:
    """One on the floor, or in a stack: each contact bears the weight of all above it."""
    balls = [ball([0.5, 0.13 + 0.23 * number], [0.0, 0.0]) for number in range(count)]
    table = law_table("normal", 0.3, stepping=stepping)
    state = gone(table, *balls, end=0.8, step=0.004, gravity=[0.0, -10.0])
    borne = 0.01 * np.pi * 10.0 * np.arange(count, 0, -1)
    lowest = np.cumsum(0.2 + RANGE - np.sqrt(EPSILON["normal"] * borne)) - 0.1
    np.testing.assert_allclose(state.pose.position[:, 1], lowest, atol=1e-6)
    assert np.abs(state.twist.velocity).max() < 1e-4


@pytest.mark.parametrize("restitution", [0.2, 0.8])
def test_implicit_steps_that_resolve_the_impact_end_with_the_restitution(restitution: float) -> None:
    table = law_table("normal", restitution, stepping="implicit")
    disk = ball([0.1 + 1.25 * RANGE, 0.5], [-1.0, 0.0])
    states = [gone(table, disk, end=0.1, step=step) for step in (4e-3, 2.5e-4)]
    errors = [abs(rebound(state) - restitution) for state in states]
    assert errors[1] < 1e-3
    assert all(abs(state.ledger.residual) < 1e-8 for state in states)
    assert all(state.ledger.contact_loss > 0.0 for state in states)


def impact(law: ForceLaw, speed: float, mass: float = 1.0) -> float:
    """Speed after over speed before a head-on impact, from the integrated equation of motion."""

    def rate(_: float, state: np.ndarray) -> list[float]:
        there = contact(state[0])
        force = law.force(there) + law.damping(there, Motion(state[1] * NORMAL, np.array([mass])))
        return [state[1], float(force[0] @ NORMAL[0]) / mass]

    def parted(_: float, state: np.ndarray) -> float:
        return float(state[0] - RANGE)

    parted.terminal, parted.direction = True, 1  # type: ignore[attr-defined]
    start = [RANGE * (1.0 - 1e-9), -speed]
    found = solve_ivp(rate, (0.0, 10.0), start, method="DOP853", rtol=1e-9, atol=1e-13, events=parted)
    return float(found.y_events[0][0, 1]) / speed


@pytest.mark.parametrize("restitution", [LEAST, 0.3, 0.999, 1.0])
def test_the_damper_itself_is_exact(restitution: float) -> None:
    law = Restitution(NormalLaw(NormalLaw.Options(epsilon=1e-6), RANGE), restitution)
    assert impact(law, 1.0) == pytest.approx(restitution, rel=1e-6)


@pytest.mark.parametrize("speed", [1.5, 4.0, 100.0])
def test_the_restitution_follows_the_stokes_number(speed: float) -> None:
    law = Restitution(NormalLaw(NormalLaw.Options(epsilon=1e-6), RANGE), 0.9, FilmLoss(35.0, FILM, LOADS))
    stokes = float(stokes_number(contact(RANGE), FILM, LOADS)[0]) * speed
    assert impact(law, speed) == pytest.approx(0.9 * np.exp(-35.0 / stokes), rel=1e-5)


@pytest.mark.parametrize("speed", [4.0, 100.0])
def test_without_a_resolved_film_the_law_takes_the_film_down_to_the_roughness(speed: float) -> None:
    rough = RoughFilm(0.1 * RANGE, FILM, LOADS)
    stokes = float(stokes_number(contact(RANGE), FILM, LOADS)[0]) * speed
    share = float(rough.taken(contact(RANGE))[0]) / stokes
    law = Restitution(NormalLaw(NormalLaw.Options(epsilon=1e-6), RANGE), 0.9, rough)
    assert impact(law, speed) == pytest.approx(0.9 * (1.0 - share) - share, rel=1e-5)


@pytest.mark.parametrize("cell", [0.0, 0.01, np.inf])
def test_the_restitution_of_rough_surfaces_grows_with_the_speed_up_to_the_dry_one(cell: float) -> None:
    """So that each state has one speed at range."""
    rough = RoughFilm(0.01 * RANGE, Film(Newtonian(0.1), np.array([0.1, 0.1]), cell, True), LOADS)
    law = NormalLaw(NormalLaw.Options(epsilon=1e-6), RANGE)
    restitution = rough.restitution(0.9, law, contact(RANGE), np.ones(1))
    found = [float(restitution(np.array([speed]))[0]) for speed in np.geomspace(1e-3, 1e4, 200)]
    assert np.all(np.diff(found) >= 0.0)
    assert found[0] == 0.0
    assert 0.85 < found[-1] <= 0.9


def test_slow_impacts_end_with_the_least_restitution() -> None:
    law = Restitution(NormalLaw(NormalLaw.Options(epsilon=1e-6), RANGE), 0.9, FilmLoss(35.0, FILM, LOADS))
    assert impact(law, 0.2) == pytest.approx(LEAST, rel=1e-5)


@pytest.mark.parametrize("dimension", [2, 3])
def test_at_a_wall_the_stokes_number_is_that_of_density_diameter_and_viscosity(dimension: int) -> None:
    volume = np.pi * 0.1**2 if dimension == 2 else 4.0 / 3.0 * np.pi * 0.1**3
    film = Film(Newtonian(0.02), np.array([0.1]), np.inf, True)
    loads = unstacked(np.array([3.5 * volume]), *np.zeros((2, 1)), 0.1)
    found = stokes_number(contact(0.01, 0.1, np.inf, dimension), film, loads)
    np.testing.assert_allclose(found, 3.5 * 0.2 / (9.0 * 0.02))


def test_of_two_balls_the_stokes_number_is_the_binary_one() -> None:
    """Of reduced mass and radius: twice that of one of them at a wall if they are alike."""
    one, pair = (stokes_number(contact(0.01, 0.1, radius, 3), FILM, LOADS) for radius in (np.inf, 0.1))
    np.testing.assert_allclose(pair, 2.0 * one)


def test_substeps_resolve_the_damper_where_it_is_steepest() -> None:
    """At rest: there a small velocity v is resisted by f √(2 G(x) m/(2U)) v."""
    law = Restitution(NormalLaw(NormalLaw.Options(epsilon=1e-6), RANGE), 0.2)
    there, speed = contact(0.5 * RANGE), 1e-9
    resisted = law.damping(there, Motion(speed * NORMAL, np.ones(1)))
    steepest = -float(resisted[0] @ NORMAL[0]) / speed
    coefficient = _greatest(law, there, Motion(NORMAL, np.ones(1)), there.gap)[1]
    assert coefficient[0] == pytest.approx(steepest, rel=1e-6)


def test_a_restitution_of_one_is_the_law_itself() -> None:
    system = build_system(dry_scene(law_table("normal", 1.0), ball([0.5, 0.5], [0.0, 0.0]), end=1.0, step=0.1))
    assert type(system.law) is NormalLaw


def test_a_spring_and_dashpot_keeps_its_own() -> None:
    table = law_table("spring-dashpot", 0.5)
    system = build_system(dry_scene(table, ball([0.5, 0.5], [0.0, 0.0]), end=1.0, step=0.1))
    assert isinstance(system.law, SpringDashpotLaw)
    assert system.law.options.restitution == 0.5


def test_each_interaction_has_its_own() -> None:
    scene = dry_scene({}, ball([0.125, 0.5], [-1.0, 0.0]), ball([0.375, 0.5], [0.0, 0.0]), end=0.35, step=0.005)
    tables = [
        law_table("normal", 0.4, between="walls"),
        law_table("barrier", 0.7, between="pairs"),
    ]
    simulation = Simulation(scene_from_dict(scene.to_dict() | {"interaction": tables}))
    simulation.go(until=0.1)
    assert simulation.state.twist.velocity[0, 0] == pytest.approx(0.4, abs=1e-3)
    simulation.go()
    velocity = simulation.state.twist.velocity[:, 0]
    assert velocity[1] - velocity[0] == pytest.approx(0.4 * 0.7, abs=1e-3)


@pytest.mark.parametrize(
    ("table", "field", "words"),
    [
        (
            {"law": "lubrication", "range": RANGE, "viscosity": 0.1, "cutoff": 0.001, "restitution": 0.5},
            "law",
            "energy",
        ),
        (law_table("normal", 0.5 * LEAST), "restitution", "Set it to"),
        (law_table("normal", 0.5, restitution_stokes=35.0), "restitution_stokes", "viscosity"),
        (law_table("spring-dashpot", 0.5, restitution_stokes=35.0), "restitution_stokes", "its own"),
        ({"restitution": 0.5}, "restitution", "law"),
        ({"restitution_stokes": 35.0}, "restitution_stokes", "law"),
        (law_table("normal", 0.5, roughness=0.001), "roughness", "viscosity"),
        (law_table("spring-dashpot", 0.5, roughness=0.001), "roughness", "its own"),
        (law_table("normal", 0.5, roughness=0.001, restitution_stokes=35.0), "roughness", "Remove either"),
        (law_table("normal", 0.5, roughness=1.5 * RANGE), "roughness", "widen the range"),
        (law_table("normal", 0.5, roughness=0.3 * RANGE), "roughness", "smallest gap"),
        (law_table("normal", 0.5, roughness=-0.001), "roughness", "above 0|greater than 0"),
        ({"roughness": 0.001}, "roughness", "law"),
        (law_table("normal", 1.1), "restitution", "1"),
        (law_table("normal", 0.0), "restitution", "0"),
    ],
)
def test_what_has_no_meaning_is_refused(table: dict[str, Any], field: str, words: str) -> None:
    with pytest.raises(SceneError, match=words) as refused:
        build_system(dry_scene(table, ball([0.5, 0.5], [0.0, 0.0]), end=1.0, step=0.1))
    assert refused.value.subject == f"contact.{field}"


def test_a_law_with_dampers_of_its_own_is_refused() -> None:
    film = LubricationLaw(LubricationLaw.Options(viscosity=0.1, cutoff=0.1 * RANGE), RANGE)
    with pytest.raises(SceneError, match="dampers of its own"):
        Restitution(film, 0.5)
