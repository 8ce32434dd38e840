"""Two makings of a page are the same but for times and the last digit."""

from __future__ import annotations

from pathlib import Path

import pytest
from page_tools.check import check
from page_tools.same_page import differences

PAGE = """# Page

Made on 2026-11-22 at commit 1, in 7 s of CPU time.

The speed is 1.25 cm/s, 0.5% off. The run took 12 s of CPU time.

| case | speed | CPU [s] | off |
| --- | --- | --- | --- |
| a | 1.250 | 12 | -0.01% |
| b | 12,345 | 13 | 2e-13 |
| memory [GB] | 1.5 | 1.2 | 1.1 |
"""


@pytest.mark.parametrize(
    ("before", "after", "lines"),
    [
        ("2026-11-22 at commit 1", "2026-11-25 at commit 2", 0),
        ("12 s of", "99 s of", 0),
        ("| 12 |", "| 99 |", 0),
        ("| 1.5 | 1.2 |", "| 2.5 | 2.2 |", 0),
        ("2e-13", "7e-14", 0),
        ("| 1.250", "| 1.251", 0),
        ("| 1.250", "| 1.252", 1),
        ("12,345", "12,346", 0),
        ("12,345", "12,347", 1),
        ("-0.01%", "+0.01%", 1),
        ("| a |", "| c |", 1),
        ("CPU [s]", "wall time", 1),
        ("| b | 12,345 | 13 | 2e-13 |\n", "", 1),
        ("2e-13", "2e-06", 1),
    ],
)
def test_lines_that_differ_are_told(before: str, after: str, lines: int) -> None:
    assert before in PAGE
    assert len(list(differences(PAGE, PAGE.replace(before, after)))) == lines


def test_numbers_of_prose_are_compared() -> None:
    one = "The speed is 1.25 cm/s."
    assert list(differences(one, one)) == []
    assert list(differences(one, "The speed is 1.35 cm/s.")) == [f"- {one}\n+ The speed is 1.35 cm/s."]


def test_quick_pages_are_made_elsewhere_and_compared(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pages, folder = tmp_path / "pages", tmp_path / "made"
    for place in (pages, folder):
        place.mkdir()
        (place / "same.md").write_text(PAGE)
        (place / "other.md").write_text(PAGE)
    (folder / "other.md").write_text(PAGE.replace("| a |", "| c |"))

    def make(name: str, *, fresh: bool, folder: Path) -> bool:
        assert fresh
        return name != "failed"

    monkeypatch.setattr("page_tools.make.make", make)
    found = dict(check(["same", "other", "failed"], folder, pages))
    assert found["same"] == []
    assert len(found["other"]) == 1
    assert found["failed"] == ["could not be made"]
