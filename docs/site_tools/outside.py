"""Pages whose text is another file, mostly outside of docs/, and links that lead out of docs/."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import TYPE_CHECKING

from site_tools.notebook import page_text

if TYPE_CHECKING:
    from sphinx.application import Sphinx

DOCS = Path(__file__).parents[1]
ROOT = DOCS.parent
READMES = {readme.parent.name: f"plugins/{readme.parent.name}/README.md" for readme in ROOT.glob("plugins/*/README.md")}
OUTSIDE = {
    "howto/notebook": "docs/howto/notebook.ipynb",
    "project/architecture": "ARCHITECTURE.md",
    "project/changes": "CHANGELOG.md",
    "project/contributing": "CONTRIBUTING.md",
    "project/security": "SECURITY.md",
    "project/third_party": "THIRD_PARTY.md",
    **{f"packages/{name}": readme for name, readme in READMES.items()},
}
"""Pages of the site, and the files of the repository that they show; a page's own file says only which."""

_LINK = re.compile(r"\]\((?![a-z]+:|#)([^)#\s]+)(#[^)\s]*)?\)")


def setup(app: Sphinx) -> dict[str, bool]:
    """Connect to the reading of pages."""
    app.connect("source-read", show)
    return {"parallel_read_safe": True}


def show(_: Sphinx, docname: str, source: list[str]) -> None:
    """Put the file in the place of the page that shows it, and turn its links to where the site has their targets."""
    file = ROOT / OUTSIDE[docname] if docname in OUTSIDE else DOCS / f"{docname}.md"
    text = file.read_text(encoding="utf-8") if docname in OUTSIDE else source[0]
    if file.suffix == ".ipynb":
        text = page_text(text)
    source[0] = _LINK.sub(lambda link: f"]({relinked(link[1], file, docname)}{link[2] or ''})", text)


def relinked(link: str, file: Path, docname: str) -> str:
    """Path of a ``link`` in a ``file`` as its page must say it; files that are no pages are there for download."""
    target = (file.parent / link).resolve()
    pages = {(ROOT / outside).resolve(): DOCS / f"{page}.md" for page, outside in OUTSIDE.items()}
    pages[ROOT / "README.md"] = DOCS / "index.md"
    return os.path.relpath(pages.get(target, target), (DOCS / docname).parent)
