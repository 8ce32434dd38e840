"""Linked bodies without a fluid: momentum, energy, work of drives and dampers, contacts, and runs that are resumed."""

from itertools import pairwise
from pathlib import Path

import mechanism_parts
import numpy as np
import pytest
from linked_runs import bar, body, hinge, linked_scene, misfit, momenta

import rigidfluid
from rigidfluid.core.output.energy_account import energy_account
from rigidfluid.core.run.simulation import Simulation

DIMENSIONS = pytest.mark.parametrize("dimension", [2, 3])
WAVE = {"smooth": [[0.0, 0.0], [0.25, 0.4], [0.75, -0.4], [1.0, 0.0]]}


def run(scene):
    it = Simulation(scene)
    it.go()
    return it


def chain(dimension, **keys):
    """Four bars in a row, the middle hinge driven, thrown and turning."""
    rest = [2.0] * (dimension - 1)
    spins = [1.0, -2.0, 0.5, 1.5] if dimension == 2 else [[1.0, 2.0 * i, 0.5] for i in range(4)]
    velocity = [0.3, 0.1, -0.2][:dimension]
    bars = [bar(1.1 + 0.6 * i, *rest, name=f"bar{i}", angular_velocity=spins[i], velocity=velocity) for i in range(4)]
    hinges = [hinge(f"bar{i}", f"bar{i + 1}", at=[1.4 + 0.6 * i, *rest]) for i in range(3)]
    hinges[1]["drive"] = WAVE
    return linked_scene(bars, hinges, **keys)


@pytest.mark.long
@pytest.mark.parametrize(("dimension", "steps"), [(2, 1000), (3, 200)])
def test_a_free_chain_keeps_its_momenta_and_its_joints_together(dimension, steps):
    it, gaps = Simulation(chain(dimension, end=0.002 * steps, step=0.002)), []
    before = momenta(it)
    it.observe(lambda now: gaps.append(misfit(now)))
    it.go()
    scale = np.abs(before).max()
    assert scale > 1e-3
    np.testing.assert_allclose(momenta(it), before, atol=1e-12 * scale)
    assert len(gaps) == steps
    assert max(gaps) < 1e-12
    assert np.abs(it.state.link.force).max() > 0.0


def test_a_drive_works_as_the_ledger_says_to_second_order():
    ledgers = [run(chain(2, end=0.5, step=step)).state.ledger for step in (0.01, 0.005, 0.0025)]
    errors = [abs(ledger.residual) for ledger in ledgers]
    assert abs(ledgers[0].control) > 1e3 * errors[2]
    assert errors[1] < 0.3 * errors[0]
    assert errors[2] < 0.3 * errors[1]


@pytest.mark.parametrize(
    ("corner", "last", "error"), [(0.1, 0.5, 1e-10), (0.1037, 0.5, 1e-5), (0.10006, 0.5, 1e-5), (0.1, 1e3, 1e-4)]
)
def test_the_ledger_has_the_work_of_a_drive_whose_rate_jumps(corner, last, error):
    """At the end of a step, between two ticks, and in a stroke of many steps."""
    jumps = {"piecewise": [[0.0, 0.0], [corner, 0.3], [0.4, -0.3], [last, 0.0]]}
    bars = [bar(1.5, 2.0, name="a"), bar(2.1, 2.0, name="b", angular_velocity=1.0)]
    it = Simulation(linked_scene(bars, [hinge("a", "b", at=[1.8, 2.0], drive=jumps)], end=0.5, step=0.02))
    it.go(0.1)
    thrown = it.state.ledger.control
    it.go(0.3)
    assert abs(it.state.ledger.control - thrown) > 0.05 * it.state.ledger.initial
    it.go()
    assert abs(it.state.ledger.residual) < error * it.state.ledger.initial


