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
        "settling_cylinder": "A cylinder leaves a channel's wall: terminal speed and drag compared with published ones",
        "ellipse_xia": "An ellipse settles in a channel: path and angle compared with Xia et al. (2009)",
        "ellipse_in_channel": "An ellipse in a narrow channel: how mesh, step and law affect its oscillations",
        "hundred_disks": "A hundred disks settle: a movie, energies and the cost",
        "falling_sphere": "A sphere falls in a box: height and speed compared with a published run",
        "settling_spheres": "Spheres settle at Re 41, 280 and 360: speeds compared with Mordant and Pinton (2000)",
        "ten_cate": "A sphere settles in oil and touches down: compared with the measurement of ten Cate et al. (2002)",
        "falling_ellipsoid": "An ellipsoid falls in a flat box: its path, and how it depends on the mesh",
        "many_bodies_3d": "Twenty spheres and ellipsoids settle: meshes, energies and the cost in 3D",
        "hundred_spheres": "A hundred spheres: meshes, memory and time",
    },
    "Flow past bodies and through channels": {
        "dfg_cylinder": "Steady flow past a cylinder: drag, lift and pressure of benchmark 2D-1",
        "dfg_unsteady": "Unsteady flow past a cylinder: drag and lift of benchmark 2D-3",
        "vortex_induced": "A cylinder on a spring in its own vortices: amplitude, compared with Shiels et al. (2001)",
        "wakes": "A fast disk and its wake: the effect of finer cells behind it",
        "window": "A short mesh moves with a disk in a long channel: compared with a mesh of the whole channel",
        "walls": "Curved and oblique walls: errors against exact flows, and their order",
        "migration_in_channel": "A disk migrates in a channel: path compared with Pan and Glowinski (2002)",
        "channel_of_disks": "72 disks in a channel at Re 1000: share across it compared with Chen et al. (2012)",
        "stenosis": "Two disks pass a throat: case 7 of the paper",
    },
    "Contacts": {
        "contacts_in_fluid": "Stiff contacts in a fluid: how much energy is created or lost",
        "energy_of_friction": "Contacts with friction, dry and wet: how much energy is created or lost",
        "stokes_contacts": "Contacts in Stokes flow: approach and rest compared with theory",
        "restitution": "Impacts that lose energy: rebound compared with the formula for Stokes numbers",
        "steel_rebound": "A steel sphere bounces in oil: height and time compared with Gondret et al. (2002)",
        "rebound_over_stokes": "Rebound over the Stokes number from 5 to 1,000, in 3D and 2D",
        "rebounds_after_falls": "Rebounds after falls at St 100, 152 and 742: one compared with Gondret et al. (2002)",
        "oblique_in_liquid": "Oblique impacts in a liquid: angles compared with those of dry impacts",
        "resistances": "Spheres in narrow gaps: forces and torques of all motions compared with exact series",
        "explicit_coupling": "Light bodies, contacts and new meshes: one system compared with explicit coupling",
        "stability": "Extreme contacts and densities: which runs succeed, and which fail",
        "contact_stepping": "Substeps and implicit steps: error against run time",
        "domino_rows": "Rows of dominoes: speed compared with a published theory",
        "lammps": "200 dry spheres compared with LAMMPS",
    },
    "Stokes flow and swimmers": {
        "periodic_arrays": "Drag in arrays of cylinders and spheres: compared with published tables",
        "materials": "Fluids whose viscosity varies: orders, drags between bounds, and their plastic limit",
        "drag_in_materials": "Disks and spheres in Bingham and thinning fluids: compared with published drags",
        "settling_arrays": "Spheres that settle as a cubic array: speeds compared with published drags and speeds",
        "effective_viscosity": "Sheared suspensions: viscosity by walls and by stresslets, compared with Einstein's",
        "swimmer": "A three-sphere swimmer in 2D: distance per cycle compared with two other computations",
        "swimmer_3d": "The same swimmer in 3D: compared with the exact series",
        "swimmer_near_wall": "A swimmer approaches a wall: a case of the paper",
        "dumbbell_in_shear": "Two balls on a rod turn in shear: period compared with the exact one",
    },
    "Heat": {
        "heat": "A heated cavity, a hot cylinder and bodies that conduct: compared with published numbers and theory",
        "cold_disk": "A cold disk falls: speed, flux, balances with many new meshes, and paths by the Grashof number",
    },
    "Meshes and distances": {
        "seams": "Disks that cross periodic surfaces: paths from two places and in a longer channel, and momentum",
        "enter_and_leave": "Ten bodies enter a box of fluid and leave it: account of energy and mass",
        "seeding": "Seeded swarms: fraction, gaps, radial distribution and cost",
        "mesh_estimate": "Cells that follow an estimate of their error: cells to an error compared with graded meshes",
        "mesh_for_forces": "Cells that follow the error of forces: cells to an error compared with graded meshes",
        "insertion": "Bodies inserted into domains: cell quality and failures",
        "detectors": "Gaps among ellipses: error of each detector against its time",
        "distance_field": "Distance to a circle over a mesh: orders of convergence",
    },
    "Cost": {
        "work_precision": "The falling disk: error against CPU time, compared with NGSolve and OpenFOAM",
        "backends_study": "Fluid backends: error against CPU time",
        "backends": "The cost of a step with each backend, part by part",
        "error_bars": "Error bars of velocities and forces: compared with true errors",
        "sensitivities": "Derivatives by values of a scene: compared with differences of runs, and their cost",
        "adaptive_step": "Steps by a tolerance: when they pay",
        "step": "One step compared with the same step in NGSolve",
        "contact_step": "What a step with contacts costs",
        "sheared_disks": "200 disks in a sheared periodic cell: seconds and memory of its steps",
        "spheres_in_cell": "64 spheres that settle in a periodic cell: seconds and memory of its steps",
        "step_profile": "Where the time of a step goes, in twelve classes of scenes",
        "settling_sphere": "Steps in 3D: iterations, time and memory",
        "parallel": "Many balls on several processes",
    },
    "Tests": {
        "tests": "The validation tests: which pass, and which fail",
    },
}
HEAD = """# Validation

Each page behind a picture has tables, the sources of the reference values, and the differences from them.
`make validate` makes these pages from runs. [The main results in figures](figures.md) lists figures with their
references and the tests that check them. (`python docs/make_gallery.py` writes this page; a test fails if it is out
of date.)
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
