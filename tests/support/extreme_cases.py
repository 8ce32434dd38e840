"""Stiff and extreme contacts: a table of scenes, what each must do, and what it is found to do."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np
from dry_scenes import ball, dry_scene, sphere_gas
from extreme_scenes import (
    RADIUS,
    almost_touching,
    dashpot,
    driven,
    ellipsoid,
    heap,
    law,
    oblique_hit,
    spinning,
    squeezed_by_the_heavy,
    three_disks,
    thrown,
    wet,
    wet_hit,
)

from rigidfluid.core.history import History
from rigidfluid.core.scene import Scene
from rigidfluid.core.simulation import Simulation
from rigidfluid.core.system import System
from rigidfluid.core.threads import one_openblas_thread
from rigidfluid.errors import StepError

LAST_PART = 0.1
"""Of the steps, over which what is at rest is averaged."""


@dataclass(frozen=True, slots=True)
class Demand:
    """A ``figure`` of a run must be above ``above`` and at most ``at_most``."""

    figure: str
    above: float = -np.inf
    at_most: float = np.inf

    def met_by(self, value: float) -> bool:
        """Whether the value is within the limits; what is not a number is not."""
        return self.above < value <= self.at_most

    def __str__(self) -> str:
        limits = [f"above {self.above:g}"] if np.isfinite(self.above) else []
        limits += [f"at most {self.at_most:g}"] if np.isfinite(self.at_most) else []
        return f"{self.figure} {', '.join(limits)}"


@dataclass(frozen=True, slots=True)
class Case:
    """A scene and what must hold of it, or what the error must say that ``stops`` it; ``heavy`` ones take long."""

    name: str
    scene: Callable[[], Scene]
    demands: tuple[Demand, ...]
    heavy: bool = False
    stops: str = ""


@dataclass(frozen=True, slots=True)
class Finding:
    """What was demanded, what was found, and whether that is enough."""

    demanded: str
    found: str
    passed: bool


def findings(case: Case) -> list[Finding]:
    """Run the case and hold it against each of its demands.

    Parameters
    ----------
    case : Case
        Of the table.

    Returns
    -------
    list of Finding
        At least one.
    """
    with one_openblas_thread():
        run = Simulation(case.scene(), None, False)
        try:
            run.go(None)
        except StepError as error:
            expected = bool(case.stops) and case.stops in error.remedy
            return [Finding(_demanded_end(case), f"stops: {error}", expected)]
        run.finish("complete")
    if case.stops:
        return [Finding(_demanded_end(case), "runs to its end", False)]
    values = [(demand, FIGURES[demand.figure](run.system, run.history)) for demand in case.demands]
    return [Finding(str(demand), f"{value:.2g}", demand.met_by(value)) for demand, value in values]


def rows(cases: list[Case]) -> Iterator[tuple[str, str, str, str]]:
    """Of each case: its name, what was demanded, what was found, and whether it passed."""
    for case in cases:
        found = findings(case)
        passed = "yes" if all(finding.passed for finding in found) else "**no**"
        yield case.name, "; ".join(f.demanded for f in found), "; ".join(f.found for f in found), passed


def _demanded_end(case: Case) -> str:
    return f"stops and says: {case.stops}" if case.stops else "runs to its end"


def _columns(history: History, prefix: str, count: int) -> np.ndarray:
    """Of each step, body and axis."""
    axes = "xyz"[: history.dimension]
    return np.stack([history.bodies[prefix + axis] for axis in axes], axis=-1).reshape(-1, count, len(axes))


def _stored(history: History) -> np.ndarray:
    return np.asarray(history.energy["kinetic"] + history.energy["contact"])


def _unaccounted(system: System, history: History) -> float:
    return float(np.abs(history.energy["residual"]).max() / _stored(history).max())


def _gained(system: System, history: History) -> float:
    energy, stored = history.energy, _stored(history)
    return float((stored - stored[0] - energy["gravity"] - energy["control"]).max() / stored.max())


def _still_moving(system: System, history: History) -> float:
    kinetic = history.energy["kinetic"]
    return float(kinetic[-_late(history) :].max() / kinetic.max())


def _momentum(system: System, history: History) -> float:
    velocity = _columns(history, "v", len(system.mass))
    total = np.einsum("n,tnd->td", system.mass, velocity)
    largest = (system.mass[:, None] * np.linalg.norm(velocity, axis=2).T).max()
    return float(np.linalg.norm(total - total[0], axis=1).max() / largest)


def _held(system: System, history: History) -> float:
    force = _columns(history, "cf", len(system.mass))[-_late(history) :]
    weight = system.weight.sum(axis=0)
    return float(-force.sum(axis=1).mean(axis=0) @ weight / (weight @ weight))


def _moved(system: System, history: History) -> float:
    place = _columns(history, "", len(system.mass))
    return float(np.linalg.norm(place - place[0], axis=2).max() / RADIUS)


def _steps_with_contact(system: System, history: History) -> float:
    return float(np.count_nonzero(_columns(history, "cf", len(system.mass)).any(axis=(1, 2))))


def _late(history: History) -> int:
    return int(np.ceil(LAST_PART * len(history.energy["time"])))


FIGURES: dict[str, Callable[[System, History], float]] = {
    "smallest gap over the radius": lambda system, history: float(history.bodies["gap"].min() / RADIUS),
    "rejected steps": lambda system, history: float(history.summary["rejected_steps"]),
    "steps with contact": lambda system, history: float(
        np.count_nonzero(_columns(history, "cf", len(system.mass)).any((1, 2)))
    ),
    "energy unaccounted for": _unaccounted,
    "energy gained": _gained,
    "kinetic energy left": _still_moving,
    "momentum off": _momentum,
    "force of the floor over the weight": _held,
    "moved, in radii": _moved,
}
"""Energies over the most that was stored, momenta over a body's largest."""

