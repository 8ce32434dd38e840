"""Impacts that lose energy: dry, and of a disk thrown at a wall in a fluid, beside what balls in liquids do."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from matplotlib.figure import Figure
from page_tools import Page, Run, Work, table

from pages._studies import study_plot, study_table

SCENE = "rebound.toml"
RESTITUTION, DECAY = 0.8, 35.0
DRY = {
    "normal": [],
    "centre": ["contact.law=centre"],
    "contact": ["contact.law=contact", "contact.smallest_gap=0.01"],
    "barrier": ["contact.law=barrier"],
}
DRY_RESTITUTIONS = 0.05, 0.2, 0.5, 0.8, 0.95
VISCOSITIES = 0.15, 0.08, 0.05, 0.035, 0.018, 0.005, 0.002
FAR = ["body.0.position=[0.4, 0.5]", "domain.upper=[1.2, 1.0]", "time.end=0.14"]
BALL = [
    *("scene.dimension=3", "domain.lower=[0.0, 0.0, 0.0]", "domain.upper=[0.8, 0.8, 0.8]"),
    *("body.0.position=[0.2, 0.4, 0.4]", "body.0.velocity=[-10.0, 0.0, 0.0]", "contact.range=0.01"),
    *("contact.restitution=1.0", "mesh.size=0.2", "mesh.size_body=0.04", "time.step=0.001", "time.end=0.04"),
]
BALLS = {"st4": (0.4722, []), "st6": (0.3148, []), "st6_film": (0.3148, [f"contact.restitution_stokes={DECAY}"])}
"""By folder: the viscosity, and what else differs of a ball that is thrown so slowly that it should not come back."""
LAWS = {
    "restitution": [],
    "stokes": [f"contact.restitution_stokes={DECAY}"],
}
RANGES, SIZES = (0.02, 0.005), (0.02, 0.04)
STEPS = 0.001, 0.0005, 0.00025, 0.000125
HEADINGS = {"restitution": "e = .8", "stokes": "e = .8 exp(-35/St)"}
FAST, HIGHEST = 40.0, 0.08
"""Above the Stokes number FAST, off the formula."""


class Impact:
    """Of one run: the speed at range and the highest one away [cm/s], its energies; at a gap of half a radius the
    Stokes number, and the speed away over that before, zero where the disk does not come there again."""

    def __init__(self, run: Run) -> None:
        bodies = run.history.bodies
        reach = run.scene.contact.range
        near = int(np.argmax(bodies["gap"] < reach))
        gap, time = bodies["gap"][near - 1 : near + 1][::-1], bodies["time"][near - 1 : near + 1][::-1]
        self.arrival = -float(np.interp(np.interp(reach, gap, time), bodies["time"], bodies["vx"]))
        self.departure = float(bodies["vx"].max())
        self.energy = run.summary["energy"]
        disk, fluid = run.scene.body[0], run.scene.fluid
        came, self.gone = _through(bodies, 0.5 * disk.radius)
        diameter, moved = 2.0 * disk.radius, disk.density + fluid.density
        self.whole = self.gone / came
        self.stokes = moved * diameter * came / (9.0 * (fluid.viscosity or np.inf))

    @property
    def rebound(self) -> float:
        """Highest speed away over the speed at range."""
        return self.departure / self.arrival


def _through(bodies: dict[str, np.ndarray], gap: float) -> tuple[float, float]:
    """The speeds at which the disk passes a ``gap`` [cm] towards the wall and away from it, zero if it never does."""
    turn, found = int(np.argmin(bodies["gap"])), []
    for way, sign in ((slice(turn, None, -1), -1.0), (slice(turn, None), 1.0)):
        gaps, speed = bodies["gap"][way], sign * bodies["vx"][way]
        after = int(np.argmax(gaps > gap))
        pair = slice(after - 1, after + 1)
        found.append(float(np.interp(gap, gaps[pair], speed[pair])) if after else 0.0)
    return found[0], found[1]


def page(work: Work) -> Page:
    """Dry impacts, rebounds over the Stokes number, halvings of the step, and the study."""
    dry = {law: [_dry(work, law, e) for e in DRY_RESTITUTIONS] for law in DRY}
    film = [_wet(work, "elastic", viscosity, RANGES[0], SIZES[0]) for viscosity in VISCOSITIES]
    wet = {
        (reach, size): [_wet(work, "stokes", viscosity, reach, size) for viscosity in VISCOSITIES]
        for reach in RANGES
        for size in SIZES
    }
    thin = [_wet(work, "elastic", viscosity, RANGES[1], SIZES[0]) for viscosity in VISCOSITIES]
    halved = {
        law: [Impact(work.run(f"{law}_{step}", SCENE, [*LAWS[law], f"time.step={step}"])) for step in STEPS]
        for law in LAWS
    }
    study = work.study("rebound")
    dry_error = max(abs(found - e) for row in dry.values() for found, e in zip(row, DRY_RESTITUTIONS, strict=True))
    created = max(100.0 * one.energy["created"] for row in (film, thin, *wet.values(), *halved.values()) for one in row)
    text = TEXT.format(
        dry=table(
            ("law", *(f"e = {e:g}" for e in DRY_RESTITUTIONS)),
            [(f"`{law}`", *(f"{found:.4f}" for found in row)) for law, row in dry.items()],
        ),
        dry_error=f"{dry_error:.1e}",
        wet=table(
            (
                "viscosity",
                "St",
                *(f"e = 1, range {reach:g}" for reach in RANGES),
                *(f"range {reach:g}, cells {size:g}" for reach, size in wet),
                "formula",
            ),
            _wet_rows(film, thin, wet),
        ),
        **_distances(wet),
        ball=table(BALL_HEAD, [_ball_row(work, name) for name in BALLS]),
        halved=table(("law", "step [s]", "rebound", "created [%]", "lost [%]"), _halved_rows(halved)),
        created=f"{created:.2f}",
        study=study_table(study),
    )
    return Page("Impacts that lose energy", text, {"": rebounds(film, wet), "_study": study_plot(study)})


TEXT = """`scenes/rebound.toml`: a disk of density 8 is thrown at a wall at 10 cm/s.

