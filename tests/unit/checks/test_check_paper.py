"""What `check` says of the scenes after Van Landeghem et al.: how strong their laws are, and where bodies rest."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from paths import SCENES
from typer.testing import CliRunner

from rigidfluid import load_scene
from rigidfluid.cli import app
from rigidfluid.core.case.system import build_system

NONE = "none"
# scene, law, against, largest force over submerged weight, rest gap [cm]; computed by hand from 4 range³/(27 ε),
# 2 r range²/ε and the roots of F(gap) = W
TABLE = [
    ("falling_disk", "contact", "bottom", "0.008", NONE),
    ("falling_disk", "centre", "bottom", "0.93", "-0.0005"),
    ("falling_sphere", "contact", "bottom", "1.96", "0.174"),
    ("falling_sphere", "centre", "bottom", "75", "0.234"),
    ("two_disks", "contact", "bottom", "0.11", NONE),
    ("two_disks", "centre", "bottom", "6.6", "0.0140"),
    ("two_disks", "contact", "lower_disk", "0.08", NONE),
    ("two_disks", "centre", "lower_disk", "4.7", "0.0124"),
    ("hundred_disks", "contact", "bottom", "77", "0.0239"),
    ("hundred_disks", "centre", "bottom", "1300", "0.0244"),
    ("hundred_disks", "contact", "body", "1.5", "0.0150"),
    ("hundred_disks", "centre", "body", "26", "0.0207"),
]

PAPER = {"falling_disk": ["contact.epsilon_wall=5e-6"], "falling_ellipsoid": ["contact.epsilon=3e-6"]}
"""What the paper has where a shipped scene has something else."""


def checked(scene: str, tmp_path: Path, *assignments: str) -> tuple[int, dict[str, Any]]:
    """Exit code and report of the command."""
    path = tmp_path / "check.json"
    settings = [word for assignment in assignments for word in ("--set", assignment)]
    result = CliRunner().invoke(app, ["check", str(SCENES / f"{scene}.toml"), "--json", str(path), *settings])
    return result.exit_code, json.loads(path.read_text())


def at_rest(report: dict[str, Any], against: str) -> dict[str, Any]:
    """The one finding about rest on a surface of this name."""
    found = [one for one in report["findings"] if one["question"] == "rest" and one["subject"][1].startswith(against)]
    assert len(found) == 1
    return found[0]


def to_its_digits(text: str) -> Any:
    """The number in the table, within half of its last digit."""
    digits = len(text.partition(".")[2])
    unit = 10.0**-digits if digits else 10.0 ** (len(text) - len(text.rstrip("0")))
    return pytest.approx(float(text), abs=0.5 * unit)


@pytest.mark.parametrize(("scene", "law", "against", "share", "gap"), TABLE)
def test_strength_of_the_paper(scene: str, law: str, against: str, share: str, gap: str, tmp_path: Path) -> None:
    code, report = checked(scene, tmp_path, f"contact.law={law}", *PAPER.get(scene, []))
    finding = at_rest(report, against)
    assert finding["found"]["force_over_weight"] == to_its_digits(share)
    assert finding["found"]["rest_gap"] == (None if gap == NONE else to_its_digits(gap))
    weak = float(share) < 1.0
    assert finding["grade"] == ("error" if weak else "note")
    assert code == (1 if report["errors"] else 0)
    assert report["errors"] > 0 or not weak


def test_the_disk_of_the_paper_needs_a_smaller_epsilon(tmp_path: Path) -> None:
    _, report = checked("falling_disk", tmp_path, *PAPER["falling_disk"])
    finding = at_rest(report, "bottom")
    assert finding["enough"]["epsilon_wall"] == to_its_digits("0.00000467")
    assert "contact.epsilon_wall to 4.67e-06 or less" in finding["remedy"]
    code, again = checked("falling_disk", tmp_path, "contact.epsilon_wall=4.67e-6")
    assert code == 0
    assert at_rest(again, "bottom")["found"]["rest_gap"] >= 0.0


def test_the_disk_as_shipped_has_nothing_to_warn_of(tmp_path: Path) -> None:
    code, report = checked("falling_disk", tmp_path)
    assert (code, report["errors"], report["warnings"]) == (0, 0, 0)


@pytest.mark.parametrize("scene", ["ellipse_in_channel", "falling_ellipsoid"])
def test_ellipses_of_the_paper_rest_where_the_cubic_says(scene: str, tmp_path: Path) -> None:
    overrides = PAPER.get(scene, [])
    loaded = load_scene(SCENES / f"{scene}.toml", overrides)
    law_range, epsilon = loaded.contact.range, loaded.contact.options["epsilon"]
    weight = np.linalg.norm(build_system(loaded).weight[0])
    code, report = checked(scene, tmp_path, *overrides)
    found = at_rest(report, "bottom")["found"]
    roots = np.roots([1.0, -2.0 * law_range, law_range**2, -epsilon * weight])  # gap (range - gap)² = ε W
    inside = roots.real[(np.abs(roots.imag) < 1e-12) & (roots.real < law_range)]
    assert code == 0
    assert found["force_over_weight"] == pytest.approx(4 * law_range**3 / (27 * epsilon * weight), rel=1e-6)
    assert found["rest_gap"] == pytest.approx(inside.max(), rel=1e-9)


@pytest.mark.parametrize(("law_range", "grade"), [(0.05, "warning"), (0.03, "note"), (0.01, None)])
def test_ellipse_between_walls(law_range: float, grade: str | None, tmp_path: Path) -> None:
    _, report = checked("ellipse_in_channel", tmp_path, f"contact.range={law_range}", "contact.epsilon=1e-9")
    found = [one for one in report["findings"] if one["question"] == "free-gap"]
    assert [one["grade"] for one in found] == ([] if grade is None else [grade])
    for one in found:
        assert one["found"]["least_centred_gap"] == to_its_digits("0.0115")
        assert one["found"]["most_centred_gap"] == to_its_digits("0.0365")
