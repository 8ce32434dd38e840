"""Text of docs/gallery.md: each shipped scene with what its head says, and a picture where one shows it."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

DOCS = Path(__file__).parents[1]
SCENES = DOCS.parent / "scenes"
PICTURES = DOCS / "validation"
OWN = DOCS / "pictures"
HEAD = """# Gallery

Made from the heads of the scenes by `python docs/make_gallery.py`; a test fails where it is out of date. Each scene is
a file in `scenes/`: `rigidfluid run scenes/NAME.toml` runs it, and `rigidfluid check scenes/NAME.toml` estimates before
how long that takes.
"""


def gallery() -> str:
    """The whole page."""
    cards = "\n\n".join(card(scene) for scene in sorted(SCENES.glob("*.toml"), key=order))
    return f"{HEAD}\n::::{{grid}} 1 2 2 3\n:gutter: 2\n\n{cards}\n\n::::\n"


def order(scene: Path) -> tuple[bool, int, str]:
    """Scenes with a picture first, of two dimensions before three."""
    dimension: int = tomllib.loads(scene.read_text(encoding="utf-8"))["scene"]["dimension"]
    return picture(scene.stem) is None, dimension, scene.stem


def card(scene: Path) -> str:
    """One scene: its picture, its name, and the first sentence of its head."""
    lines = [f":::{{grid-item-card}} {scene.stem.replace('_', ' ')}", ":class-card: gallery-card"]
    if (image := picture(scene.stem)) is not None:
        lines.append(f":img-top: {image.relative_to(DOCS)}")
    lines += ["", first_sentence(scene), "", " · ".join(links(scene.stem))]
    return "\n".join([*lines, ":::"])


def links(name: str) -> list[str]:
    """Links to the file of a scene, and to the page that measures it."""
    page = PICTURES / f"{name}.md"
    measured = [f"[measured](validation/{page.name})"] if page.exists() else []
    return [f"[{name}.toml](../scenes/{name}.toml)", *measured]


def picture(name: str) -> Path | None:
    """Picture that shows a scene: one made for the gallery, else that of its page; a movie before a plot."""
    choices = [OWN / f"{name}.png", PICTURES / f"{name}.gif", PICTURES / f"{name}.png"]
    return next((choice for choice in choices if choice.exists()), None)


def first_sentence(scene: Path) -> str:
    """First sentence of the comment that a scene begins with."""
    head = re.match(r"(?:#[^\n]*\n)+", scene.read_text(encoding="utf-8"))
    if head is None:
        raise ValueError(f"{scene.name} does not begin with a comment that says what it shows")
    text = " ".join(line.removeprefix("#").strip() for line in head[0].splitlines())
    return re.split(r"(?<=[.:]) (?=cm|scenes|[A-Z])", text)[0]
