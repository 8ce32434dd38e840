"""Bodies enter and leave beside joints, springs to the ground and mechanisms, whose bodies stay and go on as before."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scenes import dry_tables, wet_tables
from two_parts import run_in_two_parts

from rigidfluid.api import Simulation, scene_from_dict
from rigidfluid.errors import SceneError
from rigidfluid.post.reports.results import read_results
from rigidfluid.post.reports.results_in_memory import results_of

BALL = {"type": "sphere", "radius": 0.05, "density": 2.0}
OTHER = BALL | {"name": "other", "position": [0.9, 0.4]}
GUEST = BALL | {"name": "guest", "position": [0.1, 0.2], "angular_velocity": 2.0}
BOB = BALL | {"name": "bob", "position": [0.65, 0.65]}
FOREARM = BALL | {"name": "forearm", "position": [0.8, 0.5]}
PIVOT = {"name": "pivot", "type": "hinge", "between": ["bob"], "at": [0.5, 0.8], "stiffness": 0.02, "damping": 1e-3}
ELBOW = {"name": "elbow", "type": "hinge", "between": ["forearm", "bob"], "at": [0.72, 0.58]}
DRIVE = {"drive": {"smooth": [[0.0, 0.0], [0.15, 0.4], [0.3, 0.0]]}}
SPRUNG = BALL | {
    "name": "sprung",
    "position": [0.2, 0.7],
    "free": ["y", "rotation"],
    "spring": {"stiffness": [0.0, 2.0], "damping": [0.0, 0.01], "angular_stiffness": 1e-3, "rest": [0.0, 0.6]},
    "angular_velocity": 1.0,
}
SWIMMER = {
    "name": "swimmer",
    "type": "three_sphere_swimmer",
    "radius": 0.03,
    "arms": 0.15,
    "amplitude": 0.05,
    "speed": 0.5,
    "density": 2.0,
    "position": [0.5, 0.3],
    "angular_velocity": 0.4,
}

CASES: dict[str, dict[str, Any]] = {
    "pendulum": {"body": [BOB], "joint": [PIVOT]},
    "double pendulum": {"body": [BOB, FOREARM], "joint": [PIVOT, ELBOW]},
    "drive": {"body": [BOB, FOREARM], "joint": [PIVOT, ELBOW | DRIVE]},
    "spring": {"body": [SPRUNG]},
    "strokes": {"body": [], "mechanism": [SWIMMER]},
    "all": {"body": [BOB, SPRUNG], "joint": [PIVOT], "mechanism": [SWIMMER]},
}


def tables_of(case: str, make: Any = dry_tables, **more: Any) -> dict[str, Any]:
    """Tables in which a far body, the first of all, may leave."""
    given = {name: value for name, value in CASES[case].items() if name != "body"}
    defaults = {"fluid": {"gravity": [0.0, -1.0]}, "end": 0.4, "step": 0.005}
    bodies = [OTHER | {"fixed": True, "name": "post", "position": [0.9, 0.9]}, OTHER, *CASES[case]["body"]]
    return make(*bodies, **(defaults | given | more))


def of(run: Simulation, table: str, column: str, name: str) -> Any:
    """Values of a column of one body or joint over time."""
    rows, key = run.history.table(table), {"bodies": "body", "joints": "joint"}[table]
    return rows[column][rows[key] == name]


def names_of(run: Simulation, table: str) -> set[str]:
    return set(run.history.table(table)[{"bodies": "body", "joints": "joint"}[table]].tolist())


@pytest.mark.parametrize("case", CASES)
def test_motion_goes_on_over_an_exchange(case: str) -> None:
    """To rounding, with forces and angles of joints, and with the energy in springs."""
    run, alone = (Simulation(scene_from_dict(tables_of(case))) for _ in range(2))
    run.go(0.13)
    run.add(GUEST)
    run.go(0.21)
    run.remove("other")
    run.go()
    alone.go()
    stay = names_of(alone, "bodies") - {"other"}
    assert names_of(run, "bodies") - {"guest", "other"} == stay
    for column in ("x", "y", "angle", "vx", "vy", "w"):
        for name in stay:
            np.testing.assert_allclose(
                of(run, "bodies", column, name), of(alone, "bodies", column, name), rtol=0, atol=1e-11, err_msg=name
            )
    assert names_of(run, "joints") == names_of(alone, "joints")
    for column in ("gap", "angle", "rate", "fx", "fy", "t"):
        for name in names_of(alone, "joints"):
            found, wanted = (of(one, "joints", column, name) for one in (run, alone))
            np.testing.assert_allclose(found, wanted, rtol=1e-9, atol=1e-9, err_msg=f"{name} {column}")
    for name in ("contact", "control", "contact_loss"):
        np.testing.assert_allclose(run.history.energy[name], alone.history.energy[name], rtol=0, atol=1e-12)
    np.testing.assert_allclose(run.history.energy["residual"], alone.history.energy["residual"], rtol=0, atol=1e-11)
    assert [body.name for body in run.model.bodies][-1] == "guest"


def test_a_hinge_in_space_keeps_its_axis() -> None:
    bob = {"name": "bob", "type": "ellipsoid", "semi_axes": [0.08, 0.05, 0.04], "density": 2.0}
    bob |= {"position": [0.65, 0.65, 0.5], "angular_velocity": [0.6, -0.8, 0.0]}
    bob["velocity"] = np.cross(bob["angular_velocity"], np.array([0.15, -0.15, 0.0])).tolist()
    hinge = {"name": "pivot", "type": "hinge", "between": ["bob"], "at": [0.5, 0.8, 0.5], "axis": [0.6, -0.8, 0.0]}
    tables = dry_tables(
        OTHER | {"position": [0.9, 0.4, 0.5]}, bob, joint=[hinge], fluid={"gravity": [0.0, -1.0, 0.5]}, step=0.005
    )
    run, alone = (Simulation(scene_from_dict(tables)) for _ in range(2))
    run.go(0.2)
    run.add(GUEST | {"position": [0.1, 0.2, 0.5], "angular_velocity": [0.0, 0.0, 1.0]})
    run.remove("other")
    for one in (run, alone):
        one.go(0.4)
    assert np.ptp(of(alone, "joints", "angle", "pivot")) > 0.1
    np.testing.assert_allclose(of(run, "joints", "angle", "pivot"), of(alone, "joints", "angle", "pivot"), atol=1e-11)
    assert of(run, "joints", "gap", "pivot").max() < 1e-12


def test_a_rotor_on_a_body_that_is_driven_follows_the_caller() -> None:
    """Who prescribes its motion anew before bodies enter."""
    hub = BALL | {"name": "hub", "position": [0.5, 0.8], "fixed": True}
    axle = {"name": "axle", "type": "hinge", "between": ["bob", "hub"], "at": [0.58, 0.72]}
    tables = dry_tables(hub, OTHER, BOB, joint=[axle], fluid={"gravity": [0.0, -1.0]}, step=0.005)
    run, alone = (Simulation(scene_from_dict(tables)) for _ in range(2))
    for one in (run, alone):
        one.go(0.1)
        one.prescribe("hub", angular_velocity=[1.5], over=0.05)
        one.go(0.12)
    run.add(GUEST)
    for one in (run, alone):
        one.go(0.3)
    np.testing.assert_allclose(of(run, "joints", "angle", "axle"), of(alone, "joints", "angle", "axle"), atol=1e-11)
    assert run.state.ledger.control == pytest.approx(alone.state.ledger.control, abs=1e-12)


@pytest.mark.parametrize("case", ["pendulum", pytest.param("all", marks=pytest.mark.long)])
def test_a_resumed_run_has_the_joints_of_the_earlier_one(case: str, tmp_path: Path) -> None:
    source = {"name": "grain", "shape": [{"type": "sphere", "radius": 0.03}], "density": 2.0, "times": [0.1, 0.25]}
    source["region"] = {"type": "box", "lower": [0.02, 0.02], "upper": [0.3, 0.2]}
    sink = {"when": "age > 0.12 and t > 0.22"}
    scene = scene_from_dict(tables_of(case, source=[source], sink=[sink], output={"every": 0.15}, step=0.01))
    whole, resumed = Simulation(scene), run_in_two_parts(scene, tmp_path, 0.3)
    whole.go()
    assert whole.history.exchanges["body"].tolist() == ["grain0", "other", "grain0", "grain1", "grain1"]
    for table in ("bodies", "joints", "energy", "exchanges"):
        for column, values in whole.history.table(table).items():
            np.testing.assert_array_equal(resumed.history.table(table)[column], values, err_msg=f"{table} {column}")


def test_results_have_mechanisms_beside_bodies_that_change(tmp_path: Path) -> None:
    run = Simulation(scene_from_dict(tables_of("all", output={"every": 0.1}, step=0.01)), tmp_path)
    run.go(0.1)
    run.add(GUEST)
    run.go(0.2)
    run.remove("other")
    run.go()
    run.finish("complete")
    run.close()
    spheres = tuple(f"swimmer.{name}" for name in ("left", "middle", "right"))
    for found in (read_results(tmp_path), results_of(run)):
        assert found.names[:5] == ("post", "other", "bob", "sprung", "guest")
        assert len(found.names[5:]) == len(spheres)
        assert found.present[-1].tolist() == [True, False, *6 * [True]]
        assert np.isfinite(found.wholes["x"]).all()


@pytest.mark.parametrize("name", ["bob", "sprung", "swimmer.left"])
def test_held_bodies_do_not_leave(name: str) -> None:
    run = Simulation(scene_from_dict(tables_of("all", sink=[{"when": "t > 0.02"}])))
    name = next(body for body in run.bodies if body.startswith(name[:9]))
    with pytest.raises(SceneError, match=r"which a joint, a spring or a mechanism holds.*may leave: post, other"):
        run.remove(name)
    run.go(0.1)
    assert run.history.exchanges["body"].tolist() == ["other"]


def test_a_long_range_force_leaves_with_its_body() -> None:
    """And with its energy, which the account has; the joint's force goes on."""
    force = {"law": "dipole", "range": 2.0, "strength": 1e-5, "moments": [[0.0, 1.0], [1.0, 0.0]]}
    run = Simulation(scene_from_dict(tables_of("pendulum", interaction=[force | {"names": ["bob", "other"]}])))
    run.go(0.1)
    before, stored = run.state, run.system.joints.spring_energy(run.state.motions.pose, 0.1)
    run.remove("other")
    now = run.system.joints.spring_energy(run.state.motions.pose, 0.1)
    (taken,) = run.history.exchanges["kinetic"]
    assert abs(now - stored) > 1e-6
    assert run.state.ledger.exchange == pytest.approx(now - stored - taken, rel=1e-12)
    np.testing.assert_array_equal(run.state.link.force, before.link.force)
    run.go(0.2)
    assert abs(run.state.ledger.residual) < 1e-6


