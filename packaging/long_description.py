"""The README as the long description of a distribution: links into the repository become addresses on the web."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from hatchling.metadata.plugin.interface import MetadataHookInterface

_RELATIVE = re.compile(r"(!?)\[([^\]]*)\]\((?!https?://|#)([^)]+)\)")


def with_addresses(text: str, repository: str) -> str:
    """A text in Markdown with absolute links into the main branch of a repository on GitHub; pictures raw."""

    def absolute(found: re.Match[str]) -> str:
        mark, words, path = found.groups()
        return f"{mark}[{words}]({repository}/{'raw' if mark else 'blob'}/main/{path})"

    return _RELATIVE.sub(absolute, text)


class LongDescription(MetadataHookInterface):
    """Gives the project's ``readme``."""

    def update(self, metadata: dict[str, Any]) -> None:
        """Add the README to a project's metadata."""
        text = (Path(self.root) / "README.md").read_text(encoding="utf-8")
        repository = metadata["urls"]["Source"]
        metadata["readme"] = {"content-type": "text/markdown", "text": with_addresses(text, repository)}
