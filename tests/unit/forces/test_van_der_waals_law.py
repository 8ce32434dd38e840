from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from dry_scenes import ball
from scenes import dry_tables
from scipy.integrate import quad
from touching import NORMAL, contact

from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.errors import SceneError
from rigidfluid.forces.van_der_waals import VanDerWaalsLaw, VanDerWaalsOptions

HAMAKER, RANGE, CUTOFF = 0.7, 0.02, 0.001
REPULSION = {"law": "normal", "range": 0.02, "epsilon": 2e-5}
ATTRACTION = {"law": "van-der-waals", "range": 0.04, "cutoff": 0.004, "between": "pairs"}
HAMAKERS = {2: 5e-5, 3: 2e-4}


@pytest.fixture
def law() -> VanDerWaalsLaw:
    return VanDerWaalsLaw(VanDerWaalsOptions(hamaker=HAMAKER, cutoff=CUTOFF), RANGE)


def between_plates(gap: float, radius: float, dimension: int) -> float:
    """Derjaguin: the pressure of half-spaces, A/(6π h³), over the gap of a parabola and a plane."""

    def pressure(along: float) -> float:
        ring = 2.0 * np.pi * along if dimension == 3 else 2.0
        return ring * HAMAKER / (6.0 * np.pi * (gap + along**2 / (2.0 * radius)) ** 3)

    return float(quad(pressure, 0.0, np.inf, epsabs=0.0, epsrel=1e-10)[0])


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("gap", [0.0011, 0.004, 0.015])
def test_is_the_pressure_of_half_spaces_over_the_gap(law: VanDerWaalsLaw, gap: float, dimension: int) -> None:
    radius = 0.7 * 0.4 / 1.1
    shift = between_plates(RANGE, radius, dimension)
    found = law.force(contact(gap, 0.7, 0.4, dimension))[0, :2] @ NORMAL[0]
    assert found == pytest.approx(shift - between_plates(gap, radius, dimension), rel=1e-7)


def test_energy_of_balls_is_that_of_the_books(law: VanDerWaalsLaw) -> None:
    """Israelachvili: -A R/(6 D) of spheres and -A √R/(12√2 D^(3/2)) of cylinders, between gaps where the shift is
    small."""
    far = VanDerWaalsLaw(law.options, 1e6)
    assert far.energy(contact(0.01, 2.0, np.inf, 3))[0] == pytest.approx(-HAMAKER * 2.0 / 0.06, rel=1e-6)
    cylinders = -HAMAKER * np.sqrt(2.0) / (12.0 * np.sqrt(2.0) * 0.01**1.5)
    assert far.energy(contact(0.01, 2.0, np.inf, 2))[0] == pytest.approx(cylinders, rel=1e-6)


@pytest.mark.parametrize("dimension", [2, 3])
def test_is_no_steeper_below_the_cutoff(law: VanDerWaalsLaw, dimension: int) -> None:
    stiffness = [law.stiffness(contact(gap, 0.7, 0.4, dimension))[0] for gap in (0.0011, 0.001, 0.0005, 0.0, -0.01)]
    assert stiffness[1] < stiffness[0] < 0.0
    assert stiffness[1:] == [stiffness[1]] * 4


def test_a_cutoff_that_is_not_below_range_is_refused() -> None:
    with pytest.raises(SceneError, match="below contact"):
        VanDerWaalsLaw(VanDerWaalsOptions(hamaker=1.0, cutoff=0.1), 0.1)


def pair(stepping: str, step: float, dimension: int, *, speed: float, end: float, **repulsion: Any) -> Simulation:
    """Two balls that come towards each other, attract from a gap of .04 and repel from .02."""
    rest, laws = [0.5] * (dimension - 1), [REPULSION | repulsion, ATTRACTION | {"hamaker": HAMAKERS[dimension]}]
    still = [0.0] * (dimension - 1)
    balls = ball([0.35, *rest], [speed, *still]), ball([0.59, *rest], [-speed, *still])
    contact = {"stepping": stepping}
    return Simulation(scene_from_dict(dry_tables(*balls, contact=contact, interaction=laws, end=end, step=step)))


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("stepping", ["substeps", "implicit"])
@pytest.mark.parametrize("step", [4e-3, 5e-4])
@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_a_pair_that_attracts_keeps_its_energy(stepping: str, step: float, dimension: int) -> None:
    run = pair(stepping, step, dimension, speed=0.5, end=0.25)
    whole, least, created = run.state.ledger.kinetic, 0.0, 0.0
    while not run.ended:
        ledger = run.step().ledger
        least, created = min(least, ledger.contact), max(created, abs(ledger.residual))
    assert least < -0.01 * whole
    assert created < 0.005 * whole
    assert run.state.twist.velocity[0, 0] == pytest.approx(-0.5, rel=1e-3)


@pytest.mark.parametrize("stepping", ["substeps", pytest.param("implicit", marks=pytest.mark.long)])
def test_a_slow_pair_with_a_damper_is_caught(stepping: str) -> None:
    caught, free = (pair(stepping, 4e-3, 2, speed=0.1, end=0.8, restitution=restitution) for restitution in (0.3, 1.0))
    for run in (caught, free):
        run.go()
    assert free.state.twist.velocity[0, 0] == pytest.approx(-0.1, rel=2e-3)
    ledger = caught.state.ledger
    assert ledger.kinetic + ledger.contact < 0.0
    assert caught.state.contacts.gap.min() < ATTRACTION["range"]
    start = 2.0 * 0.5 * np.pi * 0.01 * 0.1**2
    assert abs(ledger.residual) < 0.005 * start


def test_auto_holds_the_work_of_the_attraction_besides_the_impact() -> None:
    alone = {"law": "normal", "range": 0.02, "epsilon": "auto", "smallest_gap": 0.005}
    heavy = ATTRACTION | {"hamaker": 1e-3}
    balls = ball([0.35, 0.5], [0.5, 0.0]), ball([0.59, 0.5], [-0.5, 0.0])
    work = []
    for laws in ([alone], [alone, heavy]):
        system = Simulation(scene_from_dict(dry_tables(*balls, interaction=laws, end=1.0, step=1e-3))).system
        near = contact(0.005, 0.1, 0.1)
        work.append(system.interactions[0].law.energy(near)[0])
    attraction = VanDerWaalsLaw(VanDerWaalsOptions(hamaker=1e-3, cutoff=0.004), 0.04).energy(contact(0.005, 0.1, 0.1))
    assert work[1] - work[0] == pytest.approx(-attraction[0])
