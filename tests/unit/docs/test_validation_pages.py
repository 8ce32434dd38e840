"""Pages of docs/validation are whole, and the README and docs/figures.md say what they say."""

from __future__ import annotations

import re
from importlib import import_module
from inspect import signature
from pathlib import Path

import pytest
from benchmark_scripts import benchmark
from page_tools import Work
from page_tools.make import MEASURED, WITH_DOLFINX, pages
from page_tools.places import GENERATORS, PAGES, RECORDS, ROOT, generators
from page_tools.quick import SECONDS, quick
from page_tools.quotes import disagreements, quotes, unmarked
from page_tools.record import Record, read_record

NAMES = sorted(path.stem for path in PAGES.glob("*.md"))
QUOTING = [(ROOT / name).read_text(encoding="utf-8") for name in ("README.md", "docs/figures.md")]
TABLE = """
| case | step | speed | off |
| --- | --- | --- | --- |
| disk | 0.1 | 1.234 (+0.5%) | 2.1e-05 |
| disk | 0.2 | 1.250 (+1.5%) | 4.0e-05 |
"""


def rows(text: str) -> list[list[str]]:
    """The rows of a text's table of results: case, figure, what is measured, reference."""
    table = text.partition("| case | figure | measured |")[2].partition("\n\n")[0]
    return [line.split("|")[1:5] for line in table.splitlines()[2:]]


@pytest.mark.parametrize("name", NAMES)
def test_every_page_says_what_makes_it(name: str) -> None:
    page = (PAGES / f"{name}.md").read_text(encoding="utf-8")
    if name in generators():
        assert f"python docs/make_validation.py {name}`" in page or f"docs/make_validation.py {name}`" in page
    else:
        script = re.search(r"(?:^|`)python ((?:benchmarks|tools)/\w+\.py)", page, re.M)
        assert script
        assert (ROOT / script[1]).exists()


@pytest.mark.parametrize("name", generators())
def test_every_generator_makes_a_page(name: str) -> None:
    assert list(signature(import_module(f"pages.{name}").page).parameters) == ["work"]


@pytest.mark.parametrize("path", sorted(GENERATORS.glob("*.py")), ids=lambda path: path.stem)
def test_a_generator_asks_its_work_for_what_there_is(path: Path) -> None:
    """Also after hours of runs."""
    asked = set(re.findall(r"\bwork\.(\w+)", path.read_text(encoding="utf-8")))
    assert {name for name in asked if not hasattr(Work("page"), name)} == set()


def test_every_generator_has_a_page() -> None:
    """But for that of the validation tests, which take hours."""
    assert set(generators()) - set(NAMES) <= {"tests"}


@pytest.mark.parametrize("name", NAMES)
def test_a_page_shows_what_there_is(name: str) -> None:
    links = re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", (PAGES / f"{name}.md").read_text(encoding="utf-8"))
    assert [link for link in links if not (PAGES / link).exists()] == []


def test_every_picture_is_shown() -> None:
    shown = {link for name in NAMES for link in re.findall(r"\]\((\w+\.png)\)", (PAGES / f"{name}.md").read_text())}
    assert {path.name for path in PAGES.glob("*.png")} - shown == set()


def test_every_page_is_made_by_the_command() -> None:
    assert set(NAMES) <= set(pages())
    assert not set(MEASURED) & set(generators())
    assert set(WITH_DOLFINX) <= set(pages())


@pytest.mark.parametrize("name", NAMES)
def test_a_page_is_as_it_was_written(name: str) -> None:
    record = read_record(name)
    assert record is not None, f"docs/validation/{name}.md has no record"
    assert record.edited() == [], "a page is made, not edited: python docs/make_validation.py NAME"


@pytest.mark.parametrize("name", sorted(path.stem for path in (PAGES / "measured").iterdir()))
def test_a_page_that_tells_times_follows_from_what_is_kept(name: str) -> None:
    if name == "step":
        pytest.importorskip("ngsolve", reason="the benchmark imports it")
    with benchmark("written_page") as written, benchmark(name) as script:
        found = written.measurement(PAGES / f"{name}.md")
        text = script.page(found, f"{name}.png") if name == "work_precision" else script.page(found)
    assert (PAGES / f"{name}.md").read_text(encoding="utf-8").startswith(text.rstrip())