def pendulum(**keys):
    """Two bars, the first hinged to the ground, that fall."""
    bars = [bar(2.3, 3.0, name="upper"), bar(2.9, 3.0, name="lower")]
    hinges = [hinge("upper", at=[2.0, 3.0]), hinge("upper", "lower", at=[2.6, 3.0])]
    return linked_scene(bars, hinges, gravity=[0.0, -10.0], **keys)


def test_a_double_pendulum_keeps_its_energy_to_second_order():
    errors = []
    for step in (0.02, 0.01, 0.005):
        it, residuals = Simulation(pendulum(end=0.8, step=step)), []
        it.observe(lambda now, seen=residuals: seen.append(now.state.ledger.residual))
        it.go()
        errors.append(np.abs(residuals).max() / it.state.ledger.gravity)
    assert errors[0] < 0.02
    assert all(finer < 0.3 * coarser for coarser, finer in pairwise(errors))


def test_the_period_of_a_physical_pendulum():
    """2π √(I/(m g l)) for small angles: gravity pulls aside by .005, so that it swings to .01 in half of it."""
    mass, inertia, lever = 0.0125 * np.pi, 0.0125 * np.pi * (0.25**2 + 0.05**2) / 4.0, 0.6
    period = 2.0 * np.pi * np.sqrt((inertia + mass * lever**2) / (mass * lever))
    size, given = period / 800.0, bar(2.0, 1.4, angle=0.5 * np.pi, name="it")
    gravity = [np.sin(5e-3), -np.cos(5e-3)]
    it = run(linked_scene([given], [hinge("it", at=[2.0, 2.0])], gravity=gravity, end=450.0 * size, step=size))
    times, angle = it.history.bodies["time"], it.history.bodies["angle"] - 0.5 * np.pi
    near_turn = slice(380, 421)
    bend, slope, _ = np.polyfit(times[near_turn] / period - 0.5, angle[near_turn], 2)
    assert angle.max() == pytest.approx(0.01, rel=1e-4)
    assert 0.5 * slope / bend == pytest.approx(0.0, abs=0.5e-5)


def test_a_ball_on_a_rail_falls_freely():
    it = run(linked_scene([body(2.0, 3.0, free=["y"])], gravity=[5.0, -2.0]))
    ball = it.bodies["body0"]
    np.testing.assert_allclose(ball.position, [2.0, 3.0 - 1.0], atol=1e-12)
    np.testing.assert_allclose(ball.velocity, [0.0, -2.0], atol=1e-12)
    assert ball.orientation[0] == 0.0
    np.testing.assert_allclose(it.state.link.force[:1], [-5.0 * it.system.mass[0]], rtol=1e-10)


def test_a_ball_on_a_spring_oscillates_with_its_frequency_to_second_order():
    """Pulled by its weight alone: y = -(m g/k)(1 - cos ωt), in steps that springs do not cut."""
    mass, errors = np.pi * 0.01, []
    for step in (0.04, 0.02, 0.01):
        spring = {"stiffness": [0.0, 16.0 * mass]}
        it = run(linked_scene([body(2.0, 3.0, free=["y"], spring=spring)], gravity=[0.0, -2.0], step=step))
        errors.append(abs(it.bodies["body0"].position[1] - 3.0 + 0.125 * (1.0 - np.cos(4.0))))
        assert abs(it.state.ledger.relative_residual) < 0.05 * step
    assert errors[0] < 1e-3
    assert all(finer < 0.27 * coarser for coarser, finer in pairwise(errors))


def test_springs_that_are_fast_are_cut_into_parts():
    spring = {"stiffness": [0.0, 400.0 * np.pi]}
    it = run(linked_scene([body(2.0, 3.0, free=["y"], spring=spring, velocity=[0.0, 1.0])], end=0.02, step=2e-3))
    assert it.system.joints.frequency == pytest.approx(200.0)
    assert it.bodies["body0"].velocity[1] == pytest.approx(np.cos(4.0), abs=8e-3)


