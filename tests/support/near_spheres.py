"""Two near spheres, or a sphere at a wall, that move relative to each other: their scenes, and their exact loads."""

from __future__ import annotations

from dataclasses import dataclass

import bispherical
import numpy as np
from approach import approach
from paths import SCENES
from published import brenner

from rigidfluid.core.case.load import load_scene
from rigidfluid.core.run.simulation import Simulation

FloatArray = np.ndarray
SPEED = 1e-6
COLUMNS = ("fx", "fy", "fz", "tx", "ty", "tz")
COMPONENTS = {"along": [2], "across": [0, 4], "about": [5]}
"""Of twist and load, by direction: along the normal, across it, about it."""
MOTIONS = {
    "squeezing": ("along", [1.0]),
    "sliding": ("across", [1.0, 0.0]),
    "rolling": ("across", [0.0, 1.0]),
    "twisting": ("about", [1.0]),
}
"""Relative motions at speed 1, each with its direction."""
TURNING = "turning"
"""Spheres of a pair turn oppositely, in place."""
NONE = 1e-6
"""Exact loads below this are zero by symmetry."""


@dataclass(frozen=True)
class NearSpheres:
    """A sphere of radius 1 above one of ``radius``, or above a wall where that is infinite, in a fluid of viscosity 1;
    ``size_body``: edge length on them, ``overrides`` of the scene."""

    radius: float
    size_body: float = 0.25
    overrides: tuple[str, ...] = ()

    @property
    def bodies(self) -> tuple[str, ...]:
        """Names, the upper one first."""
        return ("sphere",) if np.isinf(self.radius) else ("upper", "lower")

    def simulation(self, gap: float, far: float) -> Simulation:
        """Spheres in a box whose walls are ``far`` away."""
        if np.isinf(self.radius):
            scene, placed, floor = "squeezed_film.toml", [f"body.0.position=[0.0, 0.0, {1.0 + gap}]"], 0.0
        else:
            heights, floor = (-(self.radius + 0.5 * gap), 1.0 + 0.5 * gap), -far
            placed = [f"body.{number}.position=[0.0, 0.0, {height}]" for number, height in enumerate(heights)]
            scene, placed = "two_spheres.toml", [*placed, f"body.0.radius={self.radius}"]
        box = [f"domain.lower=[{-far}, {-far}, {floor}]", f"domain.upper=[{far}, {far}, {floor + 2.0 * far}]"]
        mesh = [f"mesh.size={0.2 * far}", f"mesh.size_body={self.size_body}", "time.end=1.0"]
        return Simulation(load_scene(SCENES / scene, [*placed, *box, *mesh, *self.overrides]))

    def loads(self, simulation: Simulation, motion: str, gap: float) -> dict[str, tuple[float, float]]:
        """Exact loads in a motion, by name, and those in a step of the simulation; none that are zero, and none that
        are the same but for their sign."""
        direction, twists = self._twists(motion, gap)
        exact = -(self._resistance(direction, gap) @ twists).reshape(len(self.bodies), -1)
        found = _step(simulation, self.bodies, COMPONENTS[direction], twists.reshape(exact.shape))
        names = [("force" if component < 3 else "torque", 0, at) for at, component in enumerate(COMPONENTS[direction])]
        if direction == "across" and 1.0 < self.radius < np.inf:
            names.append(("torque on the larger", 1, 1))
        pairs = {name: (float(exact[body, at]), float(found[body, at])) for name, body, at in names}
        return {name: pair for name, pair in pairs.items() if abs(pair[0]) > NONE}

    def _twists(self, motion: str, gap: float) -> tuple[str, FloatArray]:
        """Direction of a motion, and the components of twists in it; no load acts on a pair as a whole unless it is
        `TURNING`."""
        if motion == TURNING:
            return "across", np.array([0.0, 1.0, 0.0, -1.0])
        direction, wanted = MOTIONS[motion]
        relative = np.array([[1.0, -1.0]])[:, : len(self.bodies)]
        if direction == "across":
            relative = bispherical.relative_motion(gap, self.radius)
        return direction, bispherical.free_twists(self._resistance(direction, gap), relative, np.array(wanted))

    def _resistance(self, direction: str, gap: float) -> FloatArray:
        """Exact resistance to the components of twists in a direction."""
        if direction == "across":
            return bispherical.resistance(gap, self.radius)
        if direction == "about":
            return bispherical.twisting(gap, self.radius)
        return np.array([[6.0 * np.pi * brenner(gap)]]) if np.isinf(self.radius) else approach(gap, self.radius)


def _step(simulation: Simulation, names: tuple[str, ...], components: list[int], twists: FloatArray) -> FloatArray:
    """Components of the loads on bodies (n, c) over the speed, after a step with such components of their twists."""
    for name, moved in zip(names, twists, strict=True):
        twist = np.zeros(6)
        twist[components] = SPEED * moved
        simulation.prescribe(name, twist[:3].tolist(), twist[3:].tolist())
    simulation.step()
    bodies = simulation.history.bodies
    now = bodies["time"] == simulation.time
    rows = [np.flatnonzero(now & (bodies["body"] == name))[0] for name in names]
    return np.array([[bodies[COLUMNS[each]][row] / SPEED for each in components] for row in rows])
