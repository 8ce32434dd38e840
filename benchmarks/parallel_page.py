"""The page of many balls on several processes: measures steps, keeps them in parallel.json, and writes all of it.

python benchmarks/parallel_page.py --page docs/validation/parallel.md [--kept]

With ``--kept`` nothing is measured. Detections, the constants of the model and its memory are kept as
`shared_detection.py`, `scaling_model.py` and `memory_model.py` print them.
"""

from __future__ import annotations

import argparse
import datetime
import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from parallel import PAPER_SHARE, PAPER_SPEEDUP, parallel_rows
from step_model import Constants, Line, memory_lines, model_lines
from written_page import write_page

STORE = Path(__file__).with_name("parallel.json")
Row = dict[str, Any]

STEP_HEAD = ("nodes (paper)", "unknowns", "pairs, at walls", "processes", "collision [ms]", "step [s]")
STEP_HEAD += ("share of collision", "speed-up of collision", "of the step")
STEP_HEAD += ("paper's speed-up of collision on 4, 16, 24",)


def measured() -> dict[str, Any]:
    """Steps on one and two processes, with the date."""
    rows = [asdict(row) for row in parallel_rows()]
    return {"made": str(datetime.date.today()), "how": "DOLFINx", "rows": rows}


def table(head: Sequence[str], rows: Iterator[Sequence[str]]) -> str:
    """A Markdown table."""
    lines = [head, ("---",) * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def step_rows(rows: Sequence[Row], dimension: int) -> Iterator[Sequence[str]]:
    """Rows of one dimension."""
    for row in rows:
        if row["dimension"] == dimension:
            yield (
                str(row["bodies"]), f"{row['mesh_nodes']:,} ({row['paper_mesh_nodes']:,})", f"{row['unknowns']:,}",
                f"{row['body_body']}, {row['body_wall']}", str(row["ranks"]), f"{1e3 * row['seconds_collision']:.1f}",
                f"{row['seconds_step']:.3g}", f"{100 * row['share']:.2g} %", f"{row['speedup_collision']:.2f}",
                f"{row['speedup_step']:.2f}", ", ".join(map(str, PAPER_SPEEDUP[dimension][row["bodies"]])),
            )  # fmt: skip


def figures_of_steps(rows: Sequence[Row]) -> dict[str, str]:
    """What the text says of them."""
    told = {}
    for dimension in (2, 3):
        own = [row for row in rows if row["dimension"] == dimension]
        shared = [row["speedup_step"] for row in own if row["ranks"] > 1]
        told[f"speedup_{dimension}"] = f"{min(shared):.2f} to {max(shared):.2f}"
        told[f"share_{dimension}"] = f"{100 * max(row['share'] for row in own):.2g}"
        told[f"paper_{dimension}"] = f"{100 * PAPER_SHARE[dimension]:.0f}"
    return told


def detection_rows(rows: Sequence[Row]) -> Iterator[Sequence[str]]:
    """Detections: on one process, on each of two, collective calls, and bytes."""
    for row in rows:
        each = ", ".join(f"{one:.1f}" for one in row["each"])
        yield row["bodies"], f"{row['alone']:.1f}", each, str(row["calls"]), f"{row['sent']:,}"


def contact_rows(rows: Sequence[Row]) -> Iterator[Sequence[str]]:
    """One ball at a wall."""
    for row in rows:
        seconds = f"{row['one']:.3g}", f"{row['two']:.3g}"
        yield row["bodies"], f"{row['unknowns']:,}", *seconds, f"{row['one'] / row['two']:.2f}"


def page(kept: dict[str, Any]) -> str:
    """All that is kept."""
    steps, model, memory = kept["steps"], kept["model"], kept["memory"]
    meshing = Line.through(memory["alone"], "seconds")
    share, whole = (Line.through(memory[name], "bytes") for name in ("shared", "alone"))
    constants = Constants(*(model[name] for name in ("seconds", "sums", "rounds", "bytes")))
    return PAGE.format(
        made=steps["made"],
        how=steps["how"],
        disks=table(("disks", *STEP_HEAD), step_rows(steps["rows"], 2)),
        balls=table(("balls", *STEP_HEAD), step_rows(steps["rows"], 3)),
        **figures_of_steps(steps["rows"]),
        detections=kept["detections"],
        detected=table(
            ("", "one process [ms]", "each of two [ms]", "calls", "bytes sent"),
            detection_rows(kept["detections"]["rows"]),
        ),
        contact=kept["contact"],
        touching=table(
            ("", "unknowns", "step on one process [s]", "on two [s]", "speed-up"), contact_rows(kept["contact"]["rows"])
        ),
        model=model,
        micro=1e6 * model["seconds"],
        kilo=1e-3 * model["bytes"],
        latency=1e6 * model["latency"],
        bandwidth=1e-9 * model["bandwidth"],
        foretold="\n".join(model_lines(constants, model["latency"], model["bandwidth"])),
        memory=memory,
        share=share,
        base=1e-9 * share.start,
        mesher=1e-9 * whole.start,
        whole=whole,
        mesh_micro=1e6 * meshing.slope,
        mesh_hours=meshing.at(1e8) / 3600.0,
        mesh_memory=1e-9 * whole.at(1e8),
        held="\n".join(memory_lines(share, whole)),
    )


PAGE = """# Many balls in a fluid on several processes

`python benchmarks/parallel.py` has the form of Tables 2 and 3 of
[Van Landeghem et al.](https://arxiv.org/abs/2402.19093): 1, 25, 49, 81 and 100 disks, 1, 27, 64 and 125 balls at rest
in a box of fluid at rest, without gravity, with contact forces that hardly move them, on meshes of about as many
vertices. This page is written by `python benchmarks/parallel_page.py --page docs/validation/parallel.md`.

Each figure is the mean of ten steps of the backend `dolfinx` with the detector `narrow_band`, of a run of its own; the
first of the ten factorises. Times on several processes are means over them, and speed-ups are against one process that
has the same thread and the whole mesh.

* Pairs, at walls: pairs of bodies in contact, and bodies in contact with a wall. The paper does not give the places;
  they are [those of `benchmarks/collisions.py`](../detectors.md).
* Collision: a step's detection on the parts of the mesh, and the bodies' way through their contacts with forces and
  wrenches; in the paper preparation, detection and forces.

`mpirun` is taken from the PATH. As root, Open MPI's asks for `OMPI_ALLOW_RUN_AS_ROOT=1` and
`OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1`; they are yours to set. Memory for 3D: about 400,000 unknowns.

Measured on {made} with {how}. Pairs in contact, and bodies at walls, are as many as in the paper.

## In 2D

{disks}

## In 3D

{balls}

The whole step is {speedup_2} times as fast on two processes in 2D and {speedup_3} times in 3D. The collision algorithm
takes some milliseconds; its share of the step is at most {share_2} % in 2D and {share_3} % in 3D, in the paper up to
{paper_2} and {paper_3} %.

## Detection with shared exchanges

All bodies' marches share their exchanges. Measured on {detections[made]} by
`mpirun -n 2 python benchmarks/shared_detection.py` with {detections[how]}, so in CPU time outside of the calls: the
least of forty detections in a run.

{detected}

Of 100 disks the part with the narrow gaps has most of the marches: parts have equally many cells, not contacts.

## One ball at a wall, with a contact in each step

`python benchmarks/parallel.py --ranks 1 2 --most-bodies 1` on {contact[made]}, {contact[how]}. A step with a contact
asks how the bodies answer to impulses.

{touching}

## A model, not a measurement, of more processes

`mpirun -n 2 python benchmarks/scaling_model.py --mesh 1 --steps 4` with {model[how]}:

    T(N, p) = c N/p + r α log₂ p + m α + v (N/p)^⅔ / β

Measured a step: c = {micro:.0f} µs CPU an unknown, with what the two processes wait for each other; r = {model[sums]}
global sums; m = {model[rounds]} exchanges between neighbours; v = {kilo:.0f} kB. Assumed of the network: latency
α = {latency:.0f} µs and bandwidth β = {bandwidth:.0f} GB/s, {model[network]}.
Seconds a step, and the speed-up over one process, as the model has it:

{foretold}

The memory of a process is that of its share, M(N, p) = b + s N/p; before, the root makes the whole mesh, with b' + g
N. Measured on {memory[made]} by `mpirun -n 2 python benchmarks/memory_model.py` with 1.2 0.3 and 0.58 0.11: b =
{base:.2f} GB and s = {share.slope:,.0f} bytes an unknown, up to {memory[shared][1][unknowns]:,} unknowns a process;
by the same on one process with 0.4 0.075, 0.25 0.047 and `--steps 0`: b' = {mesher:.2f} GB and g = {whole.slope:,.0f}
bytes, up to {memory[alone][1][unknowns]:,} unknowns. GB of a process, and of the root while it makes the mesh, as the
model has it:

{held}

A mesh takes the root {mesh_micro:.0f} µs CPU an unknown, {mesh_micro:.0f} s for a million, while the others wait. At
100 million unknowns that is {mesh_hours:.1f} hours for each new mesh, and {mesh_memory:.0f} GB on one machine: these
bound such a run, not its steps.

The model carries constants of two processes to hundreds. It leaves out coarse levels of multigrid, more iterations
with more parts, unequal parts, the fluid's way to a new mesh, and that cores of a machine [share its memory's
bandwidth](https://petsc.org/release/manual/performance/), which bounds PETSc's steps where all of them are in use.
Measure your own machine by the same commands before you plan with it.
"""


def main() -> None:
    """Measure where asked, keep it, and write the page."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--page", type=Path, required=True, help="write a Markdown page here")
    parser.add_argument("--kept", action="store_true", help="measure nothing")
    arguments = parser.parse_args()
    kept = json.loads(STORE.read_text(encoding="utf-8"))
    if not arguments.kept:
        kept["steps"] = measured()
        STORE.write_text(json.dumps(kept, indent=1) + "\n", encoding="utf-8")
    write_page(arguments.page, page(kept), kept=arguments.kept)


if __name__ == "__main__":
    main()
