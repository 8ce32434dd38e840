"""Plug-ins that exit or raise stop only who uses them, are named, and leave a summary."""

from __future__ import annotations

import json
import pickle
from collections.abc import Callable
from pathlib import Path

import pytest
from dry_scenes import ball, dry_scene

import rigidfluid
from rigidfluid.checks import check
from rigidfluid.core.scene.scene import Scene
from rigidfluid.errors import PluginError, SceneError
from rigidfluid.registry import Registry

Install = Callable[..., Path]


def meeting(**contact: object) -> Scene:
    return dry_scene(contact, ball([0.3, 0.5], [1.0, 0.0]), ball([0.54, 0.5], [-1.0, 0.0]), end=0.1, step=0.01)


FORCE = "return (self.range - contacts.gap)[:, None] * contacts.normal"


def springy(install: Install, law: str, old: str, new: str) -> Scene:
    install(law.replace(old, new))
    return meeting(law="springy", range=0.05)


def later(statement: str) -> str:
    """The same force, and after ten times the statement."""
    asked = "self.asked = getattr(self, 'asked', 0) + 1"
    return f"{asked}\n            if self.asked > 10: {statement}\n            {FORCE}"


def test_a_part_that_exits_in_a_run(install: Install, law: str, tmp_path: Path) -> None:
    scene = springy(install, law, FORCE, later("raise SystemExit(0)"))
    told = r"law 'springy', force: found SystemExit: 0, raised in module springy_plugin, line \d+"
    with pytest.raises(PluginError, match=told):
        rigidfluid.run(scene, tmp_path)
    assert json.loads((tmp_path / "summary.json").read_text())["status"].startswith("stopped: force law 'springy'")


def test_the_line_of_the_part_is_told_where_another_module_raises(install: Install, law: str) -> None:
    scene = springy(install, law, FORCE, "return self.options.strenth")
    with pytest.raises(PluginError, match=r"no attribute 'strenth', raised in module springy_plugin, line \d+;"):
        check(scene)


def test_a_part_that_exits_when_it_is_made_or_asked(install: Install, law: str) -> None:
    scene = springy(install, law, "return (self.range - contacts.gap) ** 2 / 2", "raise SystemExit(0)")
    with pytest.raises(PluginError, match="module springy_plugin"):
        check(scene)
    with pytest.raises(PluginError, match="module springy_plugin"):
        rigidfluid.run(scene)


def test_an_error_of_a_part_leaves_a_summary(install: Install, law: str, tmp_path: Path) -> None:
    scene = springy(install, law, FORCE, later("raise KeyError('lost')"))
    with pytest.raises(PluginError, match="KeyError: 'lost'") as told:
        rigidfluid.run(scene, tmp_path)
    assert isinstance(told.value.__cause__, KeyError)
    assert "KeyError: 'lost'" in json.loads((tmp_path / "summary.json").read_text())["status"]


DETECTOR = """
    from rigidfluid.api import Detector, hookimpl
    from rigidfluid.detectors.sphere import SphereDetector

    class Careless(SphereDetector):
        name = "careless"
        cost = 0.0
        {statement}

    @hookimpl
    def rigidfluid_detectors():
        return [Careless]
"""


@pytest.mark.parametrize(
    "statement",
    [
        "exact_for = classmethod(lambda cls, bodies, pieces: 1 / 0)",
        "exact_for = classmethod(lambda cls, bodies, pieces: 3)",
        "exact_for = lambda self, bodies, pieces: self.walls",
        "exact_for = True",
    ],
)
def test_a_detector_that_fails_when_it_is_asked_stops_those_who_name_it(install: Install, statement: str) -> None:
    install(DETECTOR.format(statement=statement))
    check(meeting(law="centre", range=0.05, epsilon=1e-4, epsilon_wall=1e-4))
    with pytest.raises(PluginError, match="detector 'careless', exact_for: found"):
        check(meeting(law="centre", range=0.05, epsilon=1e-4, epsilon_wall=1e-4, detector="careless"))


def test_an_error_of_rigidfluid_says_by_which_part_it_came(install: Install, law: str) -> None:
    raised = "from rigidfluid.api import SceneError; raise SceneError('a', 1, 'another', 'Mend it.')"
    scene = springy(install, law, FORCE, raised)
    with pytest.raises(SceneError, match=r"a: found 1; .* Raised by force law 'springy', force\.") as told:
        check(scene)
    assert str(pickle.loads(pickle.dumps(told.value))) == str(told.value)


def test_a_hook_that_interrupts_is_an_interrupt(install: Install) -> None:
    install("from rigidfluid.api import hookimpl\n@hookimpl\ndef rigidfluid_bodies():\n    raise KeyboardInterrupt")
    with pytest.raises(KeyboardInterrupt):
        Registry.load()
