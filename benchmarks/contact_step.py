"""What a step with contacts costs beside a free one, in CPU seconds of one thread: one disk, heaps, a ball.

python benchmarks/contact_step.py [--page docs/validation/contact_step.md]
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

for threads in ("OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[threads] = "1"
ROOT = Path(__file__).parents[1]
sys.path.append(str(ROOT / "tests" / "support"))

import fluid_contacts  # noqa: E402
import numpy as np  # noqa: E402
from written_page import measurement, write_page  # noqa: E402

from rigidfluid.core.case.load import load_scene, scene_from_dict  # noqa: E402
from rigidfluid.core.run.process import one_openblas_thread  # noqa: E402
from rigidfluid.core.run.simulation import Simulation  # noqa: E402
from rigidfluid.core.scene.scene import Scene  # noqa: E402

HEAD = ("scene", "unknowns", "contacts", "free step [s]", "contact step [s]", "ratio", "steps", "re-meshes")
PITCH = 0.066
START = 2.0
"""Time until the graded start is over, in steps."""


@dataclass(frozen=True)
class Case:
    """A scene, for how many steps, and whether all of them have contacts, so that a scene without stands beside it."""

    name: str
    scene: Callable[[], Scene]
    steps: int
    free: Callable[[], Scene] | None = None


def dropped(size_body: float) -> Scene:
    """The dropped disk with cells of this size on it [cm], until after its first rebound."""
    return changed(fluid_contacts.dropped(1e-3), mesh={"size": 2.0 * size_body, "size_body": size_body})


def ball(size_body: float) -> Scene:
    """The dropped ball with cells of this size on it [cm], until after its first rebound."""
    return changed(fluid_contacts.ball_dropped(2e-3), mesh={"size": 2.5 * size_body, "size_body": size_body})


def column(floor: float = 0.0) -> Scene:
    """Ten disks, one above the other, let go just above the floor or farther from it [cm]."""
    return changed(fluid_contacts.column(2e-3), mesh={"size_body": 0.01}, domain={"lower": [0.0, floor]})


def hundred(pitch: float, step: float) -> Scene:
    """The shipped hundred disks, so far apart, let go on the floor [cm, s]."""
    data = load_scene(ROOT / "scenes" / "hundred_disks.toml").to_dict()
    random = np.random.default_rng(0)
    for number, body in enumerate(data["body"]):
        row, column = divmod(number, 10)
        place = 0.5 + (column - 4.5 + 0.25 * (row % 2)) * pitch, 0.05 + row * pitch
        body["position"] = (np.array(place) + random.uniform(-0.001, 0.001, 2)).tolist()
    return changed(scene_from_dict(data), time={"step": step}, domain={"upper": [1.0, 1.2]})


def changed(scene: Scene, **tables: dict[str, Any]) -> Scene:
    """The scene with other values in some tables, without outputs."""
    data = scene.to_dict()
    for name, values in ({"output": {"every": 100.0}, "time": {}} | tables).items():
        data[name] |= values
    return scene_from_dict(data)


CASES = (
    *(
        Case(f"one disk, cells of {size:g}", lambda size=size: dropped(size), 46)
        for size in (0.03, 0.012, 0.006, 0.0033)
    ),
    Case("heap of seven", lambda: changed(fluid_contacts.heap(2e-3), mesh={"size_body": 0.015}), 60),
    Case("column of ten", column, 50, lambda: without_law(column(-1.0))),
    *(Case(f"a ball, cells of {size:g}", lambda size=size: ball(size), 24) for size in (0.1, 0.06)),
    Case("100 disks, as shipped, .5 s", lambda: changed(load_scene(ROOT / "scenes" / "hundred_disks.toml")), 250),
    Case("100 disks, falling apart", lambda: hundred(PITCH, 2e-3), 60, lambda: without_law(hundred(0.09, 2e-3))),
)


def without_law(scene: Scene) -> Scene:
    """Without contact forces; it must end before anything touches."""
    data = scene.to_dict()
    return scene_from_dict(data | {"contact": {}})


def seconds(scene: Scene, steps: int) -> tuple[Simulation, list[tuple[int, float]]]:
    """Of each step after the graded start the contacts in range and the CPU seconds; of those without contacts only
    where they are of full length, as impacts shorten those after them, which then cost less."""
    run, found = Simulation(scene, None, False), list[tuple[int, float]]()
    for _ in range(steps):
        start = time.process_time()
        run.step()
        spent = time.process_time() - start
        law, coupling = run.system.law, run.state.coupling
        near = 0 if law is None or coupling is None else max(1, int(np.sum(run.state.contacts.gap < law.range)))
        full = (run.state.level or 0) == 0
        if run.time >= START * scene.time.step and (near > 0 or full):
            found.append((near, spent))
    return run, found


def rows() -> Iterator[tuple[str, ...]]:
    """One for each case."""
    for case in CASES:
        run, found = seconds(case.scene(), case.steps)
        free = [spent for near, spent in found if near == 0]
        if case.free is not None:
            free = [spent for _, spent in seconds(case.free(), 12)[1]]
        touching = [(near, spent) for near, spent in found if near > 0]
        contact, contacts = (np.mean(column) for column in zip(*((s, n) for n, s in touching), strict=True))
        unknowns = run.system.backend.unknowns(run.state.mesh, run.system.prescribed)
        figures = f"{np.mean(free):.3f}", f"{contact:.3f}", f"{contact / np.mean(free):.1f}"
        yield case.name, f"{unknowns:,}", f"{contacts:.0f}", *figures, f"{len(touching)}", f"{run.counts.remeshes}"


def main() -> None:
    """Run all cases, print a line for each, and write the page."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--page", type=Path, help="where to write the table as well")
    parser.add_argument("--kept", action="store_true", help="write the page of what is kept, and measure nothing")
    arguments, measured = parser.parse_args(), []
    with one_openblas_thread():
        if not arguments.kept:
            seconds(CASES[0].scene(), CASES[0].steps)  # loads compiled code
        for line in () if arguments.kept else rows():
            measured.append(line)
            print(*line, sep=" | ", flush=True)
    if arguments.page is not None:
        write_page(arguments.page, page(measurement(arguments.page, measured or None)), kept=arguments.kept)


def page(found: dict[str, Any]) -> str:
    """The rows as a Markdown page."""
    lines = [HEAD, ("---",) * len(HEAD), *found["rows"]]
    table = "\n".join("| " + " | ".join(line) + " |" for line in lines)
    return PAGE.format(date=found["date"], table=table)


PAGE = """# Steps with contacts

Made on {date} by `python benchmarks/contact_step.py --page docs/validation/contact_step.md`. CPU seconds of one thread,
means over the steps after the graded start; re-meshing is in them. Free steps are of full length; those with an impact
may be shortened. A contact step is one with a contact in range, or one that
may come into it. It solves for the fluid once or twice, and asks for the answers of the bodies where those have changed
([numerics](../numerics.md#contacts)). What is free of contacts is the same run before; for the column the same over a
floor far below, and for the hundred disks the same disks further apart. Of the shipped hundred disks it is the steps
before the first contact; their [whole run](hundred_disks.md) says what contacts took of it.

{table}
"""

if __name__ == "__main__":
    main()
