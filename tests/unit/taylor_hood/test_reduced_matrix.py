"""Pᵀ K P: its numbers, and its pattern, which no number changes."""

import numpy as np
import pytest
from falling import falling_disk
from scenes import wet_tables
from scipy import sparse

from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.taylor_hood.linear_solver.sparse import SparseDiscretisation
from rigidfluid.taylor_hood.system.coefficients import Coefficients

BALLS = wet_tables(
    {"type": "ellipsoid", "semi_axes": [0.4, 0.3, 0.25], "density": 1.5, "position": [1.0, 1.3, 1.0]},
    {"type": "sphere", "radius": 0.25, "density": 1.5, "position": [1.0, 0.5, 1.0]},
    end=0.1,
    step=0.02,
    fluid={"gravity": [0.0, -10.0, 0.0]},
    domain={"lower": [0.0, 0.0, 0.0], "upper": [2.0, 2.0, 2.0]},
    mesh={"size": 0.6, "size_body": 0.2},
)


def disk():
    sizes = {"mesh": {"size": 0.3, "size_body": 0.05}, "time": {"step": 0.004, "end": 0.1}, "output": {"every": 0.1}}
    return falling_disk(body={"angular_velocity": 5.0}, **sizes)


def balls():
    return scene_from_dict(BALLS)


@pytest.fixture(params=[disk, balls], scope="module")
def steps(request):
    """The discretisation of some steps on one mesh, and for each its matrix, K, the bodies' masses, P, and what is
    built of them."""
    made = []
    assemble = SparseDiscretisation._assemble

    def recorded(self, matrix):
        assembled = assemble(self, matrix)
        masses = matrix.mass_matrix[~matrix.prescribed]
        constraint_matrix = self._constraint.matrix.copy()
        built = self._reduced_matrix(assembled.system_matrix).filled(assembled.system_matrix, masses)
        made.append((self, matrix, assembled.system_matrix, masses, constraint_matrix, built))
        return assembled

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(SparseDiscretisation, "_assemble", recorded)
        run = Simulation(request.param(), None, False)
        made.clear()
        for _ in range(4):
            run.step()
    assert run.counts.remeshes == 0
    latest = made[-1][0]
    return latest, [step[1:] for step in made if step[0] is latest]


def pattern_of(matrix):
    return matrix.indptr.tobytes(), matrix.indices.tobytes()


def expected(discretisation, system_matrix, masses, constraint_matrix):
    product = (constraint_matrix.T @ system_matrix @ constraint_matrix).tolil()
    start, width = discretisation._constraint.twist_start, masses.shape[1]
    for body, mass in enumerate(masses):
        place = slice(start + body * width, start + (body + 1) * width)
        product[place, place] += mass
    return sparse.csr_array(product)


def test_it_is_the_product_and_the_masses(steps):
    discretisation, made = steps
    for _, system_matrix, masses, constraint_matrix, built in made:
        wanted = expected(discretisation, system_matrix, masses, constraint_matrix)
        assert abs(built - wanted).max() < 1e-14 * abs(wanted).max()


def test_its_pattern_is_that_of_all_steps(steps):
    _, made = steps
    assert len(made) >= 4
    assert len({pattern_of(built) for *_, built in made}) == 1
    assert made[0][-1].has_sorted_indices


def test_zeros_in_p_and_in_k_stay_in_its_pattern(steps):
    """SciPy's product would lose them."""
    discretisation, made = steps
    matrix, system_matrix, masses, _, built = made[-1]
    constraint = discretisation._constraint
    nodes = constraint.surfaces.body_nodes[0]
    position = matrix.position.copy()
    position[0] = matrix.node_points[nodes[0]]  # no arm, no turning
    constraint.place(matrix.node_points, position)
    emptied = system_matrix.copy()
    emptied.data[::7] = 0.0
    reduced = discretisation._reduced_matrix(system_matrix)
    assert expected(discretisation, emptied, 0.0 * masses, constraint.matrix).nnz < built.nnz
    assert pattern_of(reduced.filled(emptied, 0.0 * masses)) == pattern_of(built)


def test_twists_of_bodies_apart_have_no_entries_in_common(steps):
    discretisation, made = steps
    built, start, width = made[-1][-1], discretisation._constraint.twist_start, made[-1][2].shape[1]
    columns = built.indices[built.indptr[start] : built.indptr[start + 1]]
    assert set(range(start, start + width)) <= set(columns)
    assert not set(range(start + width, start + len(made[-1][2]) * width)) & set(columns)


def test_without_viscosity_the_pattern_is_the_same(steps):
    """One order of elimination serves both."""
    discretisation, made = steps
    matrix, _, masses, constraint_matrix, built = made[-1]
    still, none = np.zeros_like(matrix.flow), np.zeros(len(discretisation.numbering.cells))
    coefficients = Coefficients(matrix.inertia, 0.0, still, still, none)
    system_matrix = discretisation._assembly.matrix(matrix.points, coefficients)
    discretisation._constraint.place(matrix.node_points, matrix.position)
    inviscid = discretisation._reduced_matrix(system_matrix).filled(system_matrix, masses)
    wanted = expected(discretisation, system_matrix, masses, constraint_matrix)
    assert abs(inviscid - wanted).max() < 1e-14 * abs(wanted).max()
    assert pattern_of(inviscid) == pattern_of(built)
