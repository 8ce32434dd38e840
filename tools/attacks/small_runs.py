"""Small runs to be broken and taken up again, dry and in a fluid, and whether what came of them is the same."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import rigidfluid
from attacks.hostile_scenes import SCENES
from rigidfluid.api import Scene
from rigidfluid.core.output import run_files

TABLES = tuple(f"{name}.csv" for name in run_files.TABLES)


@dataclass(frozen=True)
class SmallRun:
    """A shipped scene, cut down by ``settings`` to a run of moments until its ``end``; a quarter of it is a multiple of
    the time between checkpoints, so that shorter runs have outputs of the whole one alone."""

    name: str
    file: str
    settings: tuple[str, ...]
    end: float

    @property
    def path(self) -> Path:
        """The scene file."""
        return SCENES / self.file

    def assignments(self, share: float = 1.0) -> list[str]:
        """Settings with which the run ends after a ``share`` of its time."""
        return [*self.settings, f"time.end={share * self.end!r}"]

    def scene(self, share: float = 1.0) -> Scene:
        """The scene with those."""
        return rigidfluid.load_scene(self.path, self.assignments(share))


DRY = SmallRun(
    "dry",
    "dry_bounce.toml",
    ("body.0.position=[0.38,0.5]", "body.1.position=[0.62,0.55]", "output.every=2e-4", "output.probes=[]"),
    2.4e-3,
)
WET = SmallRun(
    "in a fluid",
    "falling_disk.toml",
    ("time.step=0.004", "mesh.size=0.4", "mesh.size_body=0.1", "output.every=0.008", "output.probes=[[0.5,0.5]]"),
    0.064,
)


def differences(folder: Path, unbroken: Path) -> list[str]:
    """Names of tables and lists of fields that are not, to the last bit, those of the unbroken run."""
    names = [*TABLES, "fields.pvd"]
    return [name for name in names if _content(folder / name) != _content(unbroken / name)]


def _content(path: Path) -> bytes | None:
    return path.read_bytes() if path.is_file() else None
