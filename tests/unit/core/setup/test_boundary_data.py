"""What is prescribed on the boundary: profiles, expressions, tables over time, ramps; and what is refused."""

from __future__ import annotations

import copy
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rigidfluid
from rigidfluid.backends.scikit_fem.backend import ScikitFem
from rigidfluid.core.case.boundary_values import BoundaryPressure, BoundaryVelocity
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.case.scene_model import model_of
from rigidfluid.core.case.system import build_system
from rigidfluid.core.fluid.conditions import PrescribedPressure, PrescribedVelocity
from rigidfluid.core.geometry.piece import Piece
from rigidfluid.core.geometry.surface import Plane
from rigidfluid.core.nested.expressions import Expression, VectorExpression
from rigidfluid.core.setup.boundary_samples import quadrature
from rigidfluid.core.setup.profiles import Rectangle, poiseuille, section
from rigidfluid.domains.box import Box, BoxOptions
from rigidfluid.errors import SceneError
from rigidfluid.testing.fluid.boxes import box, nobody
from rigidfluid.testing.fluid.exact import DENSITY, VISCOSITY, Kind, enclosed, problem
from rigidfluid.testing.fluid.flow import Flow

OPEN = {"on": "right", "type": "pressure", "pressure": 0.0}


DUCT = Box(BoxOptions(lower=(0.0, 0.0, 0.0), upper=(3.0, 3.0, 4.0)), 3)


def tables(boundary: list[dict[str, Any]], dimension: int = 2, **changes: Any) -> dict[str, Any]:
    """A fixed disk or ball in a box of 3 × 1 (× 2)."""
    side = [3.0, 1.0, 2.0][:dimension]
    return {
        "scene": {"name": "boundary_data", "dimension": dimension},
        "fluid": {"density": 1.0, "viscosity": 1.0},
        "domain": {"lower": [0.0] * dimension, "upper": side},
        "boundary": copy.deepcopy(boundary),
        "body": [{"type": "sphere", "radius": 0.1, "density": 1.0, "position": [0.5] * dimension, "fixed": True}],
        "mesh": {"size": 0.5, "size_body": 0.1},
        "time": {"end": 2.0, "step": 0.1},
        "output": {"every": 1.0},
    } | changes


def value_on_left(table: dict[str, Any], time: float, points: Any, dimension: int = 2) -> np.ndarray:
    """What a table prescribes on the left face, at points given by their coordinates in it."""
    scene = scene_from_dict(
        tables([{"on": "left", **table}, *([] if table["type"] == "pressure" else [OPEN])], dimension)
    )
    condition = model_of(scene).conditions[0]
    given = condition.pressure if condition.is_open else condition.velocity
    return given(time, np.column_stack([np.zeros(len(points)), points]))


def inflow(**table: Any) -> dict[str, Any]:
    return {"type": "velocity", "velocity": [2.0, 0.0]} | table


def test_expressions_of_place_and_time() -> None:
    table = inflow(velocity=["y*t", "sin(pi*y)"])
    np.testing.assert_allclose(value_on_left(table, 3.0, [0.0, 0.5]), [[0, 0], [1.5, 1]], atol=1e-15)
    table = {"type": "pressure", "pressure": "10*t + y"}
    np.testing.assert_allclose(value_on_left(table, 2.0, [0.0, 0.5]), [20, 20.5])


@pytest.mark.parametrize(("time", "factor"), [(0.0, 0.0), (0.25, 2.0), (0.5, 4.0), (1.0, 3.0), (1.5, 2.0), (9.0, 1.0)])
def test_a_table_over_time_is_linear_between_its_rows(time: float, factor: float) -> None:
    table = inflow(over_time=[[0.0, 0.0], [0.5, 4.0], [2.0, 1.0]])
    np.testing.assert_allclose(value_on_left(table, time, [0.5]), [[2.0 * factor, 0.0]])


def test_a_ramp_rises_from_zero_with_two_continuous_derivatives() -> None:
    times = np.linspace(-0.1, 0.5, 6001)
    rise = np.array([value[0, 0] / 2.0 for value in _over(times, inflow(ramp=0.4))])
    assert rise[0] == 0.0
    assert rise[-1] == 1.0
    assert np.all(np.diff(rise) >= -1e-15)
    np.testing.assert_allclose(rise[np.searchsorted(times, 0.2)], 0.5, atol=1e-3)
    second = np.diff(rise, 2) / np.diff(times)[0] ** 2
    assert np.abs(np.diff(second)).max() < 0.01 * np.abs(second).max()


