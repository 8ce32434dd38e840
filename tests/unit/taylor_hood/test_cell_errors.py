"""Errors of cells: each term in closed form, against a naive sum over facets, and against the true error of a run."""

from __future__ import annotations

from itertools import combinations
from typing import Any

import numpy as np
import pytest

import rigidfluid
from rigidfluid.api import Simulation
from rigidfluid.backends.scikit_fem import ScikitFem
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.fluid.material import Newtonian
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.quadratic_cells import mean_products, node_coordinates, node_gradients
from rigidfluid.core.mesh.mesh_quality import cell_volumes, edge_lengths
from rigidfluid.errors import SceneError
from rigidfluid.taylor_hood.elements.numbering import Numbering
from rigidfluid.taylor_hood.stepping.cell_errors import DiscreteFlow, cell_errors
from rigidfluid.testing.fluid.boxes import box

VISCOSITY = 0.5


def flow(dimension: int, velocity: Any = None, pressure: Any = None, rate: Any = None) -> DiscreteFlow:
    """A flow in the unit box, of functions of the points; nothing where there is none."""
    numbering = Numbering.from_mesh(box(dimension, 2))
    points = numbering.node_points(box(dimension, 2).points)
    nothing = np.zeros_like(points)
    return DiscreteFlow(
        numbering,
        points,
        nothing if velocity is None else velocity(points),
        nothing[: numbering.vertices, 0] if pressure is None else pressure(points[: numbering.vertices]),
        nothing,
        nothing if rate is None else rate(points),
    )


def errors(found: DiscreteFlow) -> FloatArray:
    return cell_errors(found, Newtonian(VISCOSITY))


def along_x(values: FloatArray, points: FloatArray) -> FloatArray:
    return np.asarray(values[:, None] * np.eye(points.shape[1])[0])


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_flow_that_the_elements_hold_has_no_error(dimension: int) -> None:
    """u = (y², 0, 0), p = 2μ(x + y) under the force that it needs along y."""
    found = flow(
        dimension,
        lambda points: along_x(points[:, 1] ** 2, points),
        lambda points: 2.0 * VISCOSITY * (points[:, 0] + points[:, 1]),
        lambda points: -2.0 * VISCOSITY * np.tile(np.eye(dimension)[1], (len(points), 1)),
    )
    assert np.abs(errors(found)).max() < 1e-25


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_residual_counts_by_the_longest_edge(dimension: int) -> None:
    """η² = h²/(4π²μ) |f|² V, and with f linear, its square's integral."""
    mesh = box(dimension, 2)
    longest, volume = edge_lengths(mesh.points, mesh.cells).max(axis=1), cell_volumes(mesh.points, mesh.cells)
    weight = longest**2 / (4.0 * np.pi**2 * VISCOSITY)
    constant = flow(dimension, rate=lambda points: along_x(np.full(len(points), 3.0), points))
    assert errors(constant) == pytest.approx(9.0 * weight * volume, rel=1e-12)
    linear = flow(dimension, rate=lambda points: along_x(points[:, 0], points))
    assert errors(linear).sum() == pytest.approx(weight[0] / 3.0, rel=1e-12)


def test_a_divergence_counts_by_the_viscosity() -> None:
    """u = (x, 0): its stress is constant."""
    found = errors(flow(2, lambda points: along_x(points[:, 0], points)))
    assert found.sum() == pytest.approx(VISCOSITY, rel=1e-12)


@pytest.mark.parametrize("dimension", [2, 3])
def test_jumps_are_those_of_a_sum_over_pairs_of_cells(dimension: int) -> None:
    """u = |y - ½| (1 + z) e_x has a jump on the plane y = ½ alone, that of a stress linear along it."""
    across = (lambda points: 1.0 + points[:, -1]) if dimension == 3 else (lambda points: 1.0 + points[:, 0])
    found = flow(dimension, lambda points: along_x(np.abs(points[:, 1] - 0.5) * across(points), points))
    smooth = flow(dimension, lambda points: along_x((points[:, 1] - 0.5) * across(points), points))
    assert errors(found) - errors(smooth) == pytest.approx(_jumps(found), rel=1e-9, abs=1e-12)


def _jumps(found: DiscreteFlow) -> FloatArray:
    """½ h_E/(4πμ) ∫ |[σ·n]|² by pairs of cells, with Simpson's rule along edges and mid-edges of triangles."""
    nodes, d = found.numbering.cell_nodes, found.numbering.dimension
    gradient = node_gradients(found.points[nodes], found.velocity[nodes])
    stress, total = VISCOSITY * (gradient + gradient.swapaxes(2, 3)), np.zeros(len(nodes))
    for one, other in combinations(range(len(nodes)), 2):
        shared = sorted({*nodes[one, : d + 1].tolist()} & {*nodes[other, : d + 1].tolist()})
        if len(shared) < d:
            continue
        corners = found.points[shared]
        sides = corners[1:] - corners[:1]
        vector = np.array([sides[0, 1], -sides[0, 0]]) if d == 2 else 0.5 * np.cross(*sides)
        area = float(np.linalg.norm(vector))
        jump = [
            (stress[one, nodes[one].tolist().index(node)] - stress[other, nodes[other].tolist().index(node)])
            @ vector
            / area
            for node in found.numbering.facet_nodes(np.array([shared]))[0]
        ]
        squares = np.sum(np.square(jump), axis=1)
        weights = np.array([1.0, 1.0, 4.0]) / 6.0 if d == 2 else np.array([0.0, 0.0, 0.0, 1.0, 1.0, 1.0]) / 3.0
        whole = 0.5 * area ** (1.0 / (d - 1)) / (4.0 * np.pi * VISCOSITY) * area * float(weights @ squares)
        total[[one, other]] += whole
    return total


