"""Stiff and extreme contacts: a table of scenes, what each must do, and what it is found to do."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from functools import partial
from multiprocessing import get_context
from typing import Any

import fluid_contacts as contacts
import numpy as np
from dry_scenes import ball, dry_scene, sphere_gas
from extreme_scenes import (
    RADIUS,
    almost_touching,
    dashpot,
    driven,
    heap,
    law,
    oblique_hit,
    spinning,
    squeezed_by_the_heavy,
    three_disks,
    thrown,
)
from extreme_wet import blade, floor_hit, let_go, resting, settling, squeezed, stokes_pressed
from fluid_contacts import Stepping, put_in

from rigidfluid.core.model.system import System
from rigidfluid.core.output.energy_account import NOTICEABLE, energy_account
from rigidfluid.core.output.history import History
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.core.run.turn_remarks import turn_remarks
from rigidfluid.core.scene.scene import Scene
from rigidfluid.errors import MeshError, StepError

LAST_PART = 0.1
"""Of the steps, over which what is at rest is averaged."""
Run = tuple[float, Stepping]
"""A step [ms] and a way through contacts."""
ENDS = "runs to its end"
"""A figure for what can be demanded of every case."""


@dataclass(frozen=True, slots=True)
class Demand:
    """A ``figure`` of a run must be above ``above`` and at most ``at_most``; ``by_rounding``: it is near a limit where
    rounding decides, so that a known failure may be none."""

    figure: str
    above: float = -np.inf
    at_most: float = np.inf
    by_rounding: bool = False

    def met_by(self, value: float) -> bool:
        """Whether the value is within the limits; what is not a number is not."""
        return self.above < value <= self.at_most

    def share(self, value: float) -> float | None:
        """Of what is allowed, what was found; of a range, the distance from its middle. None where there is nothing to
        share: no upper limit, or zero."""
        if not 0.0 < self.at_most < np.inf or not np.isfinite(value):
            return None
        middle = 0.5 * (self.above + self.at_most) if np.isfinite(self.above) else 0.0
        return float(f"{abs(value - middle) / (self.at_most - middle):.3g}")

    def __str__(self) -> str:
        limits = [f"above {self.above:g}"] if np.isfinite(self.above) else []
        limits += [f"at most {self.at_most:g}"] if np.isfinite(self.at_most) else []
        return f"{self.figure} {', '.join(limits)}"


@dataclass(frozen=True, slots=True)
class Case:
    """A scene and what must hold of it, or what the error must say that ``stops`` it; ``heavy`` ones take long.

    Some figures are known not to be as demanded; ``fails`` says how far off they may be, so that none gets worse
    unseen.
    """

    name: str
    scene: Callable[[], Scene]
    demands: tuple[Demand, ...]
    heavy: bool = False
    stops: str = ""
    fails: tuple[Demand, ...] = ()


@dataclass(frozen=True, slots=True)
class Finding:
    """What was demanded of a ``figure``, what was found, and whether that is enough, or no worse than is ``known``;
    ``share`` as `Demand.share`."""

    figure: str
    demanded: str
    found: str
    passed: bool
    known: bool = False
    share: float | None = None


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
    try:
        run = Simulation(case.scene(), None, False)
        run.go()
    except (MeshError, StepError) as error:
        expected = bool(case.stops) and case.stops in error.remedy
        return [Finding(ENDS, _demanded_end(case), f"stops: {error}", expected)]
    run.finish("complete")
    if case.stops:
        return [Finding(ENDS, _demanded_end(case), ENDS, False)]
    values = [(demand, FIGURES[demand.figure](run.system, run.history)) for demand in case.demands]
    return [held_against(case, demand, value) for demand, value in values]


def held_against(case: Case, demand: Demand, value: float) -> Finding:
    """What a case's ``value`` of the figure that a ``demand`` is about says of it."""
    known = any(limit.figure == demand.figure and limit.met_by(value) for limit in case.fails)
    return Finding(demand.figure, str(demand), f"{value:.2g}", demand.met_by(value), known, demand.share(value))