## Without a fluid

Rebound: the highest speed away from the wall over the speed at which the disk reaches the law's range.

{dry}

The largest error of all is {dry_error}; it is of first order in the substep.

## In a fluid

The disk is thrown three radii away from the wall. St = (ρ_s + ρ_f) D v/(9μ), v the speed at a gap of half a radius on
the way in; the rebound is the speed there on the way out over v, or 0 if the disk does not come back so far. The
formula is .8 exp(-35/St). It was fitted to drops and balls (Legendre, Daniel and Guiraud 2005,
doi:10.1063/1.2010527), by the speed of the approach before any film; infinite cylinders have no such measurements.

{wet}

With e = 1 the law takes nothing: what is lost is what the flow takes, which is more the nearer the disk comes. With
`restitution_stokes` the law takes what that leaves of the formula's loss: film and law together are the formula.
Above St = {fast:g} they are off it by {off} at most, {judged} {highest:g}, and {ranges} apart with one range and the
other, {meshes} with one mesh and the other. Part of what is missing is drag on the way from half a radius to the wall
and back, which is no film. A law cannot give back what the film has taken: where e = 1 leaves less than the formula
asks for, that is all there is.

## A ball that should not come back

A ball in 3D of radius .1 is thrown at 10 cm/s at a wall a radius away; the law's range is R/10, its `epsilon` is
`"auto"`. St is of the speed of the throw; speeds are in cm/s.

{ball}

What leaves range the film takes before half a radius, if there is nothing in the column of the gap at the end beyond
it. With `restitution_stokes` the law keeps the ball near the wall.

## Halvings of the step

Energy created and lost by contacts and scheme, of all that was put in, for a viscosity of .02 g/s, thrown a radius
away; rebound as without a fluid.

{halved}

Of all runs on this page the worst creates {created} % of what was put in.

## Error against run time

![Error against run time](restitution_study.png)

`studies/rebound.toml`, one knob at a time.

