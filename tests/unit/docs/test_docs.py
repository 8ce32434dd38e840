"""Pages that are made from the code are up to date."""

from __future__ import annotations

import runpy

from paths import ROOT

SCRIPT = ROOT / "docs" / "make_scene_reference.py"


def test_scene_reference_is_up_to_date() -> None:
    script = runpy.run_path(str(SCRIPT))
    assert script["PATH"].read_text(encoding="utf-8") == script["reference"](), f"run python docs/{SCRIPT.name}"


def test_every_key_of_a_scene_is_described() -> None:
    page = SCRIPT.with_name("scene.md").read_text(encoding="utf-8")
    assert not [line for line in page.partition("## `[fluid] backend")[0].splitlines() if line.endswith("|  |")]