@pytest.mark.parametrize("stepping", ["substeps", "implicit"])
@pytest.mark.parametrize("damping", [0.0, 0.02])
def test_a_ball_with_springs_alone_bounces_between_them_and_a_wall(stepping, damping):
    spring = {"stiffness": [0.0, 1.0], "damping": [0.0, damping]}
    contact = {"law": "centre", "range": 0.02, "epsilon": 1e-5, "stepping": stepping}
    it = Simulation(linked_scene([body(2.0, 0.3, velocity=[0.0, -2.0], spring=spring)], contact=contact, end=0.4))
    it.go(0.2)
    assert it.bodies["body0"].velocity[1] > 0.5
    it.go()
    account = energy_account(it.history.energy)
    assert max(account.created, account.lost) < 1e-2
    assert (it.state.ledger.contact_loss > 0.0) == (damping > 0.0)


@pytest.mark.parametrize("damping", [0.1, 2.0, 1e6])
def test_a_damper_is_exact_at_any_strength(damping):
    """m u' = m g - c u."""
    mass = np.pi * 0.01
    ball = body(2.0, 3.0, free=["y"], velocity=[0.0, 1.0], spring={"damping": [0.0, damping * mass]})
    it = run(linked_scene([ball], gravity=[0.0, -3.0], end=0.5, step=0.1))
    final = -3.0 / damping
    exact = final + (1.0 - final) * np.exp(-0.5 * damping)
    assert it.bodies["body0"].velocity[1] == pytest.approx(exact, rel=1e-8, abs=1e-8)
    assert it.state.ledger.contact_loss > 0.0


def test_the_ledger_has_what_a_hinge_damper_takes_to_second_order():
    errors = []
    for step in (0.02, 0.01, 0.005):
        bars = [bar(1.5, 2.0, name="a", angular_velocity=3.0), bar(2.1, 2.0, name="b")]
        it = run(linked_scene(bars, [hinge("a", "b", at=[1.8, 2.0], damping=3e-4)], end=0.4, step=step))
        errors.append(abs(it.state.ledger.residual))
        start = it.state.ledger.initial
    assert it.state.ledger.contact_loss > 0.1 * start
    assert errors[0] < 1e-3 * start
    assert all(finer < 0.3 * coarser for coarser, finer in pairwise(errors))


def test_a_body_of_given_motion_works_on_what_is_hinged_to_it():
    errors = []
    for step in (0.02, 0.01, 0.005):
        driver = body(
            1.5, 2.0, name="driver", prescribed={"amplitude": [0.1, 0.0], "frequency": 1.0, "angular_velocity": 2.0}
        )
        given = hinge("bar", "driver", at=[1.7, 2.0], stiffness=1e-3)
        it = run(linked_scene([driver, bar(2.0, 2.0, name="bar")], [given], gravity=[0.0, -3.0], end=0.4, step=step))
        assert misfit(it) < 1e-12
        errors.append(abs(it.state.ledger.residual))
    assert abs(it.state.ledger.control) > 100.0 * errors[-1]
    assert all(finer < 0.3 * coarser for coarser, finer in pairwise(errors))


@pytest.mark.long
def test_a_bar_hinged_to_a_mechanism_that_changes_its_shape(install):
    """The work of the stroke against hinge, springs and gravity is in the ledger, to second order."""
    install(Path(mechanism_parts.__file__).read_text(encoding="utf-8"), name="strokes", module="installed_strokes")
    errors = []
    for step in (0.02, 0.01):
        stroke = {"name": "it", "type": "stroke", "radius": 0.05, "length": 0.3, "stroke": 0.1, "ratio": 3.0}
        stroke |= {"density": 1.0, "position": [1.5, 1.5], "angular_velocity": 1.0}
        held = bar(2.3, 1.5, name="bar", spring={"stiffness": [0.1, 0.1]})
        given = hinge("it.right", "bar", at=[2.05, 1.5], stiffness=1e-3)
        it = run(linked_scene([held], [given], mechanism=[stroke], gravity=[0.0, -3.0], end=0.5, step=step))
        assert misfit(it) < 1e-12
        errors.append(abs(it.state.ledger.residual))
    assert errors[1] < 1e-4 * it.state.ledger.kinetic
    assert errors[1] < 0.3 * errors[0]


