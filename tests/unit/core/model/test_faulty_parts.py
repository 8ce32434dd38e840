"""Parts that exit, or give what would be read beyond its end or crash a library, are refused by name."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from dry_scenes import ball, dry_scene

import rigidfluid
from rigidfluid.checks import check
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.scene.scene import Scene
from rigidfluid.errors import PluginError
from rigidfluid.registry import Registry

Install = Callable[..., Path]

BODY = """
    import numpy as np
    from rigidfluid.bodies.sphere import Sphere
    from rigidfluid.hookspecs import hookimpl

    class Odd(Sphere):
        name = "odd"
        FAULT

    @hookimpl
    def rigidfluid_bodies():
        return [Odd]
"""
DETECTOR = """
    from dataclasses import replace
    from rigidfluid.detectors.sphere import SphereDetector
    from rigidfluid.hookspecs import hookimpl

    class Odd(SphereDetector):
        name = "odd"

        def detect(self, pose, mesh, reach):
            contacts = super().detect(pose, mesh, reach)
            return replace(contacts, FAULT)

    @hookimpl
    def rigidfluid_detectors():
        return [Odd]
"""


def meeting(**contact: object) -> Scene:
    return dry_scene(contact, ball([0.3, 0.5], [1.0, 0.0]), ball([0.54, 0.5], [-1.0, 0.0]), end=0.1, step=0.01)


def springy(install: Install, law: str, old: str, new: str) -> Scene:
    install(law.replace(old, new))
    return meeting(law="springy", range=0.05)


@pytest.mark.parametrize("code", ["import sys; sys.exit(3)", "raise SystemExit"])
def test_a_plugin_that_exits_when_imported(install: Install, law: str, code: str) -> None:
    install(law.replace("import numpy as np", f"import numpy as np; {code}"))
    with pytest.raises(PluginError, match=r"plug-in springy of springy 1.2: found SystemExit: "):
        Registry.load()


def test_a_hook_that_exits(install: Install, law: str) -> None:
    install(law.replace("return [Springy]", "raise SystemExit(0)"))
    with pytest.raises(PluginError, match=r"module springy_plugin, line \d+: found an exit of the program, code 0"):
        Registry.load()


def test_a_part_that_exits_in_a_run(install: Install, law: str, tmp_path: Path) -> None:
    scene = springy(
        install, law, "return (self.range - contacts.gap)[:, None] * contacts.normal", "raise SystemExit(0)"
    )
    with pytest.raises(PluginError, match=r"module springy_plugin, line \d+: found an exit of the program, code 0"):
        rigidfluid.run(scene, tmp_path)
    assert json.loads((tmp_path / "summary.json").read_text())["status"].startswith("stopped: module springy_plugin")


def test_a_part_that_exits_when_it_is_made_or_asked(install: Install, law: str) -> None:
    scene = springy(install, law, "return (self.range - contacts.gap) ** 2 / 2", "raise SystemExit(0)")
    with pytest.raises(PluginError, match="module springy_plugin"):
        check(scene)
    with pytest.raises(PluginError, match="module springy_plugin"):
        rigidfluid.run(scene)


def test_an_error_of_a_part_leaves_a_summary(install: Install, law: str, tmp_path: Path) -> None:
    scene = springy(
        install, law, "return (self.range - contacts.gap)[:, None] * contacts.normal", "raise KeyError('lost')"
    )
    with pytest.raises(KeyError):
        rigidfluid.run(scene, tmp_path)
    assert json.loads((tmp_path / "summary.json").read_text())["status"] == "stopped: KeyError: 'lost'"


@pytest.mark.parametrize(
    "force", ["contacts.gap", "np.ones((2, 2))", "np.zeros((0, 2))", "np.ones((len(contacts), 3))"]
)
def test_forces_of_another_shape(install: Install, law: str, force: str) -> None:
    scene = springy(install, law, "(self.range - contacts.gap)[:, None] * contacts.normal", force)
    with pytest.raises(PluginError, match=r"contact.law: found forces of shape \(.*\); allowed is \(1, 2\), a row for"):
        rigidfluid.run(scene)


@pytest.mark.parametrize(
    ("fault", "found"),
    [
        ("body_b=contacts.body_b + 100", "a contact of surfaces that there are not"),
        ("body_a=contacts.body_a - 100", "a contact of surfaces that there are not"),
        ("point_a=contacts.point_a[:1]", "point_a of shape"),
    ],
)
def test_contacts_that_cannot_be(install: Install, fault: str, found: str) -> None:
    install(DETECTOR.replace("FAULT", fault), name="odd", module="odd_detector")
    with pytest.raises(PluginError, match=f"contact.detector: found {found}"):
        rigidfluid.run(meeting(detector="odd"))


@pytest.mark.parametrize(
    "fault",
    [
        "radius = -0.1",
        "radius = float('nan')",
        "bounding_radius = 0.0",
        "volume = -1.0",
        "volume = float('inf')",
        "unit_inertia = np.array([[-1.0]])",
        "unit_inertia = np.eye(2)",
        "semi_axes = np.array([0.1, -0.1])",
    ],
)
def test_a_body_that_cannot_be(install: Install, fault: str) -> None:
    """Netgen ends the whole process on a ball of negative radius."""
    install(BODY.replace("FAULT", fault), name="odd", module="odd_body")
    table = meeting().to_dict()
    table["body"][0]["type"] = "odd"
    with pytest.raises(PluginError, match=r"body.0: found a \w+ of .*, by the type 'odd'"):
        scene_from_dict(table)
