"""Spheres on a line in Stokes flow in cubes of fluid: a swimmer, and spheres that are moved."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import rigidfluid
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.output.history import History
from rigidfluid.core.scene.scene import Scene

SCENE = Path(__file__).parents[2] / "scenes" / "swimmer_3d.toml"
BACK = 'mechanism.0.order=["right in", "left in", "right out", "left out"]'
"""The cycle of `SCENE`, backwards in time."""
BACK_FROM_SHORT = 'mechanism.0.order=["right out", "left out", "right in", "left in"]'
"""The same, begun with short arms."""


@dataclass(frozen=True)
class Swim:
    """Displacement of the middle sphere along the line in each ``strokes`` (4,) of a cycle, and ``across`` it after the
    cycle [radii]; number of ``unknowns`` and ``steps``, and CPU ``seconds``."""

    strokes: FloatArray
    across: float
    unknowns: int
    steps: int
    seconds: float

    @property
    def displacement(self) -> float:
        """In the cycle [radii]."""
        return float(self.strokes.sum())


def swim_scene(half: float = 20.0, far: str = "wall", stroke: float = 4.0, overrides: Iterable[str] = ()) -> Scene:
    """One cycle in a cube of side 2 ``half`` whose faces are of type ``far``; each stroke takes a unit of time."""
    motion = [f"mechanism.0.amplitude={stroke}", f"mechanism.0.speed={stroke}"]
    return rigidfluid.load_scene(SCENE, [*_cube(half, far), *motion, *overrides])


def swim_of(history: History) -> Swim:
    """What is measured of a run of a `swim_scene`."""
    bodies, summary = history.bodies, history.summary
    middle = bodies["body"] == "swimmer.middle"
    ends = np.isclose(bodies["time"][middle] % 1.0, 0.0)
    across = float(np.hypot(bodies["y"][middle][-1], bodies["z"][middle][-1]))
    cost = summary["unknowns"], summary["steps"], summary["cpu_time"]
    return Swim(np.diff(bodies["x"][middle][ends]), across, *cost)


def drag(places: Sequence[float], half: float, far: str = "wall", overrides: Iterable[str] = ()) -> float:
    """Drag on the first of unit spheres at ``places`` that move along their line at the speed 1, over 6πμ, in a cube of
    side 2 ``half``."""
    scene = rigidfluid.load_scene(SCENE, [*_cube(half, far), *overrides]).model_dump(mode="json")
    del scene["mechanism"]
    moved = {"type": "sphere", "radius": 1.0, "density": 1.0, "prescribed": {"velocity": [1.0, 0.0, 0.0]}}
    scene["body"] = [moved | {"position": [place, 0.0, 0.0]} for place in places]
    scene["time"] = {"end": 2e-6, "step": 1e-6}
    bodies = rigidfluid.run(rigidfluid.scene_from_dict(scene)).bodies
    return float(-bodies["fx"][-len(places)] / (6.0 * np.pi))


def without_box(halves: Sequence[float], values: Sequence[float], power: int) -> float:
    """value(1/half = 0) of the straight line over half^-power that is nearest to the values."""
    return float(np.polyfit(np.array(halves, dtype=float) ** -power, values, 1)[1])


def _cube(half: float, far: str) -> list[str]:
    corners = [f"domain.lower={[-half] * 3}", f"domain.upper={[half] * 3}"]
    pressure = ", pressure = 0.0" if far == "pressure" else ""
    return [*corners, f'boundary=[{{ on = "all", type = "{far}"{pressure} }}]']
