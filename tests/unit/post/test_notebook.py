"""Progress in a notebook: the bar, the growing plot, how often they are drawn, and a notebook that is executed."""

from __future__ import annotations

import base64
import json
import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.image import imread
from scenes import dry_tables
from site_tools.notebook import NOTEBOOK, input_digest, page_text

from rigidfluid.api import ArgumentError, History, NotebookProgress, OutputError, Progress, run, scene_from_dict
from rigidfluid.post import notebook
from rigidfluid.post.notebook import page, picture

BODIES = [
    {"name": name, "type": "sphere", "radius": 0.1, "density": 1.0, "position": [x, 0.5], "velocity": [0.0, v]}
    for name, x, v in (("one", 0.3, 0.2), ("other", 0.7, -0.3))
]


@pytest.fixture(scope="module")
def history() -> History:
    return run(scene_from_dict(dry_tables(*BODIES, end=0.1)))


def progress(history: History, time: float, elapsed: float) -> Progress:
    return Progress(time, end=1.0, step=0.01, gap=0.3, elapsed=elapsed, failed_remeshes=0, history=history)


class Shown:
    """What a notebook was given to show, in order, and in how many places."""

    def __init__(self, in_notebook: bool = True) -> None:
        self.pages: list[dict[str, str]] = []
        self.places = 0
        self.get_ipython = lambda: self if in_notebook else None
        self.display = SimpleNamespace(display=self._display)

    def _display(self, data: dict[str, str], *, raw: bool, display_id: bool) -> Any:
        assert raw
        assert display_id
        self.places += 1
        self.pages.append(data)
        return SimpleNamespace(update=lambda data, raw: self.pages.append(data))


@pytest.fixture
def shown(monkeypatch: pytest.MonkeyPatch) -> Shown:
    found = Shown()
    monkeypatch.setattr(notebook, "optional_package", lambda name, extra: found)
    return found


def test_one_place_shows_the_first_the_due_and_the_last_step(shown: Shown, history: History) -> None:
    show = NotebookProgress(every=10.0)
    for time, elapsed in ((0.01, 1.0), (0.5, 2.0), (0.6, 12.0), (0.99, 13.0), (1.0, 14.0)):
        show(progress(history, time, elapsed))
    assert shown.places == 1
    assert [re.search(r"value='(.*?)' max='1'", data["text/html"])[1] for data in shown.pages] == ["0.01", "0.6", "1"]
    assert shown.pages[-1]["text/plain"] == "time 1 of 1, step 0.01, gap 0.3, 14 s"
    assert "<img" not in shown.pages[-1]["text/html"]


def test_a_run_is_shown_to_its_end(shown: Shown) -> None:
    run(scene_from_dict(dry_tables(*BODIES, end=0.1)), progress=NotebookProgress("bodies.y", every=1e9))
    assert [data["text/plain"].partition(",")[0] for data in shown.pages] == ["time 0.01 of 0.1", "time 0.1 of 0.1"]


def test_another_run_has_a_place_of_its_own(shown: Shown, history: History) -> None:
    show = NotebookProgress(every=10.0)
    show(progress(history, 0.5, 20.0))
    show(progress(History(2), 0.01, 1.0))
    assert shown.places == 2


def test_failed_meshes_are_told(history: History) -> None:
    now = Progress(0.5, end=1.0, step=0.01, gap=0.3, elapsed=1.0, failed_remeshes=2, history=history)
    assert "2 failed re-meshes" in page(now, None)


def test_the_picture_of_a_page_is_that_of_the_column(history: History, tmp_path: Path) -> None:
    found = re.search(
        r"alt='bodies.y over time' src='data:image/png;base64,(.*?)'", page(progress(history, 1, 1), "bodies.y")
    )
    data = base64.b64decode(found[1])
    assert data == picture(history, "bodies.y", 1.0)
    (tmp_path / "picture.png").write_bytes(data)
    image = imread(tmp_path / "picture.png")[..., :3]
    colours = [np.array([int(code[i : i + 2], 16) for i in (1, 3, 5)]) / 255 for code in notebook.PALETTE[:3]]
    drawn = [int((np.abs(image - colour).max(axis=2) < 0.02).sum()) for colour in colours]
    assert min(drawn[:2]) > 20, "a line for each body"
    assert drawn[2] == 0