{study}"""


BALL_HEAD = ("viscosity", "St", "law", "in at a gap of R/2", "in at range", "smallest gap [cm]")
BALL_HEAD += ("out at range", "gap at the end [cm]")


def _ball_row(work: Work, name: str) -> tuple[str, ...]:
    viscosity, own = BALLS[name]
    run = work.run(f"ball_{name}", SCENE, [*BALL, f"fluid.viscosity={viscosity}", *own])
    bodies, disk, fluid = run.history.bodies, run.scene.body[0], run.scene.fluid
    stokes = (disk.density + 0.5 * (fluid.density or 0.0)) * 2.0 * disk.radius * 10.0 / (9.0 * viscosity)
    (far, _), (near, gone) = (_through(bodies, gap) for gap in (0.5 * disk.radius, run.scene.contact.range))
    law = "`restitution_stokes`" if own else "elastic"
    figures = f"{far:.2f}", f"{near:.2f}", f"{bodies['gap'].min():.5f}", f"{gone:.2f}", f"{bodies['gap'][-1]:.4f}"
    return (f"{viscosity:g}", f"{stokes:.2g}", law, *figures)


def _dry(work: Work, law: str, restitution: float) -> float:
    overrides = ["fluid.backend=dry", f"contact.restitution={restitution}", *DRY[law]]
    return Impact(work.run(f"dry_{law}_{restitution}", SCENE, overrides)).rebound


def _wet(work: Work, law: str, viscosity: float, reach: float, size: float) -> Impact:
    own = LAWS["stokes"] if law == "stokes" else ["contact.restitution=1.0"]
    keys = [f"fluid.viscosity={viscosity}", f"contact.range={reach}", f"mesh.size_body={size}"]
    return Impact(work.run(f"{law}_at_{viscosity}_{reach}_{size}", SCENE, [*own, *FAR, *keys]))


def _formula(stokes: float) -> float:
    return float(RESTITUTION * np.exp(-DECAY / stokes))


def _wet_rows(
    film: list[Impact], thin: list[Impact], wet: dict[tuple[float, float], list[Impact]]
) -> Iterator[tuple[str, ...]]:
    for number, viscosity in enumerate(VISCOSITIES):
        found = (f"{row[number].whole:.3f}" for row in (film, thin, *wet.values()))
        stokes = film[number].stokes
        yield f"{viscosity:g}", f"{stokes:.3g}", *found, f"{_formula(stokes):.3f}"


def _distances(wet: dict[tuple[float, float], list[Impact]]) -> dict[str, object]:
    """How far the runs of fast disks are off the formula and off each other."""
    fast = {key: [one for one in row if one.stokes > FAST] for key, row in wet.items()}
    off = max(abs(one.whole - _formula(one.stokes)) for row in fast.values() for one in row)

    def apart(first: tuple[float, float], second: tuple[float, float]) -> float:
        return max(abs(a.whole - b.whole) for a, b in zip(fast[first], fast[second], strict=True))

    ranges = max(apart((RANGES[0], size), (RANGES[1], size)) for size in SIZES)
    meshes = max(apart((reach, SIZES[0]), (reach, SIZES[1])) for reach in RANGES)
    judged = "within" if off < HIGHEST else "not within"
    return {
        "off": f"{off:.3f}",
        "judged": judged,
        "fast": FAST,
        "highest": HIGHEST,
        "ranges": f"{ranges:.3f}",
        "meshes": f"{meshes:.3f}",
    }


def _halved_rows(halved: dict[str, list[Impact]]) -> Iterator[tuple[str, ...]]:
    for law, row in halved.items():
        for step, one in zip(STEPS, row, strict=True):
            shares = (f"{100.0 * one.energy[key]:.3f}" for key in ("created", "lost"))
            yield HEADINGS[law], f"{step:g}", f"{one.rebound:.4f}", *shares


def rebounds(film: list[Impact], wet: dict[tuple[float, float], list[Impact]]) -> Figure:
    """Rebound over the Stokes number, both at a gap of half a radius."""
    figure = Figure(figsize=(7.0, 4.2), dpi=120, layout="constrained")
    axes = figure.add_subplot(xscale="log", xlabel="St", ylabel="rebound: speed after over speed before")
    axes.plot([one.stokes for one in film], [one.whole for one in film], "o-", lw=0.8, label="film alone, e = 1")
    for (reach, size), row in wet.items():
        marker, filled = "s^"[RANGES.index(reach)], size == SIZES[0]
        style = {"markerfacecolor": None if filled else "none", "label": f"range {reach:g}, cells {size:g}"}
        axes.plot([one.stokes for one in row], [one.whole for one in row], marker, **style)
    stokes = np.geomspace(2.0, 1500.0, 200)
    axes.plot(stokes, RESTITUTION * np.exp(-DECAY / stokes), "k-", lw=1.0, label=".8 exp(-35/St)")
    axes.set_ylim(0.0, 1.0)
    axes.legend()
    return figure