def _over(times: np.ndarray, table: dict[str, Any]) -> list[np.ndarray]:
    scene = scene_from_dict(tables([{"on": "left", **table}, OPEN]))
    condition = model_of(scene).conditions[0]
    return [condition.velocity(time, np.zeros((1, 2))) for time in times]


@pytest.mark.parametrize(
    ("profile", "expected"),
    [
        ("uniform", [1, 1, 1]),
        ("parabolic", [0, 0.75, 1]),
        ("poiseuille", [0, 0.75, 1]),
        ("couette", [0, 0.25, 0.5]),
    ],
)
def test_profiles_in_2d(profile: str, expected: list[float]) -> None:
    found = value_on_left(inflow(profile=profile), 0.0, [0.0, 0.25, 0.5])
    np.testing.assert_allclose(found[:, 0], 2.0 * np.array(expected), atol=1e-15)


@pytest.mark.parametrize(
    ("profile", "peak"), [("uniform", 15.0), ("parabolic", 15.0 * 9 / 4), ("poiseuille", 15.0 * 1.9918)]
)
def test_a_flux_makes_the_velocity_that_carries_it(profile: str, peak: float) -> None:
    """Through a face of 1 × 2, of which the middle has the peak; of a duct 1.992 times the mean."""
    table = {"type": "velocity", "flux": "3*t", "profile": profile, "over_time": [[0.0, 1.0], [2.0, 5.0]]}
    face = Piece("left", Plane(np.zeros(3), np.eye(3)[0], (np.zeros(3), np.array([0.0, 1.0, 2.0]))), 2.0)
    points, weights = quadrature(face, DUCT)
    found = value_on_left(table, 2.0, points[:, 1:], dimension=3)
    assert weights @ found[:, 0] == pytest.approx(30.0)
    np.testing.assert_array_equal(found[:, 1:], 0.0)
    assert value_on_left(table, 2.0, [[0.5, 1.0]], dimension=3)[0, 0] == pytest.approx(peak, rel=2e-3)


def test_a_profile_multiplies_an_expression() -> None:
    found = value_on_left(inflow(velocity=["t + y", 0.0], profile="parabolic", ramp=1.0), 1.0, [0.5])
    np.testing.assert_allclose(found, [[1.5, 0.0]])


def test_flow_through_a_duct_has_a_constant_laplacian_and_the_published_mean() -> None:
    """White 2006, eq. 3-48: the mean over the pressure gradient's measure for a duct of sides 1:2."""
    duct = Rectangle(np.zeros(3), np.array([1.0, 2.0]), np.eye(3)[1:])
    step, points = 1e-3, np.array([[0.0, 0.1, 0.2], [0.0, -0.3, 0.7], [0.0, 0.45, -0.9], [0.0, 0.0, 0.0]])
    around = [shift * step * axis for axis in np.eye(3)[1:] for shift in (-1.0, 1.0)]
    laplacian = (sum(poiseuille(duct, points + shift) for shift in around) - 4 * poiseuille(duct, points)) / step**2
    np.testing.assert_allclose(laplacian, laplacian[-1], rtol=1e-4)
    assert poiseuille(duct, points)[-1] == 1.0
    edge = np.array([[0.0, 0.5, 0.3], [0.0, 0.2, 1.0], [0.0, -0.5, -1.0]])
    np.testing.assert_allclose(poiseuille(duct, edge), 0.0, atol=1e-4)
    piece = Piece("inlet", Plane(np.zeros(3), np.eye(3)[0], (np.array([0, -0.5, -1]), np.array([0, 0.5, 1]))), 2.0)
    nodes, weights = quadrature(piece, DUCT)
    mean = weights @ poiseuille(duct, nodes) / 2.0
    assert mean == pytest.approx(-0.02858 * 4.0 / 2.0 * laplacian[-1] / 1.0, rel=1e-3)


