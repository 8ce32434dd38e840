"""A window that goes with a body through a long domain."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gathered_backend import OnTheRoot
from mesh_tools import ball, box, upright
from threaded_ranks import on_ranks

import rigidfluid
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.case.system import build_system
from rigidfluid.core.mesh.adaptation.mesh_motion import MeshMotion
from rigidfluid.core.mesh.distribution import distributed
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.generation.meshing import generate_mesh
from rigidfluid.core.mesh.size.size_field import Sizes
from rigidfluid.core.model.types import Mesh, Pose
from rigidfluid.core.model.window import Window
from rigidfluid.core.output.history import History
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.core.scene.scene import Scene
from rigidfluid.errors import SceneError, StepError

Tables = dict[str, Any]
LENGTH = 12.0
DISK: Tables = {"name": "disk", "type": "sphere", "radius": 0.125, "density": 1.25, "position": [1.0, 10.0]}
WINDOW: Tables = {"follow": "disk", "direction": "-y", "ahead": 1.0, "behind": 1.5}
AT_REST: Tables = {"on": "all", "type": "wall"}


def tables(window: Tables | None = WINDOW, body: Tables | None = None, **more: Tables | list[Tables]) -> Tables:
    """A disk that falls in a channel of height 12."""
    found: Tables = {
        "scene": {"name": "window", "dimension": 2},
        "fluid": {"density": 1.0, "viscosity": 0.1, "gravity": [0.0, -981.0]},
        "domain": {"lower": [0.0, 0.0], "upper": [2.0, LENGTH]},
        "boundary": [AT_REST],
        "body": [DISK | (body or {})],
        "mesh": {"size": 0.3, "size_body": 0.06},
        "time": {"end": 0.3, "step": 0.01},
        "output": {"every": 1.0},
    }
    if window is not None:
        found["domain"]["window"] = window
    for name, value in more.items():
        found[name] = found.get(name, {}) | value if isinstance(value, dict) else value
    return found


def scene(*args: Any, **more: Any) -> Scene:
    return scene_from_dict(tables(*args, **more))


def span(mesh: Mesh | None, axis: int = 1) -> list[float]:
    assert mesh is not None
    return [float(mesh.points[:, axis].min()), float(mesh.points[:, axis].max())]


def last(history: History, table: str, *names: str) -> list[float]:
    return [float(history.table(table)[name][-1]) for name in names]


def long_box(dimension: int) -> tuple[Window, Pose]:
    """A ball in a box of length 20 along y, and the window around it that looks down."""
    start = upright([1.0, 10.0, 1.0][:dimension])
    domain = box([0.0, 0.0, 0.0][:dimension], [2.0, 20.0, 2.0][:dimension])
    return Window(domain, body=0, axis=1, start=10.0, behind=11.5, ahead=9.0), start


@pytest.mark.parametrize(("at", "interval"), [(10, (9, 11.5)), (7, (6, 8.5)), (0.5, (0, 2.5)), (11, (9, 11.5))])
def test_it_goes_with_the_body_up_to_the_domain_s_end_and_never_back(at: float, interval: tuple[float, float]) -> None:
    window, start = long_box(2)
    there = Pose(np.array([[1.3, at]]), start.orientation)
    assert window.interval(there) == pytest.approx(interval, rel=0, abs=1e-14)
    lower, upper = window.meshed_domain(there).extent
    assert (lower[1], upper[1]) == window.interval(there)
    assert (lower[0], upper[0]) == (0.0, 2.0)


def test_a_window_may_look_up() -> None:
    window = Window(box([0, 0], [2, 20]), body=0, axis=1, start=10.0, behind=8.0, ahead=11.0)
    assert window.ends == (2, 3)
    assert window.interval(upright([1, 12])) == (10.0, 13.0)
    assert window.interval(upright([1, 9])) == (8.0, 11.0)
    assert window.interval(upright([1, 19.5])) == (17.0, 20.0)


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_mesh_goes_with_a_ball_as_it_is(dimension: int) -> None:
    window, start = long_box(dimension)
    body = [ball(0.25, dimension)]
    mesh = generate_mesh(FluidDomain(body, start, window.meshed_domain(start), ()), Sizes(0.6, 0.2, 0.3))
    motion = MeshMotion(mesh, FluidDomain(body, start, window.domain, ()), window=window)
    there = Pose(start.position - [0.0, 4.0, 0.0][:dimension], start.orientation)
    np.testing.assert_allclose(motion.move(there), mesh.points - [0.0, 4.0, 0.0][:dimension], rtol=0, atol=1e-12)
    aside = Pose(start.position + [0.2, -4.0, 0.0][:dimension], start.orientation)
    for face, height in zip(window.ends, (7.5, 5.0), strict=True):
        np.testing.assert_allclose(motion.move(aside)[np.unique(mesh.facets[mesh.markers == 1 + face]), 1], height)


def test_a_mesh_in_parts_goes_as_the_whole_does() -> None:
    window, start = long_box(2)
    body, there = [ball(0.25)], upright([1.1, 6.0])
    mesh = generate_mesh(FluidDomain(body, start, window.meshed_domain(start), ()), Sizes(0.6, 0.2, 0.3))
    expected = MeshMotion(mesh, FluidDomain(body, start, window.domain, ()), window=window).move(there)

    def moved(ranks: Any) -> Any:
        part = distributed(mesh if ranks.is_root else None, ranks)
        assert part is not None
        assert part.part is not None
        return part.part.vertices, MeshMotion(
            part, FluidDomain(body, start, window.domain, ()), OnTheRoot, window
        ).move(there)

    for vertices, points in on_ranks(5, moved):
        np.testing.assert_allclose(points, expected[vertices], rtol=0, atol=1e-13)


def test_a_flow_that_goes_with_the_body_stays_uniform_also_where_the_window_stops() -> None:
    """The ends stop on the way, so that the mesh is squeezed between the end ahead and the body."""
    ahead: Tables = {"on": "bottom", "type": "velocity", "velocity": [0.0, -2.0]}
    behind: Tables = {"on": "top", "type": "pressure", "pressure": 0.0}
    sides: list[Tables] = [{"on": side, "type": "slip"} for side in ("left", "right")]
    light = {"position": [1.0, 1.4], "density": 1.0}  # as the fluid, which moves it at once
    run = Simulation(scene(WINDOW, light, boundary=[ahead, behind, *sides], mesh={"size_body": 0.02}))
    start = span(run.state.mesh)
    run.go()
    assert run.bodies["disk"].position[1] == pytest.approx(0.8, rel=0, abs=0.02)
    assert [*start, *span(run.state.mesh)] == pytest.approx([0.4, 2.9, 0.0, 2.5], rel=0, abs=1e-12)
    assert np.abs(run.state.fluid["velocity"] - [0.0, -2.0]).max() < 1e-6
    energy = run.history.energy
    for name in ("residual", "kinetic"):
        np.testing.assert_allclose(energy[name][3:], energy[name][3], rtol=0, atol=1e-5)


def test_the_balance_of_energy_closes_where_a_wake_leaves_through_the_end() -> None:
    history = rigidfluid.run(scene(WINDOW | {"behind": 0.5}, time={"end": 0.6, "step": 0.005}))
    residual, boundary, gravity = last(history, "energy", "residual", "boundary", "gravity")
    assert boundary < -0.1 * gravity
    assert abs(residual) < 2e-3 * gravity


@pytest.mark.long
def test_a_disk_falls_as_in_the_whole_channel() -> None:
    part, whole = (
        rigidfluid.run(scene(window, time={"end": 0.6})) for window in (WINDOW | {"ahead": 2.0, "behind": 2.0}, None)
    )
    heights, speeds = zip(*(last(history, "bodies", "y", "vy") for history in (part, whole)), strict=True)
    assert speeds[0] == pytest.approx(speeds[1], rel=0.01)
    assert 10.0 - heights[0] == pytest.approx(10.0 - heights[1], rel=0.01)
    assert part.summary["unknowns"] < 0.6 * whole.summary["unknowns"]


def test_the_end_of_the_domain_is_reached_to_the_last_bit() -> None:
    domain = box([0.0, 0.3], [2.0, 10.3])
    for start in np.linspace(5.0, 9.0, 50).tolist():
        window = Window(domain, body=0, axis=1, start=start, behind=start + 1.0, ahead=start - 1.1)
        floor = Pose(np.array([[1.0, 0.425]]), np.zeros((1, 1)))
        assert window.interval(floor)[0] == 0.3
        assert window.left_by(floor, np.array([0.125])) is None


def test_a_body_that_stops_stops_its_window() -> None:
    run = Simulation(scene(WINDOW, {"velocity": [0.0, -5.0]}, fluid={"gravity": None}, time={"end": 0.5}))
    run.go()
    gone = 10.0 - run.bodies["disk"].position[1]
    assert 0.2 < gone < 1.0
    assert span(run.state.mesh) == pytest.approx([9.0 - gone, 11.5 - gone], rel=0, abs=1e-12)
    residual = run.history.energy["residual"]
    assert np.ptp(residual[1:]) < 0.02 * run.history.energy["kinetic"][0]


@pytest.mark.long
def test_the_floor_of_the_channel_stops_the_window_and_the_body() -> None:
    law = {"law": "spring-dashpot", "range": 0.05, "stiffness": 1e5}
    run = Simulation(scene(WINDOW, {"position": [1.0, 1.3]}, contact=law, time={"end": 0.5, "step": 0.005}))
    run.go()
    assert span(run.state.mesh) == pytest.approx([0.0, 2.5], rel=0, abs=1e-12)
    assert run.bodies["disk"].position[1] == pytest.approx(0.125 + 0.05, rel=0, abs=0.05)
    assert run.history.energy["residual"][-1] > -0.01 * run.history.energy["gravity"][-1]


@pytest.mark.parametrize("remeshed", [{}, {"remesh_every": 0.02}])
def test_a_run_taken_up_equals_the_whole_one_to_the_last_bit(tmp_path: Path, remeshed: Tables) -> None:
    def until(end: float) -> Scene:
        return scene(mesh=remeshed, time={"end": end}, output={"every": 0.04, "probes": [[0.5, 9.0], [0.5, 11.0]]})

    rigidfluid.run(until(0.12), tmp_path / "whole")
    rigidfluid.run(until(0.04), tmp_path / "parts")
    resumed = rigidfluid.run(until(0.12), tmp_path / "parts", resume=True)
    for name in ("bodies.csv", "energy.csv", "probes.csv"):
        assert (tmp_path / "parts" / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()
    assert (resumed.summary["remeshes"] > 0) == bool(remeshed)


def test_probes_know_nothing_of_the_fluid_outside() -> None:
    history = rigidfluid.run(scene(time={"end": 0.2}, output={"probes": [[0.5, 8.5], [0.5, 11.3]]}))
    probe, pressure = (history.probes[name] for name in ("probe", "pressure"))
    before, after = pressure[probe == 0], pressure[probe == 1]
    assert np.isnan(before[0])
    assert np.isfinite(before[-1])
    assert np.isfinite(after[0])
    assert np.isnan(after[-1])


def test_a_body_that_the_window_leaves_behind_ends_the_run_by_name() -> None:
    slow = DISK | {"name": "slow", "density": 1.0001, "position": [0.4, 11.0]}
    left = tables(time={"end": 1.0})
    left["body"].append(slow)
    with pytest.raises(StepError, match=r"body 'slow'.*it leaves the window.*Lengthen domain.window.ahead"):
        rigidfluid.run(scene_from_dict(left))


def with_body(**keys: Any) -> Tables:
    return {"body": [DISK | keys]}


WRONG = [
    (WINDOW | {"follow": "dsk"}, {}, r"window.follow: found 'dsk'; allowed is a body: disk. Did you mean 'disk'"),
    (WINDOW, with_body(fixed=True), "window.follow: found 'disk', which is fixed"),
    (WINDOW | {"direction": "-z"}, {}, "window.direction: found '-z'; allowed is along x or y"),
    (WINDOW | {"behind": 3.0}, {}, "window.behind: found 3, which reaches beyond 'top' by 1; allowed is at most 2 "),
    (
        WINDOW | {"ahead": 10.0},
        {},
        "window.ahead: found 10, which reaches beyond 'bottom' by 0, so that the window can",
    ),
    (WINDOW | {"behind": 0.1}, {}, r"body.0.position: .* 'disk' is not well in the window; .* from 9 and 10.1 along y"),
    (WINDOW, {"fluid": {"backend": "dry"}}, "domain.window: found a window with backend 'dry', which has no mesh"),
    (WINDOW, {"contact": {"detector": "narrow_band"}}, "contact.detector: found 'narrow_band' with a window.*'sphere'"),
    (WINDOW, {"boundary": [{"on": "top", "type": "slip"}]}, "boundary: found 'slip' on 'top', an end of the window"),
    (WINDOW, {"boundary": [{"on": "bottom", "type": "pressure", "pressure": 0.0}]}, "'pressure' on 'bottom', ahead"),
    (
        WINDOW,
        {"boundary": [{"on": "left", "type": "wall", "velocity": [0.0, 1.0]}]},
        "found a velocity on 'left', along",
    ),
]


def test_a_side_that_turns_in_itself_is_refused_beside_a_wall_at_the_end() -> None:
    turning = {"on": "front", "type": "wall", "angular_velocity": [0.0, 0.0, 1.0]}
    ball = {"name": "disk", "type": "sphere", "radius": 0.125, "density": 1.2, "position": [1.0, 10.0, 1.0]}
    given = tables(boundary=[AT_REST, turning]) | {"body": [ball]}
    given["scene"]["dimension"] = 3
    given["domain"] |= {"lower": [0.0, 0.0, 0.0], "upper": [2.0, LENGTH, 2.0]}
    given["fluid"]["gravity"] = [0.0, -981.0, 0.0]
    with pytest.raises(SceneError, match="boundary: found a velocity on 'front', along a window"):
        build_system(scene_from_dict(given))


@pytest.mark.parametrize(("window", "more", "message"), WRONG)
def test_windows_that_cannot_be_are_refused_by_name(window: Tables, more: Tables, message: str) -> None:
    given = tables(window)
    for name, value in more.items():
        given[name] = given.get(name, {}) | value if isinstance(value, dict) else value
    with pytest.raises(SceneError, match=message):
        build_system(scene_from_dict(given))
