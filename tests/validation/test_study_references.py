"""Limits that studies state as their references, found again with steps shorter than the study's."""

from typing import Any

import pytest
from page_tools.places import ROOT

from rigidfluid.post.studies import load_study
from rigidfluid.post.studies.scene_subject import SceneSubject

pytestmark = pytest.mark.validation

LIMITS = {
    "contact_stepping": ({"contact.stepping": "substeps", "time.step": 2e-6}, 1e-6),
    "contact_stepping_in_fluid": ({"contact.stepping": "substeps", "time.step": 1.5625e-5}, 1e-4),
    "backends": ({"mesh.size": 0.075, "mesh.size_body": 0.00625, "time.step": 6.25e-4}, 4e-5),
}
"""By study: settings, and how well its reference is known."""


@pytest.mark.timeout(600)
@pytest.mark.parametrize(("name", "settings", "known"), [(name, *limit) for name, limit in LIMITS.items()], ids=LIMITS)
def test_a_reference_is_the_limit_of_short_steps(name: str, settings: dict[str, Any], known: float) -> None:
    subject = SceneSubject(load_study(ROOT / "studies" / f"{name}.toml"))
    assert isinstance(subject.target.reference, float)
    assert abs(subject.run(settings, lambda share: None).figure - subject.target.reference) < known