def test_flow_through_a_pipe() -> None:
    turned = np.array([0.6, 0.0, 0.8])
    half = 0.5 * np.sqrt(1.0 - turned**2)
    centre = np.array([1.0, 2.0, 3.0])
    disk = Piece("end", Plane(centre, turned, (centre - half, centre + half)), np.pi * 0.25)
    shape = section(disk)
    assert shape is not None
    nodes, weights = quadrature(disk, DUCT)
    assert weights @ poiseuille(shape, nodes) == pytest.approx(0.5 * np.pi * 0.25, rel=1e-12)
    np.testing.assert_allclose((nodes - centre) @ turned, 0.0, atol=1e-15)
    rim = centre + 0.5 * np.array([[0.0, 1.0, 0.0], [0.8, 0.0, -0.6]])
    np.testing.assert_allclose(poiseuille(shape, rim), 0.0, atol=1e-14)


def test_a_piece_of_another_shape_has_no_section() -> None:
    plane = Plane(np.zeros(3), np.eye(3)[0], (np.zeros(3), np.array([0.0, 1.0, 1.0])))
    assert section(Piece("triangle", plane, 0.5)) is None


def test_an_oblique_segment_is_measured_from_its_first_end() -> None:
    normal = np.array([0.6, -0.8])
    plane = Plane(np.zeros(2), normal, (np.zeros(2), np.array([0.8, 0.6])))
    shape = section(Piece("end", plane, 1.0))
    assert isinstance(shape, Rectangle)
    np.testing.assert_allclose(shape.coordinates(np.array([[0.0, 0.0], [0.8, 0.6]]))[:, 0], [0.0, 1.0], atol=1e-15)


def test_scenes_come_back_from_their_tables(tmp_path: Path) -> None:
    (tmp_path / "inflow.csv").write_text("# t, factor\n0.0, 0.0\n1.0, 2.5\n2.0, 1e-3\n")
    table = {"on": "left", **inflow(velocity=["y*(1 - y)", 0.0]), "over_time": {"file": str(tmp_path / "inflow.csv")}}
    scene = scene_from_dict(tables([table, OPEN]))
    assert scene.boundary[0].over_time == ((0.0, 0.0), (1.0, 2.5), (2.0, 1e-3))
    (tmp_path / "inflow.csv").unlink()
    assert scene_from_dict(scene.to_dict()) == scene


def test_the_fastest_inflow_is_found_between_start_and_end() -> None:
    table = inflow(velocity=["30*sin(pi*t/2)", 0.0], profile="parabolic")
    scene = tables([{"on": "left", **table}, OPEN], contact={"law": "centre", "range": 0.1, "epsilon": 1.0})
    scene["body"][0]["fixed"] = False
    system = build_system(scene_from_dict(scene))
    assert system.loads.speed[0] == pytest.approx(30.0, rel=1e-3)


def test_the_greatest_value_of_a_long_table_is_seen() -> None:
    rows = [[0.001 * number, 30.0 if number == 1234 else 0.1] for number in range(2001)]
    table = {"on": "left", **inflow(velocity=[1.0, 0.0], over_time=rows)}
    scene = tables([table, OPEN], contact={"law": "centre", "range": 0.1, "epsilon": 1.0})
    scene["body"][0]["fixed"] = False
    assert build_system(scene_from_dict(scene)).loads.speed[0] == pytest.approx(30.0)


def test_velocities_on_a_curved_surface_are_sampled_all_over_it() -> None:
    obstacle = {"name": "roll", "type": "sphere", "radius": 0.2, "position": [2.0, 0.5]}
    scene = tables([OPEN, {"on": "roll", "type": "velocity", "velocity": ["0.5 - y", "x - 2"]}])
    scene["domain"] |= {"type": "channel", "obstacle": [obstacle]}
    scene["contact"] = {"law": "centre", "range": 0.1, "epsilon": 1.0}
    scene["body"][0]["fixed"] = False
    assert build_system(scene_from_dict(scene)).loads.speed[0] == pytest.approx(0.2)
    scene["boundary"][1]["velocity"][0] = "log(x - 1.81)"
    with pytest.raises(SceneError, match=r"boundary\.1\.velocity\.0 on 'roll': found nan"):
        scene_from_dict(scene)


