"""Rigid bodies that move and collide in a Newtonian fluid."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rigidfluid.core.run.run import run
    from rigidfluid.core.scene.scene import Scene, load_scene

__version__ = "0.1.0"
__all__ = ["Scene", "__version__", "load_scene", "run"]

_HOMES = {
    "run": "rigidfluid.core.run.run",
    "Scene": "rigidfluid.core.scene.scene",
    "load_scene": "rigidfluid.core.scene.scene",
}


def __getattr__(name: str) -> object:
    """Import the numerical stack when it is first asked for, so that `import rigidfluid` stays light."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)
