"""Scenes, models, simulations and results tell what they are in a line, and in a table without foreign HTML."""

from __future__ import annotations

from collections.abc import Callable
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest
from scenes import dry_tables, wet_tables

from rigidfluid.api import Simulation, load_results, model_of, run, scene_from_dict
from rigidfluid.described import Described, first_names

NAME = "<b>&disk</b>"
DISK = {"name": NAME, "type": "sphere", "radius": 0.1, "density": 2.0, "position": [0.5, 0.5]}


def scene() -> Any:
    return scene_from_dict(wet_tables(DISK, end=0.02, contact={"law": "normal", "range": 0.02, "epsilon": 1e-3}))


def after_a_step(out: Path) -> Simulation:
    simulation = Simulation(scene(), out)
    simulation.step()
    simulation.close()
    return simulation


MADE: dict[str, tuple[Callable[[Path], Any], tuple[str, ...]]] = {
    "Scene": (lambda _: scene(), ("name: box", "fluid: scikit-fem", "laws: 1 (normal)", "to 0.02 in steps of 0.01")),
    "Model": (lambda _: model_of(scene()), ("name: box", "fluid: ScikitFem", "laws: 1 (NormalLaw)")),
    "Simulation": (after_a_step, ("scene: box", "time: 0.01 of 0.02", "steps: 1", "smallest gap: 0.4", "folder: ")),
    "History": (lambda out: run(scene(), out), ("scene: box", "status: complete", "time: 0.02", "folder: ")),
    "RunResults": (
        lambda out: load_results(after_a_step(out).history.folder),
        ("scene: box", "no summary yet", "1, from"),
    ),
    "FluidFields": (lambda out: after_a_step(out).fields(), ("time: 0.01", "dimension: 2", "highest speed: 0")),
}


class Cells(HTMLParser):
    """Texts and tags of a table."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.tags: set[str] = set()
        self.texts: list[str] = []
        self.feed(html)

    def handle_starttag(self, tag: str, attrs: object) -> None:
        self.tags.add(tag)

    def handle_data(self, data: str) -> None:
        self.texts.append(data)


@pytest.mark.parametrize("kind", MADE)
def test_each_tells_what_it_is(kind: str, tmp_path: Path) -> None:
    make, facts = MADE[kind]
    made = make(tmp_path)
    line, table = repr(made), Cells(made._repr_html_())
    assert line.startswith(f"{kind}(")
    assert str(made) == line
    assert [fact for fact in facts if fact not in line] == []
    assert len(line) < 400
    assert "\n" not in line
    assert table.tags == {"table", "caption", "tr", "th", "td"}
    assert table.texts[0] == kind
    assert (f"1 ({NAME})" in table.texts) == (NAME in line)


def test_names_are_shown_where_there_are_bodies() -> None:
    assert NAME in repr(scene())


def test_many_bodies_are_counted() -> None:
    places = [[0.1 + 0.2 * (i % 5), 0.1 + 0.2 * (i // 5)] for i in range(20)]
    bodies = [{"type": "sphere", "radius": 0.05, "density": 1.0, "position": place} for place in places]
    many = scene_from_dict(dry_tables(*bodies))
    for made in (many, model_of(many), Simulation(many)):
        assert "bodies: 20 (body0, body1, body2, body3, body4, …)" in repr(made)


def test_what_is_not_there_is_left_out_and_what_is_long_is_cut() -> None:
    class Long(Described):
        def _facts(self) -> dict[str, object]:
            return {"text": "word\n" * 100, "none": None, "empty": first_names([]), "number": 0.1 + 0.2}

    assert repr(Long()) == f"Long(text: {('word ' * 16)[:80]}…, number: 0.3)"
