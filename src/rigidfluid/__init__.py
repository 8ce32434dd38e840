"""Rigid bodies that move and collide in a Newtonian fluid."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rigidfluid.core.case.load import load_scene, scene_from_dict
    from rigidfluid.core.run.run import run
    from rigidfluid.core.scene.scene import Scene
    from rigidfluid.post.run_results import load_results

__version__ = "0.1.0"
__all__ = ["Scene", "__version__", "load_results", "load_scene", "run", "scene_from_dict"]

_HOMES = {
    "run": "rigidfluid.core.run.run",
    "Scene": "rigidfluid.core.scene.scene",
    "load_results": "rigidfluid.post.run_results",
    "load_scene": "rigidfluid.core.case.load",
    "scene_from_dict": "rigidfluid.core.case.load",
}


def __dir__() -> list[str]:
    """Names of the module, with those that are imported on first use."""
    return sorted({*globals(), *__all__})


def __getattr__(name: str) -> object:
    """Import the numerical stack when it is first asked for, so that `import rigidfluid` stays light."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)
