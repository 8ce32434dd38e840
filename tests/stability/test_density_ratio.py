"""Very light and very heavy disks: added mass does not destabilise the coupled step."""

import numpy as np
import pytest
from falling import falling_disk

import rigidfluid
from rigidfluid.core.run.simulation import Simulation

RADIUS, GRAVITY = 0.125, 981.0
AREA = np.pi * RADIUS**2


def fall(density, steps, step, **mesh):
    return rigidfluid.run(
        falling_disk(
            body={"density": density}, mesh=mesh, time={"step": step, "end": steps * step}, output={"every": 1.0}
        )
    )


def added_mass():
    """Of the disk at (1, 4) in its 2×6 box from potential flow: ∮ φ n_y over the disk, Δφ = 0, ∂φ/∂n = -n_y there."""
    from skfem import Basis, BilinearForm, ElementTriP2, FacetBasis, LinearForm, MeshTri, condense, solve
    from skfem.helpers import dot, grad

    made = Simulation(falling_disk(mesh={"size_body": 0.02}), None, False).state.mesh

    mesh = MeshTri(np.ascontiguousarray(made.points.T), np.ascontiguousarray(made.cells.T))
    disk = mesh.facets_satisfying(lambda x: np.hypot(x[0] - 1.0, x[1] - 4.0) < 1.5 * RADIUS, boundaries_only=True)
    basis, on_disk = Basis(mesh, ElementTriP2()), FacetBasis(mesh, ElementTriP2(), facets=disk)
    stiffness = BilinearForm(lambda u, v, _: dot(grad(u), grad(v))).assemble(basis)
    flux = LinearForm(lambda v, w: w.n[1] * v).assemble(on_disk)
    potential = solve(*condense(stiffness, flux, D=np.array([0])))
    return float(flux @ potential)


def test_added_mass_is_a_little_more_than_that_of_an_unbounded_fluid():
    assert 1.0 < added_mass() / AREA < 1.05


@pytest.mark.parametrize("density", [1e-3, 0.1, 0.5, 1.25, 10.0, 1e3])
def test_first_acceleration(density):
    """Before a boundary layer grows; the mesh is fine there, or its no-slip cells would drag fluid along."""
    bodies = fall(density, steps=2, step=5e-6, size_body=0.005, growth=0.4).bodies
    acceleration = (bodies["vy"][2] - bodies["vy"][0]) / 1e-5
    expected = -(density - 1.0) * AREA * GRAVITY / (density * AREA + added_mass())
    assert acceleration == pytest.approx(expected, rel=0.05)


@pytest.mark.parametrize("density", [1e-3, 1e3])
def test_a_long_step_stays_stable(density):
    """Speeds grow steadily towards their limit; an unstable coupling alternates and grows at every step."""
    history = fall(density, steps=30, step=0.002, size_body=0.03)
    speed = np.abs(history.bodies["vy"])
    assert np.all(np.diff(speed) > 0)
    assert speed[-1] < GRAVITY * 0.06
    assert history.summary["rejected_steps"] == 0
    assert abs(history.summary["energy"]["relative_residual"]) < 0.02


def test_a_neutrally_buoyant_disk_in_fluid_at_rest_stays_at_rest():
    bodies = fall(1.0, steps=5, step=0.01, size_body=0.04).bodies
    for column in ("vx", "vy", "w"):
        assert np.abs(bodies[column]).max() < 1e-10


def test_the_fluids_wrench_is_what_changes_the_bodys_momentum():
    """d(mU, Iω)/dt - weight, differenced as the scheme does, equals the columns f and t."""
    bodies = fall(1.25, steps=12, step=0.004, size_body=0.04).bodies
    mass, inertia = 1.25 * AREA, 1.25 * AREA * RADIUS**2 / 2

    def rate(column):
        values = bodies[column]
        return (3 * values[2:] - 4 * values[1:-1] + values[:-2]) / (2 * 0.004)

    weight = -(1.25 - 1.0) * AREA * GRAVITY
    np.testing.assert_allclose(mass * rate("vy") - weight, bodies["fy"][2:], rtol=1e-6)
    np.testing.assert_allclose(mass * rate("vx"), bodies["fx"][2:], atol=1e-6)
    np.testing.assert_allclose(inertia * rate("w"), bodies["t"][2:], atol=1e-8)
