"""A page: its text, its figures, and where they are written."""

from __future__ import annotations

import datetime
import json
import shutil
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from matplotlib.figure import Figure

import rigidfluid
from page_tools.inputs import Inputs
from page_tools.places import INPUTS, PAGES

FEW = 6
"""So many runs are named."""


@dataclass(frozen=True)
class Page:
    """What a page shows.

    Parameters
    ----------
    title : str
        Its heading.
    text : str
        Markdown.
    figures : mapping
        Figures, or pictures that were made elsewhere, by what is put to the page's name: ``""`` is NAME.png, on top of
        the page, and ``"_heights"`` is NAME_heights.png, which the text must show.
    command : str
        What it is made by, where that is not ``python docs/make_validation.py NAME``.
    """

    title: str
    text: str
    figures: Mapping[str, Figure | Path] = field(default_factory=dict)
    command: str = ""


def table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """A Markdown table."""
    head = tuple(head)
    lines = [head, ("---",) * len(head), *map(tuple, rows)]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def write(page: Page, name: str, outdated: Mapping[str, list[str]], folder: Path = PAGES) -> None:
    """Write a page and its figures, with its date, its command, and which of its runs are older than its sources."""
    command = page.command or f"python docs/make_validation.py {name}"
    made = f"Made on {datetime.date.today()} by `{command}`, rigidfluid {rigidfluid.__version__}."
    parts = [f"# {page.title}", " ".join([made, *_about_older(outdated)])]
    for suffix, figure in page.figures.items():
        picture = folder / f"{name}{suffix}.png"
        if not suffix:
            parts.append(f"![{page.title}]({picture.name})")
        elif f"]({picture.name})" not in page.text:
            raise ValueError(f"the text of {name} does not show {picture.name}")
        _save(figure, picture)
    (folder / f"{name}.md").write_text("\n\n".join([*parts, page.text.strip()]) + "\n", encoding="utf-8")


def write_inputs(name: str, inputs: Inputs, folder: Path = INPUTS) -> None:
    """Write what a page was made from."""
    folder.mkdir(exist_ok=True)
    (folder / f"{name}.json").write_text(json.dumps(dict(sorted(inputs.items())), indent=0) + "\n", encoding="utf-8")


def _about_older(outdated: Mapping[str, list[str]]) -> Iterable[str]:
    if outdated:
        changed = {file for files in outdated.values() for file in files}
        which = ", ".join(outdated) if len(outdated) <= FEW else f"{len(outdated)}"
        yield f"Of its runs, {which} are older: {len(changed)} of their sources have changed since."


def _save(figure: Figure | Path, path: Path) -> None:
    if isinstance(figure, Path):
        shutil.copy(figure, path)
    else:
        figure.savefig(path, dpi="figure", metadata={"Software": None})