def test_each_body_has_a_line_of_its_own(history: History, monkeypatch: pytest.MonkeyPatch) -> None:
    figure = notebook.new_figure(6.0, 2.4)
    monkeypatch.setattr(notebook, "new_figure", lambda width, height: figure)
    picture(history, "bodies.y", 1.0)
    lines, bodies = {line.get_label(): line for line in figure.axes[0].lines}, history.bodies
    assert list(lines) == ["one", "other"]
    for name, line in lines.items():
        np.testing.assert_array_equal(line.get_ydata(), bodies["y"][bodies["body"] == name])


@pytest.mark.parametrize("plot", ["energy.kinetic", "steps.size", "contacts.gap", "joints.rate", "probes.pressure"])
def test_columns_of_all_tables_are_drawn(plot: str, history: History) -> None:
    assert picture(history, plot, 1.0).startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("plot", "allowed"),
    [
        ("bodies.vv", "a column of numbers of bodies: time, step, x, y"),
        ("bodies.body", "a column of numbers of bodies"),
        ("vy", "table.column, as bodies.vy"),
    ],
)
def test_a_column_that_is_not_there_is_refused(plot: str, allowed: str, history: History) -> None:
    with pytest.raises(ArgumentError, match=f"plot: found '{plot}'; allowed is {allowed}"):
        picture(history, plot, 1.0)


def test_a_program_without_a_notebook_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(notebook, "optional_package", lambda name, extra: Shown(in_notebook=False))
    with pytest.raises(OutputError, match="NotebookProgress: found a program without IPython; allowed is a notebook"):
        NotebookProgress()


def test_the_documentation_shows_what_its_notebook_stores() -> None:
    stored = json.loads(NOTEBOOK.read_text(encoding="utf-8"))
    code = [cell for cell in stored["cells"] if cell["cell_type"] == "code"]
    assert stored["metadata"]["executed_input"] == input_digest(stored), "run python docs/make_notebook.py"
    assert [cell["execution_count"] for cell in code] == [1, 2, 3, 4, 5]
    assert all(cell["outputs"] for cell in code)
    assert NOTEBOOK.stat().st_size < 200 * 1024
    text = page_text(NOTEBOOK.read_text(encoding="utf-8"))
    assert text.startswith("# A run in a notebook\n")
    assert text.count("```python\n") == len(code)
    assert text.count("<img ") == 2, "the plot of the run, and the figure"


def test_the_documentation_shows_what_a_cell_prints() -> None:
    printed = {"output_type": "stream", "name": "stdout", "text": ["one\n", "two\n"]}
    cell = {"cell_type": "code", "source": ["print(1)"], "outputs": [printed]}
    assert "```text\none\ntwo\n\n```" in page_text(json.dumps({"cells": [cell]}))


def test_an_edited_cell_is_told() -> None:
    stored = json.loads(NOTEBOOK.read_text(encoding="utf-8"))
    stored["cells"][1]["source"].append("\nscene.time")
    assert stored["metadata"]["executed_input"] != input_digest(stored)


@pytest.mark.long
def test_the_notebook_of_the_documentation_runs(tmp_path: Path) -> None:
    nbformat = pytest.importorskip("nbformat")
    for name in ("nbclient", "ipykernel", "pandas"):
        pytest.importorskip(name)
    from make_notebook import executed

    cells = executed(tmp_path)
    outputs = [one for cell in cells.cells if cell.cell_type == "code" for one in cell.outputs]
    stored = [one for cell in nbformat.read(NOTEBOOK, as_version=4).cells for one in cell.get("outputs", ())]
    assert [(one.output_type, set(one.data)) for one in outputs] == [(one.output_type, set(one.data)) for one in stored]
    assert {one.output_type for one in outputs} == {"display_data", "execute_result"}, "no warnings, no prints"
    html = [one.data.get("text/html", "") for one in outputs]
    assert sum("<progress" in text for text in html) == 1
    assert "<progress value='0.03' max='0.03'></progress>" in html[1]
    assert "<img alt='bodies.vy over time'" in html[1]
    captions = [re.search(r"<caption>(\w+)</caption>", text) for text in html]
    assert [found[1] for found in captions if found] == ["Scene", "History", "FluidFields", "FluidFields"]
    assert any("image/png" in one.data for one in outputs)
