"""Steady flow past a cylinder at Re 20: Schäfer & Turek, benchmark 2D-1 (doi:10.1007/978-3-322-89849-4_39)."""

import pytest
from falling import SCENES

import rigidfluid
from rigidfluid.errors import PluginError

pytestmark = pytest.mark.long

# Force 2 F / (ρ Ū² D) with mean inflow Ū = 0.2 and diameter D = 0.1; converged values of John & Matthies 2001.
FORCE_TO_COEFFICIENT = 2.0 / (0.2**2 * 0.1)
DRAG, LIFT, PRESSURE_DIFFERENCE = 5.57953523384, 0.010618948146, 0.11752016697


OTHERS = [pytest.param(name, marks=pytest.mark.validation) for name in ("dolfinx", "ngsolve")]


@pytest.fixture(scope="module", params=["scikit-fem", *OTHERS])
def history(request):
    try:
        scene = rigidfluid.load_scene(SCENES / "dfg_cylinder.toml", [f"fluid.backend={request.param}"])
    except PluginError as error:
        pytest.skip(str(error))
    return rigidfluid.run(scene)


def test_drag(history):
    assert history.bodies["fx"][-1] * FORCE_TO_COEFFICIENT == pytest.approx(DRAG, rel=1e-3)


def test_lift(history):
    assert history.bodies["fy"][-1] * FORCE_TO_COEFFICIENT == pytest.approx(LIFT, rel=5e-3)


def test_pressure_difference(history):
    front, back = history.probes["pressure"][-2:]
    assert front - back == pytest.approx(PRESSURE_DIFFERENCE, rel=1e-3)


def test_energy_that_enters_is_dissipated(history):
    assert abs(history.summary["energy"]["relative_residual"]) < 0.02