APART = Demand("smallest gap over the radius", above=0.0)
SMOOTH = Demand("rejected steps", at_most=0.0)
TOUCHED = Demand("steps with contact", above=0.0)
STEADY = (APART, SMOOTH, TOUCHED)


def keeps(energy: float) -> tuple[Demand, ...]:
    """Steps as they are, no overlap, and this part of the energy at most unaccounted for."""
    return (*STEADY, Demand("energy unaccounted for", at_most=energy))


def loses() -> tuple[Demand, ...]:
    """In a fluid: no overlap, and never more energy than came in, but for 1 %."""
    return (*STEADY, Demand("energy gained", at_most=0.01))


SOFTEST = {"centre": 1e-6, "normal": 1e-5, "barrier": 1e-2}
"""The ε, with the ranges here, that just stops the three disks."""

NEEDLE, PLATE, BLADE = (0.2, 0.01, 0.01), (0.2, 0.2, 0.01), (0.2, 0.01)


def _dry() -> Iterator[Case]:
    for name, softest in SOFTEST.items():
        for decade in range(0, 9, 2):
            contact = law(name, softest * 10.0**-decade)
            yield Case(f"three disks, {name}, ε {contact['epsilon']:.0e}", partial(three_disks, contact), keeps(2e-3))
    for step in (1e-4, 1e-3, 1e-2, 1e-1):
        scene = partial(three_disks, law("normal", 1e-9), step)
        yield Case(f"three disks, Δt {step:.0e}", scene, keeps(0.01), heavy=step < 1e-3)
    for dimension in (2, 3):
        for ratio in (1e-4, 1e-2, 1.0, 1e2, 1e4):
            demands = (*keeps(1e-3), Demand("momentum off", at_most=1e-9))
            yield Case(f"mass ratio {ratio:g}, {dimension}D", partial(oblique_hit, ratio, dimension), demands)
    for name, epsilon in {"normal": 1e-9, "barrier": 1e-5, "centre": 1e-9}.items():
        for ratio in (1e2, 1e4):
            scene = partial(squeezed_by_the_heavy, ratio, law(name, epsilon))
            yield Case(f"light ball between one {ratio:g} times heavier and a wall, {name}", scene, keeps(5e-3))
    for name, epsilon in {"normal": 1e-5, "barrier": 1e-2, "centre": 1e-6}.items():
        for dimension in (2, 3):
            demands = (*keeps(5e-3), Demand("momentum off", at_most=1e-9))
            scene = partial(almost_touching, law(name, epsilon), dimension)
            yield Case(f"gap of 1e-6 radius, {name}, {dimension}D", scene, demands)
    scene = partial(almost_touching, law("normal", 1e-16, range=2e-7), 3)
    yield Case("gap of 1e-6 radius, range of 2e-6 radius", scene, keeps(5e-3))
    for axes, end in ((BLADE, 0.025), ((0.2, 0.1), 0.025), ((0.2, 0.15, 0.1), 0.025)):
        yield Case(f"spin 1e4, semi-axes {axes}", partial(spinning, axes, end), keeps(2e-3))
    spun = dry_scene, dashpot(1e4, 0.7), ball((0.5, 0.2), (0, 0), angular_velocity=[1e4])
    falls = partial(*spun, end=0.5, step=0.01, gravity=(0.0, -10.0))
    yield Case("spin 1e4, a ball that falls on a rough floor", falls, keeps(1e-3))
    for axes in (BLADE, NEEDLE, PLATE):
        for count in (1, 2):
            what = "walls" if count == 1 else "each other"
            yield Case(f"20:1, semi-axes {axes}, at {what}", partial(thrown, axes, count), keeps(2e-3))