FLUX = {"on": "left", "type": "velocity", "flux": 1.0}
LEFT, THROUGH = {"on": "left", **inflow()}, [{"on": "left", **inflow()}, {"on": "right", **inflow()}]
BAD: dict[str, tuple[list[dict[str, Any]], str, str]] = {
    "components": ([LEFT | {"velocity": ["y"]}, OPEN], "boundary.0.velocity: found ['y'], 1 of them", "2 dimensions"),
    "unknown name": ([LEFT | {"velocity": ["q", 0.0]}, OPEN], "velocity.0: found an unknown name", "names here"),
    "division by zero": ([LEFT | {"velocity": ["1/t", 0.0]}, OPEN], "inf from '1/t' at time 0", "where"),
    "table from later on": ([LEFT | {"over_time": [[1.0, 0.0], [2.0, 1.0]]}, OPEN], "times from 1 to 2", "Add rows"),
    "table too short": ([LEFT | {"over_time": [[0.0, 0.0], [1.9, 1.0]]}, OPEN], "times from 0 to 1.9", "Add rows"),
    "table without rows": ([LEFT | {"over_time": []}, OPEN], "boundary.0.over_time: found no rows", "Add rows"),
    "table that does not rise": (
        [LEFT | {"over_time": [[0.0, 0.0], [1.0, 1.0], [1.0, 2.0], [3.0, 1.0]]}, OPEN],
        "boundary.0.over_time.2: found time 1 after 1",
        "Sort",
    ),
    "flux and velocity": ([LEFT | {"flux": 1.0}, OPEN], "0.flux: flux takes the place of velocity", "Keep one"),
    "flux on a wall": ([{"on": "left", "type": "wall", "flux": 1.0}], "0.flux: flux is valid only with type", "Leave"),
    "flux in space": ([FLUX | {"flux": "y"}, OPEN], "boundary.0.flux: found an unknown name: 'y'", "t, pi"),
    "unbalanced flux": ([FLUX, FLUX | {"on": "right", "flux": "-t"}], "a net inflow of 1 [", "pressure"),
    "truth": ([LEFT | {"velocity": [True, 0.0]}, OPEN], "boundary.0.velocity.0: found True", "Velocity"),
    "row of one": ([LEFT | {"over_time": [[0.0], [1.0, 1.0]]}, OPEN], "boundary.0.over_time.0: found", "Factor"),
    "no table": ([LEFT | {"over_time": 3.0}, OPEN], "boundary.0.over_time: found 3.0", "Factor"),
    "unknown key": ([LEFT | {"over_time": {"flie": "a"}}, OPEN], "boundary.0.over_time.flie", "'file'"),
    "no file": (
        [LEFT | {"over_time": {"file": "nowhere.csv"}}, OPEN],
        "boundary.0.over_time.file: found nowhere.csv: No such file",
        "Check path",
    ),
    "ramp on a wall": ([{"on": "left", "type": "wall", "ramp": 1.0}], "0.ramp: ramp is valid only with", "out"),
    "expression on a wall": (
        [{"on": "top", "type": "wall", "velocity": ["sin(t)", 0.0]}],
        "boundary.0.velocity.0: found 'sin(t)'",
        "type = 'velocity'",
    ),
    "unbalanced at a time": (
        [LEFT | {"velocity": ["1 + t", 0.0]}, {"on": "right", **inflow(velocity=[1.0, 0.0])}],
        "a net inflow of 2 [length^2/time] at time 2 and no outlet",
        "pressure",
    ),
    "unbalanced in space": (
        [LEFT | {"velocity": ["sin(pi*y)", 0.0]}, {"on": "right", **inflow(velocity=[0.6, 0.0])}],
        "a net inflow of 0.0366",
        "pressure",
    ),
    "unbalanced by its ramp": (
        [LEFT | {"ramp": 1.0}, THROUGH[1]],
        "a net inflow of -2 [length^2/time] at time 0",
        "pressure",
    ),
}


@pytest.mark.parametrize(("boundary", "found", "remedy"), BAD.values(), ids=BAD.keys())
def test_what_cannot_be_is_refused(boundary: list[dict[str, Any]], found: str, remedy: str) -> None:
    with pytest.raises(SceneError) as raised:
        scene_from_dict(tables(boundary))
    assert found in str(raised.value)
    assert remedy in raised.value.remedy


def test_a_profile_that_the_surface_has_not() -> None:
    couette = {"on": "left", **inflow(velocity=[2.0, 0.0, 0.0], profile="couette")}
    with pytest.raises(SceneError, match=r"profile: 'couette' needs a surface that is a segment, in 2D, unlike"):
        scene_from_dict(tables([couette, OPEN], dimension=3))