def surprises(case: Case, found: list[Finding]) -> list[str]:
    """Of the findings, which are not as the case says: failures that it does not know, or worse ones, and what it
    wrongly takes for one."""
    failed = {finding.figure: finding for finding in found if not finding.passed}
    limits = {limit.figure: str(limit) for limit in case.fails}
    new = [f"{f.demanded}; found: {f.found}" for figure, f in failed.items() if figure not in limits]
    worse = [
        f"{limits[figure]} is known; found: {f.found}"
        for figure, f in failed.items()
        if figure in limits and not f.known
    ]
    certain = [limit.figure for limit in case.fails if not limit.by_rounding]
    mended = [f"{figure}: holds now, take it out of what fails" for figure in certain if figure not in failed]
    return new + worse + mended


def surprises_in(measured: Iterable[Mapping[str, Any]]) -> dict[str, list[str]]:
    """Surprises in ``measured`` rows, by case, which have to be those of all CASES."""
    kept = {row["case"]: [Finding(**found) for found in row["findings"]] for row in measured}
    assert set(kept) == {case.name for case in CASES}
    found = {case.name: surprises(case, kept[case.name]) for case in CASES}
    return {name: those for name, those in found.items() if those}


def rows(processes: int) -> Iterator[dict[str, Any]]:
    """Of each of CASES: its kind, its name, its findings, and how far off it is known to be; so many at a time."""
    with ProcessPoolExecutor(processes, get_context("spawn")) as pool:
        yield from pool.map(_row, range(len(CASES)))


def _row(number: int) -> dict[str, Any]:
    case = CASES[number]
    found = [asdict(finding) for finding in findings(case)]
    return {"kind": KIND[case.name], "case": case.name, "findings": found, "fails": list(map(str, case.fails))}


def _demanded_end(case: Case) -> str:
    return f"stops and says: {case.stops}" if case.stops else ENDS


def _columns(history: History, prefix: str, count: int) -> np.ndarray:
    """Of each step, body and axis."""
    axes = "xyz"[: history.dimension]
    return np.stack([history.bodies[prefix + axis] for axis in axes], axis=-1).reshape(-1, count, len(axes))


def _stored(history: History) -> np.ndarray:
    return np.asarray(history.energy["kinetic"] + history.energy["contact"])


def _unaccounted(system: System, history: History) -> float:
    return float(np.abs(history.energy["residual"]).max() / _stored(history).max())


def _created(system: System, history: History) -> float:
    return max(-float(_after_the_first(history.energy["residual"]).min()), 0.0) / put_in(history)


def _created_at_first(system: System, history: History) -> float:
    return max(-float(history.energy["residual"][1]), 0.0) / put_in(history)


def _lost_untold(system: System, history: History) -> float:
    """What was lost by a run that names no body that turned too far in a step."""
    return 0.0 if turn_remarks(history, energy_account(history.energy)) else _lost(system, history)


def _lost(system: System, history: History) -> float:
    unexplained = history.energy["residual"] - history.energy["path_friction"]
    return max(float(_after_the_first(unexplained).max()), 0.0) / put_in(history)


def _after_the_first(residual: np.ndarray) -> np.ndarray:
    """What the steps after the first left unaccounted for."""
    return np.asarray(residual[1:] - residual[1])


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
    "energy created": _created,
    "energy created by the first step": _created_at_first,
    "energy lost": _lost,
    "energy lost untold": _lost_untold,
    "kinetic energy left": _still_moving,
    "momentum off": _momentum,
    "force of the floor over the weight": _held,
    "moved, in radii": _moved,
}
"""Energies over the most that was stored, created and lost ones over what was put in, momenta over a body's largest."""

APART = Demand("smallest gap over the radius", above=0.0)
SMOOTH = Demand("rejected steps", at_most=0.0)
TOUCHED = Demand("steps with contact", above=0.0)
STEADY = (APART, SMOOTH, TOUCHED)
TOLD = Demand("energy lost untold", at_most=NOTICEABLE)
"""Where a body turns by more than a radian in a step. What goes round with it is damped within a step, however long, so
that steps of a millisecond lose as much as those of four; the run must name the body and a step that would do."""
FOLLOWING = (APART, TOUCHED, Demand("rejected steps", at_most=10.0))
"""Where films of fluid open: steps follow them, and some are taken again."""


def keeps(energy: float) -> tuple[Demand, ...]:
    """Steps as they are, no overlap, and this part of the energy at most unaccounted for."""
    return (*STEADY, Demand("energy unaccounted for", at_most=energy))


CREATED = 0.01
"""Of what was put in, with any step."""
LOST = {0.5e-3: 0.04, 1e-3: 0.07, 2e-3: 0.15}
"""Of what was put in, by step; more with longer ones."""
MOST_LOST = 0.3


