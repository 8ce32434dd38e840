"""A held cylinder sheds vortices: what a report says of them."""

from __future__ import annotations

from pathlib import Path

import pytest
from vortex_induced import FIXED

import rigidfluid
from rigidfluid.post.reports.coefficients import figures, reference
from rigidfluid.post.reports.results import read_results

pytestmark = pytest.mark.long

SCENE = Path(__file__).parents[2] / "scenes" / "vortex_induced.toml"


@pytest.mark.validation
def test_a_report_finds_the_strouhal_number_of_a_cylinder(tmp_path: Path) -> None:
    """Re = 100, in a smaller box of coarse cells: blockage of 4 % and these cells make it 3 % higher."""
    smaller = ["domain.lower=[-12.0,-12.0]", "domain.upper=[20.0,12.0]"]
    coarse = ["mesh.size_body=0.12", "time.step=0.1", "time.end=55.0", "output.every=55.0"]
    tables = rigidfluid.load_scene(SCENE, smaller + coarse).to_dict()
    del tables["body"][0]["free"], tables["body"][0]["spring"]
    tables["body"][0]["fixed"] = True
    rigidfluid.run(rigidfluid.scene_from_dict(tables), tmp_path)
    results = read_results(tmp_path)
    by = reference(results)
    assert by is not None
    (found,) = figures(results, by)
    assert found.by == "lift"
    assert found.strouhal == pytest.approx(FIXED.frequency, rel=0.04)
    assert found.drag == pytest.approx(FIXED.drag, rel=0.05)
    assert found.swing == pytest.approx(FIXED.lift, rel=0.25)
