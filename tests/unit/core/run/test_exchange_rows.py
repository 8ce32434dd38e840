"""Account of bodies that enter and leave: what each one brings and takes, and that nothing is lost between."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scenes import dry_tables, wet_tables
from scipy.spatial.transform import Rotation

from rigidfluid.api import Simulation, load_results, scene_from_dict
from rigidfluid.errors import OutputError

FIRST = {"name": "first", "type": "sphere", "radius": 0.1, "density": 2.0, "position": [0.3, 0.7]}
SECOND = FIRST | {"name": "second", "position": [0.7, 0.6], "velocity": [0.0, 0.1]}
GUEST = {
    "name": "guest",
    "type": "ellipsoid",
    "semi_axes": [0.1, 0.05],
    "density": 3.0,
    "position": [0.5, 0.25],
    "velocity": [0.2, -0.1],
    "angular_velocity": 3.0,
}
REGION = {"type": "box", "lower": [0.1, 0.5], "upper": [0.9, 0.9]}
SHAPES = [{"type": "sphere", "radius": 0.05}, {"type": "ellipsoid", "semi_axes": [0.06, 0.04]}]
SOURCE = {"name": "grain", "shape": SHAPES, "density": 2.0, "region": REGION, "velocity": [0.0, -1.0], "every": 0.06}
SINK = {"on": "bottom", "gap": 0.2}


def dry(*bodies: dict[str, Any], **tables: Any) -> Simulation:
    tables = {"fluid": {"gravity": [0.0, -1.0]}} | tables
    return Simulation(scene_from_dict(dry_tables(*(bodies or (FIRST, SECOND)), **tables)))


def stream(make: Any = dry_tables, **tables: Any) -> Any:
    """Scene with a source and a sink beside a fixed body."""
    fixed = FIRST | {"position": [0.95, 0.5], "radius": 0.04, "fixed": True}
    given = {"source": [SOURCE], "sink": [SINK], "end": 0.9, "step": 0.02, "output": {"every": 0.3}} | tables
    return scene_from_dict(make(fixed, **given))


def row(run: Simulation, number: int) -> dict[str, Any]:
    return {name: values[number] for name, values in run.history.exchanges.items()}


def test_a_row_has_what_a_body_brought() -> None:
    run = dry()
    run.go(0.1)
    run.add(GUEST)
    found = row(run, 0)
    mass = 3.0 * np.pi * 0.1 * 0.05
    spin = 0.25 * mass * (0.1**2 + 0.05**2) * 3.0
    assert (found["body"], found["change"], found["step"]) == ("guest", "entered", 10)
    wanted = {
        "time": 0.1,
        "x": 0.5,
        "y": 0.25,
        "mass": mass,
        "px": 0.2 * mass,
        "py": -0.1 * mass,
        "l": spin + 0.5 * -0.1 * mass - 0.25 * 0.2 * mass,
        "kinetic": 0.5 * mass * 0.05 + 0.5 * spin * 3.0,
    }
    assert {name: found[name] for name in wanted} == pytest.approx(wanted, rel=1e-12)
    assert found["kinetic"] == pytest.approx(run.state.ledger.exchange, rel=1e-12)


def test_a_row_has_what_a_body_took() -> None:
    """It fell for .1."""
    run = dry()
    run.go(0.1)
    run.remove("second")
    found, mass = row(run, 0), 2.0 * np.pi * 0.1**2
    assert (found["body"], found["change"]) == ("second", "gone")
    assert found["py"] == pytest.approx(0.0, abs=1e-12)
    assert found["y"] == pytest.approx(0.6 + 0.1 * 0.1 - 0.5 * 0.1**2, rel=1e-12)
    assert found["mass"] == pytest.approx(mass, rel=1e-12)


def test_the_angular_momentum_of_a_body_in_space_is_that_of_its_turned_axes() -> None:
    axes, turned = np.array([0.1, 0.06, 0.04]), Rotation.from_rotvec([0.3, -0.5, 0.8])
    x, y, z, w = turned.as_quat()
    velocity, spin, place = np.array([0.2, 0.1, -0.3]), np.array([1.0, -2.0, 0.5]), np.array([0.5, 0.3, 0.4])
    guest = {
        "name": "guest",
        "type": "ellipsoid",
        "semi_axes": axes.tolist(),
        "density": 3.0,
        "position": place.tolist(),
        "orientation": [w, x, y, z],
        "velocity": velocity.tolist(),
        "angular_velocity": spin.tolist(),
    }
    run = dry(FIRST | {"position": [0.2, 0.8, 0.8]}, fluid={"gravity": [0.0, 0.0, 0.0]})
    run.add(guest)
    mass = 3.0 * 4.0 / 3.0 * np.pi * np.prod(axes)
    inertia = mass / 5.0 * np.diag(np.sum(axes**2) - axes**2)
    matrix = turned.as_matrix()
    momentum = matrix @ inertia @ matrix.T @ spin
    found = row(run, 0)
    np.testing.assert_allclose(
        [found[name] for name in ("lx", "ly", "lz")], momentum + np.cross(place, mass * velocity), rtol=1e-12
    )
    kinetic = 0.5 * mass * velocity @ velocity + 0.5 * momentum @ spin
    assert found["kinetic"] == pytest.approx(kinetic, rel=1e-12)


def test_a_body_that_is_driven_has_no_energy_in_the_account() -> None:
    run = dry()
    free = {name: value for name, value in GUEST.items() if name not in ("velocity", "angular_velocity")}
    run.add(free | {"prescribed": {"velocity": [0.3, 0.0]}})
    found = row(run, 0)
    assert found["px"] == pytest.approx(0.3 * found["mass"], rel=1e-12)
    assert found["kinetic"] == 0.0
    assert run.state.ledger.exchange == pytest.approx(0.0, abs=1e-15)


def test_masses_add_up_and_energies_have_their_parts() -> None:
    run = Simulation(stream(fluid={"gravity": [0.0, 0.0]}))
    run.go()
    run.finish("complete")
    account, rows = run.history.summary["exchanges"], run.history.exchanges
    left = int((rows["change"] == "gone").sum())
    assert account["gone"]["bodies"] == left >= 3
    assert account["entered"]["bodies"] == len(rows["time"]) - left == left + len(run.bodies) - 1
    assert account["entered"]["mass"] > account["gone"]["mass"] > 0.0
    assert account["mass"]["there"] == pytest.approx(sum(run.system.mass), rel=1e-14)
    assert account["mass"]["residual"] == pytest.approx(0.0, abs=1e-15)
    assert account["entered"]["momentum"] == pytest.approx([0.0, -account["entered"]["mass"]], rel=1e-12, abs=1e-15)
    energy, own = account["energy"], 0.5 * (account["entered"]["mass"] - account["gone"]["mass"])
    assert energy["bodies"] == pytest.approx(own, rel=1e-10)
    assert energy["exchange"] == pytest.approx(own, rel=1e-10)
    assert energy["fluid_and_contacts"] == pytest.approx(0.0, abs=1e-14)


def test_the_fluid_around_a_body_has_its_own_part_of_the_energy() -> None:
    run = Simulation(scene_from_dict(wet_tables(FIRST, SECOND, fluid={"gravity": [0.0, 0.0]}, end=0.1, step=0.02)))
    run.add(GUEST)
    run.finish("complete")
    energy, (brought,) = run.history.summary["exchanges"]["energy"], run.history.exchanges["kinetic"]
    assert energy["bodies"] == brought
    assert energy["exchange"] == run.state.ledger.exchange
    assert 0.1 * brought < energy["fluid_and_contacts"] < brought


def test_without_an_exchange_there_is_no_account() -> None:
    run = dry()
    run.go(0.02)
    run.finish("complete")
    assert "exchanges" not in run.history.summary
    assert len(run.history.exchanges["time"]) == 0


def test_a_resumed_run_has_the_same_rows_and_sums(tmp_path: Path) -> None:
    case = stream()
    whole, run = Simulation(case), Simulation(case, tmp_path)
    whole.go()
    whole.finish("complete")
    run.go(0.5)
    during = load_results(tmp_path).exchanges
    assert 0 < len(during["time"]) < len(whole.history.exchanges["time"])
    run.close()
    resumed = Simulation(case, tmp_path, resume=True)
    resumed.go()
    resumed.finish("complete")
    resumed.close()
    found = load_results(tmp_path)
    for name, values in whole.history.exchanges.items():
        np.testing.assert_array_equal(found.exchanges[name], values)
    assert found.summary["exchanges"] == whole.history.summary["exchanges"]


def test_restoring_takes_rows_back() -> None:
    run = dry()
    run.add(GUEST)
    saved = run.save()
    run.remove("first")
    assert run.history.exchanges["body"].tolist() == ["guest", "first"]
    run.restore(saved)
    assert run.history.exchanges["body"].tolist() == ["guest"]


def test_a_body_that_does_not_fit_has_no_row() -> None:
    run = dry()
    with pytest.raises(Exception, match="first"):
        run.add(GUEST | {"position": [0.35, 0.65]})
    assert len(run.history.exchanges["time"]) == 0


def test_nobody_enters_a_run_that_was_closed(tmp_path: Path) -> None:
    """Another run may be writing there."""
    run = Simulation(scene_from_dict(dry_tables(FIRST, SECOND)), tmp_path)
    run.close()
    with pytest.raises(OutputError, match=r"an exchange of bodies after close\(\)"):
        run.add(GUEST)
    assert list(run.bodies) == ["first", "second"]
