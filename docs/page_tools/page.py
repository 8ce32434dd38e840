"""A page: its text, its figures, and where they are written."""

from __future__ import annotations

import datetime
import shutil
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from matplotlib.figure import Figure

import rigidfluid
from page_tools.places import PAGES, RECORDS
from page_tools.provenance import commit, file_digest, texts
from page_tools.record import Record
from page_tools.work import Work
from rigidfluid.core.run.summary import versions

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
        the page, and ``"_heights"`` is NAME_heights.png, ``".gif"`` NAME.gif, which the text must show.
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


def write(page: Page, name: str, work: Work, folder: Path = PAGES) -> None:
    """Write a page, its figures and its record: date, commit, command, CPU time, and which of its runs are older."""
    command = page.command or f"python docs/make_validation.py {name}"
    record = Record(
        made=str(datetime.date.today()), commit=commit(), cpu_seconds=round(work.cpu_seconds, 1), versions=versions(),
        sources=work.sources, texts=texts(), runs=work.runs,
    )  # fmt: skip
    by = f"by `{command}`, rigidfluid {rigidfluid.__version__}; [runs and versions]({RECORDS.name}/{name}.json)."
    parts = [f"# {page.title}", " ".join([f"M{record.making[1:]}, {by}", *_about_older(work.outdated)])]
    for suffix, figure in page.figures.items():
        picture = folder / picture_name(name, suffix)
        if not suffix:
            parts.append(f"![{page.title}]({picture.name})")
        elif f"]({picture.name})" not in page.text:
            raise ValueError(f"the text of {name} does not show {picture.name}")
        _save(figure, picture)
    (folder / f"{name}.md").write_text("\n\n".join([*parts, page.text.strip()]) + "\n", encoding="utf-8")
    names = [f"{name}.md", *(picture_name(name, suffix) for suffix in page.figures)]
    replace(record, files={file: file_digest(folder / file) for file in names}).write(name, folder / RECORDS.name)


def picture_name(name: str, suffix: str) -> str:
    """Name of the file of a figure."""
    return f"{name}{suffix}" if "." in suffix else f"{name}{suffix}.png"


def _about_older(outdated: Mapping[str, str]) -> Iterable[str]:
    if outdated:
        which = ", ".join(outdated) if len(outdated) <= FEW else f"{len(outdated)} of its runs"
        yield f"Older, made at {', '.join(sorted(set(outdated.values())))}: {which}."


def _save(figure: Figure | Path, path: Path) -> None:
    if isinstance(figure, Path):
        shutil.copy(figure, path)
    else:
        figure.savefig(path, dpi="figure", metadata={"Software": None})