@pytest.mark.parametrize(
    "boundary",
    [
        THROUGH,
        [table | {"velocity": ["1 + t*y", 0.0]} for table in THROUGH],
        [LEFT | {"velocity": ["pi/2*sin(pi*y)*t", 0.0]}, THROUGH[1] | {"velocity": ["t", 0.0]}],
        [table | {"ramp": 0.5, "over_time": [[0.0, 1.0], [3.0, -1.0]]} for table in THROUGH],
        [LEFT | {"velocity": [1.5, 0.0], "profile": "poiseuille"}, THROUGH[1] | {"velocity": [1.0, 0.0]}],
        [FLUX | {"flux": "1 + t", "profile": "parabolic"}, FLUX | {"on": "right", "flux": "-1 - t"}],
    ],
)
def test_what_balances_needs_no_outlet(boundary: list[dict[str, Any]]) -> None:
    scene_from_dict(tables(boundary))


@pytest.mark.parametrize(
    "text",
    [
        "0.0, 0.0\n1.0\n",
        "",
        "0.0, zero\n",
        "0, 0, 0\n2, 0, 0\n",
        "0.0, nan\n2.0, 1.0\n",
        "t, q\n0, 1\n",
        "0, 1e-99\n2, 1\n",
    ],
)
def test_files_that_are_no_tables(tmp_path: Path, text: str) -> None:
    file = tmp_path / "inflow.csv"
    file.write_text(text)
    with pytest.raises(SceneError, match=r"boundary\.0\.over_time\.file: found "):
        scene_from_dict(tables([LEFT | {"over_time": {"file": str(file)}}, OPEN]))


def test_a_value_that_is_lost_on_the_way_is_told_with_surface_time_and_point(tmp_path: Path) -> None:
    """Finite where it is sampled when the scene is loaded, and not at a node of the mesh."""
    table = LEFT | {"velocity": ["where(y < 1e-9, log(y), 0.1)", 0.0]}
    scene = scene_from_dict(tables([table, OPEN]))
    with pytest.raises(
        SceneError, match=r"boundary\.0\.velocity\.0 on 'left': found -inf .* at time .* point \[0\.0, 0\.0\]"
    ):
        rigidfluid.run(scene)


def test_pressure_that_sways_moves_the_fluid_as_womersley_says() -> None:
    """Between walls at y = 0 and 1: u = Re[G/(iωρ) (1 - cosh(k(2y - 1)/2)/cosh(k/2)) e^{iωt}], k = √(iωρ/μ).

    J. R. Womersley, J. Physiol. 127 (1955) 553, for a channel.
    """
    frequency, step = 5.0, 0.02
    sways = partial(PrescribedPressure, value=BoundaryPressure(Expression("cos(5*t)", "p", 2)))
    posed = problem(2, {"x0": sways, "x1": PrescribedPressure})
    flow = Flow.start(ScikitFem(ScikitFem.Options(), posed), box(2, 8), nobody(2))
    for _ in range(150):
        flow = flow.after(step)
    y = np.linspace(0.0, 1.0, 11)
    k = np.sqrt(1j * frequency * DENSITY / VISCOSITY)
    shape = (1.0 - np.cosh(k * (y - 0.5)) / np.cosh(0.5 * k)) / (1j * frequency * DENSITY)
    exact = (shape * np.exp(1j * frequency * flow.time)).real
    found, _ = flow.probe(np.column_stack([np.full(11, 0.5), y]))
    np.testing.assert_allclose(found[:, 0], exact, atol=0.01 * np.abs(shape).max())


