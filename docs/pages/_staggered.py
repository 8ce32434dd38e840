"""A flow and disks that are solved in turn, as programs do that couple a flow solver with one for bodies."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import brentq

from rigidfluid.api import Simulation, scene_from_dict
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.scene.scene import Scene

RADIUS, SIDE, GRAVITY = 0.1, 0.8, 200.0
VOLUME = np.pi * RADIUS**2
RANGE, EPSILON = 0.03, 4e-7
TOLERANCE = 1e-4
"""Of the greatest speed so far, within which flow and bodies agree."""
FIRST_RELAXATION = 0.5
"""Largest weight of a step's first correction; later ones are Aitken's."""


@dataclass(frozen=True)
class Disk:
    """A disk that is ``density`` times as heavy as the fluid, at rest at a place ``x``, ``y``."""

    density: float
    x: float = 0.5 * SIDE
    y: float = 0.5 * SIDE


def disk_scene(disks: Sequence[Disk], *, free: bool, step: float, end: float, width: float = SIDE) -> Scene:
    """Disks in a closed box full of fluid of density 1, that move freely or as they are told."""
    bodies = [
        {"name": f"disk{i}", "type": "sphere", "radius": RADIUS, "density": disk.density}
        | {"position": [disk.x, disk.y], "fixed": not free}
        for i, disk in enumerate(disks)
    ]
    return scene_from_dict(
        {
            "scene": {"name": "disks_in_a_closed_box", "dimension": 2},
            "fluid": {"density": 1.0, "viscosity": 0.05, "gravity": [0.0, -GRAVITY]},
            "domain": {"lower": [0.0, 0.0], "upper": [width, SIDE]},
            "body": bodies,
            "mesh": {"size": 0.1, "size_body": 0.04},
            "contact": {"law": "normal", "range": RANGE, "epsilon": EPSILON},
            "time": {"end": end, "step": step},
            "output": {"every": end},
        }
    )


class NotSettledError(Exception):
    """Flow and bodies do not agree within the flow solves that are allowed."""


@dataclass(frozen=True)
class Response:
    """What disks do under a wrench: their ``twist`` (n, 3), their ``momentum`` without that of contacts, and the
    ``impulse`` of all contacts so far."""

    twist: FloatArray
    momentum: FloatArray
    impulse: FloatArray


class Staggered:
    """A run in which the flow is told the disks' twists (n, 3), and the disks follow the flow's wrench on them.

    Momentum less the impulses of contacts is differenced by BDF2, as in rigidfluid. With ``most`` flow solves in a step
    of one, the wrench is that of the step before: explicit coupling. With more, a step is taken again until twists and
    wrench agree, with Aitken's relaxation.
    """

    def __init__(self, disks: Sequence[Disk], *, step: float, end: float, width: float = SIDE, most: int = 1) -> None:
        self.run = Simulation(disk_scene(disks, free=False, step=step, end=end, width=width))
        density = np.array([disk.density for disk in disks])[:, None]
        self._mass = VOLUME * density * [1.0, 1.0, 0.5 * RADIUS**2]
        self._weight = VOLUME * (density - 1.0) * [0.0, -GRAVITY, 0.0]
        self._step, self._most = step, most
        at_rest = np.zeros_like(self._mass)
        self._now, self._before = Response(at_rest, at_rest, at_rest), None
        self._height = self._start = self._heights()
        self._relaxation, self.fastest, self.solves = FIRST_RELAXATION, 0.0, 0

    def step(self) -> None:
        """Take one step; raises NotSettledError."""
        after = self._explicit() if self._most == 1 else self._agreed()
        self._before, self._now = self._now, after
        self._height = self._heights()
        self.fastest = max(self.fastest, speed(after.twist))

    @property
    def created(self) -> float:
        """Energy that came from nowhere, over what gravity has worked so far: what fluid, disks and contacts have and
        what the fluid has lost, less that work."""
        ledger, worked = self.run.history.energy, float(np.sum(self._weight[:, 1] * (self._height - self._start)))
        fluid = sum(ledger[name][-1] for name in ("kinetic", "dissipation", "grad_div_loss", "transfer_loss"))
        disks = 0.5 * np.sum(self._mass * self._now.twist**2) + sum(map(contact_energy, self._height))
        return float(fluid + disks - worked) / worked

    def _explicit(self) -> Response:
        after = self._response(self._wrench())
        self._flow(after.twist)
        return after

    def _agreed(self) -> Response:
        saved, told, residual = self.run.save(), self._extrapolated(), None
        relaxation = min(self._relaxation, FIRST_RELAXATION)
        for _ in range(self._most):
            self._flow(told)
            after = self._response(self._wrench())
            last, residual = residual, (after.twist - told) * [1.0, 1.0, RADIUS]
            if np.linalg.norm(residual) <= TOLERANCE * max(self.fastest, speed(after.twist)):
                self._relaxation = abs(relaxation)
                return replace(after, twist=told)
            if last is not None:
                change = residual - last
                relaxation *= -np.sum(last * change) / np.sum(change**2)
            told = told + relaxation * (after.twist - told)
            self.run.restore(saved)
        raise NotSettledError(f"time {self.run.time:g}: found a residual of {np.linalg.norm(residual):.2g}")

    def _extrapolated(self) -> FloatArray:
        return self._now.twist if self._before is None else 2.0 * self._now.twist - self._before.twist

    def _flow(self, twist: FloatArray) -> None:
        """Take a step of the flow in which velocities change linearly to a ``twist``."""
        for name, row in zip(self.run.bodies, twist, strict=True):
            self.run.prescribe(name, velocity=row[:2], angular_velocity=row[2:], over=self._step)
        self.run.step()
        self.solves += 1

    def _response(self, wrench: FloatArray) -> Response:
        """What the disks do in a step under the fluid's ``wrench``, their weight and their contacts."""
        pushed, now = self._step * (wrench + self._weight), self._now
        past = self._before
        momentum = now.momentum + pushed if past is None else (4.0 * now.momentum - past.momentum + 2.0 * pushed) / 3.0
        free = (momentum + now.impulse) / self._mass
        twist = free.copy()
        for i, height in enumerate(self._height):
            twist[i, 1] = landed(free[i, 1], now.twist[i, 1], height, self._step, self._mass[i, 0])
        return Response(twist, momentum, now.impulse + self._mass * (twist - free))

    def _wrench(self) -> FloatArray:
        return np.array([[*body.force, *body.torque] for body in self.run.bodies.values()])

    def _heights(self) -> FloatArray:
        return np.array([body.position[1] for body in self.run.bodies.values()])


