"""Bodies enter and leave: what stays, what the account of energy says, and what is refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scenes import dry_tables, wet_tables

from rigidfluid.api import Simulation, scene_from_dict
from rigidfluid.errors import SceneError

FIRST = {"name": "first", "type": "sphere", "radius": 0.1, "density": 2.0, "position": [0.3, 0.7]}
SECOND = FIRST | {"name": "second", "position": [0.7, 0.6], "velocity": [0.0, 0.1]}
THIRD = FIRST | {"name": "third", "position": [0.5, 0.25], "velocity": [0.2, 0.0], "angular_velocity": 3.0}
CONTACT = {"law": "spring-dashpot", "range": 0.05, "stiffness": 2e3, "restitution": 0.8, "friction": 0.3}
AUTO = {"law": "normal", "range": 0.05, "epsilon": "auto"}
FALLING = THIRD | {"position": [0.5, 0.14], "velocity": [0.0, -0.3]}


def dry(*bodies: dict[str, Any], **tables: Any) -> Simulation:
    tables = {"contact": CONTACT, "fluid": {"gravity": [0.0, -1.0]}} | tables
    return Simulation(scene_from_dict(dry_tables(*(bodies or (FIRST, SECOND)), **tables)))


def wet(out: Path | None = None, resume: bool = False, **tables: Any) -> Simulation:
    tables = {"contact": CONTACT, "fluid": {"gravity": [0.0, -1.0]}, "end": 0.2, "step": 0.02} | tables
    return Simulation(scene_from_dict(wet_tables(FIRST, SECOND, **tables)), out, resume=resume)


def test_a_body_enters_with_its_energy_and_the_others_go_on() -> None:
    run, alone = dry(), dry()
    run.go(0.1)
    before = run.state.ledger
    run.add(THIRD)
    mass = 2.0 * np.pi * 0.1**2
    kinetic = 0.5 * mass * 0.2**2 + 0.5 * (0.5 * mass * 0.1**2) * 3.0**2
    assert run.state.ledger.exchange == pytest.approx(kinetic, rel=1e-12)
    assert run.state.ledger.residual == pytest.approx(before.residual, abs=1e-14)
    assert list(run.bodies) == ["first", "second", "third"]
    run.go(0.3)
    alone.go(0.3)
    np.testing.assert_allclose(run.state.pose.position[:2], alone.state.pose.position, rtol=0, atol=1e-14)
    np.testing.assert_allclose(run.state.pose.position[2], [0.54, 0.23], rtol=0, atol=1e-12)
    assert run.state.ledger.residual == pytest.approx(0.0, abs=1e-12)


def test_a_body_leaves_with_its_energy() -> None:
    run, alone = dry(), dry(SECOND)
    run.go(0.1)
    kinetic = 0.5 * 2.0 * np.pi * 0.1**2 * float(np.sum(run.state.twist.velocity[0] ** 2))
    run.remove("first")
    assert run.state.ledger.exchange == pytest.approx(-kinetic, rel=1e-12)
    run.go(0.3)
    alone.go(0.3)
    assert list(run.bodies) == ["second"]
    np.testing.assert_allclose(run.state.pose.position, alone.state.pose.position, rtol=0, atol=1e-14)
    assert run.state.ledger.residual == pytest.approx(0.0, abs=1e-12)


def test_springs_of_bodies_that_stay_are_kept() -> None:
    """A ball is held on a slope by the springs of its friction with the ground and another ball, which leaves."""
    resting = FIRST | {"name": "resting", "position": [0.6, 0.14997]}
    beside = FIRST | {"name": "beside", "position": [0.84999, 0.14997], "fixed": True}
    sloped = {"gravity": [0.2, -1.0]}
    run = dry(FIRST, resting, beside, fluid=sloped, contact=CONTACT | {"tangential_stiffness": 1e3})
    run.go(0.1)
    before, residual = run.state.springs, run.state.ledger.residual
    assert before is not None
    on_ground = np.flatnonzero(before.body_b >= 3)
    assert sorted(zip(before.body_a.tolist(), before.body_b.tolist(), strict=True))[0] == (1, 2)
    run.remove("first")
    run.remove("beside")
    after = run.state.springs
    assert after is not None
    assert (after.body_a.tolist(), after.body_b.tolist()) == ([0], [int(before.body_b[on_ground[0]]) - 2])
    np.testing.assert_array_equal(after.displacement, before.displacement[on_ground])
    assert run.state.ledger.residual == pytest.approx(residual, abs=1e-15)


def test_a_prescribed_body_goes_on_as_prescribed() -> None:
    shaken = SECOND | {"prescribed": {"amplitude": [0.05, 0.0], "frequency": 2.0}}
    del shaken["velocity"]
    run, alone = dry(FIRST, shaken), dry(FIRST, shaken)
    run.go(0.13)
    run.add(THIRD)
    run.go(0.25)
    alone.go(0.25)
    np.testing.assert_allclose(run.state.pose.position[1], alone.state.pose.position[1], rtol=0, atol=1e-14)
    np.testing.assert_allclose(run.state.twist.velocity[1], alone.state.twist.velocity[1], rtol=0, atol=1e-14)


def test_a_prescribed_body_moves_from_where_it_enters() -> None:
    run = dry(FIRST, SECOND, fluid={"gravity": [0.0, 0.0]})
    run.go(0.1)
    guest = {name: value for name, value in THIRD.items() if "velocity" not in name}
    run.add(guest | {"prescribed": {"velocity": [0.4, 0.0], "amplitude": [0.0, 0.03], "frequency": 2.0}})
    run.go(0.2)
    swung = 0.03 * (np.sin(0.4 * np.pi * 2.0) - np.sin(0.4 * np.pi))
    np.testing.assert_allclose(run.state.pose.position[2], [0.5 + 0.1 * 0.4, 0.25 + swung], rtol=0, atol=1e-12)


def test_the_account_closes_in_a_fluid() -> None:
    run = wet()
    run.go(0.06)
    before = run.state.ledger.residual
    run.add(THIRD | {"velocity": [0.5, -0.5], "angular_velocity": 0.0})
    assert run.state.ledger.residual == pytest.approx(before, abs=1e-15)
    brought = run.state.ledger.exchange
    assert brought > 0.5 * 2.0 * np.pi * 0.1**2 * 0.5  # its own energy and that of the fluid around it
    run.go(0.12)
    run.remove("second")
    run.go()
    assert abs(run.state.ledger.residual) < 1e-3 * brought
    assert run.history.bodies["body"].tolist()[-2:] == ["first", "third"]


@pytest.mark.parametrize(
    ("contact", "third"),
    [(CONTACT, THIRD), pytest.param(AUTO, FALLING, marks=pytest.mark.long)],
    ids=["free", "strength by the loads at an exchange"],
)
def test_a_resumed_run_has_the_bodies_of_the_earlier_one(
    tmp_path: Path, contact: dict[str, Any], third: dict[str, Any]
) -> None:
    tables = {"output": {"every": 0.1}, "contact": contact}
    run, whole = wet(tmp_path, **tables), wet(**tables)
    for one in (run, whole):
        one.go(0.04)
        one.add(third)
        one.go(0.08)
        one.remove("first")
    run.go(0.1)
    run.close()
    resumed = wet(tmp_path, resume=True, **tables)
    assert list(resumed.bodies) == ["second", "third"]
    for one in (resumed, whole):
        one.go()
    np.testing.assert_array_equal(resumed.state.pose.position, whole.state.pose.position)
    assert resumed.state.ledger == whole.state.ledger
    resumed.close()


def test_restoring_brings_back_who_was_there() -> None:
    run = wet()
    run.go(0.04)
    saved = run.save()
    run.add(THIRD)
    run.go(0.06)
    run.restore(saved)
    assert list(run.bodies) == ["first", "second"]
    run.go(0.1)
    other = wet()
    other.go(0.1)
    np.testing.assert_array_equal(run.state.pose.position, other.state.pose.position)


@pytest.mark.parametrize(
    ("body", "message"),
    [
        (THIRD | {"name": "first"}, "first"),
        ({key: value for key, value in THIRD.items() if key != "name"}, "no name"),
        (THIRD | {"position": [0.35, 0.65]}, "first"),
        (THIRD | {"position": [5.0, 0.5]}, "third"),
        (THIRD | {"raduis": 1.0}, "raduis"),
        (THIRD | {"type": "blob"}, "blob"),
        ("third", "mapping"),
    ],
)
def test_bodies_that_cannot_enter_change_nothing(body: Any, message: str) -> None:
    run = dry()
    run.go(0.02)
    state, system = run.state, run.system
    with pytest.raises(Exception, match=message) as found:
        run.add(body)
    assert type(found.value).__name__ in ("SceneError", "SceneErrors", "PluginError")
    assert run.state is state
    assert run.system is system
    run.step()


def test_a_body_on_a_spring_does_not_enter() -> None:
    run = dry()
    with pytest.raises(SceneError, match=r"body\.spring"):
        run.add(THIRD | {"spring": {"stiffness": 1.0}})
    assert list(run.bodies) == ["first", "second"]


def test_bodies_that_cannot_leave() -> None:
    run = dry(FIRST)
    with pytest.raises(SceneError, match="the last one"):
        run.remove("first")
    with pytest.raises(SceneError, match="first"):
        run.remove("nobody")


def test_a_name_is_not_used_twice() -> None:
    run = dry()
    run.remove("first")
    with pytest.raises(SceneError, match="has had"):
        run.add(FIRST)


def test_a_body_that_enters_in_another_one_is_named_first() -> None:
    with pytest.raises(SceneError, match=r"body 'third'.*where body 'third' overlaps body 'second' by 0.1"):
        dry().add(THIRD | {"position": [0.7, 0.5]})


def test_the_name_of_a_joint_is_refused_as_such() -> None:
    run = dry(joint=[{"type": "rod", "name": "link", "between": ["first", "second"]}])
    with pytest.raises(SceneError, match=r"body.name: found 'link', the name of a joint; allowed is a name that no"):
        run.add(THIRD | {"name": "link"})


def test_joined_bodies_stay() -> None:
    joint = {"type": "rod", "between": ["first", "second"]}
    run = dry(joint=[joint])
    run.add(THIRD)
    with pytest.raises(SceneError, match=r"'first', which a joint.*may leave: third"):
        run.remove("first")