def _crowds() -> Iterator[Case]:
    rough, smooth = dashpot(500.0, 0.3, range=0.01), law("normal", 1e-6, range=0.01)
    less = (*STEADY, Demand("energy gained", at_most=1e-3))
    yield Case("1,000 balls fall, spring-dashpot", partial(heap, 1_000, rough, 0.04), less)
    yield Case("1,000 balls fall, normal", partial(heap, 1_000, smooth, 0.04), keeps(1e-3))
    at_rest = Demand("kinetic energy left", at_most=1e-3), Demand("force of the floor over the weight", 0.98, 1.02)
    yield Case("50 disks come to rest", partial(heap, 50, rough, 3.0, 2), (*less, *at_rest))
    yield Case("1,000 balls come to rest", partial(heap, 1_000, rough, 3.0), (*less, *at_rest), heavy=True)
    yield Case("200 balls fly about without gravity", partial(sphere_gas, 500), keeps(1e-3))
    still = Demand("moved, in radii", at_most=0.0)
    lonely = partial(dry_scene, law("normal", 1e-9), ball((0.5, 0.5), (0, 0)), end=1.0, step=0.01)
    yield Case("no gravity, a ball at rest", lonely, (APART, SMOOTH, still))


def _squeezed() -> Iterator[Case]:
    channel = {"end": 1.0, "step": 0.01, "upper": (1.0, 0.24)}
    wide = law("normal", 1e-6, range=0.05)
    middle = partial(dry_scene, wide, ball((0.5, 0.12), (0, 0)), **channel)
    still = Demand("moved, in radii", at_most=1e-9)
    yield Case("range wider than the free gaps, in the middle", middle, (APART, SMOOTH, still))
    thrown_at = partial(dry_scene, wide, ball((0.5, 0.11), (1, 1)), **channel)
    yield Case("range wider than the free gaps, thrown", thrown_at, keeps(2e-3))
    for name, epsilon in {"normal": 1e-6, "barrier": 1e-4, "centre": 1e-7}.items():
        contact, there = law(name, epsilon, range=0.05), ball((0.85, 0.5), (0, 0))
        presses = driven((0.5, 0.5), amplitude=[0.17, 0.0], frequency=0.5)
        scene = partial(dry_scene, contact, presses, there, end=1.0, step=0.01)
        yield Case(f"pressed onto a wall and let go, {name}", scene, keeps(2e-3))
    for step in (1e-3, 1e-2, 0.125):
        swings = driven((0.4, 0.5), amplitude=[-0.2, 0.0], frequency=1.0)
        scene = partial(dry_scene, law("normal", 1e-8), swings, ball((0.65, 0.5), (0, 0)), end=1.0, step=step)
        yield Case(f"hit by a driven ball, Δt {step:g} of its period", scene, keeps(5e-3))
    crushes = driven((0.5, 0.5), velocity=[0.5, 0.0])
    scene = partial(dry_scene, law("normal", 1e-6), crushes, ball((0.85, 0.5), (0, 0)), end=1.0, step=0.01)
    yield Case("pressed into a wall", scene, (), stops="Strengthen the contact force")


def _wet() -> Iterator[Case]:
    for epsilon in (1e-6, 1e-8, 1e-10, 1e-14):
        contact = law("centre", epsilon, range=0.05)
        yield Case(f"fluid, centre, ε {epsilon:.0e}", partial(wet_hit, contact), loses())
    stiff = law("centre", 1e-10, range=0.05)
    for density in (1e-4, 1e4):
        yield Case(f"fluid, density ratio {density:g}", partial(wet_hit, stiff, density), loses())
    yield Case("fluid, spin 1e3", partial(wet_hit, stiff, angular_velocity=[1e3]), loses())
    yield Case("fluid, contacts from the mesh", partial(wet_hit, stiff | {"detector": "narrow_band"}), loses())
    near = ball((0.5, 0.125 + 1.25e-4), (0, 0), density=3.0, radius=0.125)
    released = partial(wet, law("normal", 1e-7), near, end=0.02, step=0.002, mesh={"quality": 0.25, "refinements": 5})
    yield Case("fluid, gap of 1e-3 radius", released, (APART, loses()[-1]))
    between = ball((0.5, 0.15), (0, 0), density=3.0, radius=0.125)
    # With steps of .004 half of all meshes of this channel hold it, and with the others it gains energy and stops.
    narrow = partial(wet, law("normal", 1e-8, range=0.06), between, end=0.04, step=0.001, height=0.32)
    yield Case("fluid, range wider than the free gaps", narrow, loses())
    blade = ellipsoid((0.5, 0.145), (0, -5), (0.3, 0.015), density=3.0, angle=0.3)
    lands = partial(wet, law("normal", 1e-9, range=0.05), blade, end=0.04, step=0.002)
    yield Case("fluid, 20:1", lands, loses())
    yield Case("fluid, 3D", partial(wet_hit, law("centre", 1e-9, range=0.1), 3.0, 3), loses(), heavy=True)


CASES = [*_dry(), *_squeezed(), *_crowds(), *_wet()]
