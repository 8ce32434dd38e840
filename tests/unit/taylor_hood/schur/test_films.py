"""Films thinner than cells, solved by factors of their own: iterations stay few and resistances exact."""

import numpy as np
import pytest
from bispherical import resistance
from paths import SCENES
from published import torque_of_twist
from skfem import MeshTet

from rigidfluid.core.case.load import load_scene
from rigidfluid.core.model.types import Mesh
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.taylor_hood.elements.numbering import Numbering
from rigidfluid.taylor_hood.linear_solver.lagged_solver import LaggedSolver
from rigidfluid.taylor_hood.schur.films import MOST, RINGS, vertices_of_films, with_rings

SPEED = 1e-6


CORNERS = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.1], [0.0, 0.0, -1.0]])
CELLS = np.array([[0, 1, 2, 3], [0, 2, 1, 4]])


def test_only_flat_cells_make_a_film() -> None:
    surface = np.array([0, 0, -1, 2, 2])
    np.testing.assert_array_equal(vertices_of_films(CELLS, CORNERS, surface), [0, 1, 2, 3])
    assert not len(vertices_of_films(CELLS[1:], CORNERS, surface))


@pytest.mark.parametrize(
    ("surface", "film"),
    [
        ([-1, -1, -1, -1, -1], False),
        ([0, 0, -1, -1, -1], False),
        ([-1, -1, -1, 3, 3], False),
        ([0, 0, -1, -1, 3], False),  # ten heights away
        ([0, 0, -1, 3, -1], True),
        ([-1, -1, 4, 3, -1], True),
    ],
)
def test_a_flat_cell_is_in_a_film_between_two_surfaces_alone(surface: list[int], film: bool) -> None:
    assert bool(len(vertices_of_films(CELLS, CORNERS, np.array(surface)))) == film


def test_rings_around_few_vertices_are_not_the_whole_mesh() -> None:
    grid = MeshTet.init_tensor(*(np.arange(21.0),) * 3)
    numbering = Numbering.from_mesh(Mesh(grid.p.T, grid.t.T, np.zeros((0, 3), dtype=np.int64), np.zeros(0, dtype=int)))
    slab = np.flatnonzero(grid.p[2] <= 3.0)
    near = with_rings(numbering, slab)
    assert grid.p[2, near].max() == 3.0 + RINGS
    assert 4 * len(near) == (4 + RINGS) * len(slab)
    middle = np.flatnonzero((np.abs(grid.p - 10.0) <= 1.0).all(axis=0))
    around = with_rings(numbering, middle)
    np.testing.assert_array_equal(np.abs(grid.p[:, around] - 10.0).max(), 2.0)
    assert len(middle) < len(around) <= MOST * len(middle)
    assert not len(with_rings(numbering, middle[:0]))


def torques(gap: float, mesh: list[str], *spins: tuple[list[float], str]) -> list[float]:
    """Of a sphere of radius 1 that turns at a wall about axes, over μr³ω."""
    placed = [f"body.0.position=[0.0, 0.0, {1.0 + gap}]", "mesh.size_body=0.5", "time.end=1.0", "fluid.solver=schur"]
    simulation, found = Simulation(load_scene(SCENES / "squeezed_film.toml", [*placed, *mesh])), []
    for spin, axis in spins:
        simulation.prescribe("sphere", [0.0, 0.0, 0.0], [SPEED * each for each in spin])
        simulation.step()
        found.append(float(simulation.history.bodies[axis][-1]) / SPEED)
    return found


TURN, TWIST = ([0.0, 1.0, 0.0], "ty"), ([0.0, 0.0, 1.0], "tz")


def test_turning_and_twisting_beside_a_wall() -> None:
    exact = [-resistance(0.1, np.inf)[1, 1], -8.0 * np.pi * torque_of_twist(0.1)]
    assert torques(0.1, [], TURN, TWIST) == pytest.approx(exact, rel=0.01)


@pytest.mark.long
def test_a_thin_film_takes_few_iterations(monkeypatch: pytest.MonkeyPatch) -> None:
    counts, solve = [], LaggedSolver.solve

    def counting(self, *given):
        found = solve(self, *given)
        counts.append(found[1])
        return found

    monkeypatch.setattr(LaggedSolver, "solve", counting)
    torques(2e-3, ["mesh.refinements=4"], TURN)
    assert max(counts) < 50
