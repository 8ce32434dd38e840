"""An answer that no part may give."""

from __future__ import annotations


class Wrong(Exception):
    """Answer that no part may give: what was ``found``, what is ``allowed``, whether a ``shorter`` step may mend it."""

    def __init__(self, found: str, allowed: str, shorter: bool = False) -> None:
        super().__init__(found)
        self.found, self.allowed, self.shorter = found, allowed, shorter
