"""Text of docs/validation.md: pictures first, one line each, by subject; tables are on the pages behind."""

from __future__ import annotations

import re
from pathlib import Path

VALIDATION = Path(__file__).parents[1] / "validation"
SUBJECTS = {
    "Falling and settling bodies": {
        "falling_disk": "A disk falls in a channel: velocity and times compared with four published computations",
        "two_disks": "Two light disks draft, kiss and tumble: case 5 of the paper",
        "drafting_kissing_tumbling": "Two heavier disks: path until the kiss compared with Glowinski et al. (2001)",
        "settling_cylinder": "A cylinder leaves the wall of a channel: settled speed and drag, compared with published",
        "ellipse_xia": "An ellipse settles in a channel: path and angle compared with Xia et al. (2009)",
        "ellipse_in_channel": "An ellipse in a narrow channel: how far mesh, step and law decide its swings",
        "hundred_disks": "A hundred disks settle: a movie, energies and the cost",
        "falling_sphere": "A sphere falls in a box: height and speed compared with a published run",
        "ten_cate": "A sphere settles in oil and touches down: compared with the measurement of ten Cate et al. (2002)",
        "falling_ellipsoid": "An ellipsoid falls in a flat box: its path, and what a mesh decides of it",
        "many_bodies_3d": "Twenty spheres and ellipsoids settle: meshes, energies and the cost in 3D",
        "hundred_spheres": "A hundred spheres: meshes, memory and time",
    },
    "Flow past bodies and through channels": {
        "dfg_cylinder": "Steady flow past a cylinder: drag, lift and pressure of benchmark 2D-1",
        "dfg_unsteady": "Unsteady flow past a cylinder: drag and lift of benchmark 2D-3",
        "vortex_induced": "A cylinder on a spring in its own vortices: amplitude, compared with Shiels et al. (2001)",
        "wakes": "A fast disk and its wake: what finer cells behind it change",
        "window": "A short mesh goes with a disk in a long channel: compared with the whole channel",
        "walls": "Curved and oblique walls: orders of convergence against exact flows",
        "stenosis": "Two disks pass a throat: case 7 of the paper",
    },
    "Contacts": {
        "contacts_in_fluid": "Stiff contacts in a fluid: what energy is created or lost",
        "stokes_contacts": "Contacts in Stokes flow: approach and rest compared with what is derived",
        "restitution": "Impacts that lose energy: rebound compared with the formula for Stokes numbers",
        "resistances": "Spheres in narrow gaps: force compared with the exact series",
        "explicit_coupling": "Light bodies, contacts and new meshes: one system beside explicit coupling",
        "stability": "Extreme contacts and densities: where runs hold, and where they end",
        "contact_stepping": "Substeps and implicit steps: error against run time",
        "lammps": "200 dry spheres compared with LAMMPS",
    },
    "Stokes flow and swimmers": {
        "swimmer": "A three-sphere swimmer in 2D: way in a cycle compared with two other computations",
        "swimmer_3d": "The same in 3D: compared with the exact series",
        "swimmer_near_wall": "A swimmer comes to a wall: case of the paper",
        "dumbbell_in_shear": "Two balls on a rod turn in shear: period compared with the exact one",
    },
    "Meshes and distances": {
        "insertion": "Bodies inserted into domains: cell quality and what failed",
        "detectors": "Gaps among ellipses: error of each detector against its time",
        "distance_field": "Distance to a circle over a mesh: orders of convergence",
    },
    "Cost": {
        "work_precision": "Error against CPU time of the falling disk, compared with NGSolve and OpenFOAM",
        "backends_study": "Error against CPU time of each fluid backend",
        "backends": "A step of each backend, part by part",
        "adaptive_step": "Steps by a tolerance: when they pay",
        "step": "One step compared with the same step in NGSolve",
        "contact_step": "What a step with contacts costs",
        "settling_sphere": "Steps in 3D: iterations, time and memory",
        "parallel": "Many balls on several processes",
    },
}
HEAD = """# Validation

Made by `python docs/make_gallery.py`; a test fails where it is out of date. Each page behind a picture has the tables,
their sources, and how far the results are from them. They are made from runs by `make validate`.
[The main results in figures](figures.md), each with its reference and the test that holds it.
"""


def validation_index() -> str:
    """The whole page."""
    listed = [name for lines in SUBJECTS.values() for name in lines]
    there = {page.stem for page in VALIDATION.glob("*.md")}
    if wrong := there ^ set(listed):
        raise ValueError(f"found validation pages {sorted(wrong)}; allowed is each page once in SUBJECTS")
    sections = "\n".join(section(subject, lines) for subject, lines in SUBJECTS.items())
    tree = "\n".join(f"validation/{name}" for name in listed)
    return f"{HEAD}\n{sections}\n```{{toctree}}\n:hidden:\n\nfigures\n{tree}\n```\n"


def section(subject: str, lines: dict[str, str]) -> str:
    """Pictures of one subject as cards, each with one line."""
    cards = "\n\n".join(card(name, line) for name, line in lines.items())
    return f"## {subject}\n\n::::{{grid}} 1 2 2 3\n:gutter: 2\n\n{cards}\n\n::::\n"


def card(name: str, line: str) -> str:
    """One page: its first picture, its title and one line."""
    text = (VALIDATION / f"{name}.md").read_text(encoding="utf-8")
    title = text.splitlines()[0].removeprefix("# ")
    shown = re.search(r"!\[[^\]]*\]\(([^)]+)\)", text)
    picture = [":class-card: gallery-card", f":img-top: validation/{shown[1]}"] if shown else []
    lines = [f":::{{grid-item-card}} {title}", f":link: validation/{name}", ":link-type: doc", *picture]
    return "\n".join([*lines, "", f"{line}.", ":::"])
