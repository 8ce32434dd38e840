"""Third-party packages, made on the spot."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from textwrap import dedent

import pytest

_LAW = """
    import numpy as np
    from rigidfluid.core.model.force_law import ForceLaw
    from rigidfluid.hookspecs import hookimpl

    class Springy(ForceLaw):
        name = "springy"

        def force(self, contacts):
            return (self.range - contacts.gap)[:, None] * contacts.normal

        def energy(self, contacts):
            return (self.range - contacts.gap) ** 2 / 2

        def stiffness(self, contacts):
            return np.ones_like(contacts.gap)

    @hookimpl
    def rigidfluid_force_laws():
        return [Springy]
"""
Install = Callable[..., Path]


@pytest.fixture
def install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Install:
    """Puts a distribution with one module and its entry points, one if not given, on the path."""

    def install(
        code: str, name: str = "springy", module: str = "springy_plugin", entry_points: str | None = None
    ) -> Path:
        folder = tmp_path / name
        info = folder / f"{name}-1.2.dist-info"
        info.mkdir(parents=True)
        (folder / f"{module}.py").write_text(dedent(code))
        (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.2\n")
        (info / "entry_points.txt").write_text(entry_points or f"[rigidfluid]\n{name} = {module}\n")
        monkeypatch.syspath_prepend(str(folder))
        monkeypatch.delitem(sys.modules, module, raising=False)
        return folder

    return install


@pytest.fixture
def law() -> str:
    """The code of a plug-in that offers the force law `springy`."""
    return _LAW
