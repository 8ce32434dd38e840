"""The page about control and learning, and what is kept of the example's run."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
from learn_stroke import swim, swimming
from page_code import run_page

from rigidfluid_gymnasium import FluidEnv

ROOT = Path(__file__).parents[3]
PAGE = ROOT / "docs" / "howto" / "learning.md"
PLUGIN = Path(__file__).parents[1]
README = (PLUGIN / "README.md").read_text(encoding="utf-8")
POLICY = np.array([-0.12, -2.43, 3.25, 0.04, 0.02, 0.06])
"""What the kept run has learned."""


def test_the_page_runs(tmp_path: Path) -> None:
    folder = tmp_path / "session"
    folder.mkdir()
    run_page(PAGE, folder)


def test_the_table_has_the_figures_of_the_kept_run() -> None:
    with (PLUGIN / "examples" / "stroke.csv").open(encoding="utf-8") as file:
        kept = {row[0]: [float(value) for value in row[1:]] for row in list(csv.reader(file))[1:]}
    rows = [line.split("|")[1:-1] for line in README.splitlines() if line.startswith("| ")]
    told = {row[0].strip(): [float(value) for value in row[1:]] for row in rows if row[0].strip().isdigit()}
    assert len(told) == 5
    assert len(kept) == 12
    assert told == {number: pytest.approx(kept[number], abs=6e-5) for number in told}


def test_what_was_learned_and_the_known_stroke_swim_as_far_as_is_told() -> None:
    env = FluidEnv(swimming())
    learned, known = swim(env, POLICY)[0], swim(env, None)[0]
    assert (round(learned, 3), round(known, 4)) == (0.367, 0.3731)
    for text in (README, PAGE.read_text(encoding="utf-8")):
        assert "0.3667" in text
        assert "0.3731" in text