def speed(twist: FloatArray) -> float:
    """Greatest speed of twists (n, 3)."""
    return float(np.linalg.norm(twist[:, :2], axis=1).max())


def contact_energy(height: float) -> float:
    """Energy of a disk's contacts with floor and lid, by the law ``normal``."""
    gaps = height - RADIUS, SIDE - RADIUS - height
    return sum(max(RANGE - gap, 0.0) ** 3 for gap in gaps) / (3.0 * EPSILON)


def landed(free: float, before: float, height: float, step: float, mass: float) -> float:
    """Velocity after a step that contacts are in, ``free`` without them: their mean force is what their energy changes
    by over the way, so that they neither take nor give any."""

    def excess(velocity: float) -> float:
        way, energy = 0.5 * step * (velocity + before), contact_energy(height)
        lost = energy - contact_energy(height + way)
        force = lost / way if abs(way) > _SHORT else (energy - contact_energy(height + _SHORT)) / _SHORT
        return velocity - free - step * force / mass

    if excess(free) == 0.0:
        return free
    reach = 1.0
    while excess(free - reach) * excess(free + reach) > 0.0:
        reach *= 2.0
    return float(brentq(excess, free - reach, free + reach, xtol=1e-13))


_SHORT = 1e-9
"""A way so short that the force at its start is the mean one."""
