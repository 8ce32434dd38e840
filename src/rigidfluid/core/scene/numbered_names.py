"""Names of the bodies of a swarm or a source: one beginning, and a number each."""

from __future__ import annotations

ANY = "*"
"""End of a name in a scene that stands for all numbers: `grain*` names `grain0`, `grain1` and so on."""


def is_numbered(name: str, beginning: str) -> bool:
    """Tell whether a ``name`` is a ``beginning`` and a number."""
    return name.startswith(beginning) and name[len(beginning) :].isdecimal()


def stands_for(named: str, name: str) -> bool:
    """Tell whether what is ``named`` in a scene is the body or surface of this ``name``, or one of several."""
    return named == name or (named.endswith(ANY) and is_numbered(name, named.removesuffix(ANY)))