def balanced(step: float) -> tuple[Demand, ...]:
    """In a fluid: energy that comes from nowhere, also in the first step, and that vanishes, with this step."""
    lost = next((share for longest, share in LOST.items() if step <= longest), MOST_LOST)
    at_first = Demand("energy created by the first step", at_most=CREATED)
    return Demand("energy created", at_most=CREATED), at_first, Demand("energy lost", at_most=lost)


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
    grown, shrunk = "energy created", "energy lost"
    damped = (*STEADY, *(Demand(figure, at_most=1e-3) for figure in (grown, shrunk)))
    yield Case("1,000 balls fall, spring-dashpot", partial(heap, 1_000, rough, 0.04), damped)
    yield Case("1,000 balls fall, normal", partial(heap, 1_000, smooth, 0.04), keeps(1e-3))
    at_rest = Demand("kinetic energy left", at_most=1e-3), Demand("force of the floor over the weight", 0.98, 1.02)
    yield Case("50 disks come to rest", partial(heap, 50, rough, 3.0, 2), (*damped, *at_rest))
    balls = partial(heap, 1_000, rough, 3.0)
    yield Case("1,000 balls come to rest", balls, (*damped, *at_rest), heavy=True)
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


def _in_fluid(
    what: str,
    scene: Callable[[float, Stepping], Scene],
    substeps: Sequence[float],
    implicit: Sequence[float] = (),
    quick: Sequence[Run] = (),
    fails: Mapping[Run, tuple[Demand, ...]] | None = None,
    demands: tuple[Demand, ...] = STEADY,
) -> Iterator[Case]:
    """A scene with steps [ms] by substeps and implicit ones; those that are not ``quick`` are heavy, some fail."""
    runs: list[Run] = [(step, "substeps") for step in substeps] + [(step, "implicit") for step in implicit]
    for run in runs:
        milliseconds, stepping = run
        step = 1e-3 * milliseconds
        name = f"fluid, {what}, Δt {milliseconds:g} ms" + (", implicit" if stepping == "implicit" else "")
        limits, known = (*demands, *balanced(step)), (fails or {}).get(run, ())
        yield Case(name, partial(scene, step, stepping), limits, run not in quick, fails=known)


def _by(stepping: Stepping, *steps: float) -> list[Run]:
    return [(step, stepping) for step in steps]


def _wet_impacts() -> Iterator[Case]:
    """One or a few impacts."""
    sub, imp = partial(_by, "substeps"), partial(_by, "implicit")
    two, three = (4, 1), (4, 2, 1)
    for epsilon in (1e-6, 1e-8, 1e-10, 1e-14):
        scene = partial(floor_hit, epsilon=epsilon)
        yield from _in_fluid(f"centre, ε {epsilon:.0e}", scene, two, two, sub(*two) + imp(4))
    yield from _in_fluid("centre, ε 1e-10", floor_hit, (10, 0.1, 0.01), (10, 0.1), sub(10) + imp(10))
    for density in (1e-4, 1e4):
        scene = partial(floor_hit, density=density)
        yield from _in_fluid(f"density ratio {density:g}", scene, three, three, sub(*three) + imp(4))
    scene = partial(floor_hit, velocity=[0.0, -8.0], angular_velocity=[1e3])
    yield from _in_fluid("spin 1e3", scene, two, two, sub(4) + imp(4))
    scene = partial(floor_hit, velocity=[0.0, -80.0], angular_velocity=[1e4])
    lost = Demand("energy lost", at_most=MOST_LOST)
    once = Demand("rejected steps", at_most=1.0, by_rounding=True)
    thrice = Demand("rejected steps", at_most=3.0)
    known = dict.fromkeys(sub(1) + imp(1), (once, lost)) | dict.fromkeys(imp(4), (thrice,))
    yield from _in_fluid("spin 1e4", scene, two, two, sub(4), known, (*STEADY, TOLD))
    scene = partial(floor_hit, detector={"detector": "narrow_band"})
    yield from _in_fluid("contacts from the mesh, thrown", scene, two, two, sub(4) + imp(4))
    seen = partial(_in_fluid, demands=FOLLOWING)
    yield from seen("contacts from the mesh", contacts.from_the_mesh, three, three, sub(4))
    yield from _in_fluid("dropped", contacts.dropped, (*three, 0.5), (*three, 0.5), sub(4, 2))
    yield from _in_fluid("a scene that is shipped", contacts.bounce, three, three, sub(4))
    yield from _in_fluid("head on", contacts.head_on, three, three, sub(*three))
    yield from _in_fluid("densities 10 and .3", contacts.unlike_hit, three, three, sub(4))
    yield from _in_fluid("density .01 between walls", contacts.light, three, three, sub(*three) + imp(4))
    yield from _in_fluid("hit by a driven disk", contacts.driven_hit, three, three, sub(2))
    yield from _in_fluid("dampers and friction", contacts.rough_fall, three, three, sub(4))
    yield from _in_fluid("3D, dropped", contacts.ball_dropped, (4, 2), (4, 2))
    scene = partial(floor_hit, epsilon=1e-9, dimension=3, range=0.1)
    yield from _in_fluid("3D, thrown", scene, (4,), (4,))


