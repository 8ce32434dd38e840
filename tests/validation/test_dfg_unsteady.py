"""Flow past a cylinder in a stream that rises and falls: Schäfer & Turek, benchmark 2D-3, on a coarse mesh.

The drag is greatest before the inflow is, at 4 s, since it follows the acceleration too (John 2004,
doi:10.1002/fld.679). The lift asks for a finer mesh and shorter steps: docs/validation/dfg_unsteady.md.
"""

import numpy as np
import pytest
from falling import SCENES

import rigidfluid

pytestmark = pytest.mark.long

COARSE = ["mesh.size_body=0.0049", "mesh.size=0.04", "mesh.growth=0.2", "time.step=0.01", "time.end=4.2"]
FORCE_TO_COEFFICIENT = 2.0 / (1.0**2 * 0.1)
DRAG, AT = 2.950921575, 3.93625


def test_greatest_drag_and_its_time():
    history = rigidfluid.run(rigidfluid.load_scene(SCENES / "dfg_2d3.toml", COARSE))
    drag = history.bodies["fx"] * FORCE_TO_COEFFICIENT
    assert drag.max() == pytest.approx(DRAG, rel=0.01)
    assert history.bodies["time"][np.argmax(drag)] == pytest.approx(AT, abs=0.03)
    assert abs(history.summary["energy"]["relative_residual"]) < 2e-3
