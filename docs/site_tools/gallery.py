"""Text of docs/gallery.md: each shipped scene with a picture of it and what its head says."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

DOCS = Path(__file__).parents[1]
SCENES = DOCS.parent / "scenes"
PICTURES = DOCS / "pictures"
HEAD = """# Gallery

Each scene is a file in `scenes/`: `rigidfluid run scenes/NAME.toml` runs it, and `rigidfluid check scenes/NAME.toml`
estimates before how long that takes. Times and colours are in the units of the scene; a colour means the same at all
times of a picture. Bodies in a flow are grey, what is hatched lies outside the domain, and white lines with
arrows are streamlines. Movies of runs also have [a black bar on each body](results.md#movie), which turns with it.

`python docs/make_gallery.py` makes this page from the heads of the scenes; a test fails where it is out of date.
`python docs/make_pictures.py` runs them and makes the pictures.
"""


def gallery() -> str:
    """The whole page."""
    cards = "\n\n".join(card(scene) for scene in sorted(SCENES.glob("*.toml"), key=order))
    return f"{HEAD}\n::::{{grid}} 1 2 2 3\n:gutter: 2\n\n{cards}\n\n::::\n"


def order(scene: Path) -> tuple[int, str]:
    """Scenes of two dimensions before three."""
    dimension: int = tomllib.loads(scene.read_text(encoding="utf-8"))["scene"]["dimension"]
    return dimension, scene.stem


def card(scene: Path) -> str:
    """One scene: its picture, its name, and the first sentence of its head."""
    lines = [
        f":::{{grid-item-card}} {scene.stem.replace('_', ' ')}",
        ":class-card: gallery-card",
        f":img-top: {picture(scene.stem).relative_to(DOCS)}",
        "",
        first_sentence(scene),
        "",
        " · ".join(links(scene.stem)),
        ":::",
    ]
    return "\n".join(lines)


def links(name: str) -> list[str]:
    """Links to the file of a scene, and to the page that measures it."""
    page = DOCS / "validation" / f"{name}.md"
    measured = [f"[measured](validation/{page.name})"] if page.exists() else []
    return [f"[{name}.toml](../scenes/{name}.toml)", *measured]


def picture(name: str) -> Path:
    """Picture of a scene, which `make_pictures` makes."""
    return PICTURES / f"{name}.png"


def first_sentence(scene: Path) -> str:
    """First sentence of the comment that a scene begins with."""
    head = re.match(r"(?:#[^\n]*\n)+", scene.read_text(encoding="utf-8"))
    if head is None:
        raise ValueError(f"{scene.name} does not begin with a comment that says what it shows")
    text = " ".join(line.removeprefix("#").strip() for line in head[0].splitlines())
    return re.split(r"(?<=[.:]) (?=cm|scenes|[A-Z])", text)[0]