@pytest.mark.long
@pytest.mark.parametrize(("stepping", "error"), [("substeps", 5e-4), ("implicit", 1e-3)])
@DIMENSIONS
def test_a_hinged_pair_that_hits_a_wall_keeps_its_energy(stepping, error, dimension):
    rest, speed = [2.0] * (dimension - 2), [0.5, -2.0, 0.0][:dimension]
    bars = [bar(1.5, 0.3, *rest, name="a", velocity=speed), bar(2.1, 0.35, *rest, name="b", velocity=speed)]
    contact = {"law": "normal", "range": 0.02, "epsilon": 1e-6, "stepping": stepping}
    given = hinge("a", "b", at=[1.8, 0.3, *rest], **({"axis": [0.0, 0.0, 1.0]} if dimension == 3 else {}))
    it = Simulation(linked_scene(bars, [given], contact=contact, end=0.16, step=2e-3))
    pushed = []
    it.observe(lambda now: pushed.append(np.abs(now.bodies["a"].contact_force).max() > 0.0))
    it.go()
    assert any(pushed)
    assert it.bodies["a"].velocity[1] > 0.0
    assert misfit(it) < 1e-12
    account = energy_account(it.history.energy)
    assert max(account.created, account.lost) < error


def test_links_keep_momentum_where_others_hit_them():
    bars = [bar(1.5, 2.0, name="a"), bar(2.1, 2.0, name="b"), body(1.4, 2.4, name="ball", velocity=[0.0, -2.0])]
    contact = {"law": "normal", "range": 0.02, "epsilon": 1e-6}
    it = Simulation(linked_scene(bars, [hinge("a", "b", at=[1.8, 2.0])], contact=contact, end=0.3, step=2e-3))
    before = momenta(it)
    it.go()
    assert abs(it.bodies["b"].angular_velocity[0]) > 0.1
    np.testing.assert_allclose(momenta(it), before, atol=1e-11)


def test_a_run_of_linked_bodies_taken_up_again(tmp_path):
    bars = [bar(1.5, 2.0, name="a", angular_velocity=3.0), bar(2.1, 2.0, name="b"), bar(2.7, 2.0, name="c")]
    hinges = [hinge("a", "b", at=[1.8, 2.0], damping=1e-4, stiffness=1e-3), hinge("b", "c", at=[2.4, 2.0], drive=WAVE)]
    bars[0]["spring"] = {"stiffness": [0.1, 0.1]}
    whole, first = (linked_scene(bars, hinges, end=end, output={"every": 0.05}) for end in (0.2, 0.1))
    rigidfluid.run(whole, tmp_path / "whole")
    rigidfluid.run(first, tmp_path / "parts")
    rigidfluid.run(whole, tmp_path / "parts", resume=True)
    for name in ("bodies.csv", "energy.csv"):
        assert (tmp_path / "parts" / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()


def test_a_ball_on_a_spring_alone_in_a_fluid():
    """It is pulled back along the spring by what is stored in it, and no link has a force."""
    ball = body(0.5, 0.5, velocity=[0.0, 0.1], spring={"stiffness": [0.0, 1.0]})
    fluid, mesh = {"backend": "scikit-fem", "density": 1.0, "viscosity": 0.1}, {"size": 0.2, "size_body": 0.08}
    it = run(linked_scene([ball], end=0.03, upper=1.0, fluid=fluid, mesh=mesh))
    displaced = it.bodies["body0"].position[1] - 0.5
    assert displaced > 1e-3
    np.testing.assert_allclose(it.state.link.wrench, [[0.0, -displaced, 0.0]], atol=1e-15)
    assert len(it.state.link.force) == 0
    assert it.state.ledger.contact == pytest.approx(0.5 * displaced**2, rel=1e-12)
