"""The pieces of pages that need no other file: tables, embedded pictures, and the frame around them."""

from __future__ import annotations

import base64
from collections.abc import Iterable, Iterator, Sequence
from html import escape
from pathlib import Path
from urllib.parse import quote

from matplotlib.figure import Figure

from rigidfluid.post.reports.style import save

Picture = tuple[str, str, Figure, tuple[str, ...]]
"""Name, caption, figure and file formats, the first of them PNG."""

_STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; max-width: 62rem; margin: 2rem auto; padding: 0 1rem; color: #222; }
h1, h2 { line-height: 1.2; } h2 { margin-top: 2.2rem; }
table { border-collapse: collapse; } th, td { text-align: left; padding: .2rem 1.2rem .2rem 0; }
tr { border-bottom: 1px solid #ddd; } td.n, thead th.n { text-align: right; font-variant-numeric: tabular-nums; }
img { max-width: 100%; height: auto; } figure { margin: 1rem 0; } figcaption { color: #555; }
nav { border-bottom: 1px solid #ddd; padding-bottom: .6rem; }
pre { background: #f6f6f6; padding: 1rem; overflow-x: auto; } .note { color: #8a3c00; }
"""


def document(title: str, parts: Iterable[str]) -> str:
    """A whole page with ``title`` as its heading over ``parts``, which are HTML."""
    name = escape(title)
    return (
        f'<!doctype html>\n<html lang="en">\n<head><meta charset="utf-8"><title>{name}</title>'
        f"<style>{_STYLE}</style></head>\n<body>\n<h1>{name}</h1>\n" + "\n".join(parts) + "\n</body>\n</html>\n"
    )


def with_contents(parts: Iterable[str]) -> Iterator[str]:
    """The parts of a page after a list of links to its headings, ``<h2>`` at the start of a part."""
    found, headings = list(parts), 0
    links = []
    for i, part in enumerate(found):
        if part.startswith("<h2>"):
            headings += 1
            found[i] = part.replace("<h2>", f'<h2 id="part{headings}">', 1)
            links.append(f'<a href="#part{headings}">{part[4 : part.index("</h2>")]}</a>')
    yield f"<nav>{' · '.join(links)}</nav>"
    yield from found


def file_list(files: Iterable[tuple[str, str]]) -> str:
    """Links to files next to the page, each with what is in it."""
    items = (f'<li><a href="{quote(name)}">{escape(name)}</a>: {escape(words)}</li>' for name, words in files)
    return "<ul>\n" + "\n".join(items) + "\n</ul>"


def table(rows: Iterable[tuple[str, object]]) -> str:
    """Names with one value each."""
    lines = (f'<tr><th scope="row">{escape(name)}</th>{_cell(value)}</tr>' for name, value in rows)
    return "<table>\n" + "\n".join(lines) + "\n</table>"


def grid(header: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """A table with a head."""
    head = "".join(f'<th scope="col" class="n">{escape(name)}</th>' for name in header)
    lines = (f"<tr>{''.join(map(_cell, row))}</tr>" for row in rows)
    return f"<table>\n<thead><tr>{head}</tr></thead>\n<tbody>\n" + "\n".join(lines) + "\n</tbody>\n</table>"


def save_pictures(pictures: Iterable[Picture], folder: Path) -> tuple[list[Path], list[str]]:
    """Write pictures into a folder, each when it has been drawn; return the files, and each one's PNG embedded."""
    files: list[Path] = []
    embedded: list[str] = []
    for name, caption, figure, kinds in pictures:
        written = save(figure, folder, name, kinds)
        files += written
        embedded.append(picture(written[0], caption))
    return files, embedded


def picture(path: Path, caption: str) -> str:
    """A PNG file, embedded."""
    data = base64.b64encode(path.read_bytes()).decode("ascii")
    words = escape(caption)
    return f'<figure><img alt="{words}" src="data:image/png;base64,{data}"><figcaption>{words}</figcaption></figure>'


def _cell(value: object) -> str:
    text = f"{value:.5g}" if isinstance(value, float) else escape(str(value))
    return f'<td class="n">{text}</td>'