def test_a_run_taken_up_again_has_the_same_inflow_to_the_last_bit(tmp_path: Path) -> None:
    (tmp_path / "inflow.csv").write_text("0.0, 0.3\n0.33, 1.0\n2.0, 0.2\n")
    table = LEFT | {"velocity": ["y*(1 - y)*exp(-t)", 0.0], "over_time": {"file": str(tmp_path / "inflow.csv")}}
    changes = {"output": {"every": 0.2}, "fluid": {"density": 1.0, "viscosity": 0.1, "initial": "steady"}}
    whole, part = (
        scene_from_dict(tables([table, OPEN], **changes, time={"end": end, "step": 0.1})) for end in (0.8, 0.4)
    )
    rigidfluid.run(whole, tmp_path / "whole")
    rigidfluid.run(part, tmp_path / "parts")
    rigidfluid.run(whole, tmp_path / "parts", resume=True)
    for name in ("bodies.csv", "energy.csv"):
        assert (tmp_path / "parts" / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()


def test_flows_that_do_not_balance_on_the_mesh_are_refused_with_the_time() -> None:
    """Where the shape of a surface is not known beforehand, it shows in the first step."""
    along = [VectorExpression.parse([source, 0.0], "u") for source in ("1 + t", "1 - t")]
    left, right = (partial(PrescribedVelocity, value=value) for value in along)
    posed = problem(2, {"x0": left, "x1": right})
    flow = Flow.start(ScikitFem(ScikitFem.Options(), posed), box(2, 4), nobody(2))
    flow = flow.after(0.01)
    with pytest.raises(SceneError, match=r"boundary: found a net inflow of 0\.\d* at time 0\.31.*Balance"):
        flow.after(0.3)


@pytest.mark.parametrize("dimension", [2, 3])
def test_shear_flows_in_and_out_through_the_same_faces(dimension: int) -> None:
    """Nothing flows through a face in sum, but for rounding, and half of each face is an inlet."""
    shear = VectorExpression.parse(["y - 0.5", *[0.0] * (dimension - 1)], "u")
    posed = enclosed(dimension, shear, inertia=False)
    mesh = box(dimension, 5)
    x, y = mesh.points[:, 0], mesh.points[:, 1]
    mesh.points[:, 1] += 0.3 * y * (1.0 - y) * (1.0 - x)
    flow = Flow.start(ScikitFem(ScikitFem.Options(tolerance=1e-12), posed), mesh, nobody(dimension)).after(0.1)
    points = np.random.default_rng(0).uniform(0.1, 0.9, (20, dimension))
    velocity, _ = flow.probe(points)
    np.testing.assert_allclose(velocity[:, 0], points[:, 1] - 0.5, atol=1e-10)
    np.testing.assert_allclose(velocity[:, 1:], 0.0, atol=1e-10)


def developed(dimension: int, divisions: int, inlet: Kind) -> Flow:
    """The steady flow through a unit box from its face at x = 0, where something is given, to that at x = 1."""
    posed = problem(dimension, {"x0": inlet, "x1": PrescribedPressure})
    posed = replace(posed, initial="steady", inertia=False)
    return Flow.start(ScikitFem(ScikitFem.Options(), posed), box(dimension, divisions), nobody(dimension))


def test_flux_against_pressure_drop_between_plates() -> None:
    """Q = Δp h³/(12 μ L) for h = L = 1, and the parabola is in the space."""
    pressure = BoundaryPressure(Expression("24*exp(0*x)", "p", 2))
    flow = developed(2, 2, partial(PrescribedPressure, value=pressure))
    nodes, weights = np.polynomial.legendre.leggauss(3)
    velocity, _ = flow.probe(np.column_stack([np.full(3, 0.3), 0.5 * (nodes + 1.0)]))
    assert 0.5 * weights @ velocity[:, 0] == pytest.approx(24.0 / (12.0 * VISCOSITY), rel=1e-8)


def test_flux_against_pressure_drop_in_a_square_duct() -> None:
    """Q = 0.035144 Δp h⁴/(μ L) (White 2006): an inflow with this profile is developed at once."""
    shape = Rectangle(np.array([0.0, 0.5, 0.5]), np.ones(2), np.eye(3)[1:])
    inflow = BoundaryVelocity(VectorExpression.parse([1.0, 0.0, 0.0], "u"), partial(poiseuille, shape))
    flow = developed(3, 5, partial(PrescribedVelocity, value=inflow))
    middle = np.array([[x, 0.5, 0.5] for x in (0.25, 0.5, 0.75)])
    velocity, pressure = flow.probe(middle)
    np.testing.assert_allclose(velocity, [[1.0, 0.0, 0.0]] * 3, atol=0.01)
    mean = 0.035144 / 0.073671  # of the peak
    assert (pressure[0] - pressure[2]) / 0.5 == pytest.approx(VISCOSITY * mean / 0.035144, rel=0.02)