def test_every_record_is_of_a_page() -> None:
    assert {path.stem for path in RECORDS.iterdir()} == set(NAMES)


def test_quick_pages_are_the_cheapest_that_fit(tmp_path: Path) -> None:
    costs = {"walls": 0.5, "wakes": 0.3, "window": 0.25, "ten_cate": 0.01, "tests": 0.01, "step": 0.01}
    for name, share in costs.items():
        Record("today", "commit", share * SECONDS).write(name, tmp_path)
    Record("today", "commit", None).write("swimmer", tmp_path)
    assert quick(tmp_path) == ["window", "wakes"]


def test_there_are_quick_pages() -> None:
    assert {"walls", "lammps", "dfg_cylinder"} <= set(quick())


@pytest.mark.parametrize(("text", "count"), [(QUOTING[0], 10), (QUOTING[1], 26)], ids=("README", "figures"))
def test_every_measured_figure_names_its_page_and_is_what_that_says(text: str, count: int) -> None:
    measured = [cell for _, _, cell, _ in rows(text)]
    assert len(measured) >= count
    assert {cell: found for cell in measured if (found := unmarked(cell))} == {}
    assert list(disagreements(text)) == []


@pytest.mark.parametrize(
    ("text", "wrong"),
    [
        ("1.23<!-- page: disk, 0.1 → speed --> cm/s", False),
        ("1.24<!-- page: disk, 0.1 → speed --> cm/s", True),
        (".5 %<!-- page: disk, 0.1 → speed -->", False),
        (".5<!-- page: disk, 0.1 → speed -->", True),
        ("2.1·10⁻⁵<!-- page: disk, 0.1 → off -->", False),
        ("2.2·10⁻⁵<!-- page: disk, 0.1 → off -->", True),
        (".0021 %<!-- page: disk, 0.1 → off -->", False),
        (".0021<!-- page: disk, 0.1 → off -->", True),
        ("1.23<!-- page: disk → speed -->", True),
        ("1.23<!-- page: disk, 0.1 → height -->", True),
        ("1.23<!-- other: disk, 0.1 → speed -->", True),
    ],
)
def test_a_figure_that_its_page_does_not_say_is_seen(tmp_path: Path, text: str, wrong: bool) -> None:
    (tmp_path / "page.md").write_text(TABLE, encoding="utf-8")
    assert bool(list(disagreements(text, tmp_path))) == wrong


def test_a_mark_without_a_figure_is_refused() -> None:
    with pytest.raises(ValueError, match="behind no number"):
        quotes("speed<!-- page: disk → speed -->")


def test_a_figure_without_a_mark_is_seen() -> None:
    assert unmarked(".5<!-- a: b → c -->, .7 s") == [".7"]


NEAR = 0.02
"""Largest distance of a measured figure from its reference, relative."""


def far_from_reference(figures: str, reference: str) -> list[tuple[float, float]]:
    """Figures that are not near the reference beside them: the first one, or one each; a 0 tells nothing."""
    told = [float(number) for number in re.findall(r"(?<![\w.])\d*\.?\d+(?![\w.])", re.sub(r"\(.*?\)", "", reference))]
    found = [quote.value for quote in quotes(figures)]
    pairs = zip(found, told if len(told) == len(found) else told[:1], strict=False)
    return [(one, other) for one, other in pairs if other and abs(one / other - 1.0) > NEAR]


@pytest.mark.parametrize("text", QUOTING, ids=("README", "figures"))
def test_figures_are_near_their_references(text: str) -> None:
    assert [far for _, _, figures, reference in rows(text) for far in far_from_reference(figures, reference)] == []


def test_a_figure_far_from_its_reference_is_seen() -> None:
    figures = ".4809<!-- a: b → c -->, .9<!-- a: d → c --> s"
    assert far_from_reference(figures, ".4779, .91 (John 2004)") == []
    assert far_from_reference(figures, ".4379, .91") == [(0.4809, 0.4379)]
    assert far_from_reference(figures, ".4779; .8; .7 (others)") == []
    assert far_from_reference(figures, "0") == []
