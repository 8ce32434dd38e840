"""A result that is no number ends no run as complete, whichever part it comes from."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from dry_scenes import ball, dry_scene

import rigidfluid
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.scene.scene import Scene
from rigidfluid.errors import StepError

Install = Callable[..., Path]

LAW = """
    import numpy as np
    from rigidfluid.core.model.interfaces import ForceLaw
    from rigidfluid.hookspecs import hookimpl

    class Faulty(ForceLaw):
        name = "faulty"
        dissipative = True

        def force(self, contacts):
            return 1e3 * np.maximum(self.range - contacts.gap, 0.0)[:, None] * contacts.normal

        def energy(self, contacts):
            return 1e3 * np.maximum(self.range - contacts.gap, 0.0) ** 2 / 2

        def stiffness(self, contacts):
            return np.where(contacts.gap < self.range, 1e3, 0.0)

        FAULT

    @hookimpl
    def rigidfluid_force_laws():
        return [Faulty]
"""
FAULTS = {
    "force": "lambda self, contacts: np.full_like(contacts.normal, np.nan)",
    "infinite force": "lambda self, contacts: np.full_like(contacts.normal, np.inf)",
    "energy": "lambda self, contacts: np.full_like(contacts.gap, np.nan)",
    "stiffness": "lambda self, contacts: np.full_like(contacts.gap, np.nan)",
    "damping": "lambda self, contacts, motion: np.full_like(contacts.normal, np.nan)",
}
DETECTOR = """
    import numpy as np
    from dataclasses import replace
    from rigidfluid.detectors.sphere import SphereDetector
    from rigidfluid.hookspecs import hookimpl

    class Blind(SphereDetector):
        name = "blind"

        def detect(self, pose, mesh, reach):
            contacts = super().detect(pose, mesh, reach)
            return replace(contacts, FIELD=np.full_like(contacts.FIELD, np.nan))

    @hookimpl
    def rigidfluid_detectors():
        return [Blind]
"""
BACKEND = """
    import numpy as np
    from dataclasses import replace
    from rigidfluid.backends.dry import Dry
    from rigidfluid.core.model.types import Twist
    from rigidfluid.hookspecs import hookimpl

    class Lost(Dry):
        name = "lost"

        def advance(self, fluid, mesh, step):
            advance = super().advance(fluid, mesh, step)
            return replace(advance, FIELD)

    @hookimpl
    def rigidfluid_fluid_backends():
        return [Lost]
"""


def towards_each_other(law: str = "centre", **contact: object) -> Scene:
    table = {"law": law, "range": 0.05, **contact}
    return dry_scene(table, ball([0.3, 0.5], [1.0, 0.0]), ball([0.54, 0.5], [-1.0, 0.0]), end=0.1, step=0.01)


def assert_refused(scene: Scene, folder: Path, *words: str) -> None:
    with pytest.raises(StepError) as refused:
        rigidfluid.run(scene, folder)
    for word in words:
        assert word in str(refused.value)
    if folder.exists():  # nothing is written where the start is refused
        assert json.loads((folder / "summary.json").read_text())["status"].startswith("stopped")


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@pytest.mark.parametrize("fault", FAULTS)
def test_a_law_that_gives_no_number(install: Install, tmp_path: Path, fault: str) -> None:
    install(LAW.replace("FAULT", f"{fault.split()[-1]} = {FAULTS[fault]}"), name="faulty", module="faulty_law")
    assert_refused(towards_each_other("faulty"), tmp_path / "out", "contact", "contact.law")


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@pytest.mark.parametrize("field", ["gap", "normal", "point_a"])
def test_a_detector_that_gives_no_number(install: Install, tmp_path: Path, field: str) -> None:
    install(DETECTOR.replace("FIELD", field), name="blind", module="blind_detector")
    scene = towards_each_other(detector="blind", epsilon=1e-4, epsilon_wall=1e-4)
    assert_refused(scene, tmp_path / "out", "contacts", "contact.detector")


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ("twist=Twist(advance.twist.velocity * np.nan, advance.twist.angular_velocity)", "velocity"),
        ("kinetic_energy=np.nan", "energy"),
    ],
)
def test_a_backend_that_gives_no_number(install: Install, tmp_path: Path, change: str, word: str) -> None:
    install(BACKEND.replace("FIELD", change), name="lost", module="lost_backend")
    scene = towards_each_other(epsilon=1e-4, epsilon_wall=1e-4).to_dict()
    scene["fluid"]["backend"] = "lost"
    assert_refused(scene_from_dict(scene), tmp_path / "out", word, "fluid.backend")
