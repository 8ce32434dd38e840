"""200 spheres in a box here and in LAMMPS: until chaos parts them, and in the mean; two balls with static friction."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np
from dry_scenes import sphere_gas
from matplotlib.figure import Figure
from page_tools import Page, Work, table
from rubbing_balls import STICKS_AND_SLIPS, TANGENTIAL_STIFFNESS, hard_to_turn, oblique_hit

if TYPE_CHECKING:
    from rigidfluid_lammps import Row


def page(work: Work) -> Page:
    """Largest differences until then, means over all of the time, and static friction; needs rigidfluid-lammps."""
    from rigidfluid_lammps import crosscheck
    from rigidfluid_lammps.comparison import PARTED

    start = time.process_time()
    early = crosscheck(sphere_gas(1_000), steps=4).rows
    late = crosscheck(sphere_gas(100_000), steps=1, samples=2_000)
    rubbing = list(static_friction())
    seconds, (row,) = time.process_time() - start, late.rows
    apart = np.linalg.norm(late.ours.position - late.theirs.position, axis=2).max(axis=1)
    shown = late.ours.time <= 1.5
    figure = Figure(figsize=(7.0, 3.6), dpi=120, layout="constrained")
    axes = figure.add_subplot(xlabel="time", ylabel="largest distance of a sphere's two positions", yscale="log")
    axes.plot(late.ours.time[shown], np.maximum(apart[shown], 1e-17), label=f"rigidfluid and LAMMPS, step {row.step:g}")
    axes.axhline(PARTED * 0.04, ls=":", label="a hundredth of the smallest radius")
    axes.legend()
    head = ("step", "position", "velocity", "energy", "momentum", "position, from LAMMPS' with the shortest step")
    columns = ("step", "position", "velocity", "energy", "momentum", "from_finest")
    until = [tuple(f"{getattr(one, column):.2g}" for column in columns) for one in early]
    means = [
        (name, f"{ours:.5g}", f"{theirs:.5g}", f"{ours / theirs - 1.0:+.2%}")
        for name in ("energy", "momentum", "pressure")
        for ours, theirs in [(getattr(row.ours, name), getattr(row.theirs, name))]
    ]
    text = f"""200 spheres of three radii and two densities fly about in a box of side 1 and collide by the law `centre`
(LAMMPS: tables). Both programs take the same velocity Verlet steps.

Largest differences until time 0.1, by step; energy and momentum over their largest values:

{table(head, until)}

With the same step the positions differ by at most {max(one.position for one in early):.0e}: rounding, and what
collisions make of it. Against LAMMPS' shortest step ours converges with the order {order(early):.1f}, by the first two
halvings.

Over {100_000:,} steps of {row.step:g} the rounding grows until the histories part, at time {row.parted:g}. Means over
all of the time, {len(late.ours.time):,} samples, with the size of the total momentum:

{table(("mean", "rigidfluid", "LAMMPS", "difference"), means)}

## Static friction

Two balls of unequal weight hit each other off centre, with friction that remembers (`tangential_stiffness`, LAMMPS'
`linear_history`). Their inertia is a billion times the usual one: friction acts at slightly different arms in the two
programs, which is of no account if the balls hardly turn. Largest differences, of positions over the radius:

{table(("dimension", "friction", "surfaces", "position", "energy", "momentum"), rubbing)}

{seconds:.0f} s of CPU time for all runs."""
    return Page("200 spheres beside LAMMPS", text, {"": figure})


def static_friction() -> Iterator[tuple[str, ...]]:
    """Rows of the table of two balls that stick and slip."""
    from rigidfluid_lammps import crosscheck

    for dimension in (2, 3):
        for surfaces, friction in STICKS_AND_SLIPS.items():
            with hard_to_turn():
                scene = oblique_hit(dimension, friction=friction, tangential_stiffness=TANGENTIAL_STIFFNESS)
                (row,) = crosscheck(scene, steps=1).rows
            figures = row.position / 0.1, row.energy, row.momentum
            yield str(dimension), f"{friction:g}", surfaces, *(f"{figure:.1g}" for figure in figures)


def order(rows: Sequence[Row]) -> float:
    """Of convergence towards LAMMPS' shortest step, by the first two halvings."""
    return float(np.log2(rows[0].from_finest / rows[2].from_finest) / 2.0)