def _wet_films() -> Iterator[Case]:
    """Gaps much smaller than the range, between a disk let go and the floor."""
    sub, imp = partial(_by, "substeps"), partial(_by, "implicit")
    film = partial(_in_fluid, demands=FOLLOWING)
    scene = partial(let_go, gap=1e-3, refinements=5)
    yield from film("gap of 1e-3 radius", scene, (4, 2, 1), (4, 2, 1), sub(4, 1))
    yield from film("gap of 1e-5 radius", partial(let_go, gap=1e-5, refinements=12), (4, 2, 1), (4,))
    scene = partial(let_go, gap=1e-6, refinements=14)
    yield from film("gap of 1e-6 radius", scene, (4,), (4,), sub(4) + imp(4))
    yield from _in_fluid("range wider than the free gaps", squeezed, (4, 2, 1), (4, 2, 1), sub(4, 2))


def _wet_crowds() -> Iterator[Case]:
    steps, crowd = (4, 2, 1), partial(_in_fluid, demands=FOLLOWING)
    yield from _in_fluid("cradle of three", contacts.cradle, steps, (2,), _by("substeps", 4))
    scene = partial(contacts.cradle, density=0.2)
    yield from _in_fluid("cradle of three, density .2", scene, steps, (2,), _by("substeps", 4))
    yield from crowd("stack of two", contacts.stacked, steps, (2,), _by("substeps", 4))
    yield from crowd("stack of three", contacts.three_stacked, steps, (2,))
    yield from crowd("stack of ten", contacts.column, steps, (2,))
    yield from crowd("heap of seven", contacts.heap, steps, (2,))
    yield from crowd("heap of six radii", contacts.unlike_heap, steps, (2,))


def _wet_shapes() -> Iterator[Case]:
    steps = (4, 2, 1)
    yield from _in_fluid("20:1", blade, steps, steps, _by("substeps", 4, 1))
    yield from _in_fluid("ellipse, tip first", contacts.ellipse, steps, steps, _by("substeps", 4))
    yield from _in_fluid("ellipse that spins, into a corner", contacts.in_a_corner, steps, steps, _by("substeps", 4))


def _wet_rest() -> Iterator[Case]:
    """Contacts that last."""
    steps, slow = (4, 2, 1), (10, 4, 1)
    yield from _in_fluid("let fall onto ε 1e-10, and at rest", settling, steps, (4,))
    yield from _in_fluid("at rest from the start", resting, steps, steps, _by("substeps", *steps))
    yield from _in_fluid("without inertia, onto the floor", stokes_pressed, slow, slow, _by("substeps", 10, 4))
    scene = partial(stokes_pressed, density=0.1)
    yield from _in_fluid("without inertia, density .1", scene, slow, slow, _by("substeps", 4))


KINDS: dict[str, Callable[[], Iterator[Case]]] = {
    "no fluid: a few bodies": _dry,
    "no fluid: squeezed and driven": _squeezed,
    "no fluid: crowds": _crowds,
    "fluid: impacts": _wet_impacts,
    "fluid: thin films": _wet_films,
    "fluid: crowds": _wet_crowds,
    "fluid: shapes": _wet_shapes,
    "fluid: contacts that last": _wet_rest,
}
KIND = {case.name: kind for kind, cases in KINDS.items() for case in cases()}
CASES = [case for cases in KINDS.values() for case in cases()]
"""Scenes at the edge of what contacts can take, made on the spot."""