@pytest.mark.parametrize("count", [3, 4])
def test_products_are_integrated_exactly(count: int) -> None:
    """The constant 1 and the squares of linear functions, whose means are known."""
    products, nodes = mean_products(count), node_coordinates(count)
    assert products.sum() == pytest.approx(1.0, abs=1e-14)
    assert nodes[:, 0] @ products @ nodes[:, 1] == pytest.approx(1.0 / (count * (count + 1)), abs=1e-15)
    square = nodes[:, 0] ** 2
    fourth = 24.0 * np.prod(np.arange(1, count)) / np.prod(np.arange(1.0, count + 4))
    assert square @ products @ square == pytest.approx(fourth, abs=1e-15)


def vortex(size: float, **fluid: Any) -> rigidfluid.Scene:
    """A disk that turns in a box whose walls move with the flow around it in all the plane, u = R² (-y, x)/r²."""
    velocity = ["-0.16*y/(x**2+y**2)", "0.16*x/(x**2+y**2)"]
    return scene_from_dict({
        "scene": {"name": "vortex", "dimension": 2},
        "fluid": {"density": 1.0, "initial": "steady", **fluid},
        "domain": {"lower": [-1.0, -1.0], "upper": [1.0, 1.0]},
        "boundary": [
            {"on": name, "type": "velocity", "velocity": velocity} for name in ("left", "right", "bottom", "top")
        ],
        "body": [{
            **{"name": "disk", "type": "sphere", "radius": 0.4, "density": 1.0, "position": [0.0, 0.0]},
            "prescribed": {"angular_velocity": 1.0},
        }],
        "mesh": {"size": size, "size_body": size, "estimate": True},
        "time": {"end": 0.2, "step": 0.1},
        "output": {"every": 0.2},
    })  # fmt: skip


def effectivity(size: float, viscosity: float, inertia: bool) -> float:
    """Estimated over true error, √(Σ η²/(μ‖∇e‖² + ‖e_p‖²/μ))."""
    model = "navier-stokes" if inertia else "stokes"
    simulation = Simulation(vortex(size, viscosity=viscosity, model=model))
    simulation.go()
    fields = simulation.fields()
    assert fields.cell_errors is not None
    points = fields.points[fields.cells]
    (x, y), square = np.moveaxis(points, -1, 0), np.sum(points**2, axis=2)
    shear = np.array([[2.0 * x * y, y * y - x * x], [y * y - x * x, -2.0 * x * y]]) * 0.16 / square**2
    wrong = node_gradients(points, fields.velocity[fields.cells]) - np.moveaxis(shear, (0, 1), (2, 3))
    volume, products = np.abs(cell_volumes(fields.points, fields.cells[:, :3])), mean_products(3)
    pressure = fields.pressure[fields.cells] + inertia * 0.16**2 / (2.0 * square)
    pressure -= volume @ pressure @ products.sum(axis=1) / volume.sum()
    true = viscosity * np.einsum("m,maij,ab,mbij->", volume, wrong, products, wrong)
    true += np.einsum("m,ma,ab,mb->", volume, pressure, products, pressure) / viscosity
    return float(np.sqrt(fields.cell_errors.sum() / true))


@pytest.mark.parametrize(("viscosity", "inertia", "wanted"), [(1.0, False, 2.5), (0.01, True, 1.6)])
def test_the_estimate_follows_the_error_at_a_curved_body(viscosity: float, inertia: bool, wanted: float) -> None:
    """On two meshes within a tenth, creeping and at a Reynolds number of 32."""
    for size in (0.2, 0.1):
        assert effectivity(size, viscosity, inertia) == pytest.approx(wanted, rel=0.1)


def test_a_run_records_the_error_of_its_mesh(tmp_path: Any) -> None:
    history = rigidfluid.run(vortex(0.2, viscosity=0.1), out=tmp_path)
    table = history.mesh_error
    assert table["step"].tolist() == history.steps["step"].tolist()
    assert table["relative"] == pytest.approx(np.sqrt(table["error"] / table["dissipation"]), rel=1e-12)
    assert history.summary["mesh_error"] == {"latest": table["relative"][-1], "largest": table["relative"].max()}
    fields = rigidfluid.load_results(tmp_path).fields()
    assert fields.cell_errors is not None
    assert fields.cell_errors.sum() == pytest.approx(table["error"][-1], rel=1e-5)


def test_a_backend_without_it_is_refused_by_name(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ScikitFem, "cell_errors", False)
    with pytest.raises(SceneError, match=r"mesh.estimate: found an estimate .* with backend 'scikit-fem'"):
        vortex(0.2, viscosity=1.0)