def test_a_window_keeps_its_bodies() -> None:
    window = {"follow": "bob", "direction": "y", "ahead": 0.4, "behind": 0.4}
    domain = {"lower": [0.0, 0.0], "upper": [1.0, 4.0], "window": window}
    run = Simulation(scene_from_dict(wet_tables(BOB, domain=domain, mesh={"size": 0.4})))
    with pytest.raises(SceneError, match=r"domain\.window"):
        run.add(GUEST)


@pytest.mark.parametrize("case", ["pendulum", "spring", pytest.param("strokes", marks=pytest.mark.long)])
def test_nothing_jumps_in_a_fluid(case: str) -> None:
    """In the short steps after an exchange velocities hardly change, and places as they say; what the fluid and joints
    do not account for is as little as without exchanges."""
    fluid = {"gravity": [0.0, -1.0], "viscosity": 0.02}
    tables = tables_of(case, wet_tables, step=0.015, end=0.24, fluid=fluid)
    run, alone = (Simulation(scene_from_dict(tables)) for _ in range(2))
    run.go(0.09)
    run.add(GUEST | {"position": [0.15, 0.15]})
    run.go(0.15)
    run.remove("other")
    for one in (run, alone):
        one.go()
    name = {"pendulum": "bob", "spring": "sprung", "strokes": "swimmer"}[case]
    time = of(run, "bodies", "time", name)
    place, speed = (
        np.stack([of(run, "bodies", column, name) for column in columns], axis=1)
        for columns in (("x", "y", "angle"), ("vx", "vy", "w"))
    )
    after = np.searchsorted(time, np.unique(run.history.exchanges["time"]) + 1e-9)
    greatest, change = np.abs(speed).max(axis=0), speed[after] - speed[after - 1]
    scale = np.maximum(greatest, 1e-3 * greatest.max())
    assert np.abs(change / scale).max() < 0.01
    size = (time[after] - time[after - 1])[:, None]
    moved = place[after] - place[after - 1] - 0.5 * size * (speed[after] + speed[after - 1])
    assert np.abs(moved / (size * scale)).max() < 1e-3
    if case != "strokes":
        assert run.history.joints["gap"].max() < 1e-12
    ledger = run.state.ledger
    assert ledger.residual == pytest.approx(alone.state.ledger.residual, abs=0.02 * ledger.dissipation)
